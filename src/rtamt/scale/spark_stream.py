"""Fleets on streams of Apache Spark: a stream of samples in, a stream of robustness out; needs ``rtamt[spark]``.

Keys are grouped by their hash; each group is a shard, whose fleet is one value of the state of the query. Spark keeps
the state in RocksDB with its checkpoint: a query that is restarted continues with the state of its last complete
micro-batch, so that each sample counts once.
"""

from __future__ import annotations

import io
from math import isnan
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, choices
from rtamt.extras import library
from rtamt.scale.shard import Sample, Shard, key_problem

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from rtamt.specification import Specification

#: The state store that streams with state of several values need.
_STORE = "spark.sql.streaming.stateStore.providerClass"
_ROCKS_DB = "org.apache.spark.sql.execution.streaming.state.RocksDBStateStoreProvider"
#: The columns of results.
RESULTS = "key string, time double, robustness double, satisfied boolean, error string, late boolean"
#: Columns of a query that no variable has.
_SHARD, _KEY, _TIME = "rtamt_shard", "rtamt_key", "rtamt_time"


def stream(
    samples: Any,
    spec: Specification,
    *,
    key: str = "key",
    time: str = "time",
    watermark: str | None = None,
    shards: int = 64,
    **options: Any,
) -> Any:
    """Monitor a streaming data frame of samples; return one of results.

    ``samples``: with the columns ``key`` and ``time``, and one for each variable. Times are seconds, or timestamps of
    Spark. ``watermark``: how late a sample may be, such as ``"10 seconds"``; samples then wait until the watermark has
    passed them, and are taken in the order of their times. Without it, each micro-batch is taken in this order.
    ``shards``: the number of groups of keys; it cannot be changed while a query has a checkpoint. ``options``: those of
    :class:`~rtamt.scale.shard.Shard`.

    A row of results has a robustness and a verdict (see :class:`~rtamt.scale.shard.Result`), or the ``error`` of a
    sample that was rejected, and whether it was ``late``. Samples behind the watermark are dropped by Spark, which
    counts them: ``numRowsDroppedByWatermark`` in the progress of a query.
    """
    library("pyspark", "rtamt.scale.spark.stream", "spark")
    from pyspark.sql import functions

    columns = Shard(spec, **options).columns  # what a fleet cannot monitor is an error now
    for name in (key, time, *columns):
        if name not in samples.columns and name.partition(".")[0] not in samples.columns:
            raise UsageError(
                f"the data frame has no column '{name}'{choices(name, samples.columns, 'columns')}"
            )
    kind = dict(samples.dtypes).get(time, "")
    if watermark is not None and kind != "timestamp":
        raise UsageError(
            f"the column '{time}' is of the type {kind or 'of a field'}, and a watermark needs a column of timestamps"
        )
    if "RocksDB" not in samples.sparkSession.conf.get(_STORE, ""):
        samples.sparkSession.conf.set(_STORE, _ROCKS_DB)

    def column(name: str) -> Any:
        return functions.col(f"`{name}`" if name in samples.columns else name)

    stamps = column(time)
    if kind.startswith("timestamp"):
        stamps = functions.unix_micros(stamps.cast("timestamp")) / 1e6
    frame = samples if watermark is None else samples.withWatermark(time, watermark)
    selected = frame.select(
        functions.pmod(functions.xxhash64(column(key).cast("string")), functions.lit(shards)).alias(_SHARD),
        column(key).cast("string").alias(_KEY),
        stamps.try_cast("double").alias(_TIME),
        *(column(name).try_cast("double").alias(f"value_{i}") for i, name in enumerate(columns)),
        *([] if watermark is None else [column(time)]),
    )
    processor = _processor(spec, options, len(columns), held=watermark is not None)
    mode = "None" if watermark is None else "EventTime"
    return selected.groupBy(_SHARD).transformWithStateInPandas(processor, RESULTS, "Append", mode)


def _processor(spec: Specification, options: dict[str, Any], width: int, *, held: bool) -> Any:
    """Return what Spark runs for each group; the class exists where Spark does."""
    base = library("pyspark.sql.streaming", "rtamt.scale.spark.stream", "spark").StatefulProcessor

    class Fleets(base):  # type: ignore[misc, valid-type] # imported at run time
        def init(self, handle: Any) -> None:
            self._handle = handle
            self._fleet = handle.getValueState("fleet", "state binary")
            self._held: Any = handle.getValueState("held", "samples binary") if held else None

        def handleInputRows(self, _key: Any, rows: Iterable[Any], timers: Any) -> Iterator[Any]:  # noqa: N802 - Spark gives the name
            samples = [sample for frame in rows for sample in _samples(frame, width)]
            if self._held is None:
                yield self._results(samples)
                return
            waiting = _read(self._held) + samples
            yield from self._release(waiting, timers.getCurrentWatermarkInMs())

        def handleExpiredTimer(  # noqa: N802 - Spark gives the names
            self,
            key: Any,  # noqa: ARG002 - of an empty shard
            timerValues: Any,  # noqa: N803 - as above
            expiredTimerInfo: Any,  # noqa: ARG002, N803 - as above
        ) -> Iterator[Any]:
            yield from self._release(_read(self._held), timerValues.getCurrentWatermarkInMs())

        def close(self) -> None:
            pass

        def _release(self, waiting: list[Sample], watermark: int) -> Iterator[Any]:
            """Take the samples that the watermark has passed; ask to be called when it passes the next one."""
            ready = [sample for sample in waiting if not sample.time * 1000 > watermark]
            rest = [sample for sample in waiting if sample.time * 1000 > watermark]
            if rest:
                due = int(min(sample.time for sample in rest) * 1000) + 1
                if due not in set(self._handle.listTimers()):
                    self._handle.registerTimer(due)
            self._held.update((_bytes(rest),))
            if ready:
                yield self._results(ready)

        def _results(self, samples: list[Sample]) -> Any:
            pandas = library("pandas", "rtamt.scale.spark.stream", "spark")
            state = bytes(self._fleet.get()[0]) if self._fleet.exists() else None
            shard = Shard(spec, state=state, **options)
            rows = _rows(shard, samples)
            self._fleet.update((shard.snapshot(),))
            return pandas.DataFrame(rows, columns=[each.split()[0] for each in RESULTS.split(", ")])

    return Fleets()


def _samples(frame: Any, width: int) -> Iterator[Sample]:
    """Yield the samples of a data frame of pandas; what is null there is NaN, and a key that is null is empty."""
    keys = [each if isinstance(each, str) else "" for each in frame[_KEY].tolist()]
    values = [frame[f"value_{i}"].astype(float).tolist() for i in range(width)]
    for key, time, *row in zip(keys, frame[_TIME].astype(float).tolist(), *values, strict=True):
        yield Sample(key, time, tuple(row))


def _place(sample: Sample) -> tuple[Any, ...]:
    """Return the sort key of a sample in a batch: independent of Spark's shuffling, also if its time is NaN."""
    return isnan(sample.time), sample.time if not isnan(sample.time) else 0.0, sample.key, repr(sample.values)


def _rows(shard: Shard, samples: list[Sample]) -> list[tuple[Any, ...]]:
    """Take samples in the order of their times; return the rows of results, and of rejected samples."""
    rows: list[tuple[Any, ...]] = []
    good = []
    for sample in sorted(samples, key=_place):
        problem = key_problem(sample.key)
        if problem:
            rows.append((sample.key, sample.time, None, None, f"the key {problem}", False))
        else:
            good.append(sample)
    taken = shard.take(good)
    rows += [
        (result.key, result.time, result.robustness, result.satisfied, None, False)
        for result in taken.results
    ]
    for position, error, late in taken.rejected:
        rows.append((*good[position][:2], None, None, error, late))
    rows += [(key, time, None, None, error, False) for key, time, error in taken.discarded]
    return rows


def _bytes(samples: Sequence[Sample]) -> bytes:
    """Return samples as a table of Arrow."""
    arrow = library("pyarrow", "rtamt.scale.spark.stream", "spark")
    columns = [
        [each.key for each in samples],
        [each.time for each in samples],
        [each.values for each in samples],
    ]
    kinds = [arrow.string(), arrow.float64(), arrow.list_(arrow.float64())]
    table = arrow.table(
        [arrow.array(column, kind) for column, kind in zip(columns, kinds, strict=True)], names=Sample._fields
    )
    written = io.BytesIO()
    with arrow.ipc.new_stream(written, table.schema) as stream_of:
        stream_of.write_table(table)
    return written.getvalue()


def _read(state: Any) -> list[Sample]:
    """Return the samples that wait for the watermark."""
    if not state.exists():
        return []
    arrow = library("pyarrow", "rtamt.scale.spark.stream", "spark")
    table = arrow.ipc.open_stream(bytes(state.get()[0])).read_all()
    columns = [column.to_pylist() for column in table.columns]
    return [Sample(key, time, tuple(values)) for key, time, values in zip(*columns, strict=True)]
