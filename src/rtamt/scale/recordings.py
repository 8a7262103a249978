"""The recordings that patterns and addresses name, each with its version."""

from __future__ import annotations

import glob
import os
import stat
import tempfile
from contextlib import contextmanager
from hashlib import blake2b
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError
from rtamt.extras import library
from rtamt.files import nearest_file
from rtamt.lazy.tuples import NamedTuple
from rtamt.readers.formats import SUFFIXES, is_bag

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

#: Bytes at the beginning and at the end of a large file that its digest covers.
_END = 2**19
#: Under which names stores give what changes with the content: S3, GCS and Azure, and servers that have it, an etag.
_ETAGS = ("ETag", "etag", "md5Hash", "content_md5", "Content-MD5", "Digest")
#: How an etag begins that may stay the same when the content changes.
_WEAK = "W/"
#: Whether files have a time of their last change that no program can set.
_HAS_CHANGE_TIME = os.name == "posix"


class Recording(NamedTuple):
    """A recording: its path or address, and a version that changes whenever its content does."""

    path: str
    etag: str


def is_remote(path: str) -> bool:
    """Return whether a path is an address for fsspec, such as ``s3://bucket/log.parquet``."""
    return "://" in path


def recordings_of(patterns: Iterable[str]) -> list[Recording]:
    """Return the recordings that paths, folders and patterns name, each once, in their order.

    A pattern has ``*``, ``?``, ``[`` or ``**``; a folder means all its files of a known format. Addresses, such
    as ``s3://bucket/*.parquet``, need ``rtamt[remote]``. Raises :class:`UsageError` for what names no recording.
    """
    found: dict[str, Recording] = {}
    for pattern in [patterns] if isinstance(patterns, str) else patterns:
        named = _remote(pattern) if is_remote(pattern) else _local(os.fspath(pattern))
        if not named:
            raise UsageError(f"'{pattern}' names no recording{nearest_file(pattern)}")
        found.update((recording.path, recording) for recording in named)
    return list(found.values())


def _local(pattern: str) -> list[Recording]:
    if os.path.exists(pattern):
        paths = [pattern]
        if os.path.isdir(pattern) and not os.path.exists(os.path.join(pattern, "metadata.yaml")):
            paths = _known(
                os.path.join(folder, name) for folder, _, names in os.walk(pattern) for name in names
            )
    else:
        paths = [path for path in glob.glob(pattern, recursive=True) if os.path.isfile(path) or is_bag(path)]
    return [Recording(path, version_of(path)) for path in sorted(paths)]


def _known(paths: Iterable[str]) -> list[str]:
    return [path for path in paths if os.path.splitext(path)[1].lower() in SUFFIXES]


def version_of(path: str) -> str:
    """Return the version of a local recording, of a folder that of all its files: the time, the size and a digest.

    A copy or a restored backup may have the time and the size of other content. The digest covers the beginning and
    the end of a large file; the system's time of the last change, which no program can set, covers the rest.
    """
    paths = [path]
    if os.path.isdir(path):
        paths = sorted(os.path.join(folder, name) for folder, _, names in os.walk(path) for name in names)
    parts = []
    for each in paths:
        try:
            known = os.stat(each)
        except OSError as error:
            raise UsageError(f"cannot read '{each}': {error.strerror}") from None
        digest = _digest(each, known) if stat.S_ISREG(known.st_mode) else ""
        parts.append(f"{known.st_mtime_ns}-{known.st_size}-{digest}")
    return "+".join(parts)


def _digest(path: str, known: os.stat_result) -> str:
    """Return the digest of a file, of a large one of its ends with the time of its last change; empty on an error."""
    found = blake2b(digest_size=16)
    try:
        with open(path, "rb") as file:
            if known.st_size > 2 * _END and _HAS_CHANGE_TIME:
                found.update(file.read(_END))
                file.seek(known.st_size - _END)
                found.update(file.read(_END))
                return f"{found.hexdigest()}-{known.st_ctime_ns}"
            while part := file.read(_END):
                found.update(part)
    except OSError:  # the check reports it
        return ""
    return found.hexdigest()


def _remote(pattern: str) -> list[Recording]:
    system, path = _file_system(pattern)
    try:
        if system.isdir(path):
            paths = _known(system.find(path))
        elif any(character in path for character in "*?["):
            paths = system.glob(path)
        else:
            paths = [path]
        return [_version_at(system, each) for each in sorted(paths)]
    except (OSError, ValueError) as error:
        raise UsageError(f"cannot read '{pattern}': {error}") from None


def _version_at(system: Any, path: str) -> Recording:
    fsspec = library("fsspec", f"reading '{path}'", "remote")
    if isinstance(system, fsspec.get_filesystem_class("file")):
        return Recording(system.unstrip_protocol(path), version_of(path))
    info = system.info(path)
    etag = next((str(info[key]) for key in _ETAGS if info.get(key)), "")
    if not etag or etag.startswith(_WEAK):
        return Recording(system.unstrip_protocol(path), _digest_at(system, path))
    return Recording(system.unstrip_protocol(path), f"{etag}-{info.get('size')}")


def _digest_at(system: Any, path: str) -> str:
    """Return the digest of all that a remote recording contains.

    A time and a size are not enough: times are whole seconds in many stores, and a copy may keep them.
    """
    found = blake2b(digest_size=16)
    with system.open(path, "rb") as file:
        while part := file.read(_END):
            found.update(part)
    return found.hexdigest()


def _file_system(path: str) -> tuple[Any, str]:
    fsspec = library("fsspec", f"reading '{path}'", "remote")
    try:
        system, inside = fsspec.core.url_to_fs(path)
    except (ImportError, ValueError) as error:
        raise UsageError(f"cannot read '{path}': {error}") from None
    return system, inside


@contextmanager
def fetched(path: str) -> Iterator[str]:
    """Yield the local path of a recording; one that is remote is copied to a temporary file for as long."""
    if not is_remote(path):
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="rtamt-") as folder:
        system, inside = _file_system(path)
        local = os.path.join(folder, os.path.basename(inside))
        try:
            system.get(inside, local)
        except OSError as error:
            raise TraceError(f"cannot read '{path}': {error}") from None
        yield local
