"""``rtamt check`` of several requirements: a row each, in every report."""

import json
from pathlib import Path
from xml.etree import ElementTree as ET

import pytest

BAD = "time,x\n0,5\n1,1.5\n2,6\n"
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

    def episode(begin, end, worst):
        one = {"begin": begin, "end": end if domain == "dense" else begin, "worst": worst, "at": begin}
        return {"count": 1, "worst": one, "first": [one]}

    assert rows == [
        {
            "requirement": "REQ-7",
            "robustness": -0.5,
            "first_violation": 1,
            "episodes": episode(1, 2, -0.5),
            "description": "brakes in time",
            "severity": "warning",
            **common,
        },
        {
            "requirement": "REQ-8",
            "robustness": -1,
            "first_violation": 3,
            "episodes": episode(3, 3, -1),
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
    suites = ET.parse("r.xml").getroot()
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
