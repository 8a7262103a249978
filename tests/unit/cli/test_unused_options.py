"""An option without effect in its combination with others is an error."""

import pytest

DATES = "time,x\n2026-01-01T00:00:00,5\n2026-01-01T00:00:01,1\n"
HOW = "--how is for samples on a new time base: give its period, such as --resample 100ms"
DATED = "the times are dates, which have a unit: leave out time_unit=, on the command line --time-unit"
UNIT = "name their column, or leave out time_unit=, on the command line --time-unit"


@pytest.fixture(autouse=True)
def files(write):
    write("a.csv", "time,x\n0,5\n1,1\n")
    write("dates.csv", DATES)
    write("rows.csv", "x\n5\n1\n")
    write("s.stl", "x >= 0")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["check", "s.stl", "a.csv", "--how", "linear"], HOW),
        (["explain", "s.stl", "a.csv", "--how", "hold"], HOW),
        (["mutate", "s.stl", "a.csv", "--how", "linear"], HOW),
        (["info", "a.csv", "--how", "linear"], HOW),
        (["info", "s.stl", "--how", "linear"], "--how is for recordings, and 's.stl' is a requirement or program"),
        (["check", "s.stl", "dates.csv", "--time-unit", "ms"],
         DATED.replace("times", "times of dates.csv")),
        (["info", "dates.csv", "--time-unit", "ms"],
         DATED.replace("times", "times of dates.csv")),
        (["check", "s.stl", "rows.csv", "--time-unit", "ms"], f"rows.csv has no timestamps: {UNIT}"),
        (["check", "s.stl", "a.csv", "--time-column", "", "--time-unit", "ms"], f"a.csv has no timestamps: {UNIT}"),
        (["check", "s.stl", "a.csv", "--recover"],
         "only MCAP files are read up to their damage; leave out recover for 'a.csv'"),
        (["info", "a.csv", "--period", "1s"], "--period is for requirements, and this is a recording"),
        (["info", "a.csv", "--time", "dense"], "--time is for requirements, and this is a recording"),
        (["info", "s.stl", "--latex", "--json"],
         "--latex prints the formula alone, and --json contains it: leave one out"),
        (["plot", "s.stl", "a.csv", "-o", "p.svg", "--tree", "--rows", "2"],
         "--rows is for plots over time: leave it out, or --tree"),
        (["plot", "s.stl", "a.csv", "-o", "p.svg", "--tree", "--from", "0"],
         "--from is for plots over time: leave it out, or --tree"),
        (["plot", "s.stl", "a.csv", "-o", "p.svg", "--tree", "--bounds"],
         "--bounds is for plots over time: leave it out, or --tree"),
        (["plot", "s.stl", "a.csv", "-o", "p.svg", "--zoom", "violation", "--from", "0", "--to", "1"],
         "--from and --to choose what is shown: leave out --zoom"),
    ],
    ids=str,
)  # fmt: skip
def test_an_option_without_effect_is_one_sentence(run, arguments, message) -> None:
    assert run(*arguments) == (2, "", f"rtamt: {message}\n")


@pytest.mark.parametrize(
    ("lines", "option", "message"),
    [
        (DATES, ["--time-unit", "ms"],
         f"stdin, line 2: {DATED}"),
        ("x\n5\n1\n", ["--time-unit", "ms"],
         "stdin, line 2: there is no timestamp: name its column, or leave out --time-unit"),
        ('{"x": 5}\n', ["--time-unit", "ms"],
         "stdin, line 1: there is no timestamp: name its column, or leave out --time-unit"),
        ("time,x\n0,5\n", ["--tolerance", "0.2", "--time", "dense"],
         "dense time has no sampling period: leave out --tolerance, or --time dense"),
    ],
)  # fmt: skip
def test_so_is_one_of_a_stream(run, lines, option, message) -> None:
    assert run("monitor", "x >= 0", *option, stdin=lines) == (2, "", f"rtamt: {message}\n")


def test_how_has_an_effect_where_the_specification_samples_the_recording(run) -> None:
    assert run("check", "sample 500ms hold; x >= 0", "a.csv", "--how", "linear").code == 0
