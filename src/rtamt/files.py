"""Read texts that end, and write output files completely or not at all."""

from __future__ import annotations

import errno
import os
import stat
from contextlib import contextmanager, suppress

from rtamt.errors import readable
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import TextIO


def nearest_file(path: str) -> str:
    """Return ``"; did you mean 'log.csv'?"`` for the nearest name in the same folder, else an empty string."""
    from difflib import get_close_matches

    folder, name = os.path.split(path)
    try:
        names = os.listdir(folder or ".")
    except OSError:
        return ""
    close = get_close_matches(name, names, n=1, cutoff=0.75)
    return f"; did you mean '{os.path.join(folder, close[0])}'?" if close else ""


def is_device(path: str | os.PathLike[str]) -> bool:
    """Return whether a path leads to a device, such as ``/dev/zero``."""
    mode = _mode(path)
    return stat.S_ISCHR(mode) or stat.S_ISBLK(mode)


def is_pipe(path: str | os.PathLike[str]) -> bool:
    """Return whether a path leads to a named pipe or a socket."""
    mode = _mode(path)
    return stat.S_ISFIFO(mode) or stat.S_ISSOCK(mode)


def _mode(path: str | os.PathLike[str]) -> int:
    """Return the mode of what a path leads to, 0 for nothing."""
    try:
        return os.stat(path).st_mode
    except (OSError, ValueError):  # texts that are no paths
        return 0


def open_text(
    path: str | os.PathLike[str], encoding: str = "utf-8-sig", newline: str | None = None
) -> TextIO:
    """Open a text to read it whole; raises :class:`OSError`, also for a device: it may have no end."""
    if is_device(path):
        raise OSError(errno.EINVAL, "it is a device, expected a file", path)
    return open(path, encoding=encoding, newline=newline)


def same_file(first: str, second: str) -> bool:
    """Return whether two paths lead to one regular file, which need not exist yet."""
    try:
        known, other = _status(first), _status(second)
    except (OSError, ValueError):  # texts that are no paths
        return False
    if known is None or other is None:
        return known is other and os.path.realpath(first) == os.path.realpath(second)
    return stat.S_ISREG(known.st_mode) and os.path.samestat(known, other)


@contextmanager
def replacing(path: str | os.PathLike[str]) -> Iterator[str]:
    """Yield a temporary file in the folder of ``path``, which replaces ``path`` on success.

    It keeps the permissions of the file that it replaces; symbolic links are followed.
    Anything but a regular file (a pipe, a terminal, ``/dev/stdout``) is written directly. Raises :class:`OSError`.
    """
    given = os.fspath(path)
    known = _status(given)
    if known is not None and not _is_plain(known):
        yield given
        return
    target = os.path.realpath(given)
    folder, name = os.path.split(target)
    stem, suffix = os.path.splitext(name)  # plotting libraries choose the format by the extension
    new = os.path.join(folder, f".{stem[:100]}.{os.urandom(4).hex()}{suffix}")
    if known is not None and not os.access(target, os.W_OK):
        raise PermissionError(13, "Permission denied", given)
    os.close(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    try:
        if known is not None:
            os.chmod(new, stat.S_IMODE(known.st_mode))
        yield new
        os.replace(new, target)
    except BaseException:
        with suppress(FileNotFoundError):
            os.unlink(new)
        raise


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a text as UTF-8; raises :class:`OSError`."""
    write_bytes(path, readable(text).encode())


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write bytes; raises :class:`OSError`."""
    with replacing(path) as new, open(new, "wb") as file:
        file.write(content)


def _status(path: str) -> os.stat_result | None:
    try:
        return os.stat(path)
    except FileNotFoundError:
        return None


def _is_plain(known: os.stat_result) -> bool:
    """Return whether a path is a regular file that no standard stream of this process writes to."""
    return stat.S_ISREG(known.st_mode) and not any(
        os.path.samestat(known, stream) for stream in _standard_streams()
    )


def _standard_streams() -> Iterator[os.stat_result]:
    for number in (1, 2):
        with suppress(OSError):
            yield os.fstat(number)
