"""``rtamt check``: output, JSON, exit codes."""

import json
from dataclasses import asdict
from pathlib import Path

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
            "episodes": {
                "count": 1,
                "worst": {"begin": 0, "end": 0.5, "worst": "-inf", "at": 0},
                "first": [{"begin": 0, "end": 0.5, "worst": "-inf", "at": 0}],
            },
        },
        {
            "requirement": "once[1:1](x > 0)",
            "trace": "nowhere.csv",
            "error": "there is no file 'nowhere.csv'",
        },
    ]
    assert (answer.code, answer.err) == (2, "rtamt: there is no file 'nowhere.csv'\n")


@pytest.mark.parametrize("large", [False, True])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_episodes_are_those_of_the_result_whatever_way_the_recording_is_read(
    run, write, monkeypatch, large, time
):
    if large:
        monkeypatch.setattr("rtamt.cli.runner.LARGE", 0)
    write("a.csv", "time,x\n0,5\n1,2\n2,1\n3,4\n4,0\n5,6\n")
    answer = run("check", "always(x >= 3)", "a.csv", "--time", time)
    until = "5" if time == "dense" else "4"
    where = "from 4 s to 5 s: robustness -3 at 4 s" if time == "dense" else "at 4 s: robustness -3"
    assert answer.out.splitlines()[-1] == f"a.csv: 2 episodes of violation, the worst {where}"
    row = json.loads(run("check", "always(x >= 3)", "a.csv", "--time", time, "--json").out)
    result = rtamt.parse("always(x >= 3)").evaluate(rtamt.read("a.csv"), time=time)
    episodes = [asdict(episode) for episode in result.episodes()]
    assert row["episodes"] == {"count": 2, "worst": episodes[1], "first": episodes}
    assert row["episodes"]["worst"]["end"] == float(until)


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


#: A recording without violations.
NONE = {"count": 0, "worst": None, "first": []}


def test_period_unit_and_time_column(run, write):
    write("a.csv", "clock [ms],time,x\n0,7,0\n100,7,0\n200,7,9\n")
    args = ("check", "eventually[0:200](x >= 3)", "a.csv", "--unit", "ms", "--json")
    answer = run(*args, "--time-column", "clock", "--period", "100ms")
    assert json.loads(answer.out) == {
        "requirement": "eventually[0:200](x >= 3)", "trace": "a.csv", "satisfied": True, "robustness": 6.0,
        "first_violation": None, "samples": 3, "period": 0.1, "episodes": NONE,
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
