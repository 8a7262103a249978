"""One set of reading options for every command that reads a recording; the instant of ``--at``."""

import json
import re

import pytest
import sqlalchemy

MENDED = "always(x >= 3)"
DATES = "time,x\n2026-01-01T00:00:00,5\n2026-01-01T00:00:00.1,1\n2026-01-01T00:00:00.2,4\n"


@pytest.fixture
def commands(run):
    """Every command that reads one recording, called alike."""

    def call(*args):
        return {
            "check": run("check", *args),
            "explain": run("explain", *args),
            "plot": run("plot", *args, "-o", "picture.svg"),
            "report": run("report", *args, "-o", "report.html"),
        }

    return call


def test_a_database(commands, run, tmp_path):
    engine = sqlalchemy.create_engine(f"sqlite:///{tmp_path}/log.db")
    with engine.begin() as connection:
        connection.execute(sqlalchemy.text("create table log (time real, speed real)"))
        connection.execute(sqlalchemy.text("insert into log values (0, 5), (1, 1)"))
    engine.dispose()
    database = ["--sql", "sqlite:///log.db", "--query", "select * from log", "--name", "x=speed"]
    found = commands(MENDED, *database)
    assert {name: (answer.code, answer.err) for name, answer in found.items()} == {
        "check": (1, ""), "explain": (1, ""), "plot": (0, ""), "report": (1, ""),
    }  # fmt: skip
    told = run("info", *database)
    assert (
        told.out == "Trace of sqlite:///log.db: 1 signal, 0 s to 1 s\n  x  2 samples, 0 s to 1 s  (speed)\n"
    )
    assert run("info", "x", *database).out == told.out


def test_nan_is_skipped_and_the_rest_put_on_one_time_base(commands, write, run):
    write("log.csv", "time,x,y\n0,5,1\n0.5,nan,1\n1,4,1\n1.5,2,1\n")
    for answer in commands(MENDED, "log.csv").values():
        assert (answer.code, answer.err) == (
            2,
            "rtamt: log.csv, line 3: 'x' is NaN: fill the gap, or leave such samples out with skip_nan=, "
            "on the command line --skip-nan\n",
        )
    found = commands(MENDED, "log.csv", "--skip-nan", "x", "--resample", "500ms", "--how", "linear")
    *_, row, _, note = found["check"].out.splitlines()
    assert row.split() == ["log.csv", "4", "500", "ms", "-1", "1.5", "s", "violated"]
    assert note == "note: log.csv: left out, NaN: 1 sample of x, the first at 0.5 s"
    assert found["explain"].out.splitlines()[2].startswith("critical point at 1.5 s: 'x >= 3' is -1")
    assert (
        run("check", MENDED, "log.csv", "--skip-nan", "y").err
        == "rtamt: --skip-nan y: no formula reads 'y'\n"
    )


def test_what_is_left_out_and_held_is_in_every_report(commands, write, run, tmp_path):
    write("log.csv", "time,x\n0,5\n0.5,nan\n1,nan\n1.5,4\n")
    held = ["left out, NaN: 2 samples of x, the first at 0.5 s",
            "held: 2 samples of x, the first at 0.5 s, the oldest value for 1 s"]  # fmt: skip
    options = ("log.csv", "--skip-nan", "x", "--hold-for", "1s")
    for time in ("discrete", "dense"):
        answer = run(
            "check", "always(x >= 3)", *options, "--time", time, "--json", "--junit", "j", "--html", "h"
        )
        assert (answer.code, json.loads(answer.out)["notes"]) == (0, held)
        assert all(note in (tmp_path / name).read_text() for name in "jh" for note in held)
        assert all(
            f"note: log.csv: {note}" in run("check", "x >= 3", *options, "--time", time).out for note in held
        )
    for answer in commands("always(x >= 3)", *options[:-1], "500ms").values():
        assert (answer.code, answer.err) == (
            2,
            "rtamt: 'x' of log.csv has no sample from 0 s to 1 s (sample 2), longer than the 500 ms for which "
            "a value is held: fill the gap, or hold it for longer (hold_for=, on the command line --hold-for)\n",
        )


def test_a_nan_that_no_line_of_text_tells_is_mended_by_an_option(run, tmp_path):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    table = pyarrow.table({"time": [0.0, 0.5, 1.0], "x": [5.0, float("nan"), 4.0]})
    parquet.write_table(table, tmp_path / "log.parquet")
    assert run("check", MENDED, "log.parquet") == (
        2,
        "",
        "rtamt: log.parquet: 'x' is NaN at sample 1, time 0.5 s: fill the gap or leave the sample out (--skip-nan x)\n",
    )
    assert run("check", MENDED, "log.parquet", "--skip-nan", "x", "--time", "dense").code == 0


def test_a_nan_in_a_later_chunk_is_mended_by_the_same_option(run, tmp_path, monkeypatch):
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    monkeypatch.setattr("rtamt.cli.runner.LARGE", 0)
    monkeypatch.setattr("rtamt.readers.arrow.CHUNK", 2)
    values = [5.0, 5.0, 5.0, float("nan"), 1.0]
    parquet.write_table(pyarrow.table({"time": [0.0, 1, 2, 3, 4], "x": values}), tmp_path / "log.parquet")
    assert run("check", MENDED, "log.parquet").err.endswith(
        "log.parquet: 'x' is NaN at sample 3, time 3 s: fill the gap or leave the sample out (--skip-nan x)\n"
    )
    answer = run("check", MENDED, "log.parquet", "--skip-nan", "x", "--time", "dense", "--json")
    assert (answer.code, '"first_violation": 4.0' in answer.out) == (1, True)


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("content", "at"),
    [
        ("time,x\n0,5\n0.5,1\n1,4\n", "500ms"),
        ("time,x\n0,5\n0.5,1\n1,4\n", "0.5"),
        ("time,x\n-0.5,1\n0,5\n0.5,4\n", "-0.5"),
        ("t [ns],x\n1700000000000000000,5\n1700000000500000000,1\n", "1700000000.5"),
        (DATES, "2026-01-01T00:00:00.1"),
        (DATES, "2026-01-01T01:00:00.1+01:00"),
    ],
)
def test_an_instant_is_told_in_seconds_with_a_unit_or_as_a_date(run, write, time, content, at):
    write("log.csv", content)
    answer = run("explain", "x >= 3", "log.csv", "--time", time, "--at", at)
    assert (answer.code, answer.err) == (1, "")
    assert re.match(r"violated( at .*)?, robustness -2: x >= 3\n", answer.out)
    assert run("report", "x >= 3", "log.csv", "--time", time, "--at", at, "-o", "report.html").err == ""
    with open("report.html", encoding="utf-8") as page:
        assert re.search(r"violated( at .*)?, robustness -2", page.read())


@pytest.mark.parametrize(
    ("content", "at", "message"),
    [
        (
            DATES,
            "0.1",
            "--at is '0.1', but the recording has times in dates: give one such as 2026-05-01T12:00:00.5",
        ),
        (
            "time,x\n0,5\n",
            "2026-01-01",
            "--at is '2026-01-01', but the recording has times in seconds: give a number of them",
        ),
        (
            "time,x\n0,5\n",
            "soon",
            "--at is 'soon'; give seconds, a time with a unit such as 500ms, or a date such as 2026-05-01T12:00:00.5",
        ),
        (
            DATES,
            "2026-01-01T00:00:07",
            "there is no sample at 2026-01-01T00:00:07.000000000; the recording has 3, from "
            "2026-01-01T00:00:00.000 to 2026-01-01T00:00:00.200",
        ),
    ],
)
def test_an_instant_that_is_none(run, write, content, at, message):
    write("log.csv", content)
    for command in (["explain"], ["plot", "-o", "x.svg"], ["report", "-o", "x.html"]):
        assert run(*command, "x >= 3", "log.csv", "--at", at) == (2, "", f"rtamt: log.csv: {message}\n")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["plot", "x >= 3", "a.csv", "b.csv", "-o", "x.svg"], "'rtamt plot' takes one specification and one trace; "
         "leave out 'b.csv'"),
        (["explain", "x >= 3"], "there is no trace to explain: name a file, or --sql URL; see 'rtamt explain --help'"),
        (["info"], "name a requirement, a program or a recording; see 'rtamt info --help'"),
        (["info", "x >= 3", "--sheet", "a"], "--sheet is for recordings, and 'x >= 3' is a requirement or program"),
        (["info", "a.xlsx"], "there is no file 'a.xlsx' (if a formula is meant, put it in parentheses)"),
    ],
)  # fmt: skip
def test_messages(run, arguments, message):
    assert run(*arguments) == (2, "", f"rtamt: {message}\n")


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("unit", ["s", "ns"])
def test_an_instant_of_timestamps_since_1970_may_be_given_as_the_date_that_is_printed(run, write, time, unit):
    zeros = "0" * 9 * (unit == "ns")
    write("log.csv", f"t [{unit}],x\n1700000000{zeros},5\n1700000001{zeros},2\n1700000002{zeros},9\n")
    for at in ("2023-11-14 22:13:21", "2023-11-14T23:13:21+01:00", "1700000001"):
        answer = run("explain", "x >= 3", "log.csv", "--time", time, "--at", at)
        assert answer.out.startswith("violated at 2023-11-14 22:13:21 (+1 s), robustness -1: x >= 3\n")


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        (
            "2026-03-29 01:59:58,1\n2026-03-29 01:59:59,1\n2026-03-29 02:00:00,1\n2026-03-29 02:00:03,1\n",
            "sample 3 at 2026-03-29T02:00:03 is 3 s after the one before, expected 1 s (within 10%): give the right "
            "period, resample the trace, or use dense time (time='dense', on the command line --time dense)",
        ),
        (
            "2026-10-25 02:59:58.5,1\n2026-10-25 02:59:59.5,1\n2026-10-25 02:00:00,5\n",
            "time does not increase at sample 2: 2026-10-25T02:00:00 comes after 2026-10-25T02:59:59.5; sort the "
            "samples and drop repeated timestamps",
        ),
    ],
    ids=["gap", "end of summer time"],
)
def test_errors_in_dates_name_the_dates(run, write, rows, message):
    write("log.csv", f"time,x\n{rows}")
    assert run("check", "x >= 3", "log.csv").err == f"rtamt: log.csv: {message}\n"


def test_an_unknown_method_of_resampling_is_an_error_also_without_resampling(run, write):
    write("log.csv", "time,x\n0,5\n1,2\n")
    for command in (["check"], ["explain"], ["plot", "-o", "x.svg"]):
        answer = run(*command, "x >= 3", "log.csv", "--how", "cubic")
        assert answer == (2, "", "rtamt: cannot resample by 'cubic'; methods: hold, linear\n")


def test_the_error_for_an_instant_without_a_sample_of_nanoseconds_names_it_in_seconds(run, write):
    write("log.csv", "t [ns],x\n1700000000000000000,5\n1700000001000000000,2\n")
    assert run("explain", "x >= 3", "log.csv", "--at", "2500ms").err == (
        "rtamt: log.csv: there is no sample at 2.5 s; the recording has 2, from 1700000000 s to 1700000001 s\n"
    )
