"""Messages in protobuf: the type from a file of descriptors, ``protoc --include_imports --descriptor_set_out=FILE``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rtamt.errors import TraceError, UsageError, choices
from rtamt.extras import library
from rtamt.scale.messages import framed

#: The most bytes of a number of variable length.
_VARINT = 10
_WHAT = "reading messages in protobuf"


class ProtobufDecoder:
    """Decodes messages of one type; ``schemas``: files by schema ID, see :func:`rtamt.scale.messages.decoder`."""

    def __init__(self, schemas: Mapping[int | None, str], message: str | None) -> None:
        self._types = {number: _message_type(path, message) for number, path in schemas.items()}
        self._error = library("google.protobuf.message", _WHAT, "kafka").DecodeError

    def __call__(self, value: bytes) -> Mapping[str, Any]:
        """Return the fields of a message; raise :class:`TraceError` for other bytes."""
        number: int | None = None
        if None not in self._types:
            number, value = framed(value)
            if number not in self._types:
                known = ", ".join(map(str, sorted(each for each in self._types if each is not None)))
                raise TraceError(f"the message has the schema ID {number}, and schemas are given for {known}")
        type_ = self._types[number]
        if number is not None:
            place, value = _place(value)
            if place != _place_of(type_.DESCRIPTOR):
                raise TraceError(f"the message is not of the type '{type_.DESCRIPTOR.full_name}'")
        message = type_()
        try:
            message.ParseFromString(value)
        except self._error:
            raise TraceError(f"the message is not a '{type_.DESCRIPTOR.full_name}'") from None
        return _Fields(message)


class _Fields(Mapping[str, Any]):
    """The single fields of a message; an optional field is a key only if it is present."""

    def __init__(self, message: Any) -> None:
        self._message = message
        self._known = message.DESCRIPTOR.fields_by_name

    def __getitem__(self, name: str) -> Any:
        field = self._known.get(name)
        if field is None or _is_repeated(field) or (field.has_presence and not self._message.HasField(name)):
            raise KeyError(name)
        value = getattr(self._message, name)
        if field.enum_type is not None:
            member = field.enum_type.values_by_number.get(value)
            return str(value) if member is None else member.name  # a number without a name is no member
        return _Fields(value) if field.message_type is not None else value

    def __contains__(self, name: object) -> bool:
        try:
            self[str(name)]
        except KeyError:
            return False
        return True

    def __iter__(self) -> Any:
        return (name for name in self._known if name in self)

    def __len__(self) -> int:
        return sum(1 for _ in self)


def _is_repeated(field: Any) -> bool:
    """Return whether a field is a list; the descriptors of protobuf have said so themselves since 6.31."""
    known: bool | None = getattr(field, "is_repeated", None)
    return bool(field.label == field.LABEL_REPEATED) if known is None else known


def _message_type(path: str, name: str | None) -> Any:
    descriptor_pb2, descriptor_pool, messages, message_factory = (
        library(f"google.protobuf.{module}", _WHAT, "kafka")
        for module in ("descriptor_pb2", "descriptor_pool", "message", "message_factory")
    )
    try:
        with open(path, "rb") as file:
            files = descriptor_pb2.FileDescriptorSet.FromString(file.read())
    except OSError as error:
        raise UsageError(f"cannot read the schema '{path}': {error.strerror}") from None
    except messages.DecodeError:
        files = descriptor_pb2.FileDescriptorSet()
    if not files.file:
        raise UsageError(
            f"the schema '{path}' is no file of descriptors: write it with protoc --include_imports "
            f"--descriptor_set_out=FILE"
        )
    pool = descriptor_pool.DescriptorPool()
    try:
        for each in files.file:
            pool.Add(each)
        names = [
            f"{each.package}.{type_.name}".lstrip(".") for each in files.file for type_ in each.message_type
        ]
        if name is None and len(names) != 1:
            raise UsageError(f"the schema '{path}' has several messages: choose one of {', '.join(names)}")
        found = pool.FindMessageTypeByName(names[0] if name is None else name)
    except KeyError:
        raise UsageError(
            f"the schema '{path}' has no message '{name}'{choices(str(name), names, 'messages')}"
        ) from None
    except TypeError as error:
        raise UsageError(
            f"the schema '{path}' is not complete: {error}; write it with --include_imports"
        ) from None
    return message_factory.GetMessageClass(found)


def _place(value: bytes) -> tuple[list[int], bytes]:
    """Return where a type is in its file, and the message that follows: a number of indices, and these."""
    count, rest = _varint(value)
    if not count:
        return [0], rest
    indices = []
    for _ in range(min(count, len(value))):
        index, rest = _varint(rest)
        indices.append(index)
    return indices, rest


def _varint(value: bytes) -> tuple[int, bytes]:
    number = 0
    for i, byte in enumerate(value[:_VARINT]):
        number |= (byte & 0x7F) << (7 * i)
        if byte < 0x80:
            return (number >> 1) ^ -(number & 1), value[i + 1 :]
    raise TraceError(
        "the message does not say which type it has: a schema ID is followed by the place of the type"
    )


def _place_of(descriptor: Any) -> list[int]:
    if descriptor.containing_type is None:
        return [list(descriptor.file.message_types_by_name.values()).index(descriptor)]
    return [*_place_of(descriptor.containing_type), descriptor.containing_type.nested_types.index(descriptor)]
