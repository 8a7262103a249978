"""The definitions of messages in a bag: one for each type, since rosbags reads all topics with the last one."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.readers.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

#: What separates the definitions of several types in IDL.
_SEPARATOR = f"{'=' * 80}\n"


def require_one_definition(path: str, connections: list[Any], typesys: Any) -> None:
    """Raise :class:`TraceError` if two topics, or two publishers, define a type of messages differently.

    Fields and constants count, comments do not. ``typesys``: the module of rosbags that reads definitions.
    """
    known: dict[str, tuple[Any, str]] = {}
    read: set[tuple[str, str]] = set()
    for connection in connections:
        text = connection.msgdef.data
        if (connection.msgtype, text) in read:
            continue
        read.add((connection.msgtype, text))
        topic = printable(str(connection.topic))
        for name, content in _types(connection, typesys):
            first, where = known.setdefault(name, (content, topic))
            if first != content:
                places = f"on {topic}" if topic == where else f"on {where} and on {topic}"
                raise TraceError(
                    f"'{path}' cannot be read: it holds two definitions of the type {printable(name)}, {places}, as "
                    f"when a node was built anew between two parts of the bag; split it so that each part has one"
                )


def _types(connection: Any, typesys: Any) -> Iterator[tuple[str, Any]]:
    """Yield the types that a connection defines, with their constants and fields."""
    text, form = connection.msgdef.data, connection.msgdef.format.name
    if form == "MSG":
        yield from typesys.get_types_from_msg(text, connection.msgtype).items()
    elif form == "IDL" and text.startswith(f"{_SEPARATOR}IDL: "):
        for part in text.split(_SEPARATOR)[1:]:
            yield from typesys.get_types_from_idl(part.partition("\n")[2]).items()
    elif form == "IDL":
        yield from typesys.get_types_from_idl(text).items()
