"""Samples that a signal has not, left out or held for a while from the sample before, and those that are rounded."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.language.units.durations import format_duration
from rtamt.lazy.modules import np
from rtamt.signals.listing import show_time

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray

    Mask = NDArray[np.bool_]


class Gaps:
    """The samples of one signal that are left out, held or rounded, chunk by chunk.

    ``hold_for``: seconds for which the value of the last sample takes the place of those that are left out; None:
    it takes none.
    """

    def __init__(self, name: str, source: str, hold_for: Fraction | None) -> None:
        self._name = name
        self._source = source
        self._hold_for = hold_for
        #: The last sample: its time and value.
        self._last: tuple[Any, float] | None = None
        self._nan: list[Any] = [0, None]
        self._held: list[Any] = [0, None]
        self._rounded: list[Any] = [0, None]
        self._longest = 0

    def skip(self, nan: Mask, times: Any, before: int) -> None:
        """Take note of samples that are left out because they are NaN. ``before``: samples in earlier chunks."""
        self._note(self._nan, nan, times, before)

    def round(self, inexact: Mask, times: Any, before: int) -> None:
        """Take note of integers that no double holds."""
        self._note(self._rounded, inexact, times, before)

    def hold(self, numbers: FloatArray, missing: Mask, times: Any, before: int) -> tuple[FloatArray, Mask]:
        """Return the values with those of earlier samples in the gaps, and which are missing all the same.

        Only what comes before the first sample of all has nothing to hold. Raises :class:`TraceError` if the last
        sample is older than allowed.
        """
        if self._hold_for is None or not len(numbers):
            return numbers, missing
        if times is None and missing.any():
            raise TraceError(
                f"samples of '{self._name}' are missing in {self._source} and to be held for "
                f"{format_duration(self._hold_for)}, which takes timestamps: name their column with time=, or on the "
                f"command line --time-column",
                variable=self._name,
            )
        if times is None:
            return numbers, missing
        last = np.maximum.accumulate(np.where(missing, -1, np.arange(len(numbers))))
        gap = np.flatnonzero(missing & ((last >= 0) | (self._last is not None)))
        values = numbers.copy()
        if len(gap):
            inside = last[gap] >= 0
            since, value = times[last[gap]], numbers[last[gap]]
            if self._last is not None:
                since, value = since.copy(), value.copy()
                since[~inside], value[~inside] = self._last
            ages = _nanoseconds(times[gap] - since)
            self._check(ages, since, times[gap], before + gap)
            values[gap] = value
            held = np.zeros(len(numbers), dtype=bool)
            held[gap] = True
            self._note(self._held, held, times, before)
            self._longest = max(self._longest, int(ages.max()))
            missing = missing & ~held
        if last[-1] >= 0:
            self._last = times[last[-1]], float(numbers[last[-1]])
        return values, missing

    def losses(self) -> list[str]:
        """Return the samples left out, held and rounded so far, one sentence each."""
        found = []
        for what, (count, first) in (("left out, NaN", self._nan), ("held", self._held)):
            if count:
                plural = "s" * (count != 1)
                found.append(f"{what}: {count:,} sample{plural} of {self._name}, the first at {first}")
        if self._held[0]:
            found[-1] += f", the oldest value for {self._longest / 1e9:.6g} s"
        count, first = self._rounded
        if count:
            found.append(
                f"rounded to doubles: {count:,} integer{'s' * (count != 1)} of {self._name} beyond 2^53, "
                f"the first at {first}"
            )
        return found

    def _check(self, ages: NDArray[np.int64], since: Any, until: Any, rows: NDArray[np.int64]) -> None:
        assert self._hold_for is not None
        late = ages > int(self._hold_for * 10**9)
        if late.any():
            i = int(late.argmax())
            raise TraceError(
                f"'{self._name}' of {self._source} has no sample from {show_time(since[i])} to {show_time(until[i])} "
                f"(sample {rows[i]}), longer than the {format_duration(self._hold_for)} for which a value is held: "
                f"fill the gap, or hold it for longer (hold_for=, on the command line --hold-for)",
                variable=self._name,
                index=int(rows[i]),
            )

    def _note(self, noted: list[Any], which: Mask, times: Any, before: int) -> None:
        if which.any():
            first = int(which.argmax())
            noted[0] += int(which.sum())
            if noted[1] is None:
                noted[1] = f"sample {before + first}" if times is None else show_time(times[first])


def _nanoseconds(gaps: Any) -> NDArray[np.int64]:
    """Return differences of times as nanoseconds: those of seconds are rounded, since 0.3 - 0.1 is no 0.2."""
    if gaps.dtype.kind == "f":
        gaps = np.rint(gaps * 1e9)
    return np.asarray(gaps.astype("m8[ns]") if gaps.dtype.kind == "m" else gaps).astype(np.int64)
