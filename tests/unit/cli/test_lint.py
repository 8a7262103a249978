"""``rtamt lint``: specification files, without a recording."""

from __future__ import annotations


def test_files_that_are_right(run, write):
    write("a.stl", "specification a\nalways(x >= 3)\n")
    write("b.stl", "eventually[0:100ms](y <= 1)\n")
    assert run("lint", "a.stl", "b.stl") == (0, "2 files are right\n", "")
    assert run("lint", "a.stl") == (0, "1 file is right\n", "")
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
