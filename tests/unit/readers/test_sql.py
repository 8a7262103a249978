"""Databases: SQLite, and a PostgreSQL server of our own, started for the test in a folder of its own."""

import glob
import os
import shutil
import sqlite3
import subprocess
import tempfile
from contextlib import closing
from pathlib import Path

import numpy as np
import psycopg
import pytest

import rtamt

STAMPS = np.array(["2024-05-01T10:00:00", "2024-05-01T10:00:00.5", "2024-05-01T10:00:01"], dtype="M8[ns]")


@pytest.fixture
def database(tmp_path):
    with closing(sqlite3.connect(tmp_path / "log.db")) as connection:
        connection.execute("create table log (stamp text, x real, y integer)")
        rows = [(str(stamp)[:26], 5.0 - i, None if i == 1 else i) for i, stamp in enumerate(STAMPS)]
        connection.executemany("insert into log values (?, ?, ?)", rows)
        connection.commit()
    return f"sqlite:///{tmp_path}/log.db"


def test_sqlite(database):
    trace = rtamt.read(database, query="select stamp, x, y from log order by stamp")
    assert trace["x"].times.tolist() == STAMPS.tolist()
    assert trace["x"].values.tolist() == [5, 4, 3]
    assert trace["y"].values.tolist() == [0, 2]
    assert rtamt.parse("always(x >= y)").evaluate(trace, time="dense").robustness == 1


@pytest.mark.parametrize(
    ("query", "message"),
    [
        (None, "'{url}' is a database: say what to read with query=, or on the command line --query"),
        ("selec", "cannot read from '{url}': near \"selec\": syntax error"),
        ("create table other (x)", "cannot read from '{url}': attempt to write a readonly database"),
        ("select x, x from log", "{url} has 2 columns called 'x'; rename all but one"),
        ("select x as a, 'text' as b from log", None),
    ],
)
def test_messages(database, query, message):
    if message is None:
        assert rtamt.read(database, query=query).notes == ("left out, not numbers: b",)
        return
    with pytest.raises(rtamt.StlError) as error:
        rtamt.read(database, query=query)
    assert str(error.value) == message.format(url=database)


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("nosuch://host/x", "there is no driver for 'nosuch://host/x': Can't load plugin: sqlalchemy.dialects:nosuch"),
        ("mysql://u:secret@host/x",
         "'mysql://u:***@host/x' needs the Python module 'MySQLdb', which is not installed"),
    ],
)  # fmt: skip
def test_a_database_without_a_driver(url, message):
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.read(url, query="select 1")
    assert str(error.value) == message


# ---- PostgreSQL ----------------------------------------------------------------------------------


def programs():
    """Return the folder of initdb and pg_ctl, which Debian keeps out of the PATH."""
    found = shutil.which("initdb") or next(iter(sorted(glob.glob("/usr/lib/postgresql/*/bin/initdb"))), None)
    return None if found is None else Path(found).parent


@pytest.fixture(scope="module")
def server():
    """Start PostgreSQL on a socket in a folder of its own; it refuses to run as root."""
    folder = programs()
    if folder is None:
        pytest.skip("PostgreSQL is not installed; on Debian: apt-get install postgresql")
    root = os.geteuid() == 0
    if root and shutil.which("runuser") is None:
        pytest.skip("PostgreSQL does not run as root, and there is no runuser to become somebody else")
    as_somebody = ["runuser", "-u", "postgres", "--"] if root else []
    with tempfile.TemporaryDirectory(prefix="rtamt-") as home:
        if root:
            shutil.chown(home, "postgres")

        def run(program, *arguments):
            command = [*as_somebody, str(folder / program), "-D", f"{home}/data", *arguments]
            subprocess.run(command, cwd=home, check=True, stdout=subprocess.DEVNULL)

        run("initdb", "--auth=trust", "--username=rtamt", "--no-sync")
        run(
            "pg_ctl",
            "--wait",
            "--log",
            f"{home}/log",
            "--options",
            f"-k {home} -c listen_addresses=",
            "start",
        )
        try:
            yield f"postgresql://rtamt@/postgres?host={home}"
        finally:
            run("pg_ctl", "--mode=immediate", "stop")


@pytest.fixture
def log(server):
    host = server.partition("host=")[2]
    with psycopg.connect(host=host, user="rtamt", dbname="postgres", autocommit=True) as connection:
        connection.execute("drop table if exists log")
        connection.execute(
            "create table log (at timestamptz, x double precision, y numeric(6, 2), note text)"
        )
        for i, stamp in enumerate(STAMPS):
            row = (f"{stamp}Z"[:26] + "Z", 5 - i, None if i == 1 else i, "a%b:c")
            connection.execute("insert into log values (%s, %s, %s, %s)", row)
    return server


def test_postgresql(log):
    query = "select at::timestamp, x, y, note from log where note like 'a%:c' order by at"
    trace = rtamt.read(log, query=query)
    assert trace["x"].times.tolist() == STAMPS.tolist()
    assert (trace["x"].values.tolist(), trace["y"].values.tolist()) == ([5, 4, 3], [0, 2])
    assert trace.notes == ("time is 'at', the one column of dates", "left out, not numbers: note")


def test_postgresql_dates_with_a_time_zone(log):
    trace = rtamt.read(log, query="select at, x from log order by at")
    assert trace["x"].times.tolist() == STAMPS.tolist()


def test_postgresql_says_what_is_wrong(log):
    with pytest.raises(rtamt.TraceError) as error:
        rtamt.read(log, query="select z from log")
    assert str(error.value) == f"cannot read from '{log}': column \"z\" does not exist"


def test_a_folder_and_a_link_were_files_that_do_not_exist(tmp_path):
    (tmp_path / "a.db").mkdir()
    (tmp_path / "b.db").symlink_to("nowhere")
    os.mkfifo(tmp_path / "c.db")
    for name, message in [
        ("a.db", "is a directory, expected a file"),
        ("b.db", "is a link to 'nowhere', which does not exist"),
        ("c.db", "is a pipe or a device, expected a file"),
    ]:
        with pytest.raises(rtamt.TraceError) as error:
            rtamt.read(f"sqlite:///{tmp_path}/{name}", query="select 1")
        assert str(error.value) == f"'{tmp_path}/{name}' {message}"
