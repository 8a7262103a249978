"""The checkpoint of a shard: the state of its keys, and the offset of the next message, in one object.

An object is written completely or not at all: a new file, synchronised to the disk, replaces the old one; an
object store replaces an object with the end of its upload. Its bytes are: ``RTAMT-CHECKPOINT 1`` and a line feed, a
line of JSON (topic, partition, offset), the [state of the fleet](fleet-state.md), and the SHA-256 of all of that. Bytes
that are not a checkpoint are rejected.
"""

from __future__ import annotations

import hashlib
import json
import os
from typing import Any

from rtamt.errors import UsageError
from rtamt.extras import library
from rtamt.files import replacing
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.tuples import NamedTuple
from rtamt.scale.recordings import is_remote

_MAGIC = b"RTAMT-CHECKPOINT 1\n"
_DIGEST = hashlib.sha256().digest_size
_NAME = lazy_pattern(r"[A-Za-z0-9._-]{1,249}")


class Checkpoint(NamedTuple):
    """The position of a shard: ``offset``: of the first message that ``state`` does not contain."""

    topic: str
    partition: int
    offset: int
    state: bytes

    def to_bytes(self) -> bytes:
        """Return the bytes of the object."""
        header = {"topic": self.topic, "partition": self.partition, "offset": self.offset}
        body = _MAGIC + json.dumps(header).encode() + b"\n" + self.state
        return body + hashlib.sha256(body).digest()

    @classmethod
    def from_bytes(cls, content: bytes, place: str) -> Checkpoint:
        """Read an object; raise :class:`UsageError` for other bytes. ``place``: where it is.

        >>> Checkpoint.from_bytes(Checkpoint("cars", 3, 17, b"...").to_bytes(), "cars-3")
        Checkpoint(topic='cars', partition=3, offset=17, state=b'...')
        """
        body, digest = content[:-_DIGEST], content[-_DIGEST:]
        if body.startswith(_MAGIC) and hashlib.sha256(body).digest() == digest:
            line, _, state = body[len(_MAGIC) :].partition(b"\n")
            if (header := _header(line)) is not None:
                return cls(*header, state)
        raise UsageError(
            f"'{place}' is no checkpoint of rtamt, or a damaged one: delete it to read the partition from its start"
        )


def _header(line: bytes) -> tuple[str, int, int] | None:
    """Return the topic, the partition and the offset; None for a header that only its digest makes right."""
    try:
        header = json.loads(line)
        topic, partition, offset = header["topic"], header["partition"], header["offset"]
    except (KeyError, RecursionError, TypeError, ValueError):
        return None
    if not isinstance(topic, str) or not all(type(each) is int and each >= 0 for each in (partition, offset)):
        return None
    return topic, partition, offset


class Checkpoints:
    """The checkpoints of a group and a topic: an object for each partition in a folder, or at an address such as s3://."""

    def __init__(self, place: str, group: str, topic: str) -> None:
        for what, name in (("group", group), ("topic", topic)):
            if not _NAME.fullmatch(name):
                raise UsageError(
                    f"the {what} '{name}' cannot name a file: use letters, digits, '.', '_' and '-' with checkpoints"
                )
        self._topic = topic
        self._system: Any = None
        if is_remote(place):
            fsspec = library("fsspec", f"writing checkpoints to '{place}'", "remote")
            try:
                self._system, folder = fsspec.core.url_to_fs(place)
            except (ImportError, ValueError) as error:
                raise UsageError(f"cannot write checkpoints to '{place}': {error}") from None
        else:
            folder = place
        self._folder = f"{folder.rstrip('/')}/{group}/{topic}"
        self._place = place
        try:
            if self._system is None:
                os.makedirs(self._folder, exist_ok=True)
            else:
                self._system.makedirs(self._folder, exist_ok=True)
        except OSError as error:
            raise self._error("write", error) from None

    def load(self, partition: int) -> Checkpoint | None:
        """Return the checkpoint of a partition; None if there is none."""
        path = self._path(partition)
        try:
            if self._system is None:
                with open(path, "rb") as file:
                    content = file.read()
            else:
                self._system.invalidate_cache()
                content = self._system.cat_file(path)
        except FileNotFoundError:
            return None
        except OSError as error:
            raise self._error("read", error) from None
        found = Checkpoint.from_bytes(content, path)
        if (found.topic, found.partition) != (self._topic, partition):
            raise UsageError(
                f"'{path}' is the checkpoint of partition {found.partition} of '{found.topic}': was it renamed?"
            )
        return found

    def save(self, checkpoint: Checkpoint) -> None:
        """Replace the checkpoint of a partition; the old one stays until the new one is complete."""
        path, content = self._path(checkpoint.partition), checkpoint.to_bytes()
        try:
            if self._system is None:
                with replacing(path) as new, open(new, "wb") as file:
                    file.write(content)
                    file.flush()
                    os.fsync(file.fileno())
                if os.name == "posix":  # elsewhere a folder cannot be forced to the disk
                    folder = os.open(self._folder, os.O_RDONLY)
                    try:
                        os.fsync(folder)
                    finally:
                        os.close(folder)
            else:
                self._system.pipe_file(path, content)
        except OSError as error:
            raise self._error("write", error) from None

    def _path(self, partition: int) -> str:
        return f"{self._folder}/{partition}.checkpoint"

    def _error(self, what: str, error: OSError) -> UsageError:
        return UsageError(f"cannot {what} checkpoints in '{self._place}': {error.strerror or error}")
