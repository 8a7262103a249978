"""The engine on this machine: a process pool, which survives recordings that end a process."""

from __future__ import annotations

import atexit
import os
import threading
from collections import deque
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection, get_context, parent_process
from typing import TYPE_CHECKING

from rtamt.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.fleet.verdict_table import VerdictTable
    from rtamt.scale.job import Job
    from rtamt.scale.recordings import Recording

#: Recordings that wait for each process, so that none is idle.
_AHEAD = 2


def tables(
    job: Job, recordings: Sequence[Recording], jobs: int | None = None
) -> Iterator[tuple[Recording, VerdictTable]]:
    """Yield the rows of each recording, in the order in which they are done.

    ``jobs``: the number of processes, by default one for each core; with 1, this process does the work.
    """
    if jobs is not None and jobs < 1:
        raise UsageError(f"jobs is {jobs}; give a number of processes, 1 or more")
    count = min(jobs or os.cpu_count() or 1, len(recordings))
    if count <= 1:
        for recording in recordings:
            yield recording, job.table(recording.path)
        return
    waiting = deque(recordings)
    while waiting:
        running: dict[Future[VerdictTable], Recording] = {}
        with _pool(job, count) as pool:
            try:
                yield from _run(pool, waiting, running, count * _AHEAD)
            except BrokenProcessPool:
                pass
            finally:
                pool.shutdown(wait=True, cancel_futures=True)
        for recording in running.values():  # one of them has ended its process
            yield recording, _check_alone(job, recording)


def _run(
    pool: ProcessPoolExecutor,
    waiting: deque[Recording],
    running: dict[Future[VerdictTable], Recording],
    most: int,
) -> Iterator[tuple[Recording, VerdictTable]]:
    while waiting or running:
        while waiting and len(running) < most:
            future = pool.submit(_table, waiting[0].path)
            running[future] = waiting.popleft()
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in done:
            table = future.result()
            yield running.pop(future), table


def _check_alone(job: Job, recording: Recording) -> VerdictTable:
    with _pool(job, 1) as pool:
        try:
            return pool.submit(_table, recording.path).result()
        except BrokenProcessPool:
            return job.failed(
                recording.path,
                f"{recording.path} cannot be checked: the process that read it was ended, perhaps for want of memory",
            )


def _pool(job: Job, count: int) -> ProcessPoolExecutor:
    # Processes start afresh: nothing of this one (locks, threads of libraries) is copied into them.
    return ProcessPoolExecutor(count, get_context("spawn"), _receive, (job,))


_jobs: list[Job] = []


def _receive(job: Job) -> None:
    """Take the job, once in each process."""
    _jobs[:] = [job]
    # With the thread below, modules are not cleared at the end, which the core reports as leaks: end without.
    atexit.register(os._exit, 0)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this process when the one that started it is killed: nothing else would."""
    parent = parent_process()
    assert parent is not None
    connection.wait([parent.sentinel])
    os._exit(1)


def _table(path: str) -> VerdictTable:
    return _jobs[0].table(path)
