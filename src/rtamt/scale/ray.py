"""The engine on Ray Data: ``check`` for paths; needs ``rtamt[ray]``."""

from __future__ import annotations

import logging
import os
from typing import TYPE_CHECKING, Any

from rtamt.extras import library
from rtamt.fleet.verdict_table import Row, VerdictTable
from rtamt.scale.job import Job
from rtamt.scale.recordings import Recording, recordings_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from typing_extensions import Unpack

    from rtamt.fleet.suite import Suite
    from rtamt.scale.job import ReaderOptions


def check(recordings: Iterable[str], suite: Suite, **options: Unpack[ReaderOptions]) -> Any:
    """Check recordings with Ray Data; return a ``ray.data.Dataset`` with a row for each recording and requirement.

    ``recordings``: paths and patterns of files that every worker can read, see :func:`recordings_of`. ``options``: of
    :func:`rtamt.read`. A damaged recording becomes rows with its error. The columns are those of
    :class:`rtamt.VerdictTable`.
    """
    found = recordings_of(recordings)
    return _dataset(Job(suite, **options), found, None).select_columns(
        list(VerdictTable([], suite.select).columns)
    )


def tables(
    job: Job, recordings: Sequence[Recording], jobs: int | None = None
) -> Iterator[tuple[Recording, VerdictTable]]:
    """Yield the rows of each recording, see :data:`rtamt.scale.engines.ENGINES`; ``jobs``: the tasks."""
    select = job.suite.select
    names = VerdictTable([], select).columns
    rows: list[Row] = []
    for found in _dataset(job, recordings, jobs).iter_rows():
        rows.append(Row(**{name: found[name] for name in names}))
        if len(rows) == len(job.suite):  # those of a recording follow each other
            yield Recording(rows[0].recording, found["etag"]), VerdictTable(rows, select)
            rows = []


def _dataset(job: Job, recordings: Sequence[Recording], tasks: int | None) -> Any:
    ray = library("ray", "rtamt.scale.ray", "ray")
    data = library("ray.data", "rtamt.scale.ray", "ray")
    if not ray.is_initialized():
        alone = {}
        if not os.environ.get("RAY_ADDRESS"):  # Ray on this machine alone, without usage reports
            alone["_node_ip_address"] = "127.0.0.1"
            os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
        logging.getLogger("ray.data").setLevel(logging.WARNING)
        ray.init(include_dashboard=False, log_to_driver=False, configure_logging=False, **alone)
    sent = ray.put(job)

    def rows(batch: Any) -> Iterator[Any]:
        pa = library("pyarrow", "a table in Arrow", "data")

        job = ray.get(sent)
        for recording in batch.to_pylist():
            table = job.table(recording["recording"]).to_arrow()
            etags = pa.array([recording["etag"]] * table.num_rows, pa.string())
            yield table.append_column("etag", etags)

    items = [each._asdict() for each in recordings]
    blocks = max(1, min(tasks or int(ray.cluster_resources().get("CPU", 1)) * 4, len(items)))
    frame = data.from_items(
        [{"recording": each["path"], "etag": each["etag"]} for each in items], override_num_blocks=blocks
    )
    return frame.map_batches(rows, batch_format="pyarrow", batch_size=None)
