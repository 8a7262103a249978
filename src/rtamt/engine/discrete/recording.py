"""Read a recording that needs no conversion, in one call of the compiled core."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from rtamt.engine.native import read_columns
from rtamt.signals.arrays import TIME
from rtamt.signals.discrete import Discrete, DiscreteTrace
from rtamt.signals.regular import RegularTimes

if TYPE_CHECKING:
    from collections.abc import Sequence

_SECOND = Fraction(1)


def read_discrete(data: Any, names: Sequence[str], domain: Discrete) -> DiscreteTrace | None:
    """Return the trace that ``record_discrete`` makes of these data; None where it has to convert or reject them."""
    period = domain.period
    found = read_columns(
        data, names, TIME, None if period is None else float(period), float(domain.tolerance)
    )
    if found is None:
        return None
    times, inferred, columns, count = found
    if times is None:
        period = period or _SECOND
        return DiscreteTrace(RegularTimes(count, period), columns, period)
    return DiscreteTrace(times, columns, period or _decimal(inferred), period is None)


@lru_cache(64)
def _decimal(period: float) -> Fraction:
    return Fraction(repr(period))
