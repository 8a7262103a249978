"""Quantifiers on the command line: the members are the columns of the file, or the keys of the stream."""

from __future__ import annotations

import json

import pytest

import rtamt
from rtamt.cli import main

SPEC = """input float ego.x
input group cars = "car_*" { float x [m] }
require A: always forall v in cars: v.x - ego.x > 5
require B: ego.x >= 0
"""
TRACE = "time,ego.x,car_1.x,car_2.x [m]\n0,0,10,\n1,1,11,9\n2,2,12,6\n3,3,13,\n"


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "f.stl").write_text(SPEC)
    (tmp_path / "forall.stl").write_text(SPEC.partition("require B")[0])
    (tmp_path / "f.csv").write_text(TRACE)
    (tmp_path / "empty.csv").write_text("time,ego.x\n0,0\n1,1\n")


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.usefixtures("files")
def test_the_members_are_the_columns_of_each_file(capsys, time):
    assert main(["check", "f.stl", "f.csv", "empty.csv", "--time", time, "--json"]) == 2
    a, b, without, beside = map(json.loads, capsys.readouterr().out.splitlines())
    assert (a["requirement"], a["robustness"], a["first_violation"]) == ("A", -1, 2)
    assert (b["requirement"], b["robustness"]) == ("B", 0)
    message = "empty.csv has no member of the group 'cars': no name matches \"car_*\" and a field, such as car_1.x; "
    assert without["error"] == message + "names: ego.x"
    assert (beside["requirement"], beside["robustness"]) == ("B", 0)


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_variable_that_is_recorded_as_a_field_of_a_member_is_read_by_other_requirements(run, write, time):
    text = (
        'input float e = "car_1.x"; group cars = "car_*"\nrequire A: always(e >= 3)\n'
        "require B: always(forall v in cars: v.x >= 3)\n"
    )
    rows = run(
        "check",
        write("f.stl", text),
        write("f.csv", "time,car_1.x,car_2.x\n0,4,5\n1,5,1\n"),
        "--json",
        "--time",
        time,
    )
    assert [json.loads(row)["robustness"] for row in rows.out.splitlines()] == [1, -2]


@pytest.mark.usefixtures("files")
def test_explanations_and_reports_name_the_members(capsys):
    main(["explain", "forall.stl", "f.csv"])
    assert "'car_2.x - ego.x > 5' fails at 2 s (-1)" in capsys.readouterr().out


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_declared_field_that_no_formula_reads_ends_the_presence_of_its_member_in_files(run, write, time):
    spec = write("f.stl", 'group cars = "car_*" { float x; bool on }\nrequire A: forall v in cars: v.x > 5\n')
    trace = write("f.csv", "time,car_1.x,car_1.on,car_2.x,car_2.on\n0,6,true,1,\n1,6,true,1,false\n")
    answer = run("check", spec, trace, "--json", "--time", time)
    assert json.loads(answer.out)["robustness"] == 1.0


@pytest.mark.usefixtures("files")
def test_info_lists_groups(capsys):
    assert main(["info", "f.stl"]) == 0
    assert 'groups     input cars = "car_*" { float x [m] }\n' in capsys.readouterr().out


# ---- streams ------------------------------------------------------------------------------------

STREAMED = """enum Mode { SLOW, FAST }
input float ego.x
input group cars = "car_*" { float x [m]; bool on; Mode mode }
"""
FORMULAS = [
    "forall v in cars: v.x - ego.x > 5",
    "always[0:2] exists v in cars: once[0:1](v.x > 9) and not v.on",
    "(count v in cars: v.mode == FAST or eventually[0:1](v.on)) <= 1",
    "forall v in cars: forall w in cars where v != w: v.x - w.x > 1 or s_prev(w.mode == SLOW)",
]
CSV = """time,ego.x,car_1.x [km],car_1.on,car_1.mode,car_2.x,car_2.on,car_2.mode
0,0,0.010,true,SLOW,,,
1,1,0.011,false,FAST,9,true,FAST
2,2,,,,6,true,SLOW
3,3,,true,,7,false,FAST
4,4,0.012,true,SLOW,,,
"""
#: The same samples, in metres.
DATA = {
    "ego.x": [0, 1, 2, 3, 4],
    "car_1.x": [10, 11, None, None, 12],
    "car_1.on": [True, False, None, True, True],
    "car_1.mode": ["SLOW", "FAST", None, None, "SLOW"],
    "car_2.x": [None, 9, 6, 7, None],
    "car_2.on": [None, True, True, False, None],
    "car_2.mode": [None, "FAST", "SLOW", "FAST", None],
}


def values(out):
    return [float(json.loads(line)["robustness"]) for line in out.splitlines()]


@pytest.mark.parametrize("formula", FORMULAS)
def test_streams_and_files_give_the_same_values_while_members_come_and_go(run, write, formula):
    spec, trace = write("f.stl", STREAMED + f"require A: {formula}\n"), write("f.csv", CSV)
    whole = rtamt.load(spec).evaluate(DATA)
    streamed = run("monitor", spec, stdin=CSV)
    assert (streamed.code, streamed.err) == (0, "rtamt: note: stdin: car_1.x was converted from km to m\n")
    assert values(streamed.out) == whole.signal.values.tolist()
    checked = run("check", spec, trace, "--json")
    assert float(json.loads(checked.out)["robustness"]) == values(streamed.out)[0]


def test_keys_of_members_are_names_with_dots_or_nested_objects_and_what_is_left_out_is_absent(run, write):
    samples = [
        {
            "time": 0,
            "ego.x": 0,
            "car_1.x": 10,
            "car_1.on": False,
            "car_1.mode": "SLOW",
            "car_1.note": "unread",
        },
        {"time": 1, "ego": {"x": 1}, "car_1": {"x": 11, "on": True, "mode": 1}, "cat_7": {"x": 0}},
        {"time": 2, "ego.x": 2},
        {"time": 3, "ego.x": 3, "car_1": None, "car_9": {"x": "inf", "on": True, "mode": "FAST"}},
        {"time": 4, "ego.x": 4, "car_1.x": None, "car_1.on": True, "car_1.mode": "SLOW"},
    ]
    formula = "forall v in cars: v.x - ego.x > (if v.on and v.mode == FAST then 5 else 1)"
    spec = write("f.stl", f"{STREAMED}require A: {formula}\nrequire B: (count v in cars: v.on) <= 1\n")
    answer = run("monitor", spec, stdin="".join(json.dumps(sample) + "\n" for sample in samples))
    assert (answer.code, answer.err) == (0, "")
    found = [json.loads(line)["requirements"] for line in answer.out.splitlines()]
    assert [each["A"] for each in found] == [9.0, 5.0, "inf", "inf", "inf"]
    assert [each["B"] for each in found] == [1.0, 0.0, 1.0, 0.0, 1.0]


WRONG_LINES = [
    (
        {"eog": 1, "car_1.x": 5, "car_1.v": 1},
        "the data has no 'ego'; did you mean 'eog'? (signals: eog, car_1.x, car_1.v)",
    ),
    (
        {"ego": 1, "car_1.x": 5},
        "'car_1' has no 'v' at sample 1; give 'car_1.v', or leave out all fields of a member that is absent",
    ),
    (
        {"ego": 1, "car_1": {"note": 5}},
        "'car_1' has no 'x' at sample 1; give 'car_1.x', or leave out all fields of a member that is absent",
    ),
    ({"ego": 1, "car_1": {}}, "'car_1' has no field 'x' at sample 1: it is a dict"),
    ({"ego": 1, "car_1": {"x": "5", "v": 1}}, "'car_1.x' is \"5\", expected a number"),
]


@pytest.mark.parametrize(("sample", "message"), WRONG_LINES)
def test_a_line_with_an_unknown_key_or_a_member_without_a_field_is_one_sentence(run, sample, message):
    good = json.dumps({"ego": 1, "car_1": {"x": 5, "v": 1}}) + "\n"
    formula = 'group cars = "car_*"; forall v in cars: v.x - v.v > ego'
    answer = run("monitor", formula, "--keep-going", stdin=f"{good}{json.dumps(sample)}\n{good}")
    assert (answer.code, answer.err) == (2, f"rtamt: stdin, line 2: {message}\n")
    assert values(answer.out) == [3.0, 3.0]


WRONG_HEADERS = [
    (
        "time,ego.x",
        "stdin has no member of the group 'cars': no name matches \"car_*\" and a field, such as car_1.x; names: ego.x",
    ),
    (
        "time,ego.x,car_1.y",
        "stdin, line 1: 'car_1' is a member of the group 'cars' and has no 'x'; record 'car_1.x', or narrow the "
        'pattern "car_*"',
    ),
]


@pytest.mark.parametrize(("header", "message"), WRONG_HEADERS)
def test_a_header_without_members_or_without_a_field_is_one_sentence(run, header, message):
    answer = run("monitor", 'group cars = "car_*"; forall v in cars: v.x - ego.x > 5', stdin=f"{header}\n")
    assert (answer.code, answer.out, answer.err) == (2, "", f"rtamt: {message}\n")


@pytest.mark.parametrize(
    ("options", "spec", "what"),
    [
        (["--verdict", "eager"], "", "--verdict eager"),
        (["--verdict", "interval", "--time", "dense"], "", "--verdict interval"),
        (["--verdict", "causation"], "", "--verdict causation"),
        ([], "sample 1s hold\n", "'sample 1s hold'"),
    ],
)
def test_what_no_monitor_of_quantifiers_offers_is_one_sentence(run, options, spec, what):
    answer = run("monitor", f'{spec}group cars = "car_*"; forall v in cars: v.x > 1', *options)
    assert (answer.code, answer.out, answer.err) == (
        2,
        "",
        f"rtamt: the formula quantifies over 'cars', whose members come and go, and 'rtamt monitor' does not support "
        f"{what} for it: leave that out, or check recordings with 'rtamt check'\n",
    )


def test_the_future_of_members_has_an_end(run):
    answer = run("monitor", 'group cars = "car_*"; forall v in cars: eventually(v.x > 1)')
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("rtamt: 'eventually' without an upper bound needs the whole future")


def test_in_dense_time_null_and_an_empty_cell_end_the_presence_of_a_member(run):
    formula = 'group cars = "car_*"; forall v in cars: v.x - ego > 5'
    objects = ['{"time": 0, "ego": 0, "car_1.x": 30, "car_7": {"x": 14}}', '{"time": 1, "car_7": null}']
    lines = ["time,ego,car_1.x,car_7.x", "0,0,30,14", "1,0,30,"]
    for stdin, ends in (("\n".join([*objects, '{"time": 2, "ego": 0}']), 2.0), ("\n".join(lines), 1.0)):
        answer = run("monitor", formula, "--time", "dense", stdin=stdin)
        found = [json.loads(line) for line in answer.out.splitlines()]
        assert found[0] == {"time": 0.0, "robustness": 9.0}
        assert [each["robustness"] for each in found if each["time"] == 1.0] == [25.0]
        assert found[-1] == {"time": ends, "robustness": 25.0}


def test_an_unbounded_requirement_over_members_is_monitored_at_the_start(run):
    lines = ['{"ego": 0, "car_1.x": 30}', '{"ego": 12, "car_7.x": 14}', '{"ego": 24}']
    formula = 'group cars = "car_*"; always forall v in cars: v.x - ego > 5'
    found = [json.loads(line) for line in run("monitor", formula, stdin="\n".join(lines)).out.splitlines()]
    assert [each["status"] for each in found] == ["open", "violated since 1.0 s", "violated since 1.0 s"]
    assert found[-1] == {"lower": -3.0, "upper": -3.0, "status": "violated since 1.0 s", "final": True}


def test_bounds_of_every_instant_over_members(run):
    lines = ['{"car_1.x": 30}', '{"car_7.x": 14}', "{}"]
    formula = 'group cars = "car_*"; always[0:1] forall v in cars: v.x > 5'
    answer = run("monitor", formula, "--verdict", "interval", stdin="\n".join(lines))
    found = [json.loads(line) for line in answer.out.splitlines()]
    assert found[0] == {"time": 0.0, "lower": "-inf", "upper": 25.0, "final": False}
    assert {each["time"]: each["lower"] for each in found if each["final"]} == {
        0.0: 9.0,
        1.0: 9.0,
        2.0: "inf",
    }
