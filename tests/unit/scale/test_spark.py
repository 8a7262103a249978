"""Suites on Apache Spark, in local mode: one session for all tests."""

from __future__ import annotations

import os

import pytest

import rtamt
from rtamt.scale.engines import check_recordings
from rtamt.scale.job import Job
from rtamt.scale.recordings import recordings_of
from tests.unit.scale.conftest import SPARK
from tests.unit.scale.recorded import columns, expected, suite, write_csv

pytestmark = SPARK

ROWS = ("recording", "requirement", "robustness", "satisfied", "first_violation", "unchecked", "error")


@pytest.fixture
def folder(tmp_path):
    logs = tmp_path / "logs"
    logs.mkdir()
    for i in range(4):
        write_csv(logs / f"{i}.csv", i)
    (logs / "bad.parquet").write_bytes(b"PAR1 and no more")
    return logs


def in_order(frame):
    return sorted(tuple(row[name] for name in ROWS) for row in frame.collect())


def test_paths_have_the_same_table_as_the_local_engine(folder):
    from rtamt.scale import spark

    frame = spark.check([str(folder)], suite())
    assert tuple(frame.columns) == ROWS
    local = list(check_recordings(Job(suite()), recordings_of([str(folder)]), jobs=1))
    assert in_order(frame) == sorted(tuple(row) for table in local for row in table)
    assert list(check_recordings(Job(suite()), recordings_of([str(folder)]), engine="spark")) == local


def test_results_that_are_known_are_not_computed_again(session, folder, tmp_path, monkeypatch):
    from rtamt.scale import recordings, spark

    results = str(tmp_path / "results")
    before = in_order(spark.check([str(folder)], suite(), results=results))
    # Whoever reads it again sees something else; its version is as before.
    versions = {str(folder / "1.csv"): recordings.version_of(str(folder / "1.csv"))}
    current = recordings.version_of
    monkeypatch.setattr(recordings, "version_of", lambda path: versions.get(path) or current(path))
    (folder / "1.csv").write_text("x")
    write_csv(folder / "2.csv", 12)
    os.utime(folder / "2.csv", ns=(1, 1))
    after = in_order(spark.check([str(folder)], suite(), results=results))
    two = str(folder / "2.csv")
    assert [row for row in after if row[0] != two] == [row for row in before if row[0] != two]
    assert [row for row in after if row[0] == two] == sorted(map(tuple, expected(12, two)))
    stored = session.read.parquet(results)
    assert stored.count() == 5 * 3 + 3
    assert {"etag", "program", "options", "semantics"} <= set(stored.columns)


def test_a_data_frame_of_shuffled_samples(session, tmp_path):
    from rtamt.scale import spark

    samples = []
    for i in range(3):
        data = columns(i)
        rows = zip(*(column.tolist() for column in data.values()), strict=True)
        samples += [(f"drive {i}", "v1", *row) for row in rows]
    samples += [("drive 9", "v1", 0.0, 1.0, float("nan"))]
    frame = session.createDataFrame(
        sorted(samples, key=hash), "recording string, etag string, time double, x double, y double"
    )
    found = in_order(spark.check(frame, suite(), results=str(tmp_path / "results")))
    assert found[:9] == sorted(tuple(row) for i in range(3) for row in expected(i, f"drive {i}"))
    errors = [row[-1] for row in found[9:]]
    assert errors.count(None) == 1  # LOW reads x alone
    assert found == in_order(spark.check(frame, suite(), results=str(tmp_path / "results")))
    with pytest.raises(rtamt.UsageError, match=r"^the data frame has no column 'etag'"):
        spark.check(frame.drop("etag"), suite(), results=str(tmp_path / "results"))
