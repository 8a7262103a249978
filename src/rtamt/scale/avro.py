"""Messages in Avro: one schema file, or the schemas of a registry by their IDs.

A schema is refused if a few bytes of a message could make its decoder run without bound: types that contain themselves,
and arrays whose items take no bytes.
"""

from __future__ import annotations

import io
import json
import re
from collections.abc import Mapping
from typing import Any

from rtamt.errors import TraceError, UsageError
from rtamt.extras import library
from rtamt.files import open_text
from rtamt.scale.messages import framed

#: Where an object is in memory, which differs from run to run.
_ADDRESS = re.compile(r" at 0x[0-9a-fA-F]+")
_PRIMITIVE = frozenset({"null", "boolean", "int", "long", "float", "double", "bytes", "string"})


class AvroDecoder:
    """Decodes records of Avro; ``schemas``: files by schema ID, see :func:`rtamt.scale.messages.decoder`."""

    def __init__(self, schemas: Mapping[int | None, str]) -> None:
        self._fastavro = library("fastavro", "reading messages in Avro", "kafka")
        self._schemas = {number: self._load(path) for number, path in schemas.items()}

    def _load(self, path: str) -> Any:
        try:
            with open_text(path) as file:
                given = json.load(file)
        except OSError as error:
            raise UsageError(f"cannot read the schema '{path}': {error.strerror}") from None
        except (ValueError, RecursionError):
            raise UsageError(f"the schema '{path}' is not JSON") from None
        try:
            parsed = self._fastavro.parse_schema(given)
            problem = _find_unbounded(given)
        except (self._fastavro.schema.SchemaParseException, ValueError, KeyError, TypeError) as error:
            raise UsageError(f"'{path}' is not a schema of Avro: {error}") from None
        if not isinstance(given, dict) or given.get("type") != "record":
            raise UsageError(f"the schema '{path}' is not that of a record")
        if problem:
            raise UsageError(
                f"the schema '{path}' has {problem}, so that a few bytes could make a message of any size; "
                f"messages are not trusted: leave that out of their schema"
            )
        return parsed

    def __call__(self, value: bytes) -> Mapping[str, Any]:
        """Return the record in a message; raise :class:`TraceError` if there is none."""
        number: int | None = None
        if None not in self._schemas:
            number, value = framed(value)
            if number not in self._schemas:
                known = ", ".join(map(str, sorted(each for each in self._schemas if each is not None)))
                raise TraceError(f"the message has the schema ID {number}, and schemas are given for {known}")
        rest = io.BytesIO(value)
        try:
            record = self._fastavro.schemaless_reader(rest, self._schemas[number], None)
        except Exception as error:  # noqa: BLE001 - fastavro raises various classes for malformed bytes
            raise TraceError(f"the message is not a record of the schema: {_sentence(error)}") from None
        left = len(value) - rest.tell()
        if left:
            raise TraceError(f"the message is not a record of the schema: {left} bytes follow its end")
        assert isinstance(record, Mapping)
        return record


def _sentence(error: Exception) -> str:
    text = " ".join(_ADDRESS.sub("", str(error)).split())
    return f"{type(error).__name__}{': ' + text[:100] if text else ''}"


def _find_unbounded(schema: Any, named: dict[str, Any] | None = None, open_: tuple[str, ...] = ()) -> str:
    """Return the part of a schema that lets a short message decode to values of any size; empty if there is none."""
    named = {} if named is None else named
    if isinstance(schema, list):
        return next(filter(None, (_find_unbounded(each, named, open_) for each in schema)), "")
    if isinstance(schema, str):
        return f"the type '{schema}' inside itself" if schema.rpartition(".")[2] in open_ else ""
    kind = schema.get("type")
    if isinstance(kind, (dict, list)):
        return _find_unbounded(kind, named, open_)
    name = str(schema.get("name", "")).rpartition(".")[2]
    if name:
        named[name] = schema
    if kind == "array":
        if not _least(schema["items"], named):
            return "an array of items without bytes"
        return _find_unbounded(schema["items"], named, open_)
    if kind == "map":
        return _find_unbounded(schema["values"], named, open_)
    if kind == "record":
        fields = [field["type"] for field in schema["fields"]]
        return next(filter(None, (_find_unbounded(each, named, (*open_, name)) for each in fields)), "")
    return "" if kind in _PRIMITIVE | {"enum", "fixed"} else _find_unbounded(str(kind), named, open_)


def _least(schema: Any, named: Mapping[str, Any], depth: int = 0) -> int:
    """Return the smallest number of bytes of a value, 1 for any other than none."""
    if depth > len(named) + 1:  # a type inside itself, which is refused
        return 1
    if isinstance(schema, list):
        return 1  # its branch
    if isinstance(schema, str):
        known = named.get(schema.rpartition(".")[2])
        return int(schema != "null") if known is None else _least(known, named, depth + 1)
    kind = schema["type"]
    if kind == "fixed":
        return int(schema["size"] > 0)
    if kind == "record":
        own = {**named, str(schema["name"]).rpartition(".")[2]: schema}
        return int(any(_least(field["type"], own, depth + 1) for field in schema["fields"]))
    if isinstance(kind, (dict, list)) or kind in named:
        return _least(kind, named, depth + 1)
    return int(kind != "null")
