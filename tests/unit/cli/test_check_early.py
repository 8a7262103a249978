"""``rtamt check --early``: where it stops, and what is known by then."""

import json
from pathlib import Path

import pytest

GOOD = "time,x\n0,5\n1,4\n2,6\n"
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


@pytest.mark.parametrize("how", [(), ("--how", "linear")])
@pytest.mark.parametrize("more", [("--time", "dense"), ("--resample", "2s")])
def test_early_stops_in_dense_time_and_on_a_chosen_clock(run, write, more, how):
    write("long.csv", f"{LONG}140000,oops\n")
    write("short.csv", "time,x\n" + "".join(f"{i},{1 if i == 70 else 5}\n" for i in range(80)))
    options = (*more, *(how if "--resample" in more else ()), "--json")
    early = run("check", "always(x >= 3)", "long.csv", "--early", *options)
    row, whole = (
        json.loads(answer.out) for answer in (early, run("check", "always(x >= 3)", "short.csv", *options))
    )
    assert early.code == 1
    assert (row["satisfied"], row["first_violation"]) == (False, whole["first_violation"]) == (False, 70)
    assert (row["decided_at"], row["upper"], row["period"]) == (70, -2, whole["period"])


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
        ("always(x >= 0)", ("--time", "dense")),
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


def test_early_counted_the_samples_of_the_variables_of_other_requirements(run, write):
    write("two.stl", "require A: always(x >= 0)\nrequire B: always(y >= 0)\n")
    write("a.csv", "time,x,y\n0,1,\n1,1,\n2,1,1\n3,,-1\n4,-1,1\n5,1,1\n")
    answer = run("check", "two.stl", "a.csv", "--early", "--json", "--time", "dense")
    found = [json.loads(line) for line in answer.out.splitlines()]
    assert [(row["first_violation"], row["decided_at"], row["samples"]) for row in found] == [
        (4, 4, 4),
        (3, 3, 2),
    ]


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


def test_early_bounds_are_those_of_a_recording_that_may_end_at_once(run, write):
    # Were the trace to go on, the robustness of eventually would be 0 at least; at the end it is -inf.
    write("a.csv", "time,x,y\n0,5,-1\n1,5,5\n")
    answer = run("check", "eventually[5:10](abs(x) > 0) and y > 0", "a.csv", "--early", "--json")
    row = json.loads(answer.out)
    assert (row["satisfied"], row["lower"], row["upper"]) == (False, "-inf", 0.0)


@pytest.mark.parametrize("more", [(), ("--time", "dense"), ("--time", "dense", "--resample", "1s")])
def test_early_stops_in_a_format_that_cannot_be_read_in_part(run, tmp_path, monkeypatch, more):
    from tests.unit.readers.test_formats import ulog

    monkeypatch.chdir(tmp_path)
    rows = [(1_000_000 * t, 1 if t == 70 else 5) for t in range(5000)]
    ulog(tmp_path / "flight.ulg", [("battery", 0, "float x", rows)])
    formula = "always(battery.x >= 3)"
    early, whole = (
        json.loads(run("check", formula, "flight.ulg", "--json", *more, *option).out)
        for option in (("--early",), ())
    )
    assert (early["satisfied"], early["first_violation"]) == (False, 70)
    assert (early["satisfied"], early["first_violation"]) == (whole["satisfied"], whole["first_violation"])
    assert (early["decided_at"], early["samples"], whole["samples"]) == (70, 71, 5000)
    assert early["lower"] == "-inf"
    assert early["upper"] == whole["robustness"] == -2
