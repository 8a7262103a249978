"""MCAP files that were cut off or are damaged: the part before the damage, as a file that can be read.

Such a file is a sequence of records, each with its kind and its length; messages lie in records of their own, or
in those of a chunk, which may be compressed. The index at the end is not needed. See https://mcap.dev/spec.
"""

from __future__ import annotations

import os
import struct
from io import BytesIO
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.extras import library
from rtamt.lazy.modules import np
from rtamt.readers.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import BinaryIO

_MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 0x02, 0x04, 0x05, 0x06, 0x0F
_KINDS = range(0x01, 0x10)

_LAST = 2**63 - 1  # ns since 1970
_RECORD = struct.Struct("<BQ")  # kind, length
_IN_MESSAGE = struct.Struct("<HIQQ")  # channel, number, time of recording, time of publication
_IN_CHUNK = struct.Struct("<QQQII")  # first time, last time, size, checksum, length of the compression's name
_LENGTH = struct.Struct("<Q")
_END = struct.Struct("<BQQQI")  # kind, length, place of the summary, place of its offsets, checksum


def salvage(path: str, copy: str) -> str:
    """Write the part of a file before the damage to ``copy``; return the loss as a sentence, "" if there is none."""
    size = os.path.getsize(path)
    last: int | None = None
    with open(path, "rb") as file, open(copy, "wb") as out:
        if file.read(len(_MAGIC)) != _MAGIC:
            raise TraceError(f"'{path}' cannot be read as MCAP: it does not begin as such a file does")
        out.write(_MAGIC)
        whole = False
        reached = file.tell()
        for kind, data, complete in _records(file, size):
            if kind in (_DATA_END, _FOOTER):
                whole = True
                break
            intact = complete and (kind != _CHUNK or _is_intact(data))
            cut = not complete and kind == _CHUNK
            for part, content in [(kind, data)] if intact else _whole_records(data) if cut else []:
                out.write(_RECORD.pack(part, len(content)) + content)
                last = _later(last, part, content)
            if not intact:
                break
            reached = file.tell()
        out.write(_RECORD.pack(_FOOTER, 20) + bytes(20) + _MAGIC)
    if whole:
        return ""
    if last is None:
        raise TraceError(
            f"'{path}' is damaged at byte {reached:,} of {size:,}, and no message comes before that"
        )
    until = np.datetime64(min(last, _LAST), "ns")
    return f"the file is damaged at byte {reached:,} of {size:,}: read up to {until} UTC"


#: Messages of ROS 2, which rosbags reads; it does not read those of ROS 1 in this format.
_ENCODING = "cdr"


def refuse_encodings(path: str) -> None:
    """Raise :class:`TraceError` at a topic whose messages are not those of ROS 2, such as JSON, or Protocol Buffers.

    Channels come before their messages, in records of their own or in chunks, and again in the summary at the end.
    """
    size = os.path.getsize(path)
    with open(path, "rb") as file:
        if file.read(len(_MAGIC)) != _MAGIC:
            return  # the reader rejects other files
        for part in (_beginning(file, size), _summary(file, size)):
            for content in part:
                if channel := _channel(content):
                    topic, encoding = channel
                    if encoding != _ENCODING:
                        raise TraceError(
                            f"'{path}' cannot be read: the messages on {topic} are {encoding or 'of no encoding'}, "
                            f"and only those of ROS 2 (cdr) are read; convert the file, to CSV for example"
                        )


def _beginning(file: BinaryIO, size: int) -> Iterator[bytes]:
    """Yield the channels before the first messages: what follows would have to be read whole."""
    for kind, data, complete in _records(file, size):
        records = [(kind, data)] if kind != _CHUNK else _whole_records(data) if complete else []
        yield from (content for part, content in records if part == _CHANNEL)
        if kind in (_CHUNK, _MESSAGE, _DATA_END, _FOOTER):
            return


def _summary(file: BinaryIO, size: int) -> Iterator[bytes]:
    """Yield the channels of the summary, whose place is in the footer; none where there is no summary."""
    at = size - len(_MAGIC) - _END.size
    if at < len(_MAGIC):
        return
    file.seek(at)
    kind, _, start = _END.unpack(file.read(_END.size))[:3]
    if kind != _FOOTER or not len(_MAGIC) <= start < at:
        return
    file.seek(start)
    for part, data, complete in _records(file, size):
        if part == _CHANNEL and complete:
            yield data


def _channel(data: bytes) -> tuple[str, str] | None:
    """Return topic and encoding of a channel; None if it is damaged, which the reader of the file reports."""
    texts, at = [], 4  # after its number and that of its schema
    for _ in range(2):
        if len(data) < at + 4:
            return None
        (length,) = struct.unpack_from("<I", data, at)
        texts.append(printable(data[at + 4 : at + 4 + length].decode("utf-8", "replace")))
        at += 4 + length
    return texts[0], texts[1]


def _records(file: BinaryIO, size: int) -> Iterator[tuple[int, bytes, bool]]:
    """Yield kind, contents and completeness of each record, up to the first malformed one."""
    while len(header := file.read(_RECORD.size)) == _RECORD.size:
        kind, length = _RECORD.unpack(header)
        if kind not in _KINDS:
            return
        data = file.read(min(length, size - file.tell()))
        yield kind, data, len(data) == length


def _later(last: int | None, kind: int, data: bytes) -> int | None:
    """Return the time of the last message so far."""
    if kind == _CHUNK:
        found = int(_IN_CHUNK.unpack_from(data)[1])
    elif kind == _MESSAGE and len(data) >= _IN_MESSAGE.size:
        found = int(_IN_MESSAGE.unpack_from(data)[2])
    else:
        return last
    return found if last is None else max(last, found)


# ---- chunks --------------------------------------------------------------------------------------


def _contents(chunk: bytes) -> tuple[str, int, int, bytes, bool]:
    """Return compression, size, checksum and the packed records of a chunk, and whether these are complete."""
    _, _, size, checksum, length = _IN_CHUNK.unpack_from(chunk)
    at = _IN_CHUNK.size + length
    (packed,) = _LENGTH.unpack_from(chunk, at)
    data = chunk[at + _LENGTH.size :]
    return chunk[_IN_CHUNK.size : at].decode(), size, checksum, data, len(data) == packed


def _is_intact(chunk: bytes) -> bool:
    storage = library("rosbags.rosbag2.storage_mcap", "reading ROS bags", "ros")
    try:
        compression, size, checksum, data, complete = _contents(chunk)
        storage.decompress(data, compression, size, checksum)
    except Exception:  # noqa: BLE001 - whatever it is, the chunk is not to be used
        return False
    return complete


def _whole_records(chunk: bytes) -> list[tuple[int, bytes]]:
    """Return the whole records of a chunk that was cut off."""
    try:
        compression, _, _, data, _ = _contents(chunk)
        records = _decompress(data, compression)
    except Exception:  # noqa: BLE001 - each decompressor has its own errors
        return []
    found = _records(BytesIO(records), len(records))
    return [(kind, content) for kind, content, complete in found if complete and kind != _CHUNK]


def _decompress(data: bytes, compression: str) -> bytes:
    """Return as much of compressed data as can be decoded without its end."""
    if not compression:
        return data
    if compression == "lz4":
        decompressor: Any = library("lz4.frame", "reading ROS bags", "ros").LZ4FrameDecompressor()
    else:
        zstd = library("rosbags.rosbag2.storage_mcap", "reading ROS bags", "ros").zstd
        decompressor = zstd.ZstdDecompressor()
    return bytes(decompressor.decompress(data))
