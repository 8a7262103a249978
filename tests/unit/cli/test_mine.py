"""``rtamt mine`` and ``rtamt classify``."""

import json

import rtamt

SPEC = "input float x\nparameter float limit = 9\nrequire HIGH: always(x <= limit)\n"
OUT = """\
2 recordings, 77 evaluations

parameter  value  next harder  violated by  direction
limit        7.5       7.4999  b.csv        larger values are easier

rtamt check: --set limit=7.5

recording  limit alone
a.csv                5
b.csv              7.5
"""


def drives(write):
    write("high.stl", SPEC)
    write("a.csv", "x\n5\n2\n")
    write("b.csv", "x\n7.5\n6\n")


def test_the_tight_value(run, write):
    drives(write)
    assert run("mine", "high.stl", "a.csv", "b.csv") == (0, OUT, "")
    assert run("check", "high.stl", "a.csv", "b.csv", "--set", "limit=7.5").code == 0
    assert run("check", "high.stl", "a.csv", "b.csv", "--set", "limit=7.4999").code == 1
    end = run("mine", "high.stl", "a.csv", "b.csv", "--range", "limit=8:10")
    assert (end.code, end.err) == (1, "")
    assert "limit          8            -  end of the range  larger values are easier" in end.out


def test_the_values_that_were_given_are_among_those_to_check_with(run, write):
    drives(write)
    write("two.stl", "input float x\nparameter float a = 0\nparameter float b = 0\nalways(x <= a + b)\n")
    found = run("mine", "two.stl", "a.csv", "b.csv", "--param", "a", "--set", "b=2", "--set", "a=1")
    (line,) = [line for line in found.out.splitlines() if line.startswith("rtamt check: ")]
    assert line == "rtamt check: --set a=5.5 --set b=2"
    assert run("check", "two.stl", "a.csv", "b.csv", *line.split()[2:]).code == 0


def test_a_front(run, write):
    drives(write)
    write(
        "two.stl",
        "parameter float low = 1\nparameter float within = 1\neventually[0:within](always(x <= low))\n",
    )
    answer = run("mine", "two.stl", "a.csv", "b.csv", "-o", "front.png")
    assert (answer.code, answer.err) == (0, "")
    assert (
        "Pareto front: 2 points\n\nlow  within  violated next by\n  6       1  b.csv\n7.5       0  b.csv\n"
        in answer.out
    )
    with open("front.png", "rb") as file:
        assert file.read(4) == b"\x89PNG"
    one = run("mine", "two.stl", "a.csv", "b.csv", "--order", "--param", "within", "--param", "low")
    assert "rtamt check: --set within=0 --set low=7.5\n" in one.out
    found = json.loads(run("mine", "two.stl", "a.csv", "b.csv", "--json").out)
    assert [point["values"] for point in found["points"]] == [
        {"low": 6.0, "within": 1.0},
        {"low": 7.5, "within": 0.0},
    ]


def test_a_spent_budget_is_said(run, write):
    drives(write)
    answer = run("mine", "high.stl", "a.csv", "b.csv", "--range", "limit=0:99", "--evaluations", "9")
    assert answer.code == 1
    assert answer.out.endswith(
        "the budget was spent: the values satisfy the requirement, and are not proven tight\n"
    )


def test_what_is_wrong_is_said(run, write):
    drives(write)
    write("other.stl", SPEC)

    def error(*args):
        answer = run("mine", *args)
        assert (answer.code, answer.out) == (2, "")
        return answer.err

    assert error("high.stl", "other.stl", "a.csv") == (
        "rtamt: 'rtamt mine' takes one specification; leave out 'other.stl'\n"
    )
    assert error("high.stl").startswith("rtamt: there is no trace to mine: name a file")
    assert error("high.stl", "a.csv", "--range", "limit") == (
        "rtamt: --range is 'limit'; give a parameter and what it is, such as limit=0:60\n"
    )
    assert error("high.stl", "a.csv", "--range", "limit=0:b") == (
        "rtamt: --range has 'b' where a number is expected; write --range limit=0:60\n"
    )
    assert error("always(x <= 3)", "a.csv") == (
        "rtamt: the specification declares no parameter to mine; declare one, such as parameter float limit = 30\n"
    )
    assert error("high.stl", "a.csv", "--param", "height").startswith("rtamt: there is no parameter 'height'")


RULES = """\
// Learned from 3 good and 3 bad recordings.
// good if it holds: 3 good and 0 bad recordings
rule_1 = always(x <= 4)
require GOOD "the recording is good": rule_1
"""


def labelled(write):
    for k in range(3):
        write(f"good/{k}.csv", f"x\n0\n{k + 1}\n1\n")
        write(f"bad/{k}.csv", f"x\n0\n{k + 5}\n1\n")


def test_rules_are_a_specification(run, write, tmp_path):
    (tmp_path / "good").mkdir()
    (tmp_path / "bad").mkdir()
    labelled(write)
    answer = run(
        "classify",
        "--good",
        "good",
        "--bad",
        "bad",
        "--folds",
        "3",
        "--rules-file",
        "rules.stl",
        "-o",
        "c.png",
    )
    assert (answer.code, answer.err) == (0, "")
    assert "if always(x <= 4) then good\nelse bad\n" in answer.out
    assert "cross-validated, 3 folds, seed 0         100.0%\nclass of most recordings" in answer.out
    with open("rules.stl", encoding="utf-8") as file:
        assert file.read() == RULES
    assert run("check", "rules.stl", "good/1.csv").code == 0
    assert run("check", "rules.stl", "bad/1.csv").code == 1
    given = run(
        "classify",
        "parameter float p = 1  eventually(x >= p)",
        "--good",
        "good",
        "--bad",
        "bad",
        "--folds",
        "3",
        "--json",
    )
    assert json.loads(given.out)["rules"][0]["formula"] == "eventually(x >= 4)"
    assert rtamt.parse(json.loads(given.out)["specification"]).evaluate({"x": [1, 2]}).satisfied


def test_equal_recordings_have_no_rule(run, write):
    for name in "abcd":
        write(f"{name}.csv", "x\n0\n1\n")
    answer = run("classify", "--good", "a.csv", "b.csv", "--bad", "c.csv", "d.csv", "--folds", "2")
    assert answer.code == 1
    assert "no rule is better than the class of most recordings" in answer.out


def test_wrong_recordings_of_a_classifier(run, write, tmp_path):
    write("a.csv", "x\n0\n1\n")
    (tmp_path / "empty").mkdir()

    def error(*args):
        answer = run("classify", *args)
        assert (answer.code, answer.out) == (2, "")
        return answer.err

    assert error("--good", "a.csv", "--bad", "a.csv") == (
        "rtamt: 'a.csv' is given as good and as bad; leave it out once\n"
    )
    assert (
        error("--good", "a.csv", "a.csv", "--bad", "b.csv")
        == "rtamt: 'a.csv' is given twice; leave it out once\n"
    )
    assert (
        error("--good", "empty", "--bad", "a.csv")
        == "rtamt: --good: there is no recording in the folder 'empty'\n"
    )
