"""A line of JSON to numbers and timestamps, with errors that name the line."""

from __future__ import annotations

import json
from contextlib import suppress
from typing import TYPE_CHECKING, Any, TypeAlias

from rtamt.errors import TraceError
from rtamt.language.value_types import Enumeration
from rtamt.readers.dates import EXAMPLE, is_date
from rtamt.readers.json_values import RepeatedKeyError, TooLarge, loads
from rtamt.readers.source import printable
from rtamt.signals.binding import missing
from rtamt.signals.data_errors import missing_variable

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rtamt.language.value_types import ValueType

#: What messages call the input.
STDIN = "stdin"

#: A number, bounds of one, or None where a sample is missing.
Known: TypeAlias = "float | tuple[float, float] | None"

#: The same in messages.
KNOWN = "a number, bounds [lower, upper], or null if it is missing"

_INFINITIES = ("inf", "-inf")


def object_in(text: str, number: int) -> dict[str, Any]:
    """Return the JSON object in a line."""
    try:
        data = loads(text)
    except json.JSONDecodeError as error:
        raise line_error(number, f"not JSON: {error.msg} at column {error.colno}") from None
    except RepeatedKeyError as error:
        raise line_error(number, f"the key {format_value(str(error))} is given twice; give it once") from None
    except (ValueError, RecursionError):
        raise line_error(number, "not JSON to read: a number is too long, or nesting too deep") from None
    if not isinstance(data, dict):
        raise line_error(
            number, f'expected a JSON object, such as {{"time": 0, "x": 1}}, got {format_value(data)}'
        )
    return data


def flat(data: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the values of an object; fields of nested objects have names with dots, an empty one has its own."""
    stack = list(data.items())
    while stack:
        name, value = stack.pop(0)
        if isinstance(value, dict) and value:
            stack += [(f"{name}.{key}", inner) for key, inner in value.items()]
        else:
            yield name, value


def stamp_in(data: dict[str, Any], name: str, number: int) -> str:
    """Return a timestamp as it would be written in a cell: a number, or a date."""
    value = value_in(data, name, number)
    if isinstance(value, str) and value not in _INFINITIES:
        if not is_date(value):
            problem = f"expected a number, or a date such as {EXAMPLE}"
            raise line_error(number, f"'{name}' is {format_value(value)}, {problem}")
        return value
    seconds = number_in(data, name, number)
    return str(int(value)) if isinstance(value, int) else repr(seconds)  # an integer to its last digit


def number_in(data: dict[str, Any], name: str, number: int, type_: ValueType | None = None) -> float:
    """Return a number of the object, or the code of a member that is given by its name."""
    return number_of(value_in(data, name, number), name, number, type_)


def number_of(value: Any, name: str, number: int, type_: ValueType | None = None) -> float:
    """Return a value of the object as a number, see :func:`number_in`."""
    if isinstance(value, str) and isinstance(type_, Enumeration):
        return code_of(value, name, type_, number)
    if isinstance(value, (bool, int, float)):
        with suppress(OverflowError):
            if not isinstance(value, TooLarge):
                return float(value)
        raise line_error(number, f"'{name}' is {format_value(value)}, beyond the range of a double", name)
    if value in _INFINITIES:
        return float(value)
    raise line_error(number, f"'{name}' is {format_value(value)}, expected a number", name)


def known_of(value: Any, name: str, number: int, type_: ValueType | None) -> Known:
    """Return what a value of the object is known to be: a number, bounds of it, or None where it is missing."""
    if value is None:
        return None
    if not isinstance(value, list):
        if isinstance(value, dict) or (isinstance(value, str) and not _is_number(value, type_)):
            raise line_error(number, f"'{name}' is {format_value(value)}, expected {KNOWN}", name)
        return number_of(value, name, number, type_)
    if len(value) != 2 or not all(_is_number(end, type_) for end in value):
        raise line_error(number, f"'{name}' is {format_value(value)}, expected {KNOWN}", name)
    lower, upper = (number_of(end, name, number, type_) for end in value)
    if not lower <= upper:
        problem = (
            "reversed: give the lower bound first"
            if upper < lower
            else "with a bound that is NaN: give numbers, or null if it is missing"
        )
        raise line_error(number, f"'{name}' is {format_value(value)}, {problem}", name)
    return lower, upper


def _is_number(value: Any, type_: ValueType | None) -> bool:
    """Return whether :func:`number_of` takes a value, or rejects it for more than its kind."""
    named = isinstance(value, str) and isinstance(type_, Enumeration)
    return named or isinstance(value, (bool, int, float)) or value in _INFINITIES


def code_of(text: str, name: str, type_: Enumeration, number: int) -> float:
    """Return the code of a member, which is given by its name."""
    code = type_.code(text)
    if code is None:
        raise line_error(
            number, f"'{name}' is '{printable(text)}', which is {type_.unknown_member(text)}", name
        )
    return float(code)


def value_in(data: dict[str, Any], name: str, number: int, variable: str = "") -> Any:
    """Return the value that the object has under a name; raise :class:`TraceError` if it has none."""
    try:
        return _member(data, name)
    except KeyError:
        known = list(data)
        other = variable and variable != name
        error = missing("the data", variable, name, known) if other else missing_variable(name, known)
        raise line_error(number, str(error), name) from None


def has_value(data: dict[str, Any], name: str) -> bool:
    """Return whether the object has a value under a name."""
    try:
        return _member(data, name) is not None
    except KeyError:
        return False


def has_key(data: dict[str, Any], name: str) -> bool:
    """Return whether the object has a value or null under a name."""
    try:
        _member(data, name)
    except KeyError:
        return False
    return True


def _member(data: dict[str, Any], name: str) -> Any:
    """Return the value called ``name``: a key, or fields of nested objects (``req.value``)."""
    if name in data:
        return data[name]
    value: Any = data
    for part in name.split("."):
        if not isinstance(value, dict):
            raise KeyError(name)
        value = value[part]
    return value


def format_value(value: object) -> str:
    """Return a value as a message shows it."""
    text = value.text if isinstance(value, TooLarge) else json.dumps(value)
    return text if len(text) <= 40 else f"{text[:40]}..."


def line_error(number: int, problem: str, variable: str | None = None) -> TraceError:
    """Return the error for a line of stdin."""
    return TraceError(f"{STDIN}, line {number}: {problem}", variable=variable)
