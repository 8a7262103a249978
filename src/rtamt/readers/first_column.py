"""The first column of a table without timestamps: it may hold them under another name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import TraceError
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.readers.numbers import numbers_of
from rtamt.signals.time_columns import counts_time

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.readers.source import Field, Raw


def possible_field(fields: Sequence[Field]) -> Field | None:
    """Return the first of the columns of a table if it may hold timestamps, as far as its kind and beginning show.

    It is read in addition to what a formula reads, so that nothing in it is an error.
    """
    if not fields or fields[0].kind not in {"number", ""} or not fields[0].rising:
        return None
    if any(field.column == fields[0].column for field in fields[1:]):
        return None
    return replace(fields[0], skip_nan=True, lenient=True)


class FirstColumn:
    """Whether the numbers of the first column increase, by steps that do not count the rows.

    Where its name has a unit of time other than seconds, no steps count the rows.
    """

    def __init__(self, field: Field) -> None:
        self._field = field
        self._increases = True
        self._counts = not counts_time(field.column)
        self._last: float | None = None

    def take(self, raw: Raw) -> None:
        """Take the next values."""
        if not self._increases:
            return
        try:
            numbers, missing = numbers_of(raw, self._field, "")
        except TraceError:  # no column of numbers
            self._increases = False
            return
        if missing is not None and missing.any():
            self._increases = False
            return
        steps = np.diff(numbers) if self._last is None else np.diff(numbers, prepend=self._last)
        self._increases = bool((steps > 0).all())
        self._counts = self._counts and bool((steps == 1).all())
        if len(numbers):
            self._last = float(numbers[-1])

    @property
    def possible_times(self) -> str | None:
        """The name of the column if it may hold timestamps, as far as it was read."""
        return self._field.column if self._increases and not self._counts else None
