"""Many requirements over many recordings: tables, reports, processes, databases, large files."""

import json
import sqlite3
import sys
from contextlib import closing
from html.parser import HTMLParser
from io import StringIO
from xml.etree import ElementTree as ET

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from rtamt.cli import runner
from rtamt.cli.terminal import Progress
from rtamt.language.units.durations import duration
from rtamt.verdicts import streaming

GOOD = "time,x\n0,5\n1,4\n2,6\n"
BAD = "time,x\n0,5\n1,1.5\n2,6\n"


@pytest.fixture
def files(write):
    write("low.stl", "specification low\ninput float x\nout = always(x >= 3)\n")
    write("high.stl", "always(x <= 5 and x > 0)")
    return ["low.stl", "high.stl", write("good.csv", GOOD), write("bad & <ugly>.csv", BAD)]


TABLE = (
    "requirement  trace             samples  period  robustness  first violation  verdict\n"
    "low          good.csv                3     1 s           1                -  satisfied\n"
    "high.stl     good.csv                3     1 s          -1              2 s  violated\n"
    "low          bad & <ugly>.csv        3     1 s        -1.5              1 s  violated\n"
    "high.stl     bad & <ugly>.csv        3     1 s          -1              2 s  violated\n"
    "\n"
    "1 satisfied, 3 violated\n"
)


@pytest.mark.parametrize("jobs", ["1", "2"])
def test_every_requirement_over_every_recording(run, files, jobs):
    assert run("check", *files, "--jobs", jobs) == (1, TABLE, "")


def test_json_says_when(run, files):
    rows = [json.loads(line) for line in run("check", *files, "--json").out.splitlines()]
    assert [(r["requirement"], r["trace"][:4], r["robustness"], r["first_violation"]) for r in rows] == [
        ("low", "good", 1, None),
        ("high.stl", "good", -1, 2),
        ("low", "bad ", -1.5, 1),
        ("high.stl", "bad ", -1, 2),
    ]


def test_dates_are_told_as_dates(run, write):
    write("a.csv", "time,x\n2024-05-01T10:00:00,5\n2024-05-01T10:00:01,1\n")
    for domain in ("discrete", "dense"):
        row = json.loads(run("check", "always(x >= 3)", "a.csv", "--json", "--time", domain).out)
        assert row["first_violation"] == "2024-05-01T10:00:01.000000000"


def test_junit(run, files):
    assert run("check", *files, "nowhere.csv", "--junit", "report.xml", "--quiet").code == 2
    root = ET.parse("report.xml").getroot()
    assert (root.get("tests"), root.get("failures"), root.get("errors")) == ("6", "3", "2")
    assert [(s.get("name"), s.get("tests"), s.get("failures")) for s in root] == [
        ("low", "3", "1"),
        ("high.stl", "3", "2"),
    ]
    failure = root.find("testsuite[@name='low']/testcase[@name='bad & <ugly>.csv']/failure")
    assert failure.get("message") == (
        "low is violated by bad & <ugly>.csv: robustness -1.5, first violated at 1 s"
    )
    assert failure.text.startswith("violated, robustness -1.5: always(x >= 3)\nfirst violation at 1 s\n")
    assert (
        root.find("testsuite/testcase[@name='nowhere.csv']/error").get("message")
        == "there is no file 'nowhere.csv'"
    )
    assert root.find("testsuite/testcase[@name='good.csv']").get("classname") == "low"


def test_the_first_violation_in_sarif_has_every_nanosecond(run, write):
    write("log.csv", "t [ns],x\n1700000000000000000,5\n1700000000100000001,1\n")
    run("check", "always(x >= 3)", "log.csv", "--time", "dense", "--sarif", "report.sarif", "--quiet")
    with open("report.sarif", encoding="utf-8") as file:
        assert '"firstViolation": 1700000000.100000001\n' in file.read()


def test_sarif(run, files):
    run("check", *files, "nowhere.csv", "--sarif", "report.sarif", "--quiet")
    with open("report.sarif", encoding="utf-8") as file:
        report = json.load(file)
    (found,) = report["runs"]
    assert report["version"] == "2.1.0"
    assert found["tool"]["driver"]["rules"] == [
        {"id": "low", "shortDescription": {"text": "always(x >= 3)"}},
        {"id": "high.stl", "shortDescription": {"text": "always(x <= 5 and x > 0)"}},
    ]
    assert [(r["ruleId"], r["ruleIndex"], r["kind"], r["level"]) for r in found["results"]] == [
        ("low", 0, "pass", "none"),
        ("high.stl", 1, "fail", "error"),
        ("low", 0, "fail", "error"),
        ("high.stl", 1, "fail", "error"),
    ]
    assert found["results"][2]["properties"] == {"robustness": -1.5, "firstViolation": 1}
    assert found["results"][2]["locations"] == [
        {"physicalLocation": {"artifactLocation": {"uri": "bad%20%26%20%3Cugly%3E.csv"}}}
    ]
    assert (
        found["results"][2]["relatedLocations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "low.stl"
    )
    (invocation,) = found["invocations"]
    assert invocation["executionSuccessful"] is False
    assert [n["message"]["text"] for n in invocation["toolExecutionNotifications"]] == [
        "there is no file 'nowhere.csv'"
    ] * 2


class Cells(HTMLParser):
    """The text of every cell, row by row."""

    def __init__(self):
        super().__init__()
        self.rows = []
        self.inside = False

    def handle_starttag(self, tag, attrs):
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")
            self.inside = True
        assert "src" not in dict(attrs)  # nothing from elsewhere
        assert dict(attrs).get("href", "#").startswith("#")

    def handle_endtag(self, tag):
        self.inside = self.inside and tag not in ("td", "th")

    def handle_data(self, data):
        if self.inside:
            self.rows[-1][-1] += data


def test_html(run, files):
    run("check", *files, "nowhere.csv", "--html", "report.html", "--quiet")
    cells = Cells()
    with open("report.html", encoding="utf-8") as file:
        cells.feed(file.read())
    rows = [[" ".join(cell.split()) for cell in row] for row in cells.rows]
    # As many requirements as traces at most: a line for each trace, the worst first.
    assert rows == [
        ["trace", "low", "high.stl"],
        ["bad & <ugly>.csv", "✗violated -1.5 1 s", "✗violated -1 2 s"],
        ["good.csv", "✓satisfied 1", "✗violated -1 2 s"],
        ["nowhere.csv", "!error", "!error"],
    ]


def test_names_sheets_units_and_resampling(run):
    table = pa.table({"t": [0, 100, 300], "Motor speed": [1.0, None, 3.0], "x": [0, 1, 2]})
    parquet.write_table(table, "log.parquet")
    args = (
        "check",
        "always[0:100ms](v >= 1 and x >= 0)",
        "log.parquet",
        "--name",
        "v=Motor speed",
        "--time-unit",
        "ms",
    )
    assert run(*args, "--time", "dense", "--quiet") == (0, "", "")
    refused = run(*args, "--quiet")
    assert refused.code == 2
    row = json.loads(run(*args, "--resample", "100ms", "--json").out)
    assert (row["robustness"], row["samples"], row["period"]) == (0, 4, 0.1)
    row = json.loads(run(*args, "--resample", "100ms", "--how", "linear", "--json").out)
    assert row["samples"] == 4


@pytest.mark.parametrize("start", [0, 1_700_000_000])
@pytest.mark.parametrize(
    ("period", "bound"), [("0.0333333", "6.66666"), ("33333333ns", "6666666600ns"), ("1ms", "1")]
)
def test_the_period_of_resampled_signals_is_the_given_one(run, write, start, period, bound):
    rows = [f"{start + k / 100:.2f},{3 + k % 7}" for k in range(1000)]
    log = write("log.csv", "\n".join(["time,x", *rows, ""]))
    (row,) = map(
        json.loads,
        run("check", f"always[0:{bound}](x >= 3)", log, "--resample", period, "--json").out.splitlines(),
    )
    assert row["period"] == float(duration(period))
    assert row["robustness"] == 0


def test_a_database(run, tmp_path):
    with closing(sqlite3.connect("log.db")) as database:
        database.execute("create table log (time real, x real)")
        database.executemany("insert into log values (?, ?)", [(0, 5), (1, 1.5), (2, 6)])
        database.commit()
    sql = ("--sql", f"sqlite:///{tmp_path}/log.db", "--query", "select * from log order by time")
    row = json.loads(run("check", "always(x >= 3)", *sql, "--json").out)
    assert (row["robustness"], row["first_violation"], row["samples"], row["period"]) == (-1.5, 1, 3, 1)
    # What needs the whole recording gets it.
    row = json.loads(run("check", "always(eventually(x >= 6))", *sql, "--json").out)
    assert (row["satisfied"], row["samples"]) == (True, 3)


def test_large_files_are_read_in_chunks_with_the_same_outcome(run, write, monkeypatch):
    parquet.write_table(pa.table({"time": np.arange(9.0), "x": np.cos(np.arange(9))}), "log.parquet")
    formulas = [write("a.stl", "always(x >= -0.5)"), write("b.stl", "always(eventually(x >= 0.9))")]
    whole = run("check", *formulas, "log.parquet", "--json")
    monkeypatch.setattr(runner, "LARGE", 0)
    streamed = []
    check = streaming.check_stream
    monkeypatch.setattr(streaming, "check_stream", lambda *a: streamed.append(a[0]) or check(*a))
    assert run("check", *formulas, "log.parquet", "--json") == whole
    assert [str(spec) for spec in streamed] == ["always(x >= -0.5)"]
    refused = run("check", "always(y >= 0)", "log.parquet")
    assert refused == (2, "", "rtamt: log.parquet has no column 'y'; columns: time, x\n")


@pytest.mark.parametrize(
    ("rows", "options", "error"),
    [
        ("time,x\n0,\n1,\n2,\n", ("--time", "dense"), "'x' has no samples: give at least one"),
        (
            "y,x\n3,5\n1,4\n2,6\n",
            ("--time", "dense"),
            "dense time needs a column of timestamps: call it 'time', or name it with --time-column",
        ),
        (
            "time,x\n2026-05-01T10:00:00,5\n2026-05-01T10:00:01,5\n2026-05-01T10:00:05,5\n",
            ("--period", "1s"),
            "sample 2 at 2026-05-01T10:00:05 is 4 s after the one before, expected 1 s (within 10%): give the right "
            "period, resample the trace, or use dense time (time='dense', on the command line --time dense)",
        ),
        (
            "time,x\n2026-05-01T10:00:00,5\n2026-05-01T10:00:01,5\n2026-05-01T10:00:00.5,5\n",
            (),
            "time does not increase at sample 2: 2026-05-01T10:00:00.5 comes after 2026-05-01T10:00:01; sort the "
            "samples and drop repeated timestamps",
        ),
        (
            "time,x\n2026-05-01T10:00:01,5\n2026-05-01T10:00:00,5\n2026-05-01T10:00:02,5\n",
            (),
            "time does not increase at sample 1: 2026-05-01T10:00:00 comes after 2026-05-01T10:00:01; sort the "
            "samples and drop repeated timestamps",
        ),
    ],
    ids=["no sample", "no timestamps", "irregular dates", "earlier date in a later chunk", "earlier date"],
)
@pytest.mark.parametrize("block", [2, 3])
def test_large_files_had_other_errors_than_whole_recordings(
    run, write, monkeypatch, rows, options, error, block
):
    monkeypatch.setattr("rtamt.readers.csv.BLOCK", block)
    args = ("check", "always(x >= 0)", write("log.csv", rows), *options)
    expected = (2, "", f"rtamt: log.csv: {error}\n")
    assert run(*args) == expected
    monkeypatch.setattr(runner, "LARGE", 0)
    assert run(*args) == expected


def test_info_of_a_recording_tells_what_was_found_and_guessed(run, write):
    assert run("info", write("log.csv", "t [ms],speed [m/s],note\n0,5,go\n100,4,stop\n")) == (
        0,
        "Trace of log.csv: 1 signal, 0 s to 0.1 s\n"
        "  time is 't [ms]', by its name\n"
        "  left out, not numbers: note\n"
        "  speed [m/s]  2 samples, 0 s to 0.1 s\n",
        "",
    )


def test_a_bar_where_somebody_watches(monkeypatch):
    monkeypatch.setitem(sys.modules, "rich.progress", None)
    stream = StringIO()
    stream.isatty = lambda: True
    with Progress(stream) as progress:
        progress.PAUSE = 0
        progress._next = 0
        progress.bar(1, 4, "b.csv")
    assert stream.getvalue() == f"\r\x1b[K[{'#' * 6}{'.' * 18}] 1/4 b.csv\r\x1b[K"


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (["--name", "v"], "--name is 'v'; give a variable and its column, such as v=voltage"),
        (["--name", "v=y"], "--name v=y: no formula reads 'v'"),
        (["--jobs", "0"], "--jobs is 0; give a number of processes, 1 or more"),
        (["--sql", "sqlite://", "--query", "x"], "--sql reads a database; leave out the trace 'good.csv', or --sql"),
        (["--how", "line", "--resample", "1"],
         "cannot resample by 'line'; did you mean 'linear'? (methods: linear, hold)"),
        (["--junit", "no/such/folder.xml", "--quiet"], "cannot write 'no/such/folder.xml': No such file or directory"),
        (["--sheet", "a"], "'good.csv' is CSV, which has no sheets; leave the sheet out"),
    ],
)  # fmt: skip
def test_messages(run, files, args, message):
    answer = run("check", "low.stl", files[2], *args)
    assert (answer.code, answer.err) == (2, f"rtamt: {message}\n")


def test_output_takes_one_pair(run, files):
    assert run("check", *files, "-o", "rho.csv").err == (
        "rtamt: --output takes the robustness of one trace, got 2 requirements and 2 traces\n"
    )
