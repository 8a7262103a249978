"""The definition of bounds in dense time: formula and partial knowledge of signals to [L, U] at every instant.

As in discrete time (``discrete_bounds.py``), on step functions. A sample is known to hold its value for the tick of
its own time, and from there up to the next sample of its variable, as far as no other sample can arrive between them.
Elsewhere only the declared range is known, until no more samples arrive: then the last value is held for ever.
"""

from __future__ import annotations

from bisect import bisect_right
from math import inf, isnan
from typing import TYPE_CHECKING, TypeAlias

from rtamt.language.definitions.dense import QUARTERS, Steps, merged
from rtamt.language.definitions.enclosures import Enclosure
from rtamt.language.formula import Apply, Const, Formula, Var, fold, postorder
from rtamt.language.records import Sum
from rtamt.language.undefined_value import UndefinedAtTickError
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.reference.cores import core_of, inside_predicates
from rtamt.reference.definition_adapter import signal_of, window_in_quarters
from rtamt.reference.dense_robustness import last_read
from rtamt.reference.discrete_bounds import ANYTHING, Range, componentwise, pointwise
from rtamt.rewrite.desugar import written

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    #: Times in ticks, and the lower and the upper bound of the value from each of them on.
    Samples: TypeAlias = tuple[Sequence[int], Sequence[float], Sequence[float]]


class StepBounds(NamedTuple):
    """[L, U] over time: from each of ``times`` (ticks, strictly increasing) up to the next, the last for ever."""

    times: tuple[int, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]

    def at(self, tick: int) -> Range:
        """Return the bounds at a tick, not before the first of ``times``."""
        i = bisect_right(self.times, tick) - 1
        return self.lower[i], self.upper[i]


@dataclass(frozen=True, slots=True)
class DenseKnowledge:
    """The known part of signals: the samples of every variable so far, each with bounds of its value.

    ``ranges`` are the declared ones, which hold where nothing else is known; without one a variable may be
    anything. ``finished``: no more samples will arrive. ``closed``: of variables the tick up to which, inclusive,
    no more samples will arrive; without one that of the newest sample. ``later``: what is supposed of variables where
    nothing but the range is known after their newest samples: bounds from each time on, the last for ever. ``end``:
    the tick of the newest sample of any variable, also of others; by default of these. ``begins``: the tick at which
    the trace is supposed to begin.
    """

    samples: Mapping[str, Samples]
    ranges: Mapping[str, Range] = field(default_factory=dict)
    finished: bool = False
    closed: Mapping[str, int] = field(default_factory=dict)
    later: Mapping[str, Samples] = field(default_factory=dict)
    end: int | None = None
    begins: int | None = None

    @property
    def start(self) -> int | None:
        """The tick at which the trace begins; None while the first sample of a variable may still arrive."""
        if self.begins is not None:
            return self.begins
        for name, (times, _, _) in self.samples.items():
            if not len(times) or (int(times[0]) > self.until(name) + 1 and not self.finished):
                return None
        return self.latest_first

    @property
    def latest_first(self) -> int | None:
        """The tick at which it begins unless an earlier sample arrives; None while a variable has none."""
        if not all(len(times) for times, _, _ in self.samples.values()):
            return None
        return max(int(times[0]) for times, _, _ in self.samples.values())

    def until(self, name: str) -> int:
        """Return the tick up to which a variable that has samples is as well known as it will ever be."""
        return self.closed.get(name, int(self.samples[name][0][-1]))

    @property
    def complete(self) -> int:
        """The same of all variables; they have samples."""
        return min(map(self.until, self.samples))

    def of(self, names: Collection[str]) -> DenseKnowledge:
        """Return the knowledge about some of the variables."""
        samples = {name: self.samples[name] for name in names}
        return DenseKnowledge(samples, self.ranges, self.finished, self.closed, self.later, self.newest)

    @property
    def newest(self) -> int:
        """The tick of the newest sample of any variable, 0 before the first."""
        if self.end is not None:
            return self.end
        return max((int(times[-1]) for times, _, _ in self.samples.values() if len(times)), default=0)


class _Signal(NamedTuple):
    lower: Steps
    upper: Steps


class Parts(NamedTuple):
    """The bounds of all parts of a formula, in quarters of a tick, over a trace that starts at ``origin``."""

    origin: int = 0
    bounds: tuple[_Signal, ...] = ()


def bounds(
    formula: Formula,
    known: DenseKnowledge,
    tick: Fraction,
    *,
    earlier: Parts | None = None,
    report: Callable[[Parts], None] | None = None,
) -> StepBounds:
    """Return [L, U] of a formula from the start of the trace on; ``tick`` is seconds.

    Before the trace has started nothing but the ranges is known, and time counts from tick 0. ``report`` receives
    the bounds of all parts; ``earlier`` are those of less knowledge, which hold where an operation that has no value
    yet is no error. Raises what :func:`rtamt.reference.discrete_bounds.bounds` raises.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> soon = parse_formula("eventually[0:2](x >= 3)")
    >>> bounds(soon, DenseKnowledge({"x": ([0, 5], [1, 4], [1, 4])}, {"x": (0, 5)}), Fraction(1))
    StepBounds(times=(0, 3, 4, 6), lower=(-2.0, 1.0, 1.0, -3.0), upper=(-2.0, 1.0, 2.0, 2.0))
    """
    core, ahead = core_of(formula, tick, continuous=True)
    own: list[_Signal] = []
    inside: set[int] | None = None  # once an operation has no value
    start = known.start
    origin = (0 if start is None else start) * QUARTERS
    signals = {name: _signal(name, known, origin, started=start is not None) for name in known.samples}
    complete = None if start is None else known.complete
    last = known.newest * QUARTERS
    read = last_read(core, last, tick) if known.finished else {}

    def final(node: Formula) -> float:
        """Return the last instant, in quarters, whose value is final, and in the trace or read at its end."""
        if known.finished:
            limit = read[id(node)]
            return inf if limit is None else limit
        depth = ahead[id(node)]
        if complete is None or depth is None:
            return -inf
        return min(last, (complete - depth) * QUARTERS)

    def step(node: Formula, below: tuple[_Signal, ...]) -> _Signal:
        nonlocal inside
        value = _apply(node, below, signals, origin, tick)

        def certain(t: int) -> bool:
            """Return whether operands are numbers at an instant of the trace, or will not be known better."""
            exact = start is not None and t <= last and all(x.lower.at(t) == x.upper.at(t) for x in below)
            return exact or t <= final(node)

        defined = _defined(value, node, formula, certain, tick)
        if defined is not value and inside is None and earlier is not None:
            inside = inside_predicates(core)
        if inside is not None and earlier is not None and id(node) not in inside:
            defined = _narrower(defined, earlier.bounds[len(own)], origin - earlier.origin)
        own.append(defined)
        return defined

    with np.errstate(all="ignore"):
        found = fold(core, step)
    if report is not None:
        report(Parts(origin, tuple(own)))
    return _in_ticks(found)


def bounds_of_parts(formula: Formula, known: DenseKnowledge, tick: Fraction) -> dict[Formula, StepBounds]:
    """Return [L, U] of every part of the core of a formula, as :func:`bounds` does of the whole.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> soon, known = parse_formula("eventually[0:2](x >= 3)"), DenseKnowledge({"x": ([0], [4], [4])}, {"x": (0, 5)})
    >>> {str(part): found.lower for part, found in bounds_of_parts(soon, known, Fraction(1)).items()}
    {'x': (4.0, 0), '3': (3.0,), 'x - 3': (1.0, -3.0), 'eventually[0:2](x - 3)': (1.0, -3.0)}
    """
    reported: list[Parts] = []
    bounds(formula, known, tick, report=reported.append)
    return by_part(formula, reported[0], tick)


def by_part(formula: Formula, parts: Parts, tick: Fraction) -> dict[Formula, StepBounds]:
    """Return what was reported of all parts of a formula by the parts of its core."""
    nodes = postorder(core_of(formula, tick, continuous=True).formula)
    return {node: _in_ticks(found) for node, found in zip(nodes, parts.bounds, strict=True)}


def _in_ticks(signal: _Signal) -> StepBounds:
    lower, upper = signal
    times = sorted({*lower.times, *upper.times})
    return StepBounds(tuple(t // QUARTERS for t in times), tuple(lower.over(times)), tuple(upper.over(times)))


def least(parts: Sequence[StepBounds]) -> StepBounds:
    """Return the bounds of a minimum: at each instant over those that have begun, each with its first time.

    >>> least([StepBounds((0, 4), (1, 5), (1, 6)), StepBounds((2,), (3,), (3,))])
    StepBounds(times=(0, 4), lower=(1, 3), upper=(1, 3))
    """
    rows: list[tuple[int, float, float]] = []
    for t in sorted({t for part in parts for t in part.times}):
        begun = [part.at(t) for part in parts if part.times[0] <= t]
        pair = min(low for low, _ in begun), min(high for _, high in begun)
        if not rows or rows[-1][1:] != pair:
            rows.append((t, *pair))
    times, lower, upper = zip(*rows, strict=True)
    return StepBounds(times, lower, upper)


def _narrower(x: _Signal, y: _Signal, shift: int) -> _Signal:
    """Return what two bounds of the same numbers imply, of which the second are later by so much."""
    ends = []
    for one, other, choose in zip(x, y, (max, min), strict=True):
        moved = Steps(tuple(t + shift for t in other.times), other.values)
        times = sorted({*one.times, *(t for t in moved.times if t >= one.times[0])})
        ends.append(merged(times, [choose(one.at(t), moved.at(t)) for t in times]))
    return _Signal(*ends)


def _signal(name: str, known: DenseKnowledge, origin: int, *, started: bool) -> _Signal:
    """Return the bounds of a variable from the start of the trace on, in quarters of a tick."""
    low, high = known.ranges.get(name, ANYTHING)
    if not started:
        return _Signal(Steps((origin,), (low,)), Steps((origin,), (high,)))
    samples = [
        (int(t), float(lower), float(upper)) for t, lower, upper in zip(*known.samples[name], strict=True)
    ]
    if not known.finished:
        samples = _held(samples, known.until(name), (low, high))
        behind = samples[-1][0]
        for t, lower, upper in zip(*known.later.get(name, ((), (), ())), strict=True):
            samples = [
                *(each for each in samples if each[0] < max(t, behind)),
                (max(t, behind), lower, upper),
            ]
    steps = []
    for column in (1, 2):
        whole = Steps(tuple(each[0] * QUARTERS for each in samples), tuple(each[column] for each in samples))
        later = [t for t in whole.times if t > origin]
        steps.append(merged([origin, *later], whole.over((origin, *later))))
    return _Signal(*steps)


def _held(
    samples: Sequence[tuple[int, float, float]], until: int, range_: Range
) -> list[tuple[int, float, float]]:
    """Return samples with the range where they do not hold: each does for its own tick, and up to ``until``."""
    held = []
    for sample, after in zip(samples, [*(t for t, _, _ in samples[1:]), None], strict=True):
        held.append(sample)
        end = max(sample[0], until) + 1
        if after is None or end < after:
            held.append((end, *range_))
    return held


def _apply(
    node: Formula, below: tuple[_Signal, ...], signals: Mapping[str, _Signal], origin: int, tick: Fraction
) -> _Signal:
    """Return one sub-formula's bounds from those of its operands."""
    if isinstance(node, Const):
        constant = Steps((origin,), (node.value,))
        return _Signal(constant, constant)
    if isinstance(node, Var):
        return signals[node.name]
    if not isinstance(node, Apply):
        raise TypeError(f"not a formula: {node!r}")
    if node.op.extension is not None:
        times = sorted({t for x in below for steps in x for t in steps.times})
        operands = tuple(
            Enclosure(np.array(lower.over(times)), np.array(upper.over(times))) for lower, upper in below
        )
        lower, upper = pointwise(node, operands)
        return _Signal(merged(times, lower.tolist()), merged(times, upper.tolist()))
    if not isinstance(node.op.kernel, Sum):  # of pulses: the certain ones, and the possible ones
        componentwise(node)
    window = (*window_in_quarters(node, tick), tick)
    return _Signal(
        signal_of(node, tuple(x.lower for x in below), *window),
        signal_of(node, tuple(x.upper for x in below), *window),
    )


def _defined(
    value: _Signal, node: Formula, formula: Formula, certain: Callable[[int], bool], tick: Fraction
) -> _Signal:
    """Raise the error for a value that certainly does not exist; one that is not certain may be anything."""
    if not any(map(isnan, value.lower.values)) and not any(map(isnan, value.upper.values)):
        return value
    times = sorted({*value.lower.times, *value.upper.times})
    pairs = list(zip(value.lower.over(times), value.upper.over(times), strict=True))
    wrong = [i for i, pair in enumerate(pairs) if any(map(isnan, pair))]
    for i in wrong:
        if certain(times[i]):
            seconds = float(times[i] * tick / QUARTERS)
            raise UndefinedAtTickError(written(node, [formula]), times[i] // QUARTERS, seconds)
    for i in wrong:
        pairs[i] = (-inf, inf)
    return _Signal(merged(times, [low for low, _ in pairs]), merged(times, [high for _, high in pairs]))
