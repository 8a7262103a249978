"""Quantifiers over groups online agree with the oracle of members that evaluates every member on a trace of its own.

Members have numbers, a Boolean and a member of an enumeration, come as fields or as objects, appear and disappear;
monitors are pickled and copied between two samples.
"""

from __future__ import annotations

import copy
import math
import pickle
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from tests.laws.test_agent_laws import FIELDS, SIZE, Writer, going_on, presence, same
from tests.oracle import agents
from tests.oracle.agents import Group, World

if TYPE_CHECKING:
    import random
    from collections.abc import Mapping, Sequence

    from tests.oracle.agents import Node

HEAD = """
enum Mode { Idle = 0, Busy = 4 }
group cars = "car_*" { float x; float v; bool on; Mode mode }
float y
"""


class TypedWriter(Writer):
    """Draws formulas that read Booleans and enumerations of members, too."""

    def formula(self, scope: list[str], depth: int) -> Node:
        if scope and self.rng.random() < 0.15:
            name = self.rng.choice(scope)
            if self.rng.random() < 0.5:
                return ("truth", name, "on")
            return ("mode", name, self.rng.choice(sorted(agents.MODES)))
        return super().formula(scope, depth)


def world(rng: random.Random, *, dense: bool = False) -> World:
    cars: dict[str, Any] = {}
    for k in range(rng.choice([1, 2, 3])):
        shown = presence(rng, SIZE)
        draw = dict.fromkeys(FIELDS, lambda: rng.randint(-8, 8) / 2)
        draw |= {
            "on": lambda: float(rng.random() < 0.5),
            "mode": lambda: rng.choice([*agents.MODES.values()]),
        }
        cars[f"car_{k}"] = {
            field: [value() if here else None for here in shown] for field, value in draw.items()
        }
    y = [rng.randint(-8, 8) / 2 for _ in range(SIZE)]
    return World({"y": y}, {"cars": Group(cars)}, SIZE, 1.0, dense)


def sample(rng: random.Random, known: World, t: int, *, absent: bool = False) -> dict[str, Any]:
    """Return what an update takes: fields under names with dots, or objects; ``absent``: None for an absent member."""
    values: dict[str, Any] = {"y": known.signals["y"][t]}
    for member, fields in known.groups["cars"].members.items():
        given = {name: column[t] for name, column in fields.items()}
        if given["x"] is None:
            if absent or rng.random() < 0.3:
                values |= {f"{member}.{name}": None for name in given}
            continue
        given["on"] = rng.choice([bool, float])(given["on"])
        given["mode"] = rng.choice([given["mode"], "Busy" if given["mode"] else "Idle"])
        if rng.random() < 0.5:
            values[member] = SimpleNamespace(**given)
        else:
            values |= {f"{member}.{name}": value for name, value in given.items()}
    return values


def moved(rng: random.Random, monitor: Any, other: Mapping[str, Any], t: int) -> Any:
    """Return a monitor in the same state; what happens to the one before changes nothing."""
    how = rng.choice([None, None, None, "pickle", "copy", "deepcopy"])
    if how is None:
        return monitor
    made = pickle.loads(pickle.dumps(monitor)) if how == "pickle" else getattr(copy, how)(monitor)
    monitor.update(t, **other)
    return made


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(rng=st.randoms(use_true_random=False))
@settings(max_examples=60)
def test_monitors_of_members_give_what_the_oracle_gives(backend, rng):
    formula = TypedWriter(rng, dense=False).closed()
    known, other = world(rng), world(rng)
    expected = agents.evaluate(known, formula)
    monitor = rtamt.parse(HEAD + agents.text(formula), backend=backend).monitor()
    found: list[float] = []
    for t in range(SIZE):
        monitor = moved(rng, monitor, sample(rng, other, t), t)
        robustness = monitor.update(t, **sample(rng, known, t))
        found += [] if robustness is None else [robustness]
    found += monitor.finish().values.tolist()
    assert same(found, expected), agents.text(formula)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(rng=st.randoms(use_true_random=False))
@settings(max_examples=40)
def test_bounds_of_members_contain_what_the_oracle_gives_and_end_there(backend, rng):
    formula = TypedWriter(rng, dense=False).closed()
    known, other = world(rng), world(rng)
    expected = agents.evaluate(known, formula)
    spec = rtamt.parse(HEAD + agents.text(formula), backend=backend)
    monitor, horizon = spec.monitor(verdict="interval"), int(spec.horizon)
    bounds = [rtamt.Interval(-math.inf, math.inf)] * SIZE

    def take(changes: Sequence[Any]) -> None:
        for change in changes:
            for t in range(int(change.begin), min(int(change.end), SIZE - 1) + 1):
                bounds[t] = change.interval

    for t in range(SIZE):
        monitor = moved(rng, monitor, sample(rng, other, t), t)
        monitor.update(t, **sample(rng, known, t))
        take(monitor.changes())
        for k in range(SIZE - horizon):  # windows that the end of the trace does not cut
            assert bounds[k].lower <= expected[k] <= bounds[k].upper, agents.text(formula)
            assert k + horizon > t or bounds[k] == rtamt.Interval(expected[k], expected[k])
    take(monitor.finish())
    assert [(each.lower, each.upper) for each in bounds] == [(e, e) for e in expected], agents.text(formula)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(rng=st.randoms(use_true_random=False))
@settings(max_examples=60)
def test_in_dense_time_monitors_of_members_give_what_the_oracle_gives(backend, rng):
    formula = TypedWriter(rng, dense=True).closed()
    known, other = world(rng, dense=True), world(rng, dense=True)
    if all(values is None for car in known.groups["cars"].members.values() for values in car["x"]):
        return
    expected = agents.evaluate(going_on(known, 60), formula)[: SIZE + 1]
    spec = rtamt.parse(HEAD + agents.text(formula), time="dense", resolution="1s", backend=backend)
    monitor = spec.monitor()
    times: list[float] = []
    values: list[float] = []

    def take(signal: Any) -> None:
        times.extend(signal.times)
        values.extend(signal.values)

    for t in range(SIZE):
        monitor = moved(rng, monitor, sample(rng, other, t, absent=True), t)
        take(monitor.update(t, **sample(rng, known, t, absent=True)))
    take(monitor.update(SIZE, y=known.signals["y"][-1]))
    take(monitor.finish())
    at = np.searchsorted(times, np.arange(SIZE + 1), side="right") - 1
    assert same(np.asarray(values)[at], expected), agents.text(formula)
