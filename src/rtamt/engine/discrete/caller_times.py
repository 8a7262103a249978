"""Timestamps of samples as the caller gives them, where those are not float64 seconds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.errors import TraceError
from rtamt.language.units import UNITS
from rtamt.signals import arrays

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.arrays import Stamps

#: How messages call what stamps are told in, by the kind of their dtype.
_KINDS = {"f": "seconds", "M": "datetimes", "m": "timedeltas"}
_NUMBERS = {"f": np.float64, "i": np.int64, "M": np.int64, "m": np.int64}


@dataclass(frozen=True, slots=True)
class CallerTimes:
    """The timestamps of the samples that may still have a value to come, and of the last one.

    ``unit``: of times that are numbers, None for seconds. ``period``: seconds from sample to sample. ``count``: how
    many samples may still have a value to come. ``told``: None while all are
    seconds, which the back end has.
    """

    unit: str | None
    period: Fraction
    count: int
    told: NDArray[Any] | None = None

    @property
    def plain(self) -> bool:
        """Whether all timestamps are seconds."""
        return self.unit is None and self.told is None

    def read(self, times: Any, samples: int) -> Stamps:
        """Return times that the caller gave; ``samples``: how many came before.

        Raises :class:`TraceError` where they are not of the kind of those before.
        """
        stamps = arrays.stamps(times, self.unit)
        self.require_alike(stamps, samples)
        return stamps

    def require_alike(self, stamps: Stamps, samples: int) -> None:
        """Raise :class:`TraceError` where timestamps are not of the kind of the ``samples`` before."""
        if self.unit is None and samples:
            before = "f" if self.told is None else self.told.dtype.kind
            if stamps.told.dtype.kind != before:
                raise TraceError(
                    f"'{arrays.TIME}' is told in {_KINDS[stamps.told.dtype.kind]} at sample {samples}, but before "
                    f"in {_KINDS[before]}: use one of them for all",
                    variable=arrays.TIME,
                    index=samples,
                )

    def extended(self, told: NDArray[Any]) -> CallerTimes:
        """Return the timestamps after more samples."""
        whole = told if self.told is None else np.concatenate((self.told, told))
        return replace(self, told=whole[-self.count - 1 :].copy())

    def later(self, count: int) -> NDArray[Any]:
        """Return the timestamps of samples that come one period after another."""
        if self.told is None or not len(self.told):
            start, dtype = Fraction(0), np.dtype(np.int64)
        else:
            dtype = self.told.dtype
            last = arrays.plain(self.told[-1:].view(_NUMBERS[dtype.kind])[0])
            start = Fraction(last) + self._period_in_unit(dtype)
        stamps = [start + i * self._period_in_unit(dtype) for i in range(count)]
        if dtype.kind in "mM":
            return np.array([round(stamp) for stamp in stamps], np.int64).view(dtype)
        if dtype.kind == "i" and all(stamp.denominator == 1 for stamp in stamps):
            return np.array([int(stamp) for stamp in stamps], np.int64)
        return np.array([float(stamp) for stamp in stamps])

    def _period_in_unit(self, dtype: np.dtype[Any]) -> Fraction:
        return self.period / UNITS["ns" if dtype.kind in "mM" else self.unit or "s"]
