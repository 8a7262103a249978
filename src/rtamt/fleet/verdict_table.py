"""The results of a suite: one row per recording and requirement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.extras import library
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.datetimes import nanoseconds_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from numpy.typing import NDArray

#: What a suite can compute of a requirement, in the order of the columns.
SELECTABLE = ("robustness", "satisfied", "first_violation")


class Row(NamedTuple):
    """The results of a requirement on a recording; None if unknown, not selected or missing."""

    recording: str
    requirement: str
    robustness: float | None = None
    satisfied: bool | None = None
    first_violation: float | None = None
    unchecked: str | None = None
    error: str | None = None


class VerdictTable:
    """Robustness and verdicts, one row per recording and requirement.

    ``select``: the columns beside ``recording``, ``requirement``, ``unchecked`` and ``error``. ``unchecked`` is the
    reason where a recording lacks an optional signal, ``error`` where a requirement cannot be evaluated.
    ``first_violation`` is in the times of the recording; of dates, seconds since 1970.

    >>> import rtamt
    >>> suite = rtamt.Suite([rtamt.parse("always(x >= 3)", period=1), rtamt.parse("always(1/x >= 0)", period=1)])
    >>> table = suite.evaluate({"x": [5, 0]}, recording="drive 1")
    >>> for row in table:
    ...     print(row.requirement, row.robustness, row.satisfied, row.first_violation, row.error is None)
    always(x >= 3) -3.0 False 1.0 True
    always(1 / x >= 0) 0.2 True None True
    """

    def __init__(self, rows: Iterable[Row], select: Sequence[str] = SELECTABLE) -> None:
        self.rows = list(rows)
        self.select = tuple(name for name in SELECTABLE if name in select)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns."""
        return ("recording", "requirement", *self.select, "unchecked", "error")

    def __len__(self) -> int:
        return len(self.rows)

    def __iter__(self) -> Iterator[Row]:
        return iter(self.rows)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, VerdictTable):
            return NotImplemented
        return (self.select, self.rows) == (other.select, other.rows)

    def __hash__(self) -> int:
        return hash((self.select, len(self.rows)))

    def __repr__(self) -> str:
        recordings = len({row.recording for row in self.rows})
        errors = sum(row.error is not None for row in self.rows)
        return f"<{len(self)} verdicts of {recordings} recordings, {errors} errors>"

    def to_numpy(self) -> NDArray[Any]:
        """Return the table as a structured array.

        Unknown numbers are NaN, ``satisfied`` is 1, 0 or (unknown) -1, and texts that do not exist are empty.

        >>> import rtamt
        >>> suite = rtamt.Suite([rtamt.parse("always(x >= 3)", period=1)], select=["satisfied"])
        >>> suite.evaluate({"x": [5, 1]}, recording="drive 1").to_numpy()[0].item()
        ('drive 1', 'always(x >= 3)', 0, '', '')
        """
        kinds = {"robustness": "f8", "first_violation": "f8", "satisfied": "i1"}
        array = np.empty(len(self.rows), [(name, kinds.get(name, "O")) for name in self.columns])
        for name in self.columns:
            unknown: Any = {"f8": np.nan, "i1": -1}.get(kinds.get(name, ""), "")
            found = [getattr(row, name) for row in self.rows]
            array[name] = [unknown if value is None else value for value in found]
        return array

    def to_arrow(self) -> Any:
        """Return the table as a ``pyarrow.Table``, with nulls for what is unknown; needs ``rtamt[data]``."""
        arrow = library("pyarrow", "the table of a suite", "data")
        fields = arrow_fields(self.select)
        return arrow.table(
            {name: arrow.array([getattr(row, name) for row in self.rows], kind) for name, kind in fields}
        )


def arrow_fields(select: Sequence[str] = SELECTABLE) -> list[tuple[str, Any]]:
    """Return the names and Arrow types of the columns."""
    arrow = library("pyarrow", "the table of a suite", "data")
    kinds = {"robustness": arrow.float64(), "first_violation": arrow.float64(), "satisfied": arrow.bool_()}
    return [(name, kinds.get(name, arrow.string())) for name in VerdictTable([], select).columns]


def number_of(time: Any) -> float | None:
    """Return a time of a recording as a number: of dates and durations, seconds."""
    if time is None:
        return None
    if isinstance(time, np.datetime64 | np.timedelta64):
        return (nanoseconds_of(time) or 0) / 10**9
    return float(time)
