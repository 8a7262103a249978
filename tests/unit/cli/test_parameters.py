"""``--set NAME=VALUE`` with every command that reads a specification."""

import json

import pytest

SPEC = """input float x
parameter float limit = 4 [m]
parameter float within = 2
require LOW: always(x > limit -> eventually[0:within](x <= limit))
"""
TRACE = "time,x\n0,3\n1,5\n2,6\n3,2\n"


@pytest.fixture
def files(write):
    return write("spec.stl", SPEC), write("log.csv", TRACE)


@pytest.mark.parametrize(("values", "code"), [([], 0), (["within=1"], 1), (["within=1", "limit=5"], 0)])
def test_check_uses_the_values(run, files, values, code):
    assert run("check", *files, *(f"--set={value}" for value in values)).code == code


def test_every_command_uses_the_values(run, files, tmp_path):
    spec, trace = files
    assert "x <= 9" in run("explain", spec, trace, "--set", "limit=9").out
    assert "always(x > 9 -> eventually[0:2](x <= 9))" in run("info", spec, "--set", "limit=9").out
    assert run("plot", spec, trace, "--set", "limit=9", "-o", "plot.png").code == 0
    run("report", spec, trace, "--set", "limit=9", "-o", "report.html")
    assert "eventually[0:2](x &lt;= 9)" in (tmp_path / "report.html").read_text()
    line = json.dumps({"time": 0, "x": 3})
    out = run("monitor", "parameter float limit = 4 once(x <= limit)", "--set", "limit=9", stdin=line).out
    assert json.loads(out)["robustness"] == 6.0
    assert (
        "const 9.0"
        in run("compile", "parameter float limit = 4 x <= limit", "--set", "limit=9", "--dump").out
    )
    assert run("lint", spec, "--set", "limit=9", "--quiet").code == 0
    assert run("fmu", "parameter float limit = 4 x <= limit", "--set", "limit=9", "-o", "unit.fmu").code == 0


def test_info_lists_parameters(run, files):
    listed = run("info", files[0], "--set", "limit=9").out.splitlines()
    at = next(i for i, line in enumerate(listed) if line.startswith("parameters"))
    assert listed[at : at + 2] == ["parameters limit = 9 [m]  (by default 4)", "           within = 2"]
    told = json.loads(run("info", files[0], "--set", "limit=inf", "--json").out)
    assert told["parameters"] == [
        {"name": "limit", "type": "float", "value": "inf", "default": 4.0, "unit": "m"},
        {"name": "within", "type": "float", "value": 2.0, "default": 2.0, "unit": None},
    ]


def test_of_several_specifications_those_with_the_parameter_have_its_value(run, files, write):
    other = write("other.stl", "require POSITIVE: always(x >= 0)")
    assert run("check", files[0], other, files[1], "--set", "within=1").code == 1
    assert run("check", files[0], other, files[1]).code == 0


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ("limt=3", "there is no parameter 'limt'; did you mean 'limit'? (parameters: limit, within)"),
        ("limit", "'limit' sets no parameter; write NAME=VALUE, such as limit=3"),
        ("limit=high", "the parameter 'limit' is 'high'; give a number"),
        ("limit=nan", "the parameter 'limit' is 'nan'; give a number"),
        ("limit=1_0", "the parameter 'limit' is '1_0'; give a number"),
        ("limit=\u0663", "the parameter 'limit' is '\u0663'; give a number"),
        ("limit=infinity", "the parameter 'limit' is 'infinity'; give a number"),
        ("limit=1e999", "the parameter 'limit' is '1e999'; give a number"),
    ],
)
def test_what_cannot_be_set_is_one_sentence(run, files, given, sentence):
    assert run("check", *files, "--set", given) == (2, "", f"rtamt: {sentence}\n")


@pytest.mark.parametrize("second", ["limit=4", "limit=3", " limit =4"])
def test_the_second_of_two_values_won_silently(run, files, second):
    error = "rtamt: the parameter 'limit' is set twice; leave out one of the values\n"
    assert run("check", *files, "--set", "limit=3", "--set", second) == (2, "", error)


@pytest.mark.parametrize(
    ("given", "value"), [("3", 3), ("-3", -3), ("+.5", 0.5), ("5.", 5), ("1E-3", 0.001), ("-inf", "-inf")]
)
def test_numbers_are_set_as_formulas_have_them(run, files, given, value):
    told = json.loads(run("info", files[0], "--set", f"limit={given}", "--json").out)
    assert told["parameters"][0]["value"] == value


def test_a_bound_that_is_set_is_pointed_at(run, files):
    error = run("check", *files, "--set", "within=1.5", "--period", "1").err
    assert error.startswith(
        "rtamt: --set within=1.5: The operator bound must be a multiple of the sampling period"
    )
    assert error.endswith("                                           ^^^^^^^^^^\n")


def test_only_requirements_have_parameters(run, files):
    run("compile", "x >= 3", "-o", "x.rtamt")
    assert (
        run("info", "x.rtamt", "--set", "limit=3").err
        == "rtamt: 'x.rtamt' is a program: --set is for requirements\n"
    )
    assert (
        run("info", files[1], "--set", "limit=3").err
        == "rtamt: --set is for requirements, and this is a recording\n"
    )


def test_a_boolean_is_set_by_its_word(run, write):
    spec = write("strict.stl", "float x parameter bool strict = false require A: strict -> x <= 2")
    write("log.csv", TRACE)
    assert run("check", spec, "log.csv").code == 0
    assert run("check", spec, "log.csv", "--set", "strict=true").code == 1
    assert "parameters strict = true  (by default false)" in run("info", spec, "--set", "strict=true").out


MODES = """
    enum Mode { MANUAL, AUTO = 4, "hold position" = 7 }
    input Mode mode
    parameter Mode start = AUTO
    parameter bool strict = true
    always(strict -> mode == start)
"""


def test_members_and_booleans_are_set_and_shown_by_name(run, write):
    path = write("modes.stl", MODES)
    log = write("log.csv", "time,mode\n0,MANUAL\n1,MANUAL\n")
    assert run("check", path, log).code == 1
    assert run("check", path, log, "--set", "start=MANUAL").code == 0
    assert run("check", path, log, "--set", "strict=false").code == 0
    shown = run("info", path, "--set", "start=hold position", "--set", "strict=false").out
    assert "start = hold position  (by default AUTO)" in shown
    assert "strict = false  (by default true)" in shown
    parameters = json.loads(run("info", path, "--json", "--set", "strict=false").out)["parameters"]
    assert [(each["type"], each["value"]) for each in parameters] == [("Mode", "AUTO"), ("bool", False)]
    assert (
        "'start' is 'AUT', which is no member of Mode; did you mean 'AUTO'?"
        in run("check", path, log, "--set", "start=AUT").err
    )
