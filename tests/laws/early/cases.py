"""Random formulas, traces and partial knowledge of them, all drawn from a ``random.Random``."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, Interval, Var
from rtamt.language.operators import STL, Bounds, Fixity, Operator, Sort, Tense
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.shares import Share, ShareKind
from rtamt.rewrite.horizon import horizon

if TYPE_CHECKING:
    from random import Random

Range = tuple[float, float]
#: What is known of a sample: bounds, or None where it is missing.
Known = Range | None

ANYTHING: Range = (-math.inf, math.inf)
#: Functions that have no value everywhere, or whose bounds are widened: drawn seldom.
ODD = frozenset(op.name for op in STL if op.fixity is Fixity.FUNCTION and op.result is Sort.NUMBER) - {
    "abs",
    "min",
    "max",
} | {"div"}


def formula(
    rng: Random, names: tuple[str, ...], *, depth: int = 3, dense: bool = False, **kinds: bool
) -> Formula:
    """Draw a formula; ``kinds`` are what it may hold: ``odd`` functions, ``past``, ``arithmetic``, ``unbounded``."""

    def allowed(op: Operator) -> bool:
        return (
            not (dense and op.discrete_only)
            and not op.presence  # what is missing in a case has a value all the same
            and (kinds.get("odd", True) or op.name not in ODD)
            and (kinds.get("past", True) or op.tense is not Tense.PAST)
            and (kinds.get("arithmetic", True) or op.result is Sort.FORMULA)
        )

    by_sort = {sort: [op for op in STL if op.result is sort and allowed(op)] for sort in Sort}
    by_sort[Sort.CONDITION] = by_sort[Sort.FORMULA]

    def number(depth: int) -> Formula:
        if depth == 0 or not by_sort[Sort.NUMBER] or rng.random() < 0.6:
            return Var(rng.choice(names)) if rng.random() < 0.75 else Const(rng.randint(-4, 4) / 2)
        return apply(rng.choice(by_sort[Sort.NUMBER]), depth)

    def apply(op: Operator, depth: int) -> Formula:
        if op.name in ODD and rng.random() < 0.7:
            return number(0)
        count = len(op.operands) - rng.randint(0, op.optional)
        operands = [draw(sort, depth - 1) for sort in op.operands[:count]]
        return Apply(op, tuple(operands), _interval(rng, op, unbounded=kinds.get("unbounded", False)))

    def draw(sort: Sort, depth: int) -> Formula:
        if sort is Sort.NUMBER:
            return number(max(depth, 0))
        if depth <= 0:
            odd = sort is Sort.FORMULA and rng.random() < 0.3
            return Var(rng.choice(names)) if odd else apply(STL[rng.choice(("ge", "gt", "le", "lt"))], 1)
        return apply(rng.choice(by_sort[sort]), depth)

    return draw(Sort.FORMULA, depth)


def _reading(rng: Random, **kinds: bool) -> Formula:
    """Draw a formula that reads a variable; ``partial``: with a function that has no value of some delayed numbers."""
    if kinds.pop("partial", False):
        return partial(rng)
    while True:
        drawn = formula(rng, ("x", "y"), depth=rng.randint(1, 3), **kinds)
        if variables(drawn):
            return drawn


def partial(rng: Random) -> Formula:
    """Draw a formula with a function that has no value of some delayed numbers."""
    delay = f"delay[{rng.randint(1, 3)}](x, {rng.choice((0, 1, -1))})"
    other = rng.choice(("y", f"ahead[{rng.randint(1, 2)}](y)", "delay[1](y, 1)"))
    number = rng.choice((f"sqrt({delay})", f"1 / {delay}", f"{other} / {delay}", f"sqrt({delay} + {other})"))
    begin, end = sorted(rng.sample(range(4), 2))
    above = rng.choice(
        (
            "{0} < 1",
            "eventually[{1}:{2}]({0} < 1) and x > 0",
            "{0} < 1 or always[{1}:{2}](x > 0)",
            "once[{1}:{2}]({0} < 1)",
            "({0} < 1) until[{1}:{2}] (x > 0)",
            "(y > 0) until[{1}:{2}] ({0} < 1)",
        )
    )
    return parse_formula(above.format(number, begin, end))


def _interval(rng: Random, op: Operator, *, unbounded: bool) -> Interval | None:
    if op.bounds is Bounds.NONE:
        return None
    begin, length = rng.randint(0, 2), rng.randint(0, 3)
    if op.bounds is Bounds.DURATION:
        begin = max(begin, op.positive)
        return Interval(Fraction(begin), Fraction(begin))
    if op.bounds is Bounds.OPTIONAL and (unbounded or op.tense is Tense.PAST) and rng.random() < 0.3:
        return None if rng.random() < 0.5 else Interval(Fraction(begin), None)
    if op.share:  # in dense time the window must not be an instant
        percent = Share(Fraction(rng.randint(1, 100)), ShareKind.PERCENT)
        share = rng.choice((percent, Share(Fraction(rng.randint(1, length + 1)), ShareKind.DURATION)))
        return Interval(Fraction(begin), Fraction(begin + length + 1), share=share)
    return Interval(Fraction(begin), Fraction(begin + length))


@dataclass(frozen=True)
class Case:
    """A formula, and a trace of discrete time that goes on for a horizon after the n samples that come.

    Of unbounded future the trace goes on for one sample.
    """

    formula: Formula
    names: tuple[str, ...]
    ranges: dict[str, Range]
    #: The whole trace.
    truth: dict[str, list[float]]
    #: Of each sample that comes, what is known of each variable: always bounds that hold the truth.
    samples: list[dict[str, Known]]

    @property
    def n(self) -> int:
        return len(self.samples)

    @property
    def exact(self) -> bool:
        return all(each is not None and each[0] == each[1] for row in self.samples for each in row.values())

    def known(self, name: str, i: int) -> Range:
        """Return the bounds of a variable at a sample."""
        found = self.samples[i][name]
        return self.ranges.get(name, ANYTHING) if found is None else found


def value(rng: Random, low: float = -4.0, high: float = 4.0) -> float:
    return min(max(rng.randint(-8, 8) / 2, low), high)


def _ranges(rng: Random, names: tuple[str, ...], share: float) -> dict[str, Range]:
    chosen = [name for name in names if rng.random() < share]
    return {name: (min(ends), max(ends)) for name in chosen if (ends := (value(rng), value(rng)))}


def _known(rng: Random, true: float, limits: Range, *, exact: bool) -> Known:
    kind = "exact" if exact else rng.choice(("exact", "exact", "bounds", "missing"))
    if kind == "missing":
        return None
    if kind == "exact":
        return true, true
    low, high = limits
    return max(true - rng.randint(0, 4) / 2, low), min(true + rng.randint(0, 4) / 2, high)


def case(
    rng: Random, *, exact: bool | None = None, ranges: bool | None = None, most: int = 8, **kinds: bool
) -> Case:
    """Draw a case of discrete time; ``exact`` and ``ranges``: whether, by default either."""
    drawn = _reading(rng, **kinds)
    names, depth = variables(drawn), horizon(drawn) or 0
    limits = _ranges(rng, names, 0.4) if ranges is None else _ranges(rng, names, 1.0) if ranges else {}
    sharp = rng.random() < 0.5 if exact is None else exact
    n = rng.randint(1, most)
    truth = {
        name: [value(rng, *limits.get(name, ANYTHING)) for _ in range(n + int(depth) + 1)] for name in names
    }
    samples = [
        {name: _known(rng, truth[name][i], limits.get(name, ANYTHING), exact=sharp) for name in names}
        for i in range(n)
    ]
    return Case(drawn, names, limits, truth, samples)


@dataclass(frozen=True)
class DenseCase:
    """A formula, signals, and the updates in which their samples come: ticks, and what is known of some variables."""

    formula: Formula
    names: tuple[str, ...]
    ranges: dict[str, Range]
    updates: list[tuple[int, dict[str, Known]]]
    #: Of each variable all samples, also later ones that never come: times and values.
    truth: dict[str, tuple[list[int], list[float]]] = field(default_factory=dict)

    @property
    def exact(self) -> bool:
        return all(
            each is not None and each[0] == each[1] for _, row in self.updates for each in row.values()
        )

    def bounded(self, k: int) -> list[tuple[int, dict[str, Range]]]:
        """Return the first k updates with the bounds of every variable in them."""
        return [
            (t, {name: self.ranges.get(name, ANYTHING) if v is None else v for name, v in row.items()})
            for t, row in self.updates[:k]
        ]


@dataclass(frozen=True)
class Arrivals:
    """The samples of a case in the order in which they come, one by one.

    Each has a time, a name, what is known of it, and perhaps a watermark that comes after it. ``lateness``: by how
    much one comes at most after the newest. ``truth``: as in the case, without what would come too late.
    """

    samples: list[tuple[int, str, Known, int | None]]
    lateness: int
    truth: dict[str, tuple[list[int], list[float]]]


def arrivals(rng: Random, case: DenseCase) -> Arrivals:
    """Draw an order; some samples come twice, first less exactly, and watermarks are as late as they can be."""
    order = [(t, name, known) for t, row in case.updates for name, known in row.items()]
    rng.shuffle(order)
    if rng.random() < 0.5:
        order.sort(key=lambda each: each[0] + rng.randint(0, 4))
    came, last = {each[:2] for each in order}, max(t for t, _ in case.updates)
    truth: dict[str, tuple[list[int], list[float]]] = {}
    for name, (times, values) in case.truth.items():
        kept = [(t, v) for t, v in zip(times, values, strict=True) if (t, name) in came or t > last]
        truth[name] = [t for t, _ in kept], [v for _, v in kept]
    newest, lateness = -(10**9), 0
    samples: list[tuple[int, str, Known, int | None]] = []
    for i, (t, name, known) in enumerate(order):
        newest = max(newest, t)
        lateness = max(lateness, newest - t)
        if known is not None and rng.random() < 0.2:
            vague = max(known[0] - 1, case.ranges.get(name, ANYTHING)[0]), known[1]
            samples.append((t, name, vague, None))
        mark = min([each[0] - 1 for each in order[i + 1 :]], default=last) if rng.random() < 0.2 else None
        samples.append((t, name, known, mark))
    return Arrivals(samples, lateness + rng.choice((1, 1, 3)), truth)


def dense_case(
    rng: Random,
    *,
    exact: bool | None = None,
    ranges: bool | None = None,
    ordered: bool | None = None,
    narrow: bool = False,
    **kinds: bool,
) -> DenseCase:
    """Draw a case of dense time; ``ordered``: whether the updates come in the order of their times.

    ``narrow``: few samples, ranges of two values.
    """
    drawn = _reading(rng, dense=True, **{"unbounded": True, **kinds})
    names = variables(drawn)
    limits = _ranges(rng, names, 0.4) if ranges is None else _ranges(rng, names, 1.0) if ranges else {}
    if narrow:
        limits = {name: (low, low + 0.5) for name, (low, _) in limits.items()}
    sharp = rng.random() < 0.5 if exact is None else exact
    origin = rng.choice((0, 0, -5, 7))
    truth: dict[str, tuple[list[int], list[float]]] = {}
    came: dict[str, int] = {}
    for name in names:
        n = rng.randint(1, 2 if narrow else 6)
        times = [origin + rng.choice((0, 0, 1, 3))]
        while len(times) < n + 3:
            times.append(times[-1] + rng.choice((1, 1, 2, 2, 3, 4)))
        truth[name] = times, [value(rng, *limits.get(name, ANYTHING)) for _ in times]
        came[name] = n
    known = {
        name: [_known(rng, v, limits.get(name, ANYTHING), exact=sharp) for v in values[: came[name]]]
        for name, (_, values) in truth.items()
    }
    updates: list[tuple[int, dict[str, Known]]] = []
    if rng.random() < 0.6 if ordered is None else ordered:
        for t in sorted({t for name in names for t in truth[name][0][: came[name]]}):
            row = {
                name: known[name][truth[name][0].index(t)]
                for name in names
                if t in truth[name][0][: came[name]]
            }
            updates.append((t, row))
    else:
        order = [name for name in names for _ in range(came[name])]
        rng.shuffle(order)
        begun = dict.fromkeys(names, 0)
        for name in order:
            k = begun[name]
            begun[name] += 1
            updates.append((truth[name][0][k], {name: known[name][k]}))
    return DenseCase(drawn, names, limits, updates, truth)
