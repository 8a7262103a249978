"""Timestamps of samples as the caller gives them, where those are not float64 seconds."""

from __future__ import annotations

from fractions import Fraction

from rtamt.errors import TraceError
from rtamt.language.units.durations import UNITS
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals import arrays

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.arrays import Timestamps

#: The names of time formats in messages, by the kind of their dtype.
_KINDS = {"f": "seconds", "M": "datetimes", "m": "timedeltas"}
_NUMBERS = {"f": "f8", "i": "i8", "M": "i8", "m": "i8"}


def other_kind(kind: str, before: str, index: int | None = None) -> TraceError:
    """Return the error for times of another kind than those before; ``index``: of the sample, None for a batch."""
    where = "" if index is None else f" at sample {index}"
    return TraceError(
        f"'{arrays.TIME}' is in {_KINDS[kind]}{where}, but before in {_KINDS[before]}: use one of them for all",
        variable=arrays.TIME,
        index=index,
    )


@dataclass(frozen=True, slots=True)
class CallerTimes:
    """The timestamps of the samples whose values may still be unknown, and of the last one.

    ``unit``: the unit of numeric times, None for seconds. ``period``: the sampling period in seconds. ``count``: the
    largest number of samples without a value. ``original``: the times as given; None while all are
    seconds, which the back end stores.
    """

    unit: str | None
    period: Fraction
    count: int
    original: NDArray[Any] | None = None

    @property
    def plain(self) -> bool:
        """Whether all timestamps are seconds."""
        return self.unit is None and self.original is None

    def read(self, times: Any, samples: int) -> Timestamps:
        """Return times given by the caller; ``samples``: the number of previous samples.

        Raises :class:`TraceError` if their format differs from that of previous times.
        """
        timestamps = arrays.timestamps(times, self.unit)
        self.require_alike(timestamps, samples)
        return timestamps

    def require_alike(self, timestamps: Timestamps, samples: int) -> None:
        """Raise :class:`TraceError` if the format of timestamps differs from that of the ``samples`` before."""
        if self.unit is None and samples:
            before = "f" if self.original is None else self.original.dtype.kind
            if timestamps.original.dtype.kind != before:
                raise other_kind(timestamps.original.dtype.kind, before, samples)

    def extended(self, original: NDArray[Any]) -> CallerTimes:
        """Return the timestamps after more samples."""
        whole = original if self.original is None else np.concatenate((self.original, original))
        return replace(self, original=whole[-self.count - 1 :].copy())

    def later(self, count: int) -> NDArray[Any]:
        """Return the timestamps of further samples, one period apart."""
        if self.original is None or not len(self.original):
            start, dtype = Fraction(0), np.dtype(np.int64)
        else:
            dtype = self.original.dtype
            last = arrays.plain(self.original[-1:].view(_NUMBERS[dtype.kind])[0])
            start = Fraction(last) + self.period_in_unit(dtype)
        timestamps = [start + i * self.period_in_unit(dtype) for i in range(count)]
        if dtype.kind in "mM":
            return np.array([round(timestamp) for timestamp in timestamps], np.int64).view(dtype)
        if dtype.kind == "i" and all(timestamp.denominator == 1 for timestamp in timestamps):
            return np.array([int(timestamp) for timestamp in timestamps], np.int64)
        return np.array([float(timestamp) for timestamp in timestamps])

    def period_in_unit(self, dtype: np.dtype[Any]) -> Fraction:
        """Return the period in the format of the caller's times."""
        return self.period / UNITS["ns" if dtype.kind in "mM" else self.unit or "s"]
