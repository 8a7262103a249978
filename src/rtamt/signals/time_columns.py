"""Recognise the time column and its unit by name, in the same way for files, frames and streams."""

from __future__ import annotations

import re
from types import MappingProxyType

from rtamt.errors import TraceError
from rtamt.language.units.durations import UNITS
from rtamt.lazy.modules import dt, np
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

#: The names of time columns, in upper or lower case, optionally with a unit: ``Time [ms]``, ``time_ms``.
NAMES = ("time", "t", "timestamp", "stamp", "datetime")

#: Common spellings of time units.
SPELLINGS: Mapping[str, str] = MappingProxyType(
    {
        "h": "h hr hrs hour hours",
        "min": "min mins minute minutes",
        "s": "s sec secs second seconds",
        "ms": "ms msec millis millisecond milliseconds",
        "us": "us µs μs usec micros microsecond microseconds",
        "ns": "ns nsec nanos nanosecond nanoseconds",
    }
)
_UNIT_OF = {spelling: unit for unit, spellings in SPELLINGS.items() for spelling in spellings.split()}
#: Units at the end of a name: t_min may be a minimum, and t_h anything.
_SUFFIXES = [spelling for spelling, unit in _UNIT_OF.items() if unit not in ("h", "min")]
_STAMPS = lazy_pattern(rf"(?:{'|'.join(NAMES)})(?:[ _](?:{'|'.join(_SUFFIXES)}))?")
#: What surrounds a name without being part of it; `str.strip` removes more, such as U+2028 and U+3000.
_BLANKS = " \t\r\n\xa0"
_BRACKETS = lazy_pattern(
    rf"(?P<name>.*[^{_BLANKS}])[{_BLANKS}]*[\[(]\s*(?P<unit>[^\[\]()]+?)\s*[\])]", re.DOTALL
)

#: Words in the names of columns that may hold timestamps, but need not.
_HINTS = frozenset({*NAMES, "ts", "date", "clock", "epoch", "elapsed"} - {"t"})
#: Units that are also names of time columns; 's' and 'ms' are too ambiguous.
_UNITS = frozenset(spelling for spelling in _SUFFIXES if len(spelling) > 2)
#: The beginning of the text of a date.
_DATED = lazy_pattern(r"\s*\d{4}-\d{2}-\d{2}(?!\d)")
_WORDS = lazy_pattern(r"[A-Z]?[a-zµμ]+|[A-Z]+(?![a-z])")


def column_name(text: str) -> str:
    r"""Return the name in a cell of a header: without spaces, tabs and line ends around it.

    >>> column_name(" x\xa0"), column_name("x\u2028")
    ('x', 'x\u2028')
    """
    return text.strip(_BLANKS)


def split_unit(column: str) -> tuple[str, str]:
    """Return the name and the unit of a column: ``Time [ms]`` is ``("Time", "ms")``.

    >>> split_unit("Time [ms]"), split_unit("req"), split_unit("q[0]")
    (('Time', 'ms'), ('req', ''), ('q[0]', ''))
    """
    match = _BRACKETS.fullmatch(column)
    if match and match["unit"].isdigit() and column.endswith(f"{match['name']}[{match['unit']}]"):
        return column, ""  # an element of an array: q[0]
    return (match["name"], match["unit"]) if match else (column, "")


def unit_called(text: str) -> str | None:
    """Return the unit of time that a text writes; None where it writes none.

    >>> unit_called("msec"), unit_called("minutes"), unit_called("kg")
    ('ms', 'min', None)
    """
    return _UNIT_OF.get(text.strip().lower()) or (text if text in UNITS else None)


def is_stamps(name: str) -> bool:
    """Return whether a column has the name of a time column; ``name``: without a unit in brackets."""
    return _STAMPS.fullmatch(name.lower()) is not None


def unit_of(name: str) -> str | None:
    """Return the unit of time that is the last word of a name; None if it is none.

    >>> [unit_of(name) for name in ("time_ms", "elapsedUs", "millis", "stamp", "t_min")]
    ['ms', 'us', 'ms', None, None]
    """
    words = _WORDS.findall(name)
    last = words[-1].lower() if words and name.endswith(words[-1]) else ""
    return _UNIT_OF[last] if last in _SUFFIXES else None


def counts_time(column: str) -> bool:
    """Return whether the name of a column has a unit of time other than seconds: 0, 1, 2 in it number no rows.

    >>> [column for column in ("Zeit [ms]", "tick_us", "t/ms", "Zeit [s]", "row") if counts_time(column)]
    ['Zeit [ms]', 'tick_us', 't/ms']
    """
    name, unit = split_unit(column)
    return (unit_called(unit) or unit_of(name) or "s") != "s"


def may_be_stamps(name: str) -> bool:
    """Return whether a column may hold timestamps, though its name alone does not decide it.

    >>> [name for name in ("sim_time", "timeMs", "header.stamp", "rostime", "speed", "t_max") if may_be_stamps(name)]
    ['sim_time', 'timeMs', 'header.stamp', 'rostime']
    """
    words = {word.lower() for word in _WORDS.findall(name)}
    return (
        bool(words & _HINTS)
        or name.lower() in _UNITS
        or any(word.endswith(("time", "timestamp")) for word in words)
    )


def check_frame(frame: Any, time: str, names: Collection[str]) -> None:
    """Raise :class:`TraceError` if the timestamps of a frame may be in another column than ``time``.

    The evaluation of a frame reads only that column; ``names``: the variables that it reads. To use another
    column or unit, read the frame with :func:`rtamt.read`.
    """
    others = [column for column in frame.columns if column != time and column not in names]
    if time in frame.columns:
        found = [f"'{column}'" for column in others if is_stamps(split_unit(str(column))[0])]
    else:
        found = [f"'{column}'" for column in others if _may_hold_times(str(column), frame[column])]
        found += _times_in_index(getattr(frame, "index", None))
    if found:
        raise TraceError(
            f"the frame may have its timestamps in {', '.join(found)}, but only the column '{time}' is read here: read "
            f"the frame with rtamt.read, which takes other columns and units",
            variable=time,
        )


def check_first_column(frame: Any, columns: Sequence[Any], time: str, names: Collection[str]) -> None:
    """Raise :class:`TraceError` if the first column of a frame without the column ``time`` may hold the timestamps.

    Its numbers then increase, but not by 1 from row to row unless its name has a unit of time, and no variable of
    ``names`` is read from it. Only where no period is given.
    """
    if time in columns:
        return
    index = getattr(frame, "index", None)
    if index is not None and numbers_no_rows(index):
        name = _index_called(index)
        raise TraceError(
            f"the frame may have its timestamps in {name}, whose values increase, but not by 1 from row to row: read "
            f"the frame with rtamt.read(frame, time='{'index' if index.name is None else index.name}'), or give the "
            f"period of the samples, such as period='1s'",
            variable=time,
        )
    if not columns or columns[0] in names:
        return
    timed = counts_time(str(columns[0]))
    if increases_otherwise(frame[columns[0]], counts_rows=not timed):
        raise TraceError(
            f"the frame may have its timestamps in its first column '{columns[0]}', whose values increase, "
            f"{'and whose name has a unit of time' if timed else 'but not by 1 from row to row'}: read the frame with "
            f"rtamt.read(frame, time='{columns[0]}'), or give the period of the samples, such as period='1s'",
            variable=time,
        )


def numbers_no_rows(index: Any) -> bool:
    """Return whether the integers of an index of pandas increase, but not by 1 from row to row."""
    if getattr(getattr(index, "dtype", None), "kind", "") not in ("i", "u"):
        return False
    return increases_otherwise(index)


def increases_otherwise(values: Any, *, counts_rows: bool = True) -> bool:
    """Return whether values are numbers that increase, but not by 1 from one to the next.

    ``counts_rows``: whether those that increase by 1 are numbers of rows.

    >>> [increases_otherwise(values) for values in ([0, 10, 20], [5, 6, 7], [0, 2, 1], ["a", "b"])]
    [True, False, False, False]
    """
    try:
        numbers = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError):
        return False
    steps = np.diff(numbers) if numbers.ndim == 1 else np.empty(0)
    return bool(len(steps) and (steps > 0).all() and not (counts_rows and (steps == 1).all()))


def _index_called(index: Any) -> str:
    return "its index" if index.name is None else f"its index '{index.name}'"


def check_mapping(
    data: Mapping[Any, Any], time: str, names: Collection[str], *, regular: bool = True
) -> None:
    """Raise :class:`TraceError` if a mapping without the key ``time`` may have its timestamps elsewhere.

    They may be under a key with another name of timestamps, or in the index of a series; ``names``: the variables,
    ``regular``: see :func:`check_index`.
    """
    heads = {name.split(".")[0] for name in names}
    for key in data:
        if key in names or key in heads:
            check_index(data[key], str(key), regular=regular)
        elif is_stamps(split_unit(str(key))[0]):
            raise TraceError(
                f"the data may have its timestamps in '{key}', but those of a mapping are read from its key '{time}': "
                f"rename the key, or read the data with rtamt.read, which takes other names and units",
                variable=time,
            )


def check_index(values: Any, name: str, *, regular: bool = False) -> None:
    """Raise :class:`TraceError` if values have an index that may hold their timestamps, which nothing reads.

    Such values are a series of pandas or an array of xarray. ``regular``: whether the period of samples without
    timestamps is known, so that integers that do not count the rows are no question.
    """
    if isinstance(values, list | tuple):  # asked first: the name of NumPy's arrays loads NumPy
        return
    if isinstance(values, np.ndarray):
        return
    indexes = values.indexes.values() if is_labelled(values) else [getattr(values, "index", None)]
    found = [named for index in indexes for named in _times_in_index(index, regular=regular)]
    if found:
        raise TraceError(
            f"'{name}' may have its timestamps in {', '.join(found)}, but those of a mapping are read from its key "
            f"'time': give them there, or the bare values, with to_numpy(), if the index holds no times",
            variable=name,
        )


def is_labelled(data: Any) -> bool:
    """Return whether data is an object of xarray, whose arrays have coordinates."""
    return hasattr(type(data), "indexes") and hasattr(type(data), "coords")


def _times_in_index(index: Any, *, regular: bool = True) -> list[str]:
    """Return an index of pandas, or those of its levels, that may hold timestamps, as a message calls them."""
    if getattr(index, "nlevels", 1) > 1:
        return [f"its index '{name}'" for name in index.names if _is_called_so(name)]
    name = getattr(index, "name", None)
    # Rows are numbered by integers: what is measured is no number of a row.
    measured = getattr(getattr(index, "dtype", None), "kind", "") == "f"
    measured = measured or (not regular and numbers_no_rows(index))
    if not (measured or _is_called_so(name) or _are_dated(index)):
        return []
    return [_index_called(index)]


def _is_called_so(name: Any) -> bool:
    return name is not None and is_stamps(split_unit(str(name))[0])


def _may_hold_times(column: str, values: Any) -> bool:
    name, _ = split_unit(column)
    return is_stamps(name) or may_be_stamps(name) or _are_dated(values)


def _are_dated(values: Any) -> bool:
    """Return whether values are dates or durations, or texts or objects of which the first is one."""
    kind = str(getattr(values, "dtype", "")).lower()
    if kind.startswith(("date", "time", "duration", "period")):
        return True
    if not kind.startswith(("object", "str", "large_string")):
        return False
    first = next(iter(values), None)
    return isinstance(first, dt.date | dt.timedelta) or (
        isinstance(first, str) and _DATED.match(first) is not None
    )
