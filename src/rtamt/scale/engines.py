"""All recordings of a job: new ones by an engine, the others from the manifest."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from rtamt.errors import UsageError, choices
from rtamt.lazy.tuples import NamedTuple
from rtamt.scale.manifest import Manifest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rtamt.fleet.verdict_table import VerdictTable
    from rtamt.scale.job import Job
    from rtamt.scale.recordings import Recording

#: Each engine: a module with ``tables(job, recordings, jobs)``.
ENGINES = ("local", "ray", "spark")


class Progress(NamedTuple):
    """The progress of a job: recordings ``done`` by now and ``known`` from the manifest, of ``total``."""

    done: int
    known: int
    total: int


def check_recordings(
    job: Job,
    recordings: Sequence[Recording],
    *,
    engine: str = "local",
    manifest: str | None = None,
    jobs: int | None = None,
    progress: Callable[[Progress], None] = lambda _progress: None,
) -> Iterator[VerdictTable]:
    r"""Yield the rows of each recording, in their order; first all are computed that the manifest does not have.

    ``manifest``: the path of the file that remembers results. ``jobs``: processes of the local engine. ``progress``: is
    called whenever a recording is done.

    >>> import pathlib, tempfile
    >>> import rtamt
    >>> from rtamt.scale.job import Job
    >>> from rtamt.scale.recordings import recordings_of
    >>> job = Job(rtamt.Suite(rtamt.parse("always(speed <= 30)", period=1)))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     for i in range(3):
    ...         _ = pathlib.Path(folder, f"{i}.csv").write_text(f"t,speed\n0,{5 + i}\n")
    ...     found = [table.rows[0].robustness for table in check_recordings(job, recordings_of([folder]), jobs=1)]
    >>> found
    [25.0, 24.0, 23.0]
    """
    if engine not in ENGINES:
        raise UsageError(f"there is no engine '{engine}'{choices(engine, ENGINES, 'engines')}")
    tables = import_module(f"rtamt.scale.{engine}").tables
    with Manifest(manifest, job.key, job.suite.select) as store:
        new = [recording for recording in recordings if recording not in store]
        known = len(recordings) - len(new)
        progress(Progress(0, known, len(recordings)))
        if new:
            for done, (recording, table) in enumerate(tables(job, new, jobs), 1):
                store.add(recording, table)
                progress(Progress(done, known, len(recordings)))
        for recording in recordings:
            yield store.table(recording)
