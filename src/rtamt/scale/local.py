"""The engine on this machine: a process pool, which survives recordings that end a process."""

from __future__ import annotations

import atexit
import os
import threading
from collections import deque
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from itertools import islice
from multiprocessing import connection, get_context, parent_process
from typing import TYPE_CHECKING

from rtamt.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from rtamt.fleet.verdict_table import VerdictTable
    from rtamt.scale.job import Job
    from rtamt.scale.recordings import Recording

#: Batches of recordings that wait for each process, so that none is idle.
_AHEAD = 2
#: The most recordings of a batch, and the bytes with which it is full: progress is reported after each batch.
_MOST, _FULL = 16, 2**18


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
    apart: set[Recording] = set()
    while waiting:
        running: dict[Future[list[VerdictTable]], list[Recording]] = {}
        with _pool(job, count) as pool:
            try:
                yield from _run(pool, waiting, running, count, apart)
            except BrokenProcessPool:
                pass
            finally:
                pool.shutdown(wait=True, cancel_futures=True)
        for batch in running.values():  # a recording of one of them has ended its process
            if len(batch) == 1:
                yield batch[0], _check_alone(job, batch[0])
            else:
                apart.update(batch)
                waiting.extendleft(reversed(batch))


def _run(
    pool: ProcessPoolExecutor,
    waiting: deque[Recording],
    running: dict[Future[list[VerdictTable]], list[Recording]],
    count: int,
    apart: Collection[Recording],
) -> Iterator[tuple[Recording, VerdictTable]]:
    while waiting or running:
        while waiting and len(running) < count * _AHEAD:
            batch = _batch(waiting, count, apart)
            future = pool.submit(_tables, [recording.path for recording in batch])
            running[future] = batch
            for _ in batch:
                waiting.popleft()
        done, _ = wait(running, return_when=FIRST_COMPLETED)
        for future in done:
            found = future.result()
            yield from zip(running.pop(future), found, strict=True)


def _batch(waiting: Sequence[Recording], count: int, apart: Collection[Recording]) -> list[Recording]:
    """Return the next recordings for one of ``count`` processes: one, or several small files; ``apart``: one each.

    The last ones are handed out one at a time, so that all processes end together.
    """
    most = min(_MOST, max(1, len(waiting) // (2 * count * _AHEAD)))
    batch: list[Recording] = []
    size = 0
    for recording in islice(waiting, most):
        try:
            size += _FULL if recording in apart else os.path.getsize(recording.path)
        except OSError:  # a remote one, or none any more
            size += _FULL
        if batch and size > _FULL:
            break
        batch.append(recording)
    return batch


def _check_alone(job: Job, recording: Recording) -> VerdictTable:
    with _pool(job, 1) as pool:
        try:
            return pool.submit(_tables, [recording.path]).result()[0]
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


def _tables(paths: Sequence[str]) -> list[VerdictTable]:
    return [_jobs[0].table(path) for path in paths]
