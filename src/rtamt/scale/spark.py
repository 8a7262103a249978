"""The engine on Apache Spark: ``check`` for data frames and paths, ``stream``; needs ``rtamt[spark]`` and Java 17.

Recordings are the rows of a data frame, which Spark distributes; a suite is sent as bytes of programs. Results may be
kept in a Parquet dataset: then only those recordings are checked that it does not have, by an anti-join on recording,
etag, program, reader options and version of the semantics.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, choices
from rtamt.extras import library
from rtamt.fleet.verdict_table import Row, VerdictTable
from rtamt.scale.job import SEMANTICS_VERSION, Job
from rtamt.scale.recordings import Recording, recordings_of
from rtamt.scale.spark_stream import stream
from rtamt.signals.time_columns import is_stamps, split_unit

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from typing_extensions import Unpack

    from rtamt.fleet.suite import Suite
    from rtamt.scale.job import ReaderOptions

__all__ = ["check", "stream", "tables"]

#: What the results of a recording depend on.
_KEYS = ("recording", "etag", "program", "options", "semantics")
_TYPES = {"robustness": "double", "satisfied": "boolean", "first_violation": "double"}
#: The tasks for each core, so that recordings of different lengths keep all cores busy.
_TASKS = 4
#: Recordings of a task whose results are collected together.
_WAVE = 64


def check(
    recordings: Any,
    suite: Suite,
    *,
    results: str | None = None,
    session: Any = None,
    **options: Unpack[ReaderOptions],
) -> Any:
    """Check recordings with Spark; return a data frame with a row for each recording and requirement.

    ``recordings``: paths and patterns of files that every worker can read (see :func:`recordings_of`), or a data frame
    of samples: a column ``recording`` with the name of each, the column of timestamps, and a column for each signal.
    ``results``: a Parquet dataset of results, to which those of new recordings are added; a data frame of samples then
    needs a column ``etag``, which changes with the content of a recording. ``session``: the Spark session, by default
    the active one, else a new one. ``options``: of :func:`rtamt.read`.

    A damaged recording becomes rows with its error. The columns are those of :class:`rtamt.VerdictTable`.
    """
    library("pyspark", "rtamt.scale.spark", "spark")
    job = Job(suite, **options)
    spark = session or _session()
    of_samples = hasattr(recordings, "groupBy")
    if of_samples:
        _check_columns(recordings, "recording", *(["etag"] if results is not None else []))
        frame = recordings
    else:
        frame = _frame_of(spark, recordings_of(recordings))
    compute = _of_samples if of_samples else _of_paths
    columns = list(VerdictTable([], suite.select).columns)
    if results is None:
        return compute(frame, job).select(columns)
    wanted = _shared_columns(frame.select("recording", "etag").distinct(), job)
    known = _known(spark, results)
    if known is not None:
        frame = frame.join(
            wanted.join(known.select(*_KEYS).distinct(), [*_KEYS], "left_anti").select("recording", "etag"),
            ["recording", "etag"],
            "left_semi",
        )
    _shared_columns(compute(frame, job), job).write.mode("append").parquet(results)
    return _known(spark, results).join(wanted, [*_KEYS], "left_semi").select(columns)


def tables(
    job: Job, recordings: Sequence[Recording], jobs: int | None = None
) -> Iterator[tuple[Recording, VerdictTable]]:
    """Yield the rows of each recording, see :data:`rtamt.scale.engines.ENGINES`; ``jobs``: the tasks."""
    library("pyspark", "rtamt.scale.spark", "spark")
    spark, select = _session(), job.suite.select
    tasks = jobs or spark.sparkContext.defaultParallelism
    size = tasks * _WAVE
    for first in range(0, len(recordings), size):  # what was done is known after each wave
        found = _of_paths(_frame_of(spark, recordings[first : first + size], tasks), job).collect()
        rows = [Row(**{name: each[name] for name in VerdictTable([], select).columns}) for each in found]
        for start in range(0, len(rows), len(job.suite)):  # those of a recording follow each other
            some = rows[start : start + len(job.suite)]
            yield Recording(some[0].recording, found[start]["etag"]), VerdictTable(some, select)


def _session() -> Any:
    from pyspark.sql import SparkSession

    active = SparkSession.getActiveSession()
    if active is not None:
        return active
    if shutil.which("java") is None and "JAVA_HOME" not in os.environ:
        raise UsageError(
            "Spark needs Java 17, which is not installed: on Debian, apt-get install openjdk-17-jre-headless"
        )
    if not any(name.startswith("SPARK_") for name in os.environ):  # Spark on this machine alone
        os.environ["SPARK_LOCAL_IP"] = "127.0.0.1"
    # The workers run what runs here, wherever "python3" leads.
    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)
    builder = SparkSession.builder.appName("rtamt").config("spark.ui.enabled", "false")
    made = builder.config("spark.ui.showConsoleProgress", "false").getOrCreate()
    made.sparkContext.setLogLevel("ERROR")
    return made


def _frame_of(spark: Any, recordings: Sequence[Recording], tasks: int | None = None) -> Any:
    context = spark.sparkContext
    count = tasks or context.defaultParallelism * _TASKS
    rows = context.parallelize([tuple(each) for each in recordings], max(1, min(count, len(recordings))))
    return spark.createDataFrame(rows, "recording string, etag string")


def _known(spark: Any, results: str) -> Any:
    """Return the results so far; None if there are none."""
    from pyspark.errors import AnalysisException

    try:
        frame = spark.read.parquet(results)
    except AnalysisException:  # there is no such dataset, or nothing in it
        return None
    _check_columns(frame, *_KEYS)
    return frame


def _shared_columns(frame: Any, job: Job) -> Any:
    """Return a data frame with the columns that all recordings of a job share."""
    from pyspark.sql.functions import lit

    options = json.dumps(job.options, sort_keys=True, default=list)
    return (
        frame.withColumn("program", lit(job.suite.fingerprint))
        .withColumn("options", lit(options))
        .withColumn("semantics", lit(SEMANTICS_VERSION))
    )


def _check_columns(frame: Any, *names: str) -> None:
    for name in names:
        if name not in frame.columns:
            raise UsageError(
                f"the data frame has no column '{name}'{choices(name, frame.columns, 'columns')}"
            )


def _schema(job: Job, *, etag: bool) -> str:
    parts = [f"{name} {_TYPES.get(name, 'string')}" for name in VerdictTable([], job.suite.select).columns]
    return ", ".join([*parts, *(["etag string"] if etag else [])])


# ---- work of the processes -----------------------------------------------------------------------


def _of_paths(frame: Any, job: Job) -> Any:
    """Return the rows of recordings in files, with their etags."""
    return frame.mapInArrow(_batches(job), _schema(job, etag=True))


def _batches(job: Job) -> Callable[[Iterable[Any]], Iterator[Any]]:
    def run(batches: Iterable[Any]) -> Iterator[Any]:
        pa = library("pyarrow", "a table in Arrow", "data")

        for batch in batches:
            for recording in batch.to_pylist():
                table = job.table(recording["recording"]).to_arrow()
                etags = pa.array([recording["etag"]] * table.num_rows, pa.string())
                yield from table.append_column("etag", etags).to_batches()

    return run


def _of_samples(frame: Any, job: Job) -> Any:
    """Return the rows of recordings whose samples are rows of a data frame, with their etags if these are known."""
    keys = ["recording", *(["etag"] if "etag" in frame.columns else [])]
    return frame.groupBy(*keys).applyInArrow(_group(job), _schema(job, etag=len(keys) > 1))


def _group(job: Job) -> Callable[[Any, Any], Any]:
    def run(key: tuple[Any, ...], samples: Any) -> Any:
        pa = library("pyarrow", "a table in Arrow", "data")

        name = str(key[0].as_py())
        table = job.table_of(name, lambda: _in_order(samples, job.options.get("time"))).to_arrow()
        if len(key) > 1:
            table = table.append_column("etag", pa.array([key[1].as_py()] * table.num_rows, pa.string()))
        return table

    return run


def _in_order(samples: Any, clock: str | None) -> Any:
    """Return the samples of one recording in the order of their timestamps: Spark may have shuffled them."""
    names = [name for name in samples.column_names if name not in ("recording", "etag")]
    clocks = [name for name in names if is_stamps(split_unit(name)[0])] if clock is None else [clock]
    if len(clocks) != 1 or clocks[0] not in names:
        raise TraceError(
            f"rows of a data frame have no order, and there is no one column of timestamps among {', '.join(names)}: "
            f"choose one with time="
        )
    return samples.select(names).sort_by(clocks[0])
