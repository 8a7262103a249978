"""The fields of a state as bytes: what is written, and read back from bytes of any origin.

A field describes one kind of value, for both directions. Numbers are in little endian order. Reading raises
:class:`UsageError` for malformed bytes; it creates only values of the kinds below.
"""

from __future__ import annotations

import datetime as dt
import struct
from math import isnan
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.lazy.modules import np
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.outcomes import Interval

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

_DTYPE = lazy_pattern(r"<[fi]8|<[mM]8\[\d{0,9}(?:Y|M|W|D|h|m|s|ms|us|ns|ps|fs|as)\]")


def damaged(reason: str) -> UsageError:
    """Return the error for bytes that are not a state."""
    return UsageError(f"this is not the state of a fleet: {reason}")


class Source:
    """Bytes that are read from their beginning."""

    def __init__(self, content: bytes) -> None:
        self._rest = memoryview(content)

    def take(self, size: int) -> bytes:
        """Return the next bytes."""
        if size > len(self._rest):
            raise damaged("it ends too early")
        taken, self._rest = self._rest[:size], self._rest[size:]
        return bytes(taken)

    def count(self) -> int:
        """Return the number of items that follow, each of at least one byte."""
        (found,) = _U64.unpack(self.take(8))
        if found > len(self._rest):
            raise damaged("it ends too early")
        return int(found)

    def end(self) -> None:
        """Raise :class:`UsageError` if anything is left."""
        if self._rest:
            raise damaged("it has bytes that nothing reads")


class Field(NamedTuple):
    """One kind of value: ``put`` appends it, ``get`` reads it."""

    put: Callable[[bytearray, Any], None]
    get: Callable[[Source], Any]


_U64 = struct.Struct("<Q")


def _packer(form: str, kinds: tuple[type, ...]) -> Field:
    pattern = struct.Struct(form)

    def put(out: bytearray, value: Any) -> None:
        if not isinstance(value, kinds):
            raise _unfit(value)
        try:
            out += pattern.pack(value)
        except (struct.error, OverflowError):
            raise _unfit(value) from None

    return Field(put, lambda source: pattern.unpack(source.take(pattern.size))[0])


def _unfit(value: Any) -> UsageError:
    return UsageError(f"{shown(value)} ({type(value).__name__}) cannot be part of a snapshot")


#: A whole number of 64 bits, a double, and one of a few kinds.
INTEGER, REAL, KIND = _packer("<q", (int,)), _packer("<d", (float, int)), _packer("<B", (int,))


def _put_data(out: bytearray, value: Any) -> None:
    out += _U64.pack(len(value))
    out += value


#: Bytes.
DATA = Field(_put_data, lambda source: source.take(source.count()))


def _get_text(source: Source) -> str:
    data: bytes = DATA.get(source)
    try:
        return data.decode()
    except UnicodeDecodeError:
        raise damaged("a text is no UTF-8") from None


def _put_text(out: bytearray, value: str) -> None:
    try:
        DATA.put(out, value.encode())
    except UnicodeEncodeError:
        raise _unfit(value) from None


TEXT = Field(_put_text, _get_text)


def checked(field: Field, holds: Callable[[Any], bool]) -> Field:
    """Return the field of values for which something holds."""

    def get(source: Source) -> Any:
        value = field.get(source)
        if not holds(value):
            raise damaged(f"it has {shown(value)} where another value belongs")
        return value

    return Field(field.put, get)


NATURAL = checked(INTEGER, lambda value: value >= 0)
#: A double that is a number.
NUMBER = checked(REAL, lambda value: not isnan(value))


def fixed(value: Any) -> Field:
    """Return the field of what is always the same, and takes no bytes."""

    def put(out: bytearray, given: Any) -> None:  # noqa: ARG001 - nothing is written
        if given != value:
            raise _unfit(given)

    return Field(put, lambda source: value)  # noqa: ARG005 - no bytes


def optional(field: Field) -> Field:
    """Return the field of what may be None."""

    def put(out: bytearray, value: Any) -> None:
        KIND.put(out, int(value is not None))
        if value is not None:
            field.put(out, value)

    present = checked(KIND, lambda kind: kind <= 1)
    return Field(put, lambda source: field.get(source) if present.get(source) else None)


def many(field: Field, kind: type = tuple) -> Field:
    """Return the field of a sequence of any length."""

    def put(out: bytearray, values: Any) -> None:
        out += _U64.pack(len(values))
        for value in values:
            field.put(out, value)

    return Field(put, lambda source: kind([field.get(source) for _ in range(source.count())]))


def row(*fields: Field, make: Callable[..., Any] | None = None) -> Field:
    """Return the field of a tuple of these; ``make``: makes another sequence of its items."""

    def put(out: bytearray, values: Any) -> None:
        for field, value in zip(fields, values, strict=True):
            field.put(out, value)

    def get(source: Source) -> Any:
        values = tuple(field.get(source) for field in fields)
        return values if make is None else make(*values)

    return Field(put, get)


def mapping(name: Field, value: Field) -> Field:
    """Return the field of a dictionary."""
    items = many(row(name, value), list)

    def get(source: Source) -> dict[Any, Any]:
        found = items.get(source)
        made = dict(found)
        if len(made) != len(found):
            raise damaged("it has a name twice")
        return made

    return Field(lambda out, given: items.put(out, list(given.items())), get)


def one_of(choices: Mapping[type, Field]) -> Field:
    """Return the field of a value of one of several types; their order is part of the format."""
    kinds = list(choices)

    def put(out: bytearray, value: Any) -> None:
        if isinstance(value, np.generic) and value.dtype.kind not in "mM":
            value = value.item()
        kind = next((number for number, each in enumerate(kinds) if type(value) is each), None)
        if kind is None:
            raise _unfit(value)
        KIND.put(out, kind)
        choices[kinds[kind]].put(out, value)

    def get(source: Source) -> Any:
        kind = KIND.get(source)
        if kind >= len(kinds):
            raise damaged("it has a value of an unknown kind")
        return choices[kinds[kind]].get(source)

    return Field(put, get)


# ---- arrays and times ----------------------------------------------------------------------------


def _put_array(out: bytearray, value: Any) -> None:
    array = np.ascontiguousarray(value)
    array = array.astype(array.dtype.newbyteorder("<"))
    if _DTYPE.fullmatch(array.dtype.str) is None:
        raise _unfit(value)
    TEXT.put(out, array.dtype.str)
    DATA.put(out, array.tobytes())


def _get_array(source: Source) -> Any:
    dtype, content = TEXT.get(source), DATA.get(source)
    if _DTYPE.fullmatch(dtype) is None or len(content) % 8:
        raise damaged(f"it has an array of {shown(dtype)}")
    try:
        kind = np.dtype(dtype)
    except TypeError:
        raise damaged(f"it has an array of {shown(dtype)}") from None
    return np.frombuffer(content, kind).astype(kind.newbyteorder("="))


#: An array of doubles, of whole numbers, of dates or of durations.
ARRAY = Field(_put_array, _get_array)


def _of_numpy(kind: str) -> Field:
    def get(source: Source) -> Any:
        found = ARRAY.get(source)
        if len(found) != 1 or found.dtype.kind != kind:
            raise damaged("it has no time where one belongs")
        return found[0]

    return Field(lambda out, value: ARRAY.put(out, np.array([value])), get)


def _date(text: str) -> dt.datetime:
    try:
        return dt.datetime.fromisoformat(text)
    except ValueError:
        raise damaged(f"it has {shown(text)} where a date belongs") from None


def _duration(days: int, seconds: int, microseconds: int) -> dt.timedelta:
    try:
        return dt.timedelta(days, seconds, microseconds)
    except OverflowError:
        raise damaged("it has a duration beyond all limits") from None


_DURATION = row(INTEGER, INTEGER, INTEGER, make=_duration)

#: A time as a user gives it.
MOMENT = one_of(
    {
        float: REAL,
        int: INTEGER,
        np.datetime64: _of_numpy("M"),
        np.timedelta64: _of_numpy("m"),
        dt.datetime: Field(
            lambda out, value: TEXT.put(out, value.isoformat()), lambda source: _date(TEXT.get(source))
        ),
        dt.timedelta: Field(
            lambda out, value: _DURATION.put(out, (value.days, value.seconds, value.microseconds)),
            _DURATION.get,
        ),
    }
)


def interval(lower: float, upper: float) -> Interval:
    """Return bounds; raise :class:`UsageError` if they are invalid."""
    if not lower <= upper:
        raise damaged("it has bounds that are reversed")
    return Interval(lower, upper)


#: A value as a user gives it.
VALUE = one_of(
    {
        type(None): fixed(None),
        float: NUMBER,
        int: INTEGER,
        bool: Field(lambda out, value: KIND.put(out, int(value)), lambda source: bool(KIND.get(source))),
        str: TEXT,
        tuple: row(NUMBER, NUMBER),
        Interval: Field(
            lambda out, value: row(NUMBER, NUMBER).put(out, (value.lower, value.upper)),
            row(NUMBER, NUMBER, make=interval).get,
        ),
    }
)
