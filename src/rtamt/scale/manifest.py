"""The results so far, in a file: nothing is computed twice, also after a crash.

A line of JSON for each recording: its path, its version, the key of the job (programs, reader options, version of the
semantics) and its rows. Lines are only added; one that a crash cut off is ignored and overwritten.
"""

from __future__ import annotations

import json
import os
import tempfile
import time
from typing import IO, TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.fleet.verdict_table import Row, VerdictTable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from typing_extensions import Self

    from rtamt.scale.recordings import Recording

_BEGIN = b'{"rtamt":'
#: Seconds after which lines are forced to the disk: what a crash of the machine, not of the process, may lose.
_SYNC = 1.0


class Manifest:
    """The results of one job by recording; ``path``: the file, None for one that lives as long as the job.

    Rows stay in the file: memory holds the place of each recording only.
    """

    def __init__(self, path: str | None, key: str, select: Sequence[str]) -> None:
        self._key, self._select = key, tuple(select)
        self._places: dict[Recording, int] = {}
        self._synced = time.monotonic()
        try:  # closed by __exit__
            self._file: IO[bytes] = tempfile.TemporaryFile() if path is None else open(path, "a+b")  # noqa: SIM115 - see above
        except OSError as error:
            raise UsageError(f"cannot write the manifest '{path}': {error.strerror}") from None
        try:
            self._load(path)
        except BaseException:
            self._file.close()
            raise

    def _load(self, path: str | None) -> None:
        self._file.seek(0)
        at = 0
        for line in self._file:
            if not line.startswith(_BEGIN) and not _BEGIN.startswith(line):  # may be cut off there, too
                raise UsageError(f"'{path}' is no manifest of rtamt: name another file")
            if not line.endswith(b"\n"):  # cut off by a crash
                break
            try:
                entry = json.loads(line)
                if entry["key"] == self._key:
                    self._places[_recording(entry)] = at
            except (KeyError, RecursionError, TypeError, ValueError):
                raise UsageError(
                    f"the manifest '{path}' is damaged at byte {at}: delete it, and all is computed again"
                ) from None
            at += len(line)
        self._file.truncate(at)

    def __contains__(self, recording: Recording) -> bool:
        return recording in self._places

    def add(self, recording: Recording, table: VerdictTable) -> None:
        """Write the rows of a recording."""
        if recording in self._places:
            return
        entry = {"rtamt": 1, "key": self._key, "path": recording.path, "etag": recording.etag}
        entry["rows"] = [row[1:] for row in table]
        self._places[recording] = self._file.seek(0, os.SEEK_END)
        self._file.write(json.dumps(entry, separators=(",", ":"), ensure_ascii=False).encode() + b"\n")
        self._file.flush()
        if time.monotonic() - self._synced > _SYNC:
            os.fsync(self._file.fileno())
            self._synced = time.monotonic()

    def table(self, recording: Recording) -> VerdictTable:
        """Return the rows of a recording that has been added."""
        self._file.seek(self._places[recording])
        entry = json.loads(self._file.readline())
        return VerdictTable([Row(recording.path, *row) for row in entry["rows"]], self._select)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_error: object) -> None:
        self._file.close()


def _recording(entry: dict[str, Any]) -> Recording:
    from rtamt.scale.recordings import Recording

    return Recording(entry["path"], entry["etag"])
