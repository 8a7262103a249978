"""Time in turns: samples are counted, whatever their timestamps are."""

from dataclasses import dataclass
from fractions import Fraction
from typing import ClassVar

import numpy as np

from rtamt.rewrite.check import PERIODS, check_bounds
from rtamt.signals.arrays import columns_of
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.discrete import DiscreteTrace
from rtamt.signals.time_domain_interface import TimeDomain

TURN = Fraction(1)


@dataclass(frozen=True)
class Turns(TimeDomain):
    name = "turns"
    summary = "samples are counted"
    continuous = False
    sampled = True
    own_time_bases = False
    held_at_end = False
    unit = PERIODS
    setting = "period"
    parts: ClassVar = {
        "engine": "tests.unit.signals.third_domain:ENGINE",
        "time_axis": "rtamt.engine.discrete.time_axis:DiscreteTimeAxis",
    }

    @classmethod
    def of(cls, period, tolerance, resolution):  # noqa: ARG003 - it has none
        return cls()

    @property
    def step(self):
        return TURN

    @property
    def online(self):
        return self

    def check(self, formula, text=None):
        check_bounds(formula, TURN, text, self.unit)

    def check_inputs(self, names):
        """Any variables will do."""

    def record(self, data, names, unit=None, types=NO_TYPES):
        _, columns, n = columns_of(data, names, unit, types)
        return TurnTrace(np.arange(n, dtype=float), columns, TURN)


class TurnTrace(DiscreteTrace):
    @property
    def domain(self):
        return Turns()
