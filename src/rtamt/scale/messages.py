"""Messages of a broker to samples: JSON, Avro and protobuf; whatever a message holds, it is data.

A decoder turns bytes into a mapping of fields, and :class:`MessageReader` picks key, time and values from it. Both
raise :class:`TraceError` for a message that is not a sample; nothing in a message is executed, and schemas whose
messages could take unbounded time or depth are refused (:mod:`rtamt.scale.avro`).
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from contextlib import suppress
from datetime import datetime
from fractions import Fraction
from math import isfinite, isnan, nan
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, choices
from rtamt.language.units.durations import UNITS, check_unit
from rtamt.language.value_types import Enumeration
from rtamt.lazy.modules import np
from rtamt.readers.dates import EXAMPLE, date_in
from rtamt.readers.json_values import RepeatedKeyError, TooLarge, loads
from rtamt.scale.inputs import inputs_of, is_dense
from rtamt.scale.shard import Sample, key_problem
from rtamt.signals.counting import is_implausible
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.time_columns import NAMES, unit_of

if TYPE_CHECKING:
    from rtamt.fleet.suite import Suite
    from rtamt.specification import Specification

Decode = Callable[[bytes], Mapping[str, Any]]

#: The formats of values.
FORMATS = ("json", "avro", "protobuf")

#: As messages of JSON write infinities, which it has no numbers for.
_INFINITIES = {"inf": float("inf"), "-inf": float("-inf")}
_MISSING = object()


def decoder(format_: str, schemas: Mapping[int | None, str], message: str | None = None) -> Decode:
    """Return the decoder of values. ``schemas``: files by schema ID, or under None the one of messages without an ID.

    ``message``: the full name of the message type, for protobuf. Raises :class:`UsageError`.
    """
    if format_ == "json":
        if schemas or message is not None:
            raise UsageError(
                "messages in JSON have no schema: leave it out, or choose the format avro or protobuf"
            )
        return decode_json
    if format_ not in FORMATS:
        raise UsageError(f"the format is '{format_}'{choices(format_, FORMATS, 'formats')}")
    if not schemas:
        raise UsageError(f"messages in {format_} need a schema: name its file")
    if None in schemas and len(schemas) > 1:
        raise UsageError("give either one schema, or schemas with their IDs, as 7=FILE")
    if format_ == "avro":
        from rtamt.scale.avro import AvroDecoder

        return AvroDecoder(schemas)
    from rtamt.scale.protobuf import ProtobufDecoder

    return ProtobufDecoder(schemas, message)


def decode_json(value: bytes) -> Mapping[str, Any]:
    """Return the object that a message in JSON holds.

    >>> decode_json(b'{"time": 0, "x": 1.5}')
    {'time': 0, 'x': 1.5}
    """
    try:
        data = loads(value, _refuse_constant)
    except json.JSONDecodeError as error:
        raise TraceError(f"the message is not JSON: {error.msg} at column {error.colno}") from None
    except UnicodeDecodeError:
        raise TraceError("the message is not JSON: it is not UTF-8 text") from None
    except RecursionError:
        raise TraceError("the message is not JSON to read: it is nested too deeply") from None
    except RepeatedKeyError:
        raise TraceError("the message is not JSON to read: a key is given twice") from None
    except ValueError as error:  # a constant, or a number of too many digits
        raise TraceError(f"the message is not JSON to read: {str(error).partition(';')[0]}") from None
    if not isinstance(data, dict):
        raise TraceError(
            f'the message is {_format_value(data)}, expected a JSON object, such as {{"time": 0, "x": 1}}'
        )
    return data


def _refuse_constant(text: str) -> float:
    raise ValueError(f"JSON has no number {text}")


def framed(value: bytes) -> tuple[int, bytes]:
    """Return the schema ID of a message in the format of schema registries, and what follows it.

    >>> framed(bytes([0, 0, 0, 0, 7, 65]))
    (7, b'A')
    """
    if len(value) < 5 or value[0]:
        raise TraceError("the message does not begin with a schema ID: a byte 0 and four bytes")
    return int.from_bytes(value[1:5], "big"), value[5:]


class MessageReader:
    """A reader of the samples of a specification, or of all requirements of a suite, from messages.

    In dense time a message may lack variables.
    ``key``: the field with the key of a sample; None for the key of the message. ``time``: the field with its time;
    None for the first of the fields that have the name of a clock. ``unit``: of times that are
    numbers; by default the one at the end of the name in ``time``, else seconds.

    >>> import rtamt
    >>> reader = MessageReader(rtamt.parse("speed <= 30"), decode_json, key="car")
    >>> reader.read(b'{"car": "car-1", "time": 2, "speed": 25}', None)
    Sample(key='car-1', time=2.0, values=(25.0,))
    """

    def __init__(
        self,
        spec: Specification | Suite,
        decode: Decode,
        *,
        key: str | None = None,
        time: str | None = None,
        unit: str | None = None,
    ) -> None:
        self._decode = decode
        self._key = key
        self._clocks = NAMES if time is None else (time,)
        self._scale = UNITS[check_unit(unit or unit_of(time or "") or "s")]
        self._inputs = inputs_of(spec)
        self._partial = is_dense(spec, {})

    def read(self, value: bytes | None, message_key: bytes | None) -> Sample:
        """Return the sample in a message; raise :class:`TraceError` for anything else."""
        if value is None:
            raise TraceError("the message has no value")
        data = self._decode(value)
        key = self._key_of(data, message_key)
        time = self._time_of(data)
        if self._partial:
            return Sample(key, time, self._values(data))
        return Sample(key, time, tuple(_number(data, *each) for each in self._inputs))

    def _values(self, data: Mapping[str, Any]) -> tuple[float, ...]:
        """Return the values of the variables that a message has, NaN for the others; in dense time."""
        found = [[_member(data, column) for column in each.columns] for each in self._inputs]
        has = [any(value is not _MISSING and value is not None for value in values) for values in found]
        if not any(has):
            names = " or ".join(f"'{each.columns[0]}'" for each in self._inputs)
            raise TraceError(f"the message has no {names}")
        values = []
        for each, here in zip(self._inputs, has, strict=True):
            values.append(_number(data, *each) if here else nan)
            if here and isnan(values[-1]):
                raise TraceError(f"'{each.columns[0]}' is NaN: leave it out", variable=each.name)
        return tuple(values)

    def _key_of(self, data: Mapping[str, Any], message_key: bytes | None) -> str:
        if self._key is None:
            if message_key is None:
                raise TraceError(
                    "the message has no key: give it one, or name the field that holds it with --key"
                )
            try:
                key = message_key.decode()
            except UnicodeDecodeError:
                raise TraceError("the key of the message is not UTF-8 text") from None
            what = "the key of the message"
        else:
            found, what = _member(data, self._key), f"the key '{self._key}'"
            if found is _MISSING:
                raise TraceError(f"the message has no '{self._key}', the field of the key")
            if isinstance(found, bool) or not isinstance(found, (str, int)):
                raise TraceError(f"{what} is {_format_value(found)}, expected text or an integer")
            key = found if isinstance(found, str) else _digits(found, what)
        problem = key_problem(key)
        if problem:
            raise TraceError(f"{what} {problem}")
        return key

    def _time_of(self, data: Mapping[str, Any]) -> float:
        for name in self._clocks:
            stamp = _member(data, name)
            if stamp is not _MISSING:
                return self._seconds(name, stamp)
        raise TraceError(f"the message has no time: expected a field {' or '.join(map(repr, self._clocks))}")

    def _seconds(self, name: str, stamp: Any) -> float:
        if isinstance(stamp, str):
            stamp = date_in(stamp) if len(stamp) <= 64 else None
        if isinstance(stamp, float) or stamp.__class__ is int:
            if isfinite(stamp) if isinstance(stamp, float) else abs(stamp) < 2**63:
                seconds = stamp if self._scale == 1 else Fraction(stamp) * self._scale
                if not is_implausible(float(seconds)):
                    return float(seconds)
            raise TraceError(
                f"'{name}' is {_format_value(stamp)}, which is no time in seconds; is its unit another one?"
            )
        nanoseconds = _nanoseconds(stamp)
        if nanoseconds is None:
            raise TraceError(f"'{name}' is not a time: expected a number, or a date such as {EXAMPLE}")
        return nanoseconds / 10**9


def _nanoseconds(stamp: Any) -> int | None:
    if not isinstance(stamp, datetime | np.datetime64):
        return None
    if isinstance(stamp, datetime) and stamp.tzinfo is not None:
        stamp = stamp.replace(tzinfo=None) - (stamp.utcoffset() or stamp - stamp)
    return nanoseconds_of(stamp)


def _member(data: Mapping[str, Any], name: str) -> Any:
    """Return the value called ``name``: a field, or one of nested fields (``position.x``)."""
    if name in data:
        return data[name]
    value: Any = data
    for part in name.split("."):
        if not isinstance(value, Mapping) or part not in value:
            return _MISSING
        value = value[part]
    return value


def _number(data: Mapping[str, Any], name: str, columns: tuple[str, ...], type_: Any) -> float:
    for column in columns:
        value = _member(data, column)
        if value is not _MISSING:
            break
    else:
        raise TraceError(f"the message has no '{columns[0]}'", variable=name)
    if value.__class__ is float or value.__class__ is bool:
        return float(value)
    if isinstance(value, int):
        with suppress(OverflowError):
            return float(value)
    if isinstance(value, int | TooLarge):
        raise TraceError(f"'{columns[0]}' is beyond the range of a double", variable=name)
    if isinstance(value, str):
        code = type_.code(value) if isinstance(type_, Enumeration) else _INFINITIES.get(value)
        if code is not None:
            return float(code)
    raise TraceError(f"'{columns[0]}' is {_format_value(value)}, expected a number", variable=name)


def _digits(number: int, what: str) -> str:
    if abs(number) >= 2**64:
        raise TraceError(f"{what} is beyond 64 bits; give it as text")
    return str(number)


def _format_value(value: Any) -> str:
    """Return a value as a message shows it: the text of JSON, abbreviated."""
    if isinstance(value, str):
        text = json.dumps(value[:100])
    elif isinstance(value, int) and not isinstance(value, bool):
        text = str(value) if abs(value) < 2**64 else "a number beyond 64 bits"
    else:
        text = (
            "null"
            if value is None
            else repr(value)
            if isinstance(value, (bool, float))
            else type(value).__name__
        )
    return text if len(text) <= 40 else f"{text[:40]}..."
