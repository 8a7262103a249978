"""The worker processes of the server: started on demand, killed when a request takes too long.

One worker evaluates while the user types, another one replays recordings, and a third one runs solver queries, which
take seconds.
"""

from __future__ import annotations

import asyncio
import json
import os
import sys
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

#: How long a request may take, in seconds, by its kind; others as ``evaluate``.
SECONDS = {"evaluate": 20.0, "recording": 120.0, "find_trace": 30.0}
_LATE = b'{"late": true}'
#: The longest answer, in bytes.
_LONGEST = 256_000_000


class Worker:
    """A process that answers one request at a time."""

    def __init__(self, room: str, folder: str | None) -> None:
        self._room = room
        self._folder = folder
        self._process: asyncio.subprocess.Process | None = None
        self._lock = asyncio.Lock()

    async def ask(self, request: Mapping[str, Any], seconds: float, still_wanted: Any) -> tuple[int, bytes]:
        """Return the status and the answer; a request that is no longer the newest is skipped."""
        async with self._lock:
            if not still_wanted():
                return 200, _LATE
            try:
                line = await asyncio.wait_for(self._exchange(request), seconds)
            except asyncio.TimeoutError:
                await self.end()
                return _failure(f"the request took more than {seconds:g} s and was ended; use fewer samples")
            except asyncio.CancelledError:
                await self.end()
                raise
        status, _, body = line.partition(b" ")
        if not body:
            await self.end()
            return _failure("the request was ended")
        return int(status), body

    async def _exchange(self, request: Mapping[str, Any]) -> bytes:
        if self._process is None or self._process.returncode is not None:
            arguments = [] if self._folder is None else [self._folder]
            self._process = await asyncio.create_subprocess_exec(
                sys.executable,
                "-m",
                "rtamt.play.worker",
                *arguments,
                stdin=asyncio.subprocess.PIPE,
                stdout=asyncio.subprocess.PIPE,
                limit=_LONGEST,
                cwd=self._room,  # an empty folder: Python imports from the current one
                env=_environment(),
                start_new_session=True,  # Ctrl-C goes to the server only
            )
        process = self._process
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps(request).encode() + b"\n")
            await process.stdin.drain()
            return await process.stdout.readline()
        except (BrokenPipeError, ConnectionResetError):  # killed by another process
            return b""

    async def end(self) -> None:
        """End the process; the next request starts another one."""
        process, self._process = self._process, None
        if process is not None and process.returncode is None:
            process.kill()
            await process.wait()


class WorkerPool:
    """The workers, and which request of a page is its newest.

    ``room``: an empty folder. ``folder``: of the files that the given specification imports.
    """

    def __init__(self, room: str, folder: str | None = None) -> None:
        self._quick, self._replaying, self._thorough = (Worker(room, folder) for _ in range(3))
        replays = dict.fromkeys(("replay", "redraw_replay", "cursor"), self._replaying)
        self._workers = {**replays, "find_trace": self._thorough}
        self._newest: dict[tuple[str, str], int] = {}

    async def ask(
        self, kind: str, message: Mapping[str, Any], file: Mapping[str, Any] | None = None
    ) -> tuple[int, bytes]:
        """Return the status and the answer of a request, or that the page has sent a newer one since."""
        page, number = message.get("page"), message.get("number")
        key = (str(page)[:40], kind)
        if isinstance(number, int):
            if len(self._newest) > 1000:
                self._newest.clear()
            self._newest[key] = max(number, self._newest.get(key, number))

        def is_newest() -> bool:
            return not isinstance(number, int) or self._newest.get(key, number) <= number

        worker = self._workers.get(kind, self._quick)
        request = {"kind": kind, "message": message, "file": file}
        return await worker.ask(request, SECONDS.get(kind, SECONDS["evaluate"]), is_newest)

    async def cancel(self) -> None:
        """Stop the search for a trace."""
        await self._thorough.end()

    async def close(self) -> None:
        """End all workers."""
        for worker in (self._quick, self._replaying, self._thorough):
            await worker.end()


def _failure(sentence: str) -> tuple[int, bytes]:
    return 200, json.dumps({"error": {"message": sentence, "start": None, "end": None}}).encode()


def _environment() -> dict[str, str]:
    """Return the environment of workers, which import what this process can import."""
    path = [os.path.abspath(each) for each in sys.path if each and os.path.isdir(each)]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path)}
