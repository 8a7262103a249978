"""``rtamt explain``: output, JSON, exit codes."""

import html
import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

import rtamt

TRACE = "time,req,gnt\n0,0,0\n1,6,0\n2,0,0\n3,0,1\n4,0,7\n"
SPEC = "always(req >= 3 -> eventually[0:2](gnt >= 3))"


def test_a_violation_is_told_and_exits_with_1(run, write):
    assert run("explain", SPEC, write("log.csv", TRACE)) == (
        1,
        "violated, robustness -2: always(req >= 3 -> eventually[0:2](gnt >= 3))\n"
        "first violation at 1 s\n"
        "critical point at 3 s: 'gnt >= 3' is -2; the robustness follows it from -3 to 3\n"
        "sufficient cause, independent of all other samples:\n"
        "  'req >= 3' holds at 1 s (3)\n"
        "  'gnt >= 3' fails from 1 s to 3 s (-3 to -2)\n",
        "",
    )


def test_another_instant_that_is_satisfied_exits_with_0(run, write):
    answer = run("explain", SPEC, write("log.csv", TRACE), "--at", "2", "--time", "dense")
    assert (answer.code, answer.err) == (0, "")
    assert answer.out.splitlines()[0] == f"satisfied at 2 s, robustness 4: {SPEC}"
    assert answer.out.splitlines()[-1] == "  'req >= 3' fails from 2 s on (-3)"


def test_json(run, write):
    answer = run("explain", SPEC, write("log.csv", TRACE), "--json")
    told = json.loads(answer.out)
    assert answer.code == 1
    assert list(told) == [
        "trace",
        "formula",
        "time",
        "satisfied",
        "robustness",
        "first_violation",
        "critical",
        "implicant",
    ]
    assert told["first_violation"] == 1
    assert (told["trace"], told["critical"]["predicate"], told["critical"]["value"]) == (
        "log.csv",
        "gnt >= 3",
        -2,
    )
    assert [(s["predicate"], s["holds"], s["start"], s["end"]) for s in told["implicant"]] == [
        ("req >= 3", True, 1, 1),
        ("gnt >= 3", False, 1, 3),
    ]


def test_an_instant_that_was_not_recorded(run, write):
    assert run("explain", SPEC, write("log.csv", TRACE), "--at", "9") == (
        2,
        "",
        "rtamt: log.csv: there is no sample at 9.0; the recording has 5, from 0 s to 4 s\n",
    )


def test_dense_time_without_stamps(run, write):
    assert run("explain", "x >= 3", write("log.csv", "x\n1\n"), "--time", "dense") == (
        2,
        "",
        "rtamt: log.csv: dense time needs a column of timestamps: call it 'time', or name it with --time-column\n",
    )


def test_dates_and_nanoseconds_are_explained_in_dense_time(run, write):
    write("log.csv", "time,x\n2026-01-01T00:00:00,5\n2026-01-01T00:00:01,1\n")
    answer = run("explain", "always(x >= 3)", "log.csv", "--time", "dense", "--json")
    assert (answer.code, answer.err) == (1, "")
    assert "2026-01-01T00:00:01" in answer.out
    write("log.csv", "t [ns],x\n1700000000000000000,5\n1700000001000000000,1\n")
    answer = run("explain", "x >= 3", "log.csv", "--time", "dense", "--at", "1700000000.5")
    assert (answer.code, answer.err) == (0, "")


def test_the_explanation_has_the_same_words_in_every_output(run, write):
    trace = "time,req,gnt\n" + "".join(f"{i},{6 * (i % 7 == 1)},{i % 50 // 9}\n" for i in range(400))
    write("log.csv", trace)
    told = str(rtamt.parse(SPEC).evaluate(rtamt.read("log.csv")).explain())
    assert run("explain", SPEC, "log.csv").out == f"{told}\n"
    reports = ("--junit", "r.xml", "--sarif", "r.sarif", "--html", "r.html", "--quiet")
    assert run("check", SPEC, "log.csv", *reports).code == 1
    (failure,) = ET.parse("r.xml").getroot().iter("failure")
    assert failure.text == told
    (sarif,) = json.loads(Path("r.sarif").read_text(encoding="utf-8"))["runs"]
    assert sarif["results"][0]["message"]["text"].endswith(told)
    page = html.unescape(Path("r.html").read_text(encoding="utf-8"))
    assert all(line.strip() in page for line in told.splitlines()[1:])


def test_all_causes_are_printed_where_all_are_asked_for(run, write):
    write("log.csv", "time,x\n" + "".join(f"{i},{i % 2 * 5}\n" for i in range(100)))
    short, everything = (
        run("explain", "always(eventually[0:1](x >= 3))", "log.csv", *more).out.splitlines()
        for more in ([], ["--all"])
    )
    assert (len(short), short[-1], len(everything)) == (9, "  45 more", 53)
    assert short[0] == "satisfied, robustness 2: always(eventually[0:1](x >= 3))"


def test_epoch_seconds_are_dates_in_every_report(run, write):
    write("log.csv", "t [ns],x\n1700000000000000000,5\n1700000000500000000,1\n")
    run(
        "check",
        "always(x >= 3)",
        "log.csv",
        "--time",
        "dense",
        "--junit",
        "r.xml",
        "--html",
        "r.html",
        "--quiet",
    )
    for name in ("r.xml", "r.html"):
        text = Path(name).read_text(encoding="utf-8")
        assert "2023-11-14 22:13:20.5" in text
        assert "1700000000" not in text.partition("<script")[0] + text.partition("</footer>")[0]


@pytest.mark.parametrize("options", [(), ("--time", "dense")])
def test_json_has_seconds_with_all_digits_where_timestamps_count_nanoseconds(run, write, options):
    write("log.csv", "t [ns],x\n1700000000000000001,5\n1700000001000000001,2\n")
    check = run("check", "always(x >= 3)", "log.csv", "--json", *options)
    answer = run("explain", "always(x >= 3)", "log.csv", "--json", *options)
    told = json.loads(answer.out, parse_float=str)
    violated = "1700000001.000000001"
    assert json.loads(check.out, parse_float=str)["first_violation"] == told["first_violation"] == violated
    assert (told["time"], told["critical"]["time"]) == ("1700000000.000000001", violated)
    (stretch,) = told["implicant"]
    assert stretch["start"] == stretch["reads"][0]["start"] == violated
    data = rtamt.parse("always(x >= 3)").evaluate(rtamt.read("log.csv")).explain().to_dict()
    assert (data["time"], data["first_violation"]) == (1700000000.000000001, 1700000001.000000001)
