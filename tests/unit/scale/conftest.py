"""One session of Spark in local mode for all tests, since a JVM takes seconds to start, and a mock cluster of Kafka."""

from __future__ import annotations

import os
import shutil

import pytest

from tests.support.brokers import broker
from tests.unit.scale.recorded import write_csv

#: The marks of a module that uses Spark.
SPARK = [
    pytest.mark.skipif(
        shutil.which("java") is None and "JAVA_HOME" not in os.environ,
        reason="there is no Java here: apt-get install openjdk-17-jre-headless",
    ),
    pytest.mark.filterwarnings("ignore:PySpark does not yet fully support pandas"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
    pytest.mark.usefixtures("session"),
]


@pytest.fixture(scope="package")
def session(tmp_path_factory):
    """Return the session, with one core."""
    from pyspark.sql import SparkSession

    from rtamt.scale import spark

    settings = {"spark.sql.shuffle.partitions": "1", "spark.default.parallelism": "1"}
    # Python's workers connect by a file, not by a port that a program of another test could call at that moment.
    settings["spark.python.unix.domain.socket.enabled"] = "true"
    settings["spark.sql.warehouse.dir"] = str(tmp_path_factory.mktemp("spark"))
    for name, value in settings.items():
        SparkSession.builder.config(name, value)
    SparkSession.builder.master("local[1]")
    found = spark._session()
    found.sparkContext.setLogLevel("ERROR")
    yield found
    found.stop()


@pytest.fixture(scope="module")
def brokers():
    with broker() as address:
        yield address


@pytest.fixture
def folder(tmp_path):
    logs = tmp_path / "logs"
    logs.mkdir()
    for i in range(6):
        write_csv(logs / f"{i}.csv", i)
    return logs
