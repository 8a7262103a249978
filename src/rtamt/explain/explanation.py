"""Explanations as data and as sentences."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from html import escape
from math import isfinite
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.datetimes import nanoseconds_of

if TYPE_CHECKING:
    from rtamt.language.formula import Formula

T = TypeVar("T")

#: The number of causes shown by default.
SHORT = 5


class Listed(Sequence[T], Generic[T]):
    """A tuple whose elements are created on access: a long explanation has many, but prints few.

    >>> squares = Listed(10**9, lambda k: k * k)
    >>> squares[3], squares[-1], squares[:2] == (0, 1)
    (9, 999999998000000001, True)
    """

    def __init__(self, length: int, make: Callable[[int], T]) -> None:
        self._length = length
        self._make = make
        self._made: dict[int, T] = {}

    def __len__(self) -> int:
        return self._length

    @overload
    def __getitem__(self, index: int) -> T: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[T, ...]: ...

    def __getitem__(self, index: int | slice) -> T | tuple[T, ...]:
        found = range(self._length)[index]
        return tuple(map(self._one, found)) if isinstance(found, range) else self._one(found)

    def _one(self, index: int) -> T:
        if index not in self._made:
            self._made[index] = self._make(index)
        return self._made[index]

    def __eq__(self, other: object) -> bool:
        return tuple(self) == tuple(other) if isinstance(other, Listed | tuple) else NotImplemented

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        return repr(tuple(self))

    def __reduce__(self) -> tuple[Any, ...]:
        return tuple, (tuple(self),)  # a copy needs no recording


@dataclass(frozen=True, slots=True)
class Reading:
    """The samples of a signal from ``start`` to ``end``, times in the caller's format.

    ``end`` is None if there is none; it belongs to the interval if ``closed``. In dense time what is meant is the
    signal on the interval, hence the samples that hold their value on any part of it.
    """

    signal: str
    start: Any
    end: Any
    closed: bool


@dataclass(frozen=True, slots=True)
class CriticalPoint:
    """The predicate and the instant whose value is, up to sign, the robustness.

    ``predicate`` is its text and ``formula`` the predicate itself; both are None where no predicate
    decides, and ``decided_by`` is what does: "predicate", "start" or "end" (of the recording: a
    window there is empty), or "constant". ``time``: in the caller's format. ``value``: of the
    predicate there; the robustness is ``polarity`` (+1 or -1) times it. ``start`` and ``end``: in dense
    time the segment [start, end) around ``time`` with that value, else ``time`` itself.

    Were ``polarity`` times this one value r instead, at this place of the formula and all else as it
    is, the robustness would be r, cut to [``lowest``, ``highest``]: beyond these something else
    decides. So moving it across 0 makes the verdict fall where 0 lies between them, and does not
    where something else (the other operand of an ``or``, a later witness) holds as well.

    ``recorded``: of a predicate over Booleans and enumerations what was recorded, such as ``mode is AUTO``.
    ``reads``: the samples that determine the value: of ``maximum[0:3](x) >= 3`` the one that attains the maximum.
    """

    predicate: str | None
    formula: Formula | None
    time: Any
    start: Any
    end: Any
    value: float
    polarity: int
    lowest: float
    highest: float
    decided_by: str = "predicate"
    recorded: str = ""
    reads: Sequence[Reading] = ()


@dataclass(frozen=True, slots=True)
class Stretch:
    """A predicate and an interval on which it held, or failed, throughout; part of an implicant.

    ``start`` and ``end`` are times in the caller's format, None for an interval without end; ``end``
    belongs to the interval if ``closed``, as it always does in discrete time. ``lowest`` and
    ``highest``: of the predicate's robustness on the interval. ``reads``: the samples that keep the predicate so,
    whatever all others are: of ``maximum[0:3](x) >= 3`` where it holds one that is large enough, where it fails the
    whole window; of ``if φ then x else y`` the condition and the branch taken. ``recorded``: as for
    :class:`CriticalPoint`.
    """

    predicate: str
    formula: Formula
    holds: bool
    start: Any
    end: Any
    closed: bool
    lowest: float
    highest: float
    reads: Sequence[Reading]
    recorded: str = ""


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why a formula is satisfied or violated at an instant: prints as sentences.

    ``critical`` is why the robustness is what it is: if every predicate changes by less than
    its absolute value, the verdict stands. ``implicant`` is why the verdict is what it is: the predicates
    on these intervals are sufficient for it, independent of all other samples, and none of them can be left out. So
    are the samples that they read.
    ``first_violation``: for ``always φ`` the earliest time of its window at which φ does not hold, for a
    conjunction the earliest of its parts, else ``time``; None where the formula is satisfied, and for any other
    instant than the first.
    ``summary``: the sentences before the causes; ``causes``: one for each interval of the implicant.
    ``ranking``: the numbers of the causes, those first that are closest to the critical point.
    ``implicant`` and ``causes`` are sequences whose elements are made when they are read.
    """

    formula: str
    time: Any
    satisfied: bool
    robustness: float
    first_violation: Any
    critical: CriticalPoint
    implicant: Sequence[Stretch]
    summary: tuple[str, ...]
    causes: Sequence[str]
    ranking: tuple[int, ...]

    def __str__(self) -> str:
        return self.text()

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"

    @property
    def headline(self) -> str:
        """The first sentence without the formula."""
        return self.summary[0].removesuffix(f": {self.formula}")

    def text(self, causes: int | None = SHORT) -> str:
        """Return the explanation as sentences with this many causes; None for all.

        >>> import rtamt
        >>> result = rtamt.parse("always(eventually[0:1](x >= 3))").evaluate({"x": [5, 1, 1, 4] * 9})
        >>> print(result.explain().text(causes=1))
        violated, robustness -2: always(eventually[0:1](x >= 3))
        first violation at 1 s
        critical point at 1 s: 'x >= 3' is -2; others give the same robustness
        sufficient cause, independent of all other samples:
          'x >= 3' fails from 1 s to 2 s (-2)
        """
        shown = self.shown(causes)
        lines = [*self.summary, *(f"  {self.causes[number]}" for number in shown)]
        if len(shown) < len(self.causes):
            lines.append(f"  {len(self.causes) - len(shown)} more")
        return "\n".join(lines)

    def shown(self, causes: int | None = SHORT) -> tuple[int, ...]:
        """Return the indices of the ``causes`` causes closest to the critical point, in their order."""
        return tuple(sorted(self.ranking[:causes]))

    def to_dict(self) -> dict[str, Any]:
        """Return the explanation as JSON data.

        Formulas are text, infinities the strings "inf" and "-inf", dates ISO 8601, times since a start seconds.
        """
        return as_data(self, _seconds)


def as_data(explanation: Explanation, moment: Callable[[Any], Any]) -> dict[str, Any]:
    """Return an explanation as JSON data; ``moment``: the data for a time, which may be None."""
    point = explanation.critical
    return {
        "formula": explanation.formula,
        "time": moment(explanation.time),
        "satisfied": explanation.satisfied,
        "robustness": _plain(explanation.robustness),
        "first_violation": moment(explanation.first_violation),
        "critical": {
            "predicate": point.predicate,
            "time": moment(point.time),
            "start": moment(point.start),
            "end": moment(point.end),
            "value": _plain(point.value),
            "polarity": point.polarity,
            "lowest": _plain(point.lowest),
            "highest": _plain(point.highest),
            "decided_by": point.decided_by,
            "reads": _as_data(point.reads, moment),
        },
        "implicant": [
            {
                "predicate": stretch.predicate,
                "holds": stretch.holds,
                "start": moment(stretch.start),
                "end": moment(stretch.end),
                "closed": stretch.closed,
                "lowest": _plain(stretch.lowest),
                "highest": _plain(stretch.highest),
                "reads": _as_data(stretch.reads, moment),
            }
            for stretch in explanation.implicant
        ],
    }


def _as_data(reads: Sequence[Reading], moment: Callable[[Any], Any]) -> list[dict[str, Any]]:
    return [
        {"signal": each.signal, "start": moment(each.start), "end": moment(each.end), "closed": each.closed}
        for each in reads
    ]


def _seconds(time: Any) -> Any:
    if isinstance(time, np.datetime64):
        return str(time)
    if isinstance(time, np.timedelta64):
        nanoseconds = nanoseconds_of(time)
        return None if nanoseconds is None else nanoseconds / 10**9
    return _plain(time)


def _plain(value: Any) -> Any:
    return str(value) if isinstance(value, float) and not isfinite(value) else value
