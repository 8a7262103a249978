"""Dates and times of Python, numpy and pandas as integers, without a double in between."""

from __future__ import annotations

from fractions import Fraction
from types import MappingProxyType

from rtamt.errors import TraceError, shown
from rtamt.language.units.durations import UNITS
from rtamt.lazy.modules import dt, np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME, is_moment
from rtamt.signals.counting import times_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Seconds in each unit in which numpy counts time; years and months have no fixed length.
_LENGTHS = MappingProxyType(
    {
        **{
            unit: Fraction(seconds) for unit, seconds in (("W", 604800), ("D", 86400), ("h", 3600), ("m", 60))
        },
        **UNITS,
        **{unit: Fraction(1, 10**digits) for unit, digits in (("ps", 12), ("fs", 15), ("as", 18))},
    }
)

#: Years and months further from 1970 than this exceed all ticks; as days they would overflow.
_FARTHEST_YEAR = 10**12


def has_length(time: Any) -> bool:
    """Return whether a ``timedelta64`` (scalar or array) has a unit of fixed length.

    >>> has_length(np.timedelta64(5, "ms")), has_length(np.timedelta64(5)), has_length(np.timedelta64(5, "Y"))
    (True, False, False)
    """
    return np.datetime_data(time.dtype)[0] in _LENGTHS


def counts_of(dated: NDArray[Any]) -> tuple[NDArray[np.int64], Fraction]:
    """Return dates or times since a start, none of them NaT, as integers, and the seconds in 1 of them.

    Raises :class:`OverflowError` for years that days cannot count.

    >>> counts_of(np.array(["1970-01-02"], "M8[h]"))
    (array([24]), Fraction(3600, 1))
    """
    unit, count = np.datetime_data(dated.dtype)
    if unit not in _LENGTHS:
        if len(dated) and max(abs(int(n)) for n in dated.view(np.int64)) * count > _FARTHEST_YEAR:
            raise OverflowError
        dated, unit, count = dated.astype("M8[D]"), "D", 1
    return dated.view(np.int64), _LENGTHS[unit] * count


def in_nanoseconds(dated: NDArray[Any], name: str, source: str = "", *, first: int = 0) -> NDArray[Any]:
    """Return dates or times since a start, of any unit, in nanoseconds.

    ``name``: of what has them, for messages; ``source``: where it was read; ``first``: the index of the first one.
    Raises :class:`TraceError` for what 64 bits cannot hold, such as the year 9999, and for timedeltas without a unit.
    """
    kind, where = dated.dtype.kind, f" of {source}" if source else ""
    if kind == "m" and not has_length(dated):
        raise no_length(name, first)
    target = f"{kind}8[ns]"
    present = dated[~np.isnat(dated)]
    try:
        numbers, length = counts_of(present)
        most = min(2**63 - 1, int((2**63 - 1) * UNITS["ns"] / length))
        wrong = np.flatnonzero((numbers > most) | (numbers < -most))
    except OverflowError:
        wrong = np.array([0])
    if not len(wrong):
        return dated.astype(target)
    index = int(np.flatnonzero(~np.isnat(dated))[wrong[0]])
    raise out_of_reach(name, first + index, dated[index], kind, where)


def out_of_reach(name: str, index: int, time: Any, kind: str, where: str = "") -> TraceError:
    """Return the error for a time beyond the nanoseconds that 64 bits hold."""
    held = "dates from 1677-09-22 to 2262-04-11" if kind == "M" else "292 years"
    return TraceError(
        f"'{name}'{where} is {time} at sample {index}, which nanoseconds in 64 bits cannot reach: they hold {held}",
        variable=name,
        index=index,
    )


def no_length(name: str, index: int) -> TraceError:
    """Return the error for a ``timedelta64`` without a fixed length."""
    return TraceError(
        f"{times_of(name)} is a timedelta64 without a unit of fixed length at sample {index}: "
        f"give it one, such as np.timedelta64(5, 'ms')",
        variable=name,
        index=index,
    )


def nanoseconds_of(time: Any) -> int | None:
    """Return a datetime or timedelta as nanoseconds, since 1970 for dates; None for NaT.

    A date without a time zone is taken literally, whatever the time zone of this machine.

    >>> nanoseconds_of(dt.datetime(1970, 1, 1, 0, 0, 1)), nanoseconds_of(np.timedelta64(5, "ms"))
    (1000000000, 5000000)
    """
    exact = getattr(time, "to_numpy", None)  # pandas counts in nanoseconds, datetime in microseconds
    if exact is not None:
        time = exact()
    if isinstance(time, np.datetime64 | np.timedelta64):
        if np.isnat(time):
            return None
        numbers, length = counts_of(np.array([time]))
        return round(int(numbers[0]) * length / UNITS["ns"])
    since: dt.timedelta = time
    if isinstance(time, dt.datetime):
        zone = None if time.tzinfo is None else dt.timezone.utc
        since = time - dt.datetime(1970, 1, 1, tzinfo=zone)
    return (since // dt.timedelta(microseconds=1)) * 1000


def moments(raw: NDArray[Any], first: int) -> NDArray[Any]:
    """Return dates or durations in nanoseconds; dates without a time zone are taken literally, as in dense time."""
    zones: dict[bool, int] = {}
    kinds: dict[str, int] = {}
    found = np.full(raw.size, np.iinfo(np.int64).min)  # NaT
    for i, value in enumerate(raw.flat, first):
        kind = "m" if isinstance(value, dt.timedelta | np.timedelta64) else "M"
        kinds.setdefault(kind, i)
        if not is_moment(value) or len(kinds) > 1:
            raise TraceError(
                f"'{TIME}' is {shown(value)} at sample {i}, expected a {'datetime' if 'M' in kinds else 'timedelta'} "
                f"like the others",
                variable=TIME,
                index=i,
            )
        if isinstance(value, np.timedelta64) and not has_length(value):
            raise no_length(TIME, i)
        moment = nanoseconds_of(value)
        if moment is None:
            continue
        if abs(moment) >= 2**63:
            raise out_of_reach(TIME, i, value, kind)
        zones.setdefault(getattr(value, "tzinfo", None) is not None, i)
        found[i - first] = moment
    if len(zones) > 1:
        raise TraceError(
            f"'{TIME}' has a time zone at sample {zones[True]} and none at sample {zones[False]}: "
            f"use one way for all",
            variable=TIME,
            index=max(zones.values()),
        )
    return found.view(f"{next(iter(kinds))}8[ns]")
