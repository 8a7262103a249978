"""Runs of ticks: tuples (begin, end, ...) in order, each from ``begin`` up to but excluding ``end``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

Pair: TypeAlias = tuple[float, float]
#: (begin, end, lower, upper)
Run: TypeAlias = tuple[int, int, float, float]
#: (begin, end, satisfied, decided at)
Decided: TypeAlias = tuple[int, int, bool, int]
R = TypeVar("R", bound=tuple[Any, ...])


def clipped(runs: Iterable[R], begin: int, end: int) -> Iterator[R]:
    """Yield the parts of runs between two ticks.

    >>> list(clipped([(0, 4, 1.0, 2.0), (4, 9, 1.0, 1.0)], 2, 5))
    [(2, 4, 1.0, 2.0), (4, 5, 1.0, 1.0)]
    """
    for first, last, *rest in runs:
        if max(first, begin) < min(last, end):
            yield max(first, begin), min(last, end), *rest  # type: ignore[misc] # an R again


def without(runs: Iterable[Decided], others: Sequence[Decided]) -> Iterator[Decided]:
    """Yield the parts of runs that are in none of the others, which are in order.

    >>> list(without([(0, 9, True, 8)], [(2, 4, False, 3)]))
    [(0, 2, True, 8), (4, 9, True, 8)]
    """
    for begin, end, satisfied, at in runs:
        after = begin
        for first, last, *_ in others:
            if after < min(first, end):
                yield after, min(first, end), satisfied, at
            after = max(after, last)
        if after < end:
            yield after, end, satisfied, at


def compared(before: Sequence[Run], now: Sequence[Run]) -> Iterator[tuple[int, int, Pair | None, Pair]]:
    """Yield the runs of now with the bounds that they had before, None where there were none: (begin, end, was, is).

    >>> list(compared([(0, 4, 1.0, 2.0)], [(2, 9, 1.0, 1.0)]))
    [(2, 4, (1.0, 2.0), (1.0, 1.0)), (4, 9, None, (1.0, 1.0))]
    """
    for begin, end, low, high in now:
        pair = low, high
        after = begin
        for first, last, lower, upper in clipped(before, begin, end):
            if after < first:
                yield after, first, None, pair
            yield first, last, (lower, upper), pair
            after = last
        if after < end:
            yield after, end, None, pair


def merged(runs: Iterable[R]) -> tuple[R, ...]:
    """Return runs in order with neighbours put together that differ in nothing else.

    >>> merged([(0, 4, True, 4), (4, 5, True, 4), (5, 6, True, 6)])
    ((0, 5, True, 4), (5, 6, True, 6))
    """
    merged: list[R] = []
    for run in runs:
        if merged and merged[-1][1] == run[0] and merged[-1][2:] == run[2:]:
            merged[-1] = (merged[-1][0], *run[1:])  # type: ignore[assignment] # an R again
        else:
            merged.append(run)
    return tuple(merged)
