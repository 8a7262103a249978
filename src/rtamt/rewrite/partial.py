"""Operations on numbers that may have no value, and numbers for which every one of them has one."""

from __future__ import annotations

from functools import lru_cache
from itertools import combinations
from math import inf
from typing import TYPE_CHECKING

from rtamt.language.operators import Operator, Sort, builtin
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Sequence

#: Values at which operations on numbers have no value, if anywhere.
_PROBES = (-inf, -1e308, -2.0, -1.0, -0.5, 0.0, 0.5, 1.0, 2.0, 1e308, inf)


def value_at(op: Operator, known: Sequence[float | None]) -> float | None:
    """Return the result of an operation on numbers; None if one of them is unknown, or the result is undefined."""
    if (
        builtin(op.name) is not op
        or op.definition is None
        or any(sort is not Sort.NUMBER for sort in op.operands)
    ):
        return None
    operands = [np.array([x]) for x in known if x is not None]
    if len(operands) < len(known):
        return None
    with np.errstate(all="ignore"):
        value = float(op.definition(*operands)[0])
    return None if np.isnan(value) else value


@lru_cache(maxsize=1024)
def may_fail(op: Operator, known: tuple[float | None, ...]) -> bool:
    """Return whether an operation may have no value, some of whose operands are known.

    >>> from rtamt.language.operators import STL
    >>> may_fail(STL["sqrt"], (None,)), may_fail(STL["sub"], (None, None)), may_fail(STL["sub"], (None, 2.0))
    (True, True, False)
    """
    if not known or any(sort is not Sort.NUMBER for sort in op.operands):
        return False
    if builtin(op.name) is not op or op.definition is None:
        return True  # what a user's own operator does with other numbers is not tried
    grid = np.meshgrid(*(_PROBES if value is None else (value,) for value in known))
    with np.errstate(all="ignore"):
        values = op.definition(*(each.ravel() for each in grid))
    return bool(np.isnan(values).any())


def harmless(op: Operator, known: Sequence[float | None]) -> dict[int, float]:
    """Return numbers for as few operands as possible with which an operation always has a value.

    >>> from rtamt.language.operators import STL
    >>> harmless(STL["sqrt"], (None,)), harmless(STL["div"], (None, None)), harmless(STL["div"], (None, 2.0))
    ({0: 1.0}, {0: 1.0}, {})
    """
    free = [k for k, value in enumerate(known) if value is None]
    for size in range(len(free) + 1):
        for places in combinations(free, size):
            instead = {k: k + 1.0 for k in places}
            if not may_fail(op, tuple(instead.get(k, value) for k, value in enumerate(known))):
                return instead
    return {k: k + 1.0 for k in range(len(known))}  # 1, 2, 3: with these, every operation has a value
