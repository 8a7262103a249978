"""``rtamt check``: output, JSON, exit codes."""

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import rtamt

EXAMPLES = Path(__file__).parents[3] / "examples" / "request_grant"
GOOD = "time,x\n0,5\n1,4\n2,6\n"
BAD = "time,x\n0,5\n1,1.5\n2,6\n"


def test_the_four_recordings_of_the_paper(run, monkeypatch):
    monkeypatch.chdir(EXAMPLES)
    answer = run("check", str(EXAMPLES / "spec.stl"), *map(str, sorted(EXAMPLES.glob("*.csv"))), "--json")
    found = [json.loads(line) for line in answer.out.splitlines()]
    assert [Path(row["trace"]).name[0] for row in found] == ["a", "b", "c", "d"]
    assert [row["robustness"] for row in found] == [3, 1, -2, -1]
    assert [row["satisfied"] for row in found] == [True, True, False, False]
    assert (answer.code, answer.err) == (1, "")


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_table(run, write, backend):
    write("good.csv", GOOD)
    write("violated_one.csv", BAD)
    answer = run("check", "always(x >= 3)", "good.csv", "violated_one.csv", "--backend", backend)
    assert answer == (
        1,
        "always(x >= 3)\n"
        "\n"
        "trace             samples  period  robustness  first violation  verdict\n"
        "good.csv                3     1 s           1                -  satisfied\n"
        "violated_one.csv        3     1 s        -1.5              1 s  violated\n"
        "\n"
        "1 satisfied, 1 violated\n",
        "",
    )


def test_one_trace_needs_no_count_of_verdicts(run, write):
    answer = run("check", "always(x >= 3)", write("good.csv", GOOD))
    assert answer == (
        0,
        "always(x >= 3)\n"
        "\n"
        "trace     samples  period  robustness  first violation  verdict\n"
        "good.csv        3     1 s           1                -  satisfied\n",
        "",
    )


def test_the_name_of_the_specification_stands_before_it(run, write):
    write("spec.stl", "specification speed_limit\ninput float x\nout = always(x >= 3)\n")
    answer = run("check", "spec.stl", write("good.csv", GOOD))
    assert answer.out.splitlines()[0] == "speed_limit: always(x >= 3)"


def test_an_error_in_one_trace_is_reported_and_the_others_are_checked(run, write):
    write("a.csv", GOOD)
    write("b.csv", "time,x\n0,abc\n")
    write("c.csv", BAD)
    answer = run("check", "always(x >= 3)", "a.csv", "b.csv", "c.csv")
    assert answer == (
        2,
        "always(x >= 3)\n"
        "\n"
        "trace  samples  period  robustness  first violation  verdict\n"
        "a.csv        3     1 s           1                -  satisfied\n"
        "b.csv        -       -           -                -  error\n"
        "c.csv        3     1 s        -1.5              1 s  violated\n"
        "\n"
        "1 satisfied, 1 violated, 1 error\n",
        "rtamt: b.csv, line 2: 'x' is 'abc', expected a number\n",
    )


def test_json_is_one_object_a_line_and_infinities_are_text(run, write):
    write("a.csv", "time,x\n0,1\n0.5,2\n")
    answer = run("check", "once[1:1](x > 0)", "a.csv", "nowhere.csv", "--json")
    assert [json.loads(line) for line in answer.out.splitlines()] == [
        {
            "requirement": "once[1:1](x > 0)",
            "trace": "a.csv",
            "satisfied": False,
            "robustness": "-inf",
            "first_violation": 0,
            "samples": 2,
            "period": 0.5,
        },
        {
            "requirement": "once[1:1](x > 0)",
            "trace": "nowhere.csv",
            "error": "there is no file 'nowhere.csv'",
        },
    ]
    assert (answer.code, answer.err) == (2, "rtamt: there is no file 'nowhere.csv'\n")


def test_the_verdict_is_boolean_where_the_robustness_is_zero(run, write):
    write("a.csv", "time,x\n0,3\n1,3\n")
    at_least = json.loads(run("check", "always(x >= 3)", "a.csv", "--json").out)
    more_than = json.loads(run("check", "always(x > 3)", "a.csv", "--json").out)
    assert (at_least["robustness"], at_least["satisfied"]) == (0, True)
    assert (more_than["robustness"], more_than["satisfied"]) == (0, False)


def test_quiet_leaves_the_exit_code(run, write):
    write("a.csv", GOOD)
    write("b.csv", BAD)
    assert run("check", "always(x >= 3)", "a.csv", "--quiet") == (0, "", "")
    assert run("check", "always(x >= 3)", "a.csv", "b.csv", "--quiet") == (1, "", "")
    assert run("check", "always(x >= 3)", "b.csv", "--quiet", "--json") == (1, "", "")


def test_options_may_stand_between_the_traces(run, write):
    write("a.csv", GOOD)
    write("b.csv", GOOD)
    answer = run("check", "--period", "1", "always(x >= 3)", "a.csv", "--json", "b.csv")
    assert [json.loads(line)["trace"] for line in answer.out.splitlines()] == ["a.csv", "b.csv"]


def test_a_formula_may_begin_with_a_minus(run, write):
    write("a.csv", GOOD)
    assert run("check", "-x <= -5", "a.csv", "--quiet").code == 0
    assert run("check", "--quiet", "--", "-x<=-5", "a.csv").code == 0


def test_period_unit_and_time_column(run, write):
    write("a.csv", "clock [ms],time,x\n0,7,0\n100,7,0\n200,7,9\n")
    args = ("check", "eventually[0:200](x >= 3)", "a.csv", "--unit", "ms", "--json")
    answer = run(*args, "--time-column", "clock", "--period", "100ms")
    assert json.loads(answer.out) == {
        "requirement": "eventually[0:200](x >= 3)", "trace": "a.csv", "satisfied": True, "robustness": 6.0,
        "first_violation": None, "samples": 3, "period": 0.1,
    }  # fmt: skip
    assert json.loads(run(*args, "--time-column", "", "--period", "0.2").out)["period"] == 0.2


def test_output_writes_the_robustness_signal(run, write):
    write("a.csv", "t,x\n0,1\n0.1,inf\n0.2,5\n")
    assert run("check", "x >= 0.7", "a.csv", "-o", "rho.csv", "--quiet") == (0, "", "")
    assert Path("rho.csv").read_text() == f"time,robustness\n0.0,{1 - 0.7!r}\n0.1,inf\n0.2,4.3\n"
    assert rtamt.read("rho.csv")["robustness"].values.tolist() == [1 - 0.7, float("inf"), 4.3]


def test_colour_where_it_is_asked_for(run, write, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    write("a.csv", GOOD)
    write("b.csv", BAD)
    plain = run("check", "always(x >= 3)", "a.csv", "b.csv").out
    coloured = run("check", "always(x >= 3)", "a.csv", "b.csv", "--color", "always").out
    assert "\x1b" not in plain
    assert "\x1b[32msatisfied\x1b[0m" in coloured
    assert "\x1b[31mviolated\x1b[0m" in coloured
    for code in ("\x1b[32m", "\x1b[31m", "\x1b[1m", "\x1b[0m"):
        coloured = coloured.replace(code, "")
    assert coloured == plain


def test_a_specification_file_without_the_suffix_is_read_too(run, write):
    write("requirement.txt", "always(x >= 3)")
    assert run("check", "requirement.txt", write("a.csv", GOOD), "--quiet").code == 0


def test_a_specification_file_may_begin_with_a_byte_order_mark(run, write):
    write("spec.stl", "\ufeffalways(x >= 3)")
    assert run("check", "spec.stl", write("a.csv", GOOD), "--quiet") == (0, "", "")


# ---- dense time --------------------------------------------------------------------------------------

DENSE = "time,x,y\n0,1,0\n0.1,0,0\n0.37,0,1\n2,0,1\n"


def test_dense_time_has_no_period(run, write):
    write("events.csv", DENSE)
    formula = "always(x > 0.5 -> eventually[0:370ms](y > 0.5))"
    assert run("check", formula, "events.csv", "--time", "dense", "-o", "rho.csv") == (
        0,
        f"{formula}\n"
        "\n"
        "trace       samples  period  robustness  first violation  verdict\n"
        "events.csv        4   dense         0.5                -  satisfied\n",
        "",
    )
    assert Path("rho.csv").read_text() == "time,robustness\n0.0,0.5\n2.0,0.5\n"
    answer = run("check", formula, "events.csv", "--time", "dense", "--json")
    assert json.loads(answer.out) == {
        "requirement": formula,
        "trace": "events.csv",
        "satisfied": True,
        "robustness": 0.5,
        "first_violation": None,
        "samples": 4,
        "period": None,
    }


def test_in_dense_time_a_variable_has_no_sample_where_its_cell_is_empty(run, write):
    write("events.csv", "time,x,y\n0,5,\n0.1,,1\n0.3,2,\n1,,\n")
    answer = run("check", "x >= 3 and y >= 0", "events.csv", "--time", "dense", "-o", "rho.csv")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.splitlines()[-1].split() == ["events.csv", "3", "dense", "1", "-", "satisfied"]
    assert Path("rho.csv").read_text() == "time,robustness\n0.1,1.0\n0.3,-1.0\n"
    assert run("check", "x >= 3", "events.csv") == (
        2,
        "",
        "rtamt: 'x' is missing at sample 1 of events.csv, but discrete time needs a value at every sample: "
        "fill the gap, hold the value before it (--hold-for DURATION), use dense time (--time dense), or put all on "
        "one clock (--resample PERIOD)\n",
    )


@pytest.mark.parametrize(("header", "options"), [("t", ["--time-unit", "ns"]), ("t [ns]", [])])
def test_integer_nanoseconds_are_exact(run, write, header, options):
    start = 1_700_000_000 * 10**9
    write("log.csv", f"{header},x\n{start},5\n{start + 1},1\n{start + 100_000_001},5\n")
    answer = run("check", "once[100ms:100ms] x", "log.csv", "--time", "dense", "-o", "rho.csv", *options)
    assert answer.code == 1
    assert Path("rho.csv").read_text() == (
        "time,robustness\n1700000000,-inf\n1700000000.1,5.0\n1700000000.100000001,1.0\n"
    )


def test_nanoseconds_since_1970_without_their_unit_are_rejected(run, write):
    write("log.csv", "t,x\n1700000000000000000,5\n1700000000100000000,1\n")
    for time in ("discrete", "dense"):
        assert run("check", "x >= 3", "log.csv", "--time", time) == (
            2,
            "",
            "rtamt: the time of 't' of log.csv is 1700000000000000000 at sample 0, too large for seconds: if it "
            "counts ns since 1970, say time_unit='ns', or on the command line --time-unit ns\n",
        )


def test_a_unit_of_stamps_in_discrete_time(run, write):
    write("log.csv", "t,x\n0,5\n100,4\n200,3\n")
    answer = json.loads(run("check", "always[0:0.2](x)", "log.csv", "--time-unit", "ms", "--json").out)
    assert (answer["robustness"], answer["period"]) == (3.0, 0.1)


def test_dates_are_time_stamps_in_both_domains(run, write):
    write(
        "log.csv", "time,x\n2026-01-01T00:00:00Z,5\n2026-01-01T01:00:00.1+01:00,1\n2026-01-01 00:00:00.2Z,4\n"
    )
    assert run("check", "once[0.2:0.2] x or x", "log.csv", "--time", "dense", "-o", "rho.csv").code == 0
    assert Path("rho.csv").read_text() == (
        "time,robustness\n2026-01-01T00:00:00.000000000,5.0\n2026-01-01T00:00:00.100000000,1.0\n"
        "2026-01-01T00:00:00.200000000,5.0\n"
    )
    assert json.loads(run("check", "x", "log.csv", "--json").out)["period"] == 0.1


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (
            ("x", "--time", "dens"),
            "unknown time domain 'dens'; did you mean 'dense'? (time domains: dense, discrete)",
        ),
        (
            ("x", "--time", "dense", "--period", "1"),
            "dense time has no sampling period: leave out --period, or --time dense",
        ),
        (
            ("x", "--time", "dense", "--time-column", ""),
            "events.csv: dense time needs a column of timestamps: call it 'time', or name it with --time-column",
        ),
        (
            ("prev(x)", "--time", "dense"),
            "'prev' means one sample away, which dense time does not have; "
            "use a window such as once[0:1], or discrete time\n"
            "  line 1, column 1:\n"
            "    prev(x)\n"
            "    ^^^^^^^",
        ),
    ],
)
def test_what_dense_time_cannot_do(run, write, args, message):
    formula, *options = args
    answer = run("check", formula, write("events.csv", DENSE), *options)
    assert answer == (2, "", f"rtamt: {message}\n")


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("semantics", "values"),
    [("output_robustness", [3, "inf", -2, -2]), ("input-vacuity", [0, 1, 0, 0])],
)
def test_the_four_recordings_under_interface_aware_semantics(run, semantics, values, time):
    traces = map(str, sorted(EXAMPLES.glob("*.csv")))
    spec = str(EXAMPLES / "spec.stl")
    answer = run("check", spec, *traces, "--json", "--semantics", semantics, "--time", time)
    found = [json.loads(line) for line in answer.out.splitlines()]
    assert [row["robustness"] for row in found] == values
    assert [row["satisfied"] for row in found] == [True, True, False, False]


BRAKING = """\
near = d <= 30
require REQ-7 "brakes in time" severity warning: always(near -> eventually[0:1](brake >= 1))
require REQ-8: always(d >= 2)
"""
DRIVE = "time,d,brake\n0,40,0\n1,20,0\n2,10,0.5\n3,1,1\n"


def test_a_file_with_several_requirements_was_judged_by_its_last_one_only(run, write):
    write("first_is_violated.stl", "always(x >= 3); always(x >= 0)")
    answer = run("check", "first_is_violated.stl", write("bad.csv", BAD))
    assert answer == (
        1,
        "requirement                           trace    samples  period  robustness  first violation  verdict\n"
        "first_is_violated.stl: requirement_1  bad.csv        3     1 s        -1.5              1 s  violated\n"
        "first_is_violated.stl: requirement_2  bad.csv        3     1 s         1.5                -  satisfied\n"
        "\n"
        "1 satisfied, 1 violated\n",
        "",
    )


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("domain", ["discrete", "dense"])
def test_each_requirement_has_a_row_whatever_way_the_recording_is_read(
    run, write, monkeypatch, large, domain
):
    if large:
        monkeypatch.setattr("rtamt.cli.runner.LARGE", 0)
    write("braking.stl", BRAKING)
    answer = run("check", "braking.stl", write("drive.csv", DRIVE), "--json", "--time", domain)
    rows = [json.loads(line) for line in answer.out.splitlines()]
    period = None if domain == "dense" else 1
    common = {"trace": "drive.csv", "satisfied": False, "samples": 4, "period": period}
    assert rows == [
        {
            "requirement": "REQ-7",
            "robustness": -0.5,
            "first_violation": 1,
            "description": "brakes in time",
            "severity": "warning",
            **common,
        },
        {
            "requirement": "REQ-8",
            "robustness": -1,
            "first_violation": 3,
            "description": "",
            "severity": "error",
            **common,
        },
    ]
    assert answer.code == 1


def test_a_requirement_that_cannot_be_evaluated_does_not_hide_the_others(run, write):
    write("braking.stl", BRAKING)
    answer = run("check", "braking.stl", write("drive.csv", "time,d\n0,40\n1,1\n"), "--json")
    assert answer.code == 2
    first, second = map(json.loads, answer.out.splitlines())
    assert first["error"].startswith("drive.csv has no column 'brake'")
    assert (second["requirement"], second["robustness"]) == ("REQ-8", -1)
    assert answer.err == f"rtamt: {first['error']}\n"


def test_ids_that_two_files_have_are_told_apart(run, write):
    write("a.stl", "require R: always(x >= 3)")
    write("b.stl", "specification b; require R: always(x >= 1); require S: always(x >= 0)")
    answer = run("check", "a.stl", "b.stl", write("bad.csv", BAD), "--json")
    assert [json.loads(line)["requirement"] for line in answer.out.splitlines()] == ["a.stl: R", "b: R", "S"]


def test_reports_name_requirements_by_their_ids(run, write):
    write("braking.stl", BRAKING)
    write("drive.csv", DRIVE)
    reports = ("--junit", "r.xml", "--sarif", "r.sarif", "--html", "r.html", "-o", "r.csv", "--quiet")
    assert run("check", "braking.stl", "drive.csv", *reports).code == 1
    suites = ET.parse("r.xml").getroot()  # noqa: S314 - our own text
    told = "REQ-7 (brakes in time) is violated by drive.csv: robustness -0.5, first violated at 1 s"
    assert [(s.get("name"), s.get("tests"), s[0][0].get("message")) for s in suites] == [
        ("REQ-7", "1", told),
        ("REQ-8", "1", "REQ-8 is violated by drive.csv: robustness -1, first violated at 3 s"),
    ]
    (sarif,) = json.loads(Path("r.sarif").read_text(encoding="utf-8"))["runs"]
    formula = "always(d <= 30 -> eventually[0:1](brake >= 1))"
    assert sarif["tool"]["driver"]["rules"] == [
        {"id": "REQ-7", "shortDescription": {"text": "brakes in time"}, "fullDescription": {"text": formula}},
        {"id": "REQ-8", "shortDescription": {"text": "always(d >= 2)"}},
    ]
    assert [(r["ruleId"], r["level"]) for r in sarif["results"]] == [("REQ-7", "warning"), ("REQ-8", "error")]
    assert sarif["results"][0]["message"]["text"].splitlines()[0] == told
    page = Path("r.html").read_text(encoding="utf-8")
    assert all(text in page for text in ("REQ-7", "REQ-8", "brakes in time"))
    assert Path("r.csv").read_text(encoding="utf-8").splitlines()[:2] == ["time,REQ-7,REQ-8", "0.0,-0.5,-1.0"]


def test_each_requirement_is_explained(run, write):
    write("braking.stl", BRAKING)
    write("drive.csv", DRIVE)
    answer = run("explain", "braking.stl", "drive.csv")
    told = [text.splitlines()[0] for text in answer.out.split("\n\n")]
    assert told == [
        "REQ-7: violated, robustness -0.5: always(d <= 30 -> eventually[0:1](brake >= 1))",
        "REQ-8: violated, robustness -1: always(d >= 2)",
    ]
    rows = [
        json.loads(line) for line in run("explain", "braking.stl", "drive.csv", "--json").out.splitlines()
    ]
    assert [row["requirement"] for row in rows] == ["REQ-7", "REQ-8"]
    assert (answer.code, run("report", "braking.stl", "drive.csv", "-o", "page.html").code) == (1, 1)


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("clock", [["--time", "dense"], ["--resample", "1s"]])
def test_a_violation_was_hidden_by_a_variable_of_another_requirement_that_begins_late(
    run, write, monkeypatch, clock, large
):
    if large:
        monkeypatch.setattr("rtamt.cli.runner.LARGE", 0)
    spec = write("two.stl", "require A: always(x > 0)\nrequire B: always(y > 0)\n")
    trace = write("late.csv", "time,x,y\n0,-5,\n1,5,\n2,5,1\n3,5,1\n")
    code, out, _ = run("check", spec, trace, "--json", *clock)
    rows = [json.loads(line) for line in out.splitlines()]
    assert code == 1
    assert [(row["requirement"], row["robustness"]) for row in rows] == [("A", -5.0), ("B", 1.0)]
    code, out, _ = run("explain", spec, trace, "--json", *clock)
    assert code == 1
    assert [json.loads(line)["time"] for line in out.splitlines()] == [0.0, 2.0]


LONG = "time,x\n" + "".join(f"{i},{1 if i == 70 else 5}\n" for i in range(140_000))


def test_early_stops_at_the_decision_and_does_not_see_what_comes_later(run, write):
    write("long.csv", f"{LONG}140000,oops\n")
    assert run("check", "always(x >= 3)", "long.csv").code == 2
    assert run("check", "always(x >= 3)", "long.csv", "--early") == (
        1,
        "always(x >= 3)\n"
        "\n"
        "trace     samples  period  robustness  first violation  verdict\n"
        "long.csv       71     1 s       <= -2             70 s  violated\n"
        "\n"
        "note: long.csv: decided at 70 s, later samples are not checked\n",
        "",
    )


def test_early_json_has_the_bounds_and_where_it_stopped(run, write):
    write("a.csv", "time,x\n0,5\n1,2\n2,6\n")
    (row,) = map(json.loads, run("check", "always(x >= 3)", "a.csv", "--early", "--json").out.splitlines())
    assert row == {
        "requirement": "always(x >= 3)",
        "trace": "a.csv",
        "satisfied": False,
        "robustness": None,
        "lower": "-inf",
        "upper": -1.0,
        "first_violation": 1.0,
        "samples": 2,
        "period": 1.0,
        "decided_at": 1.0,
        "notes": ["decided at 1 s, later samples are not checked"],
    }


@pytest.mark.parametrize(
    ("formula", "more"),
    [
        ("always(x >= 0)", ()),  # decided by the end alone
        ("eventually[1:2] once[0:5](x >= 3)", ()),  # the end may change what was decided
        ("always(x >= 3)", ("--time", "dense")),
        ("always(x >= 3)", ("--resample", "1s")),
        ("always(y >= 3)", ()),  # an error
    ],
)
def test_early_equals_an_ordinary_check_where_the_whole_recording_is_needed(run, write, formula, more):
    write("a.csv", "time,x\n0,5\n1,2\n2,6\n")
    assert run("check", formula, "a.csv", "--early", *more) == run("check", formula, "a.csv", *more)


def test_early_with_several_requirements_stops_when_all_are_decided(run, write):
    write("a.csv", "time,x\n0,5\n1,2\n2,6\n3,1\n4,0\n")
    write(
        "spec.stl",
        "input float x\nrequire R1: always(x >= 3)\nrequire R2: eventually(x >= 6)\nrequire R3: x > 4\n",
    )
    rows = [
        json.loads(line) for line in run("check", "spec.stl", "a.csv", "--early", "--json").out.splitlines()
    ]
    assert [(r["requirement"], r["satisfied"], r["decided_at"], r["robustness"]) for r in rows] == [
        ("R1", False, 1.0, None),
        ("R2", True, 2.0, None),
        ("R3", True, 0.0, 1.0),
    ]
    table = run("check", "spec.stl", "a.csv", "--early").out
    assert "note: a.csv: R2 is decided at 2 s, later samples are not checked" in table


def test_early_leaves_nothing_to_write(run, write):
    write("a.csv", GOOD)
    answer = run("check", "x > 0", "a.csv", "--early", "-o", "out.csv")
    assert answer.code == 2
    assert "--early reads no more than the verdicts need, and --output shows all: leave one out" in answer.err


def test_early_reports_name_what_is_known_of_the_robustness(run, write):
    write("a.csv", "time,x\n0,5\n1,2\n2,6\n")
    run("check", "always(x >= 3)", "a.csv", "--early", "--junit", "r.xml", "--sarif", "r.sarif")
    assert "robustness &lt;= -1, first violated at 1 s; decided at 1 s" in Path("r.xml").read_text()
    (result,) = json.loads(Path("r.sarif").read_text())["runs"][0]["results"]
    assert result["properties"]["upper"] == -1.0
    assert result["properties"]["robustness"] is None


@pytest.mark.parametrize("command", ["check", "explain"])
def test_a_signal_without_samples_in_dense_time_is_not_reported_as_a_missing_column_of_timestamps(
    run, command
):
    Path("empty.csv").write_text("time,x\n0,nan\n1,nan\n")
    answer = run(command, "x >= 3", "empty.csv", "--time", "dense", "--skip-nan", "x")
    assert answer.code == 2
    assert answer.err.splitlines()[-1] == "rtamt: empty.csv: 'x' has no samples: give at least one"
    Path("plain.csv").write_text("x\n1\n2\n")
    assert "needs a column of timestamps" in run(command, "x >= 3", "plain.csv", "--time", "dense").err


def test_early_bounds_are_those_of_a_recording_that_may_end_at_once(run, write):
    # Were the trace to go on, the robustness of eventually would be 0 at least; at the end it is -inf.
    write("a.csv", "time,x,y\n0,5,-1\n1,5,5\n")
    answer = run("check", "eventually[5:10](abs(x) > 0) and y > 0", "a.csv", "--early", "--json")
    row = json.loads(answer.out)
    assert (row["satisfied"], row["lower"], row["upper"]) == (False, "-inf", 0.0)
