"""Declared Booleans and enumerations in data: numbers, names of members, members of Python's ``enum``."""

from __future__ import annotations

import enum
import pickle
from math import inf

import numpy as np
import pytest
from matplotlib.figure import Figure

import rtamt
from rtamt.html_report.scene_data import data_of
from rtamt.html_report.store import Store
from rtamt.plot.scene import scene

MODES = "enum Mode { MANUAL, AUTO = 4, RTL } input Mode mode output bool p float x "


class Mode(enum.IntEnum):
    """Members are found by name: these values are others than the codes of the text."""

    MANUAL = 17
    AUTO = 18


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_booleans_and_equal_members_are_plus_or_minus_infinity(backend, time):
    spec = rtamt.parse(MODES + "(p -> mode == AUTO) and x > 3", backend=backend)
    data = {"p": [1, 1, 0], "mode": ["AUTO", "RTL", "RTL"], "x": [5, 5, 7]}
    if time == "dense":
        data = {name: ([0, 1, 2], values) for name, values in data.items()}
    assert spec.evaluate(data, time=time).signal.values.tolist() == [2, -inf, 4]


@pytest.mark.parametrize(
    "column",
    [
        ["MANUAL", "AUTO", 4, 0],
        [Mode.MANUAL, Mode.AUTO, Mode.AUTO, Mode.MANUAL],
        np.array(["MANUAL", "AUTO", "AUTO", "MANUAL"]),
        np.array(["MANUAL", "AUTO", 4, 0.0], object),
        np.array([0, 4, 4, 0], np.uint8),
    ],
)
def test_members_are_given_by_name_or_by_code(column):
    spec = rtamt.parse(MODES + "mode == AUTO")
    assert spec.evaluate({"mode": column}).signal.values.tolist() == [-inf, inf, inf, -inf]
    monitor = spec.monitor()
    assert [monitor.update(t, mode=value) for t, value in enumerate(column)] == [-inf, inf, inf, -inf]
    again = pickle.loads(pickle.dumps(spec.monitor()))
    assert [again.step(value) for value in column] == [-inf, inf, inf, -inf]
    assert spec.monitor().update_many({"mode": column}).values.tolist() == [-inf, inf, inf, -inf]


def test_an_unknown_code_equals_no_member():
    spec = rtamt.parse(MODES + "mode in {MANUAL, AUTO, RTL}")
    assert spec.evaluate({"mode": [7, 5]}).signal.values.tolist() == [-inf, inf]
    assert rtamt.parse(MODES + "mode != AUTO").evaluate({"mode": [7, 4]}).signal.values.tolist() == [
        inf,
        -inf,
    ]


def test_a_bool_is_1_or_0_as_a_number():
    spec = rtamt.parse(MODES + "p == 1; 2 * p >= 1")
    assert spec.evaluate({"p": [True, False]}).signal.values.tolist() == [0, -1]


def test_a_missing_member_leaves_bounds():
    result = rtamt.parse(MODES + "mode == AUTO").evaluate({"mode": ["AUTO", None]})
    assert [result.intervals.lower.tolist(), result.intervals.upper.tolist()] == [[inf, -inf], [inf, inf]]


@pytest.mark.parametrize("semantics", ["standard", "boolean", "output_robustness", "input_robustness"])
def test_members_and_booleans_are_their_own_truth_in_every_semantics(semantics):
    data = {"p": [1, 1, 0], "mode": ["AUTO", "RTL", "RTL"]}
    spec = rtamt.parse(MODES + "p -> mode == AUTO")
    assert spec.evaluate(data, semantics=semantics).signal.values.tolist() == [inf, -inf, inf]


def test_a_group_without_the_role_of_the_variable_is_zero_under_vacuity():
    spec = rtamt.parse(MODES + "p")
    assert spec.evaluate({"p": [1]}, semantics="input_vacuity").robustness == 0


def test_streams_take_members_by_name():
    spec = rtamt.parse(MODES + "always(mode == AUTO)")
    chunks = [{"mode": ["AUTO", "AUTO"]}, {"mode": ["RTL"]}]
    result = rtamt.check_stream(spec, chunks)
    assert (result.robustness, result.first_violation) == (-inf, 2.0)


def test_watched_booleans_are_formulas():
    spec = rtamt.parse(MODES + "flag = p; x > 3 and flag")
    monitor = spec.monitor(watch=["p", "flag", "x"])
    monitor.update(0, p=True, x=5)
    assert [monitor[name] for name in ("p", "flag", "x")] == [inf, inf, 5]


def test_if_keeps_the_type_of_its_branches():
    data = {"p": [1, 0], "mode": ["AUTO", "AUTO"]}
    assert rtamt.parse(MODES + "(if p then mode else RTL) == AUTO").evaluate(data).signal.values.tolist() == [
        inf,
        -inf,
    ]
    flags = {"p": [1, 0], "x": [5, 1]}
    spec = rtamt.parse(MODES + "if x > 3 then p else p")
    assert spec.evaluate(flags).signal.values.tolist() == [inf, -inf]


def test_explanations_name_members_and_booleans_instead_of_numbers():
    spec = rtamt.parse(MODES + "always(p -> mode == AUTO)")
    explanation = str(spec.evaluate({"p": [0, 1], "mode": ["AUTO", "RTL"]}).explain())
    assert "'p' holds at 1 s (p is true)" in explanation
    assert "'mode == AUTO' fails at 1 s (mode is RTL)" in explanation


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_picture_names_members_and_booleans_at_the_axis_instead_of_codes(time):
    data = {"p": [0, 1, 1], "mode": ["AUTO", 9, "RTL"], "x": [1, 2, 3]}
    if time == "dense":
        data = {name: ([0, 1, 2], values) for name, values in data.items()}
    figure = (
        rtamt.parse(MODES + "p -> mode == AUTO or x > 2.5").evaluate(data, time=time).plot(figure=Figure())
    )
    labels = [[label.get_text() for label in axis.get_yticklabels()] for axis in figure.axes[:3]]
    assert labels[:2] == [["false", "true"], ["AUTO", "RTL", "9"]]
    assert set(labels[2]).isdisjoint({"false", "true", "AUTO"})
    assert figure.axes[1].get_yticks().tolist() == [4, 5, 9]


def test_signals_of_different_types_in_one_panel_have_numbers_at_the_axis():
    figure = rtamt.parse(MODES + "p < x").evaluate({"p": [0, 1], "x": [2, 2]}).plot(figure=Figure())
    assert "true" not in [label.get_text() for label in figure.axes[0].get_yticklabels()]


def test_a_picture_of_a_time_without_samples_has_no_names():
    result = rtamt.parse(MODES + "always p").evaluate({"p": [1, 0]})
    figure = result.plot(start=0.25, end=0.75, figure=Figure())
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == []


def test_names_of_many_members_do_not_overlap_in_a_picture():
    members = ", ".join(f"M{i}" for i in range(40))
    spec = rtamt.parse(f"enum Many {{ {members} }} input Many m always(m != M3)")
    figure = spec.evaluate({"m": list(range(40))}).plot(figure=Figure())
    assert len(figure.axes[0].get_yticks()) <= 7


def test_a_report_has_the_names_of_members():
    store = Store()
    result = rtamt.parse(MODES + "p -> mode == AUTO").evaluate({"p": [0, 1], "mode": ["AUTO", "RTL"]})
    panels = data_of(scene(result), store)["panels"]
    assert [panel["lines"][0]["names"] for panel in panels] == [
        {"0": "false", "1": "true"},
        {"0": "MANUAL", "4": "AUTO", "5": "RTL"},
    ]


def test_rtamt_classes_keep_numbers():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.spec = "enum Mode { MANUAL, AUTO = 4 }\nMode mode\nbool p\nalways(p and mode == AUTO)"
    spec.parse()
    assert spec.evaluate({"time": [0, 1], "p": [1, 0.5], "mode": [4, 4]}) == [[0, 0.5], [1, 0.5]]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("delay[1](mode) == AUTO", [-inf, -inf, inf]),
        ("delay[1](mode, RTL) in {RTL, AUTO}", [inf, -inf, inf]),
        ("ahead[1](mode) != MANUAL", [inf, inf, inf]),
        ("held(mode, p) == MANUAL", [inf, inf, inf]),
        ("delay[1](p)", [inf, inf, -inf]),
        ("held(p, mode == AUTO, p)", [inf, -inf, -inf]),
    ],
)
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_delay_ahead_and_held_keep_the_type(text, expected, backend):
    data = {"mode": ["MANUAL", "AUTO", "RTL"], "p": [1, 0, 0]}
    spec = rtamt.parse(MODES + text, backend=backend)
    assert spec.evaluate({name: data[name] for name in spec.input_names}).signal.values.tolist() == expected


def test_an_explanation_names_the_member_of_a_set_that_decides():
    spec = rtamt.parse(MODES + "always(mode in {AUTO, RTL})")
    report = str(spec.evaluate({"mode": ["AUTO", "AUTO"]}).explain())
    assert "'mode == AUTO' holds" in report
    assert "{" not in report.partition("cause")[2]
