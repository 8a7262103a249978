"""Read a recording that needs no conversion, and evaluate it, in one call of the compiled core."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from rtamt.engine.native import read_columns
from rtamt.lazy_numpy import np
from rtamt.lazy_tuples import NamedTuple
from rtamt.signals.arrays import TIME
from rtamt.signals.discrete import Discrete, DiscreteTrace
from rtamt.signals.regular import RegularTimes
from rtamt.signals.signal import Signal
from rtamt.signals.time_columns import check_frame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.signals.arrays import FloatArray

_SECOND = Fraction(1)
#: The numbers of a frame that may all be copied to read some of them.
_SMALL = 4096


def read_discrete(data: Any, names: Sequence[str], domain: Discrete) -> DiscreteTrace | None:
    """Return the trace that ``record_discrete`` makes of these data; None where it has to convert or reject them."""
    if data.__class__ is not dict:
        data = frame_columns(data, names)
        if data is None:
            return None
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


def frame_columns(data: Any, names: Sequence[str]) -> dict[str, Any] | None:
    """Return the columns of a frame of pandas or polars as arrays; None for anything else."""
    kind = type(data)
    library = kind.__module__.partition(".")[0]
    if kind.__name__ != "DataFrame" or library not in ("pandas", "polars"):
        return None
    columns = data.columns  # a list, or an index, of which a list takes longer than all the rest
    wanted = [name for name in (TIME, *names) if name in columns]
    if len(wanted) != len(columns) or wanted[0] != TIME:
        check_frame(data, TIME, names)
    if library == "pandas" and len(data.index) * len(columns) <= _SMALL and columns.is_unique:
        values = data.to_numpy()  # a frame takes longer to return a column than an evaluation of it takes
        return {name: values[:, columns.get_loc(name)] for name in wanted}
    return {name: data[name].to_numpy() for name in wanted}


class Reading(NamedTuple):
    """How ``DirectEvaluator`` of the core has read recordings: their variables, their period, whether it was given.

    What it returns is ``found``: memory in rows, the number of samples, and whether there are timestamps. Arrays are
    made of it when they are asked for.
    """

    names: tuple[str, ...]
    period: Fraction
    given: bool

    def trace(self, found: Any) -> DiscreteTrace:
        """Return the recording."""
        rows, timed = _rows_of(found), found[2]
        columns = dict(zip(self.names, rows, strict=False))
        times = rows[-2] if timed else RegularTimes(found[1], self.period)
        return DiscreteTrace(times, columns, self.period, timed and not self.given)

    def signal(self, found: Any) -> Signal:
        """Return the values; as everywhere, the timestamps cannot be written."""
        rows = _rows_of(found)
        if not found[2]:
            return Signal(RegularTimes(found[1], self.period), rows[-1])
        times = rows[-2].view()
        times.flags.writeable = False
        return Signal(times, rows[-1])


def _rows_of(found: Any) -> Sequence[FloatArray]:
    memory: Any = found[0]
    return memory if memory.__class__ is list else list(np.frombuffer(memory).reshape(-1, found[1]))


@lru_cache(64)
def _decimal(period: float) -> Fraction:
    return Fraction(repr(period))
