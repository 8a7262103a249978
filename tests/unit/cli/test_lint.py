"""``rtamt lint``: specification files, without a recording."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

import rtamt


def test_files_that_are_right(run, write):
    write("a.stl", "specification a\nalways(x >= 3)\n")
    write("b.stl", "eventually[0:100ms](y <= 1)\n")
    assert run("lint", "a.stl", "b.stl") == (0, "2 files have no errors or warnings\n", "")
    assert run("lint", "a.stl") == (0, "1 file has no errors or warnings\n", "")
    assert run("lint", "a.stl", "--quiet") == (0, "", "")


def test_every_file_that_is_wrong_is_told_with_the_place(run, write):
    write("a.stl", "always(x >= )\n")
    write("b.stl", "always(x >= 3)\n")
    write("c.stl", "float x\nalways(y >= 3)\n")
    answer = run("lint", "a.stl", "b.stl", "c.stl")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == (
        "rtamt: a.stl: expected an operand after '>=', got ')'\n"
        "  line 1, column 13:\n"
        "    always(x >= )\n"
        "                ^\n"
        "rtamt: c.stl: 'y' is not declared; declared names: x\n"
        "  line 2, column 8:\n"
        "    always(y >= 3)\n"
        "           ^\n"
    )


def test_every_error_of_a_file_is_told(run, write):
    write("a.stl", "float x [m\nlow = x < ;\nrequire R: always(low and y > 3)\n")
    answer = run("lint", "a.stl")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == (
        "rtamt: a.stl: expected a unit and ']' after 'x [', such as [m/s]\n"
        "  line 1, column 9:\n"
        "    float x [m\n"
        "            ^\n"
        "rtamt: a.stl: expected an operand after '<', got ';'\n"
        "  line 2, column 11:\n"
        "    low = x < ;\n"
        "              ^\n"
    )
    answer = run("lint", "a.stl", "--json")
    assert [(row["line"], row["column"]) for row in map(json.loads, answer.out.splitlines())] == [
        (1, 9),
        (2, 11),
    ]
    write("b.stl", "once[0:0.25] x > 3; always[0:0.15] x > 3\n")
    answer = run("lint", "b.stl", "--period", "100ms", "--json")
    assert [row["column"] for row in map(json.loads, answer.out.splitlines())] == [5, 27]


def test_bounds_that_are_too_short_and_others_are_told_together(run, write):
    write("a.stl", "a = once[0:0.05] x > 3\nb = once[0:0.15] x > 3\nrequire R: always[0:0.35](a and b)\n")
    answer = run("lint", "a.stl", "--period", "100ms", "--json")
    rows = [json.loads(line) for line in answer.out.splitlines()]
    assert answer.code == 2
    assert [(row["code"], row["severity"], row["line"]) for row in rows] == [
        (None, "error", 2),
        (None, "error", 3),
        ("RT107", "error", 1),
    ]


def test_a_reversed_bound_is_told_with_its_file(run, write):
    write("a.stl", "once[2:1] x > 3\n")
    answer = run("lint", "a.stl")
    assert (answer.code, answer.err.splitlines()[0][:14]) == (2, "rtamt: a.stl: ")


def test_bounds_are_held_to_the_period(run, write):
    write("a.stl", "once[0:150ms](x >= 3)\n")
    assert run("lint", "a.stl").code == 0
    answer = run("lint", "a.stl", "--period", "100ms")
    assert answer.code == 2
    assert answer.err.startswith(
        "rtamt: a.stl: The operator bound must be a multiple of the sampling period: 150 ms"
    )


def test_what_a_monitor_cannot_run_is_refused_on_demand(run, write):
    write("a.stl", "always(x >= 3)\n")
    assert run("lint", "a.stl").code == 0
    answer = run("lint", "a.stl", "--online")
    assert answer.code == 2
    assert answer.err.startswith("rtamt: a.stl: 'always' without an upper bound needs the whole future")


def test_dense_time_has_no_samples_to_step_by(run, write):
    write("a.stl", "next(x >= 3)\n")
    assert run("lint", "a.stl").code == 0
    answer = run("lint", "a.stl", "--time", "dense")
    assert answer.code == 2
    assert "next" in answer.err


def test_only_files_are_read(run):
    answer = run("lint", "x >= 3")
    assert answer == (2, "", "rtamt: there is no file 'x >= 3'; 'rtamt info' looks at a formula in quotes\n")


def test_warnings_have_codes_that_can_be_silenced(run, write):
    write("gap.stl", "x and y >= 3; 3 >= 2")
    answer = run("lint", "gap.stl")
    assert answer == (
        0,
        "",
        "rtamt: gap.stl: warning RT101: 'x' is a number where a formula is expected; compare it, such as x > 0\n"
        "  line 1, column 1:\n"
        "    x and y >= 3; 3 >= 2\n"
        "    ^\n"
        "rtamt: gap.stl: warning RT103: '3 >= 2' reads no variable: it always holds or never does\n"
        "  line 1, column 15:\n"
        "    x and y >= 3; 3 >= 2\n"
        "                  ^^^^^^\n",
    )
    assert run("lint", "gap.stl", "--strict").code == 1
    silent = run("lint", "gap.stl", "--strict", "--ignore", "RT101", "--ignore", "RT103")
    assert silent == (0, "1 file has no errors or warnings\n", "")
    assert (
        "argument --ignore: there is no code 'RT999'; did you mean 'RT509'?"
        in run("lint", "gap.stl", "--ignore", "RT999").err
    )


def test_check_prints_warnings_and_keeps_its_exit_code(run, write):
    write("a.csv", "x\n5\n4\n")
    answer = run("check", "prev(x) - x <= 3", "a.csv", "--json")
    assert (answer.code, answer.err.splitlines()[0]) == (
        0,
        "rtamt: warning RT105: 'prev' applies to all of '(x) - x <= 3'; write prev((x) - x <= 3) if that is meant",
    )
    assert run("check", "prev(x) - x <= 3", "a.csv", "--json", "--ignore", "RT105").err == ""
    assert run("check", "prev(x) - x <= 3", "a.csv", "--quiet").err == ""


SPEED = "input float speed [m/s]\ninput float gap [m]\nalways(speed + gap > 3) and speed\n"


def test_units_that_do_not_fit_are_errors_and_block_no_check(run, write):
    write("speed.stl", SPEED)
    write("log.csv", "speed,gap\n2,3\n")
    answer = run("lint", "speed.stl", "--quiet")
    assert answer == (
        2,
        "",
        "rtamt: speed.stl: error RT301: 'speed' is in m/s and 'gap' is in m, which are different quantities; correct a "
        "declaration, or multiply 'speed' by a constant in s\n"
        "  line 3, column 8:\n"
        "    always(speed + gap > 3) and speed\n"
        "           ^^^^^^^^^^^\n",
    )
    assert run("lint", "speed.stl", "--ignore", "RT301").code == 0
    checked = run("check", "speed.stl", "log.csv", "--ignore", "RT101")
    assert (checked.code, checked.err) == (0, answer.err)


def test_findings_as_json_for_editors(run, write):
    write("speed.stl", SPEED)
    write("wrong.stl", "always(\n  x >= )\n")
    answer = run("lint", "speed.stl", "wrong.stl", "none.stl", "--json")
    rows = [json.loads(line) for line in answer.out.splitlines()]
    places = [tuple(row.get(key) for key in ("line", "column", "end_line", "end_column")) for row in rows]
    assert (answer.code, answer.err) == (2, "")
    assert [(row["file"], row["severity"], row["code"]) for row in rows] == [
        ("speed.stl", "error", "RT301"),
        ("speed.stl", "warning", "RT101"),
        ("wrong.stl", "error", None),
        ("none.stl", "error", None),
    ]
    assert places == [(3, 8, 3, 19), (3, 29, 3, 34), (2, 8, 2, 9), (None,) * 4]
    assert rows[2]["message"] == "expected an operand after '>=', got ')'"
    assert run("lint", "speed.stl", "--json", "--ignore", "RT301", "--ignore", "RT101") == (0, "", "")


def test_without_the_library_of_units_only_lint_notes_what_is_not_checked(run, write, monkeypatch):
    monkeypatch.setitem(sys.modules, "pint", None)
    write("speed.stl", "input float speed [m/s]\ninput float limit [km/h]\nalways(speed <= limit)\n")
    write("log.csv", "speed,limit\n2,3\n")
    answer = run("lint", "speed.stl", "--strict")
    assert (answer.code, answer.err.splitlines()[0]) == (
        0,
        "rtamt: speed.stl: note RT303: the units are not checked here: comparing units needs the package 'pint', which "
        "is not installed: pip install 'rtamt[units]'",
    )
    assert run("check", "speed.stl", "log.csv").err == ""


def test_a_file_that_others_import_needs_no_formula(run, write):
    write("lib.stl", "input float v [m/s]\ninput float gap [m]\ndef near(x) = x < 3\nclose = v + gap > 3\n")
    write("other.stl", 'import "lib.stl"\nconst float least = 3\n')
    assert run("lint", "other.stl") == (0, "1 file has no errors or warnings\n", "")
    answer = run("lint", "lib.stl", "--json")
    assert answer.code == 2
    assert (json.loads(answer.out)["code"], json.loads(answer.out)["line"]) == ("RT301", 4)
    for text, message in (
        ("x > 3 and", "expected an operand after 'and'"),
        ("def f(x) = x +\n", "expected an operand after '+'"),
        ("// nothing\n", "the text is empty"),
    ):
        write("wrong.stl", text)
        assert f"rtamt: wrong.stl: {message}" in run("lint", "wrong.stl").err


def test_the_files_of_the_package_have_no_findings(run):
    files = sorted(map(str, Path(rtamt.__file__).parent.glob("library/**/*.stl")))
    assert run("lint", "--strict", *files) == (0, f"{len(files)} files have no errors or warnings\n", "")


@pytest.mark.parametrize("options", [[], ["--json"]])
def test_many_files_are_checked_in_processes_and_reported_in_their_order(run, write, monkeypatch, options):
    names = ["good.stl", "warned.stl", "wrong.stl", "warned.stl", "good.stl"]
    write("good.stl", "x >= 3")
    write("warned.stl", "x and y >= 3")
    write("wrong.stl", "x >=")
    expected = run("lint", *names, *options)
    assert expected.code == 2
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    monkeypatch.setattr("rtamt.cli.lint._WORTH_A_PROCESS", 2)
    monkeypatch.setattr("rtamt.cli.lint._AT_ONCE", 2)
    assert run("lint", *names, *options) == expected
