"""The definition of early verdicts: after each sample, the verdicts that the samples so far decide.

A formula is decided at an instant as soon as its lower bound is positive or its upper bound negative, with
predicates that are +inf where they hold and -inf where they do not. It is decided for every
continuation of the trace. The verdict is reported once the instant itself is reached.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from rtamt.lazy.tuples import NamedTuple
from rtamt.reference import dense_bounds, discrete_bounds
from rtamt.reference.cores import Identity
from rtamt.reference.dense_bounds import DenseKnowledge
from rtamt.rewrite.semantics import boolean

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.definitions.enclosures import Enclosure
    from rtamt.language.formula import Formula
    from rtamt.reference.dense_bounds import StepBounds
    from rtamt.reference.discrete_bounds import Knowledge, Range


#: Of how many formulas the Boolean form is remembered, which is evaluated again and again.
_KEPT = 256


class Decided(NamedTuple):
    """The verdict at one sample or tick, and the sample or tick that decided it."""

    instant: int
    satisfied: bool
    decided_at: int


def verdicts(
    formula: Formula, known: Knowledge, period: Fraction, found: list[Enclosure] | None = None
) -> list[list[Decided]]:
    """Return, for each of the n samples, the verdicts that it makes known; of a finished trace also the rest.

    The last entry of a finished trace is what its end decides, by the last sample. ``found``: the bounds after the
    first of the same samples, as an earlier call left them there; the others are added.

    >>> from fractions import Fraction
    >>> import numpy as np
    >>> from rtamt.language.definitions.enclosures import Enclosure
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> from rtamt.reference.discrete_bounds import Knowledge
    >>> x = np.array([1.0, 4.0, 2.0])
    >>> known = Knowledge({"x": Enclosure(x, x)}, 3)
    >>> [[*map(tuple, each)] for each in verdicts(parse_formula("eventually[0:2](x >= 3)"), known, Fraction(1))]
    [[], [(0, True, 1), (1, True, 1)], []]
    """
    truth = _truth(Identity(formula))
    stages = [known.until(n) for n in range(1, known.n + 1)] + [known] * known.finished
    every = [] if found is None else found
    every += [discrete_bounds.bounds(truth, stage, period) for stage in stages[len(every) :]]
    reported: dict[int, Decided] = {}
    pending: dict[int, Decided] = {}  # of instants that are not reached yet
    news = []
    for stage, bounds in zip(stages, every, strict=True):
        last = stage.n - 1
        for i in range(known.n):
            place = min(i, len(bounds.lower) - 1)
            verdict = _sign(float(bounds.lower[place]), float(bounds.upper[place]))
            if verdict is not None and i not in reported:
                pending.setdefault(i, Decided(i, verdict, last))
        reached = {i: decided for i, decided in sorted(pending.items()) if i <= last and i not in reported}
        reported |= reached
        news.append(list(reached.values()))
    return news


#: The samples that arrive at one time, in ticks: of each variable the bounds of its value.
Update = tuple[int, "Mapping[str, Range]"]


def dense_verdicts(
    formula: Formula,
    updates: Sequence[Update],
    names: Sequence[str],
    tick: Fraction,
    ranges: Mapping[str, Range],
    *,
    finished: bool,
    found: list[StepBounds | None] | None = None,
) -> list[list[Decided]]:
    """Return, for each update, the ticks whose verdicts it makes known; of a finished trace also the rest.

    ``updates`` are in the order of arrival, ``names`` the variables. An entry stands for the
    instants from its tick up to the next. An instant is reached by the first sample that is not before it. ``found``:
    as in :func:`verdicts`; None before the trace starts.
    """
    truth = _truth(Identity(formula))
    stages = [after(updates[: k + 1], names, ranges, finished=False) for k in range(len(updates))]
    if finished:
        stages.append(after(updates, names, ranges, finished=True))
    every = [] if found is None else found
    for stage in stages[len(every) :]:
        every.append(None if stage.start is None else dense_bounds.bounds(truth, stage, tick))
    last = max((time for time, _ in updates), default=0)
    reported: dict[int, Decided] = {}
    pending: dict[int, Decided] = {}
    news: list[list[Decided]] = []
    for k, bounds in enumerate(every):
        start = stages[k].start
        if start is None or bounds is None:
            news.append([])
            continue
        came = updates[: k + 1]
        now = last if k == len(updates) else came[-1][0]
        for t in range(start, last + 1):
            verdict = _sign(*bounds.at(t))
            if verdict is not None and t not in reported:
                pending.setdefault(t, Decided(t, verdict, now))
        newest = max(time for time, _ in came)
        reached = {t: decided for t, decided in sorted(pending.items()) if t <= newest and t not in reported}
        reported |= reached
        news.append(list(reached.values()))
    return news


def after(
    updates: Sequence[Update], names: Sequence[str], ranges: Mapping[str, Range], *, finished: bool
) -> DenseKnowledge:
    """Return the verdicts that updates decide."""
    samples = {}
    for name in names:
        came = [(time, values[name]) for time, values in updates if name in values]
        samples[name] = [t for t, _ in came], [low for _, (low, _) in came], [high for _, (_, high) in came]
    return DenseKnowledge(samples, ranges, finished)


def runs(decided: Sequence[Decided]) -> list[tuple[int, int, bool, int]]:
    """Return ticks in order as runs (begin, end, satisfied, decided_at), the end not included.

    >>> runs([Decided(3, True, 4), Decided(4, True, 4), Decided(5, True, 5)])
    [(3, 5, True, 4), (5, 6, True, 5)]
    """
    breaks = [
        i
        for i, (one, other) in enumerate(pairwise(decided), 1)
        if other != (one.instant + 1, one.satisfied, one.decided_at)
    ]
    ends = [0, *breaks, len(decided)] if decided else []
    return [
        (decided[i].instant, decided[k - 1].instant + 1, decided[i].satisfied, decided[i].decided_at)
        for i, k in pairwise(ends)
    ]


@lru_cache(_KEPT)
def _truth(same: Identity) -> Formula:
    return boolean(same.formula)


def _sign(lower: float, upper: float) -> bool | None:
    """Return the verdict that bounds give, if they do."""
    return True if lower > 0 else False if upper < 0 else None
