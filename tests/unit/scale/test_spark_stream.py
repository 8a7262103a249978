"""Fleets on streams of Spark: real streams of files, restarted from their checkpoint after a crash."""

import json
import os

import numpy as np
import pytest

import rtamt
from tests.unit.scale.conftest import SPARK

pytestmark = SPARK

SPEC = rtamt.parse("always[0:2](speed <= 30)")
SCHEMA = "key string, time double, speed double"
SAMPLES = 8
#: The time of the first sample where there is a watermark: what is not after 1970 would be behind it.
START = 1_700_000_000


@pytest.fixture(autouse=True)
def one_task(session):
    """Let a stateful stage have one task."""
    before = session.conf.get("spark.sql.shuffle.partitions")
    session.conf.set("spark.sql.shuffle.partitions", "1")
    yield
    session.conf.set("spark.sql.shuffle.partitions", before)


def series():
    random = np.random.default_rng(5)
    return {f"car-{i}": random.uniform(0, 60, SAMPLES).round(3).tolist() for i in range(12)}


def write(folder, number, rows):
    folder.mkdir(exist_ok=True)
    lines = [json.dumps(dict(zip(("key", "time", "speed"), row, strict=True))) for row in rows]
    path = folder / f"{number}.json"
    path.write_text("\n".join(lines))
    os.utime(path, (1_700_000_000 + number,) * 2)  # Spark reads files in this order


def offline(known):
    found = []
    for key, speeds in known.items():
        signal = SPEC.evaluate({"time": np.arange(SAMPLES, dtype=float), "speed": speeds}).signal
        found += [(key, float(t), float(r)) for t, r in zip(signal.times, signal.values, strict=True)][:-2]
    return sorted(found)


def run(results, place, wrong=None):
    """Run a query until it has read all files; return its rows. ``wrong``: the batch whose sink fails."""
    found = []

    def sink(frame, number):
        rows = [tuple(row) for row in frame.collect()]
        if number == wrong:
            raise RuntimeError("the sink has crashed")
        found.extend(rows)

    query = (
        results.writeStream.foreachBatch(sink)
        .option("checkpointLocation", str(place))
        .outputMode("append")
        .trigger(availableNow=True)
        .start()
    )
    try:
        query.awaitTermination(200)
    finally:
        query.stop()
    return found


def read(session, folder):
    return session.readStream.schema(SCHEMA).option("maxFilesPerTrigger", 1).json(str(folder))


def test_a_restart_from_the_checkpoint_counts_each_sample_once(session, tmp_path):
    from pyspark.errors import StreamingQueryException

    from rtamt.scale import spark

    known, place = series(), tmp_path / "checkpoint"
    folder = tmp_path / "samples"
    write(folder, 0, [(key, t, known[key][t]) for t in range(3) for key in known])
    bad = [("car-1", 1, 7.0), ("car-2", 5, None), (None, 0, 7.0)]
    write(folder, 1, [*((key, t, known[key][t]) for t in range(3, 5) for key in known), *bad])
    results = spark.stream(read(session, folder), SPEC, shards=3)
    rows = []
    with pytest.raises(StreamingQueryException, match="the sink has crashed"):
        rows += run(results, place, wrong=1)
    write(folder, 2, [(key, t, known[key][t]) for t in range(5, SAMPLES) for key in known])
    rows = run(spark.stream(read(session, folder), SPEC, shards=3), place)
    # The first batch was complete before the crash: its results are not there again.
    expected = [row for row in offline(known) if row[1] > 0]
    assert sorted(row[:3] for row in rows if row[4] is None) == expected
    assert all(row[3] == (row[2] > 0) for row in rows if row[4] is None)
    errors = sorted((row[0], row[5], row[4]) for row in rows if row[4] is not None)
    assert [each[:2] for each in errors] == [("", False), ("car-1", True), ("car-2", False)]
    assert errors[0][2] == 'the key is "", expected 1 to 256 printable characters'
    assert errors[1][2].startswith("key 'car-1': time does not increase at sample")


def test_samples_wait_for_the_watermark(session, tmp_path):
    from pyspark.sql import functions

    from rtamt.scale import spark

    known, place = series(), tmp_path / "checkpoint"
    folder = tmp_path / "samples"
    rows = [(key, t, known[key][t]) for t in range(SAMPLES) for key in known]
    np.random.default_rng(2).shuffle(shuffled := np.array(range(len(rows))))
    # Each file has samples of four seconds, in any order; those of two seconds come a file later.
    files = [[rows[i] for i in shuffled if rows[i][1] // 4 == n] for n in range(2)]
    files[1] += [row for row in files[0] if row[1] >= 2]
    files[0] = [row for row in files[0] if row[1] < 2] + [
        row for row in files[0] if row[1] == 3 and row[0] == "car-0"
    ]
    files[1] = [row for row in files[1] if row not in files[0]]
    files.append([("end", 60, 0.0)])

    def stream():
        frame = read(session, folder).withColumn("time", (functions.col("time") + START).cast("timestamp"))
        return spark.stream(frame, SPEC, watermark="3 seconds", shards=2)

    write(folder, 0, files[0])
    found = run(stream(), place)
    for number in (1, 2):
        write(folder, number, files[number])
    found += run(stream(), place)
    assert sorted((row[0], row[1] - START, row[2]) for row in found) == offline(known)
    assert all(row[4] is None for row in found)


def test_mistakes(session):
    from rtamt.scale import spark

    frame = session.createDataFrame([], SCHEMA)
    for options, error in (
        (
            {"key": "kez"},
            "the data frame has no column 'kez'; did you mean 'key'? (columns: key, time, speed)",
        ),
        (
            {"watermark": "3 seconds"},
            "the column 'time' is of the type double, and a watermark needs a column of timestamps",
        ),
    ):
        with pytest.raises(rtamt.UsageError) as caught:
            spark.stream(frame, SPEC, **options)
        assert str(caught.value) == error
