"""The trace of discrete time: one value of every variable at each sample, one sampling period apart."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.errors import TraceError
from rtamt.language.units import UNITS, decimal
from rtamt.signals.arrays import check_numbers, columns_of, plain, units_of
from rtamt.signals.regular import TOLERANCE, check_increasing, check_regular, check_tolerance, infer_period

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class DiscreteTrace:
    """A finished recording in discrete time: one column of ``len(times)`` samples for each variable."""

    #: Seconds; of dates, since 1970.
    times: FloatArray
    columns: Mapping[str, FloatArray]
    period: Fraction
    #: Whether the period was taken from the time stamps.
    inferred: bool = False
    #: The time stamps as the caller tells time; None where that is in seconds.
    told: NDArray[Any] | None = None
    #: Of time stamps that are numbers of something other than seconds.
    unit: str | None = None
    #: The units of the variables whose source tells them.
    units: Mapping[str, str] = dataclasses.field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.times)

    @property
    def stamps(self) -> NDArray[Any]:
        """The time stamps as the caller tells time."""
        return self.times if self.told is None else self.told

    @property
    def dated(self) -> bool:
        """Whether the time stamps are dates."""
        return self.stamps.dtype.kind == "M"

    def stamp(self, sample: int) -> Any:
        """Return a time stamp: a number of Python, or a date or duration of numpy."""
        return plain(self.stamps[sample])

    def show(self, sample: int) -> str:
        """Return a time stamp for a sentence."""
        stamp = self.stamp(sample)
        if isinstance(stamp, np.datetime64):
            return str(stamp.astype("M8[ms]")) if stamp == stamp.astype("M8[ms]") else str(stamp)
        if isinstance(stamp, np.timedelta64):
            return f"{decimal(int(stamp.astype(np.int64)) * UNITS['ns'])} s"
        number = f"{stamp:.15g}" if isinstance(stamp, float) else str(stamp)
        return f"{number} {self.unit or 's'}"


def record_discrete(
    data: Any,
    names: Sequence[str],
    period: Fraction | None,
    declared: Collection[str] = (),
    tolerance: float = TOLERANCE,
    unit: str | None = None,
) -> DiscreteTrace:
    """Normalise a finished recording; the caller's data is never changed.

    ``data``: a mapping, or anything with columns (a pandas or polars frame), from variable to n
    numbers; ``"time"`` (n stamps, seconds or datetimes) is optional. ``names`` are the variables the
    formula reads, ``declared`` others that may be there. Without a ``period`` (seconds) it is taken
    from the stamps. ``unit``: of stamps that are numbers, by default seconds. Raises :class:`TraceError`.
    """
    check_tolerance(tolerance)
    stamped, columns, n = columns_of(data, names, declared, unit)
    if n == 0:
        raise TraceError("the trace is empty: give at least one sample")
    inferred, told = False, None
    if stamped is None:
        period = period or Fraction(1)
        times = np.arange(n, dtype=np.float64)
        if period != 1:
            times *= float(period)
    else:
        times = stamped.seconds
        told = None if stamped.told is times else stamped.told
        check_increasing(times)
        inferred = period is None
        period = period or infer_period(times)
        check_regular(times, period, tolerance)
    for name, column in columns.items():
        check_numbers(name, column, times)
    return DiscreteTrace(times, columns, period, inferred, told, unit, units_of(data))
