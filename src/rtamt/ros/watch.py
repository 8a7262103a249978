"""One output: its pastified formula under robustness and Boolean semantics, over either kind of time."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from rtamt.engine.dense_signals import TickSignal
from rtamt.engine.ticks import NANOSECOND
from rtamt.errors import SpecificationError
from rtamt.language.formula import variables
from rtamt.rewrite.horizon import horizon

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.engine.signals import Signal
    from rtamt.ros.binding import Output
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class Robustness:
    """How robust an output's pastified formula was at ``stamp`` (nanoseconds)."""

    output: Output
    stamp: int
    value: float


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether an output's formula held at ``stamp - horizon``.

    ``stamp``: nanoseconds. ``horizon``: seconds. ``satisfied`` is None while that instant lies before
    the first sample.
    """

    output: Output
    stamp: int
    horizon: float
    satisfied: bool | None


#: Messages that are kept while another topic is silent.
HELD = 1000

Record: TypeAlias = Robustness | Verdict


class Watch:
    """What both kinds of time share. ``topic_of``: from the name of a number to its topic."""

    def __init__(self, output: Output, topic_of: Mapping[str, str], period: Fraction | None) -> None:
        self.output = output
        formula = output.specification.formula
        self.names = variables(formula)
        self.topics = frozenset(topic_of[name] for name in self.names)
        self.past = _past(output, period)
        depth = horizon(formula, period or Fraction(1))
        assert depth is not None, "unbounded future was refused"
        self.depth = depth
        self.horizon = float(depth)
        self.latest: float | None = None
        self.satisfied: bool | None = None
        #: Why the last sample could not be used.
        self.fault: str | None = None


def _past(output: Output, period: Fraction | None) -> Specification:
    """Return the specification of past operators alone, equal one horizon later."""
    spec = output.specification
    try:
        formula = spec.pastified(period)
    except SpecificationError as error:
        raise type(error)(f"'{output.name}': {error.message}", error.text, error.span) from None
    *before, last = spec.document.assertions
    return replace(
        spec, document=replace(spec.document, assertions=(*before, replace(last, formula=formula)))
    )


class DiscreteWatch(Watch):
    """Samples one period apart."""

    def __init__(self, output: Output, topic_of: Mapping[str, str], period: Fraction) -> None:
        super().__init__(output, topic_of, period)
        self._robustness = self.past.monitor(time="discrete", period=period)
        self._verdict = self.past.monitor(time="discrete", period=period, semantics="boolean")
        self._lag = int(self.depth / period)

    @property
    def samples(self) -> int:
        """How many samples were taken since the beginning or the last reset."""
        return self._robustness.samples

    def take(self, stamp: int, values: Mapping[str, float]) -> list[Record]:
        """Take one sample; raise :class:`StlError` where it cannot be used."""
        row = [values[name] for name in self.names]
        value, truth = self._robustness.step(*row), self._verdict.step(*row)
        assert value is not None, "a formula of the past is known at once"
        assert truth is not None
        self.latest = value
        self.satisfied = truth > 0 if self.samples > self._lag else None
        return [
            Robustness(self.output, stamp, value),
            Verdict(self.output, stamp, self.horizon, self.satisfied),
        ]

    def reset(self) -> None:
        """Forget all samples."""
        self._robustness.reset()
        self._verdict.reset()
        self.latest = self.satisfied = None


class DenseWatch(Watch):
    """Samples at the times in the messages' headers, each topic on its own clock."""

    def __init__(self, output: Output, topic_of: Mapping[str, str]) -> None:
        super().__init__(output, topic_of, None)
        # A tick is a nanosecond, so that what comes out needs no conversion.
        self._robustness = self.past.monitor(time="dense", resolution=NANOSECOND)
        self._verdict = self.past.monitor(time="dense", resolution=NANOSECOND, semantics="boolean")
        self._lag = round(self.depth * 10**9)
        self._start: int | None = None
        self._held: deque[tuple[int, dict[str, float]]] = deque(maxlen=HELD)

    @property
    def samples(self) -> int:
        """How many numbers were taken since the beginning or the last reset."""
        return self._robustness.samples

    def hold(self, stamp: int, values: Mapping[str, float]) -> None:
        """Keep a message while another topic has nothing to say, of many the latest: the trace begins when all do."""
        self._held.append((stamp, self._mine(values)))

    def take(self, stamp: int, values: Mapping[str, float]) -> list[Record]:
        """Take the numbers of one message; raise :class:`StlError` where they cannot be used."""
        records: list[Record] = []
        while self._held:
            before, held = self._held.popleft()
            records += self._update(before, held)
        return records + self._update(stamp, self._mine(values))

    def _mine(self, values: Mapping[str, float]) -> dict[str, float]:
        return {name: values[name] for name in self.names if name in values}

    def _update(self, stamp: int, values: dict[str, float]) -> list[Record]:
        time = np.int64(stamp)  # an integer of numpy means nanoseconds
        known, truths = self._robustness.update(time, **values), self._verdict.update(time, **values)
        points = _points(known)
        records: list[Record] = [Robustness(self.output, t, value) for t, value in points]
        if points:
            self.latest = points[-1][1]
            self._start = points[0][0] if self._start is None else self._start
        return records + [self._judge(t, truth) for t, truth in _points(truths)]

    def _judge(self, stamp: int, truth: float) -> Verdict:
        assert self._start is not None
        self.satisfied = truth > 0 if stamp >= self._start + self._lag else None
        return Verdict(self.output, stamp, self.horizon, self.satisfied)

    def reset(self) -> None:
        """Forget all samples."""
        self._robustness.reset()
        self._verdict.reset()
        self._held.clear()
        self._start = self.latest = self.satisfied = None


def _points(signal: Signal) -> list[tuple[int, float]]:
    if isinstance(signal, TickSignal):
        return signal.points()
    return list(zip(signal.times.tolist(), signal.values.tolist(), strict=True))
