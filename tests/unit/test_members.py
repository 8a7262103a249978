"""Quantifiers over the members of a group: values computed by hand, the trace of each member has gaps."""

from __future__ import annotations

import copy
import pickle
from types import SimpleNamespace

import numpy as np
import pytest

import rtamt
from rtamt.errors import TraceError, UsageError

inf = float("inf")

#: One car, present at samples 0, 2, 3 and 5.
X = [1, None, 5, 2, None, 4]

WORKED = [
    ("forall v in cars: always[0:1](v.x > 0)", [1, inf, 2, 2, inf, 4]),
    ("exists v in cars: once[1:2](v.x > 0)", [-inf, -inf, 1, 5, -inf, 2]),
    ("forall v in cars: prev(v.x > 0)", [inf, inf, inf, 5, inf, inf]),
    ("exists v in cars: s_next(v.x > 0)", [-inf, -inf, 2, -inf, -inf, -inf]),
    ("forall v in cars: delay[1](v.x) > 0", [1, inf, 1, 5, inf, 1]),
    ("forall v in cars: delay(v.x, 7) > 0", [7, inf, 7, 5, inf, 7]),
    ("forall v in cars: diff(v.x) > 0", [0, inf, 4, -3, inf, 3]),
    ("forall v in cars: rate(v.x) > 0", [0, inf, 4, -3, inf, 3]),
    ("forall v in cars: sum[0:1](v.x) > 0", [1, inf, 5, 7, inf, 4]),
    ("forall v in cars: mean[1:1](v.x) > 0", [1, inf, 1, 5, inf, 1]),
    ("forall v in cars: mean[0:3](v.x) > 0", [1, inf, 3, 8 / 3, inf, 11 / 3]),
    ("forall v in cars: maximum[1:2](v.x) > 0", [-inf, inf, 1, 5, inf, 2]),
    ("forall v in cars: held(v.x, v.x > 3) > 0", [1, inf, 5, 5, inf, 4]),
    ("count v in cars: duration[0:1](v.x > 1) >= 2", [0, 0, 0, 1, 0, 0]),
    ("forall v in cars: count(v.x > 3) >= 2", [-2, inf, -1, -1, inf, 0]),
    ("exists v in cars: rise(v.x > 3)", [-2, -inf, 2, -2, -inf, 1]),
    ("exists v in cars: fall(v.x > 3)", [2, -inf, -2, 1, -inf, -1]),
    ("forall v in cars: ahead[1](v.x) > 0", [1, inf, 2, 2, inf, 4]),
    ("forall v in cars: v.x > 0 until[0:2] v.x > 4", [1, inf, 1, 0, inf, 0]),
    ("forall v in cars: v.x > 0 since v.x > 4", [-3, inf, 1, 1, inf, 1]),
    ("forall v in cars: atleast[0:2](50%, v.x > 2)", [3, inf, 3, 2, inf, inf]),
    ("forall v in cars: atleast[0:2](2, v.x > 2)", [-1, inf, 0, 0, inf, -inf]),
    ("forall v in cars: 1 / (v.x - 1 / 1) < 9", [-inf, inf, 8.75, 8, inf, 9 - 1 / 3]),
    ("always exists v in cars: v.x > 0", [-inf] * 5 + [4]),
    ("eventually[0:1] exists v in cars: v.x > 0", [1, 5, 5, 2, 4, 4]),
    ("count v in cars: true", [1, 0, 1, 1, 0, 1]),
]


@pytest.mark.parametrize(("text", "expected"), WORKED)
@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_windows_delays_and_held_values_are_cut_to_where_a_member_is_present(text, expected, backend):
    spec = rtamt.parse(f'group cars = "car_*" {{ float x }}; {text}', backend=backend)
    np.testing.assert_array_equal(spec.evaluate({"car_1.x": X}).signal.values, expected)


DENSE = [
    ("forall v in cars: eventually[0:1](v.x > ego)", [(0, 1), (1, inf), (2, 5), (3, 2), (6, 2)]),
    ("exists v in cars: once[1:2](v.x > ego)", [(0, -inf), (2, 1), (3, 5), (5, 2), (6, 2)]),
    ("forall v in cars: delay[1](v.x) > ego", [(0, 1), (1, inf), (2, 1), (3, 5), (4, 2), (6, 2)]),
    ("forall v in cars: held(v.x, v.x > 3) > ego", [(0, 1), (1, inf), (2, 5), (6, 5)]),
    ("forall v in cars: historically(v.x > ego)", [(0, 1), (1, inf), (2, 1), (6, 1)]),
    ("count v in cars: v.x > ego", [(0, 1), (1, 0), (2, 1), (6, 1)]),
]


@pytest.mark.parametrize(("text", "expected"), DENSE)
def test_in_dense_time_a_missing_sample_ends_presence_until_the_next_one(text, expected):
    spec = rtamt.parse(f'group cars = "car_*"; {text}', time="dense")
    data = {"ego": ([0, 6], [0, 0]), "car_1.x": ([0, 1, 2, 3], [1, None, 5, 2])}
    assert list(spec.evaluate(data).signal.points()) == expected


VERDICTS = [
    ("always(forall v in cars: v.x > ego)", 7),
    ("not eventually(exists v in cars: v.x <= ego)", 0),
    ("always[0:20](ego < 9 -> not exists v in cars: v.x <= ego)", 7),
]


@pytest.mark.parametrize(("text", "violated"), VERDICTS, ids=[text for text, _ in VERDICTS])
def test_a_violation_by_a_member_after_the_last_sample_of_the_variables_was_satisfied(text, violated):
    spec = rtamt.parse(f'group cars = "car_*"; {text}', time="dense")
    data = {"ego": ([0, 5], [0, 0]), "car_1.x": ([0, 7, 8], [4, -3, 4])}
    result = spec.evaluate(data)
    assert (result.robustness, result.satisfied) == (-3, False)
    assert rtamt.first_violation(result) == violated
    if text.startswith("always("):
        (episode,) = result.episodes()
        assert (episode.begin, episode.end, episode.worst) == (7, 8, -3)
    (row,) = rtamt.Suite(spec).evaluate(data)
    assert (row.robustness, row.satisfied, row.first_violation) == (-3, False, violated)


def test_each_of_several_requirements_reads_its_own_groups():
    spec = rtamt.parse(
        'group cars = "car_*"; group dogs = "dog_*"\n'
        "require A: always(forall v in cars: v.x > 0)\n"
        "require B: always(forall v in dogs: v.x > 0)\n"
        "require C: always(ego > 0)"
    )
    data = {"ego": [1, 2], "car_1.x": [3, 4]}
    assert {name: list(each.groups) for name, each in spec.requirements.items()} == {
        "A": ["cars"],
        "B": ["dogs"],
        "C": [],
    }
    assert [spec.requirements[name].evaluate(data).robustness for name in "AC"] == [3, 1]
    with pytest.raises(TraceError, match="no member of the group 'dogs'"):
        spec.requirements["B"].evaluate(data)
    rows = rtamt.Suite(spec).evaluate(data).rows
    assert [row.robustness for row in rows] == [3, None, 1]


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("read", [lambda data: data, rtamt.read], ids=["mapping", "trace"])
def test_a_field_that_is_read_outside_of_quantifiers_was_1_where_it_is_missing(time, read):
    spec = rtamt.parse('group cars = "car_*"; always(forall v in cars: v.x - car_1.x >= -0.5)', time=time)
    data = {"time": [0, 1, 2], "car_1.x": [5, None, 5], "car_2.x": [5, 9, 5]}
    with pytest.raises(TraceError) as caught:
        spec.evaluate(read(data))
    assert str(caught.value) == (
        "'car_1.x' is missing at sample 1, and the formula reads it outside of its quantifiers, where it needs a "
        "value: fill the gap, or read it of the members alone"
    )
    data = {"time": [0, 1, 2], "car_1.x": [5, 4, 5], "car_2.x": [5, None, 5]}
    assert spec.evaluate(read(data)).robustness == 0.5


def test_a_field_is_its_own_value_outside_of_quantifiers_also_where_its_member_is_absent():
    spec = rtamt.parse(
        'group cars = "car_*" { float x; float y }; always(car_1.x >= 3 or exists v in cars: v.y > 9)'
    )
    data = {"time": [0, 1], "car_1.x": [5, 4], "car_1.y": [5, None], "car_2.x": [5, 5], "car_2.y": [0, 0]}
    assert spec.evaluate(data).robustness == 1


def test_a_variable_that_is_recorded_as_a_field_of_a_member_took_the_member_away():
    spec = rtamt.parse(
        'input float e = "car_1.x"; group cars = "car_*"; always(forall v in cars: v.x - e >= 0.5)'
    )
    with pytest.raises(UsageError) as caught:
        spec.evaluate({"car_1.x": [0, 0], "car_2.x": [5, 5]})
    with pytest.raises(UsageError, match=r"read 'car_1\.x' in formulas in place of 'e'"):
        spec.monitor(period=1)
    assert str(caught.value) == (
        "'car_1.x' is the recorded name of 'e', and a field of 'car_1' of the group 'cars': read 'car_1.x' in formulas "
        "in place of 'e'"
    )


def test_members_move_neither_the_start_nor_the_end_of_a_dense_trace():
    spec = rtamt.parse('group cars = "car_*"; forall v in cars: v.x > ego', time="dense")
    data = {"ego": ([1, 5], [0, 0]), "car_1.x": ([3, 9], [4, 2]), "car_2.x": ([0, 2], [7, None])}
    assert list(spec.evaluate(data).signal.points()) == [(1, 7), (2, inf), (3, 4), (5, 4)]


def test_two_quantifiers_range_over_pairs_at_the_instants_of_both():
    spec = rtamt.parse(
        'group cars = "car_*"; forall v in cars: forall w in cars where v != w: once(v.x - w.x > 2)'
    )
    # b is at samples 1 to 3, a everywhere: a - b is 1, 2, 6, b - a the negation.
    data = {"car_a.x": [9, 3, 5, 8, 0], "car_b.x": [None, 2, 3, 2, None]}
    assert spec.evaluate(data).signal.values.tolist() == [inf, -3, -3, -3, inf]
    alone = {"car_a.x": [9, 3]}
    assert spec.evaluate(alone).robustness == inf


def test_a_quantifier_inside_another_ones_window_means_the_members_of_that_instant():
    spec = rtamt.parse('group cars = "car_*"; forall v in cars: next(exists w in cars: w.x > v.x)')
    data = {"car_a.x": [1, 3, None], "car_b.x": [None, 7, 5]}
    # a: at 1, w is a or b: 4; at 2 a is absent, and next is weak. b: at 2 only b itself.
    assert spec.evaluate(data).signal.values.tolist() == [4, 0, inf]


def test_a_member_is_present_where_all_its_fields_are():
    spec = rtamt.parse('group cars = "car_*"; count v in cars: v.x > 0 or v.y > 0')
    assert spec.evaluate({"car_1.x": [1, None, 1], "car_1.y": [1, 1, None]}).signal.values.tolist() == [
        1,
        0,
        0,
    ]
    declared = rtamt.parse('group cars = "car_*" { float x; float y }; count v in cars: v.x > 0')
    assert declared.evaluate({"car_1.x": [1, 1], "car_1.y": [1, None]}).signal.values.tolist() == [1, 0]


def test_members_may_be_objects_and_fields_may_have_types():
    text = 'enum Mode { OFF, ON } group cars = "car_*" { float x; bool ok; Mode mode }; '
    spec = rtamt.parse(text + "count v in cars: v.ok and v.mode == ON and v.x > 0")
    car = [SimpleNamespace(x=1.0, ok=True, mode="ON"), None, SimpleNamespace(x=1.0, ok=False, mode="ON")]
    assert spec.evaluate({"car_1": car}).signal.values.tolist() == [1, 0, 0]


def test_an_operation_without_a_value_is_no_error_where_the_member_is_absent():
    spec = rtamt.parse('group cars = "car_*"; forall v in cars: 1 / ego - 1 / ego < v.x')
    data = {"ego": [0.5, 0, 2], "car_1.x": [3, None, 5]}
    assert spec.evaluate(data).signal.values.tolist() == [3, inf, 5]
    with pytest.raises(rtamt.EvaluationError):
        spec.evaluate({**data, "car_1.x": [3, 4, 5]})


def test_a_member_has_the_role_of_its_group():
    text = 'group cars = "car_*"; forall v in cars: once(v.x >= 3) -> ego >= 2'
    data = {"car_1.x": [5, None, 1], "ego": [1, 1, 1]}
    values = {}
    for role in ("input ", "output "):
        spec = rtamt.parse(f"float ego {role}{text}")
        values[role] = spec.evaluate(data, semantics="output_robustness").signal.values.tolist()
    assert values == {"input ": [-1, inf, -1], "output ": [-1, inf, -1]}
    vacuous = rtamt.parse(f"float ego input {text}").evaluate(data, semantics="input_vacuity").signal.values
    assert vacuous.tolist() == [0, inf, 0]


def test_explanations_name_the_member():
    spec = rtamt.parse('group cars = "car_*"; always forall v in cars: v.x - ego > 5')
    result = spec.evaluate({"ego": [0, 0, 0], "car_3.x": [9, None, 2], "car_4.x": [7, 8, 9]})
    explanation = str(result.explain())
    assert "'car_3.x - ego > 5' is -3" in explanation
    assert "v.x" not in explanation


def test_results_and_specifications_over_members_are_copied_and_pickled():
    spec = rtamt.parse(
        'parameter float gap = 5  group cars = "car_*"; require R1: always forall v in cars: v.x > gap'
    )
    result = spec.evaluate({"car_1.x": [9, None, 7]})
    for twin in (pickle.loads(pickle.dumps(result)), copy.deepcopy(result)):
        assert twin.robustness == 2
        assert twin["count v in cars: v.x > 8"].values.tolist() == [1, 0, 0]
        assert list(twin.requirements) == ["R1"]
    over = result.specification.with_parameters(gap=1)
    assert over.evaluate({"car_1.x": [9, 9], "valid(car_1)": [1, 1]}).robustness == 8


def test_missing_samples_of_other_variables_still_make_an_interval():
    spec = rtamt.parse('group cars = "car_*"; forall v in cars: v.x > ego')
    result = spec.evaluate({"ego": [None, 1], "car_1.x": [3, None]}, ranges={"ego": (0, 2)})
    assert (result.interval.lower, result.interval.upper) == (1.0, 3.0)
    assert result.intervals.lower.tolist() == [1.0, inf]


def test_several_recordings_may_have_different_members():
    spec = rtamt.parse('group cars = "car_*"; count v in cars: v.x > 0')
    assert spec.evaluate({"car_1.x": [1, 2]}).signal.values.tolist() == [1, 1]
    assert spec.evaluate({"car_1.x": [1, 2], "car_2.x": [0, 2]}).signal.values.tolist() == [1, 2]


def test_the_pattern_of_a_log_file_matches_instances_in_brackets():
    spec = rtamt.parse(
        'group batteries = "battery_status[*]" { float voltage_v [V] }; always forall b in batteries: b.voltage_v > 14'
    )
    data = {
        "battery_status[0].voltage_v": [15, 16],
        "battery_status[1].voltage_v": [15.5, 14.5],
        "battery.voltage_v": [1, 1],
    }
    assert spec.evaluate(data).robustness == 0.5


WRONG = [
    (
        {"ego": [1]},
        "the data has no member of the group 'cars': no name matches \"car_*\" and a field, such as car_1.x; "
        "names: ego",
    ),
    (
        {"car_1.x": [1], "car_1.v": [1], "car_2.x": [1]},
        "'car_2' is a member of the group 'cars' and has no 'v'; record 'car_2.v', or narrow the pattern \"car_*\"",
    ),
    ({"car_1.x": [1, float("nan")], "car_1.v": [1, 1]}, "'car_1.x' is NaN at sample 1, time 1 s"),
]


@pytest.mark.parametrize(("data", "message"), WRONG)
def test_what_is_wrong_with_members_is_one_sentence(data, message):
    spec = rtamt.parse('group cars = "car_*"; forall v in cars: v.x > v.v')
    with pytest.raises(TraceError) as error:
        spec.evaluate(data)
    assert str(error.value).startswith(message)


def test_a_boolean_field_is_true_or_false_also_where_nothing_else_has_a_type():
    spec = rtamt.parse('group cars = "car_*" { float x; bool ok }; always forall v in cars: v.ok -> v.x > 3')
    assert spec.evaluate({"car_1.x": [None, 1], "car_1.ok": [None, True]}).robustness == -2
    assert (
        rtamt.parse('group cars = "car_*" { bool ok }; exists v in cars: v.ok')
        .evaluate({"car_1.ok": [1, 0]})
        .robustness
        == inf
    )


def test_missing_samples_of_any_container_end_presence():
    pd, pa, pl = (pytest.importorskip(name) for name in ("pandas", "pyarrow", "polars"))
    spec = rtamt.parse('group cars = "car_*"; forall v in cars: v.x > ego')
    data = {"time": [0.0, 1.0, 2.0], "ego": [0.0, 0.0, 0.0], "car_1.x": [1.0, None, 3.0]}
    frame = pd.DataFrame({**data, "car_1.x": pd.array(data["car_1.x"], dtype="Float64")})
    masked = {**data, "car_1.x": np.ma.masked_array([1.0, 2.0, 3.0], [False, True, False])}
    for given in (data, frame, pl.DataFrame(data), rtamt.read(pa.table(data)), masked):
        assert spec.evaluate(given).signal.values.tolist() == [1, inf, 3]
        assert list(spec.evaluate(given, time="dense").signal.points()) == [(0, 1), (1, inf), (2, 3)]
    assert frame["car_1.x"].isna().tolist() == [False, True, False]


def test_rtamts_classes_reject_groups():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.spec = 'group cars = "car_*"; out = forall v in cars: v.x > 3'
    with pytest.raises(Exception, match="RTAMT's classes have no groups such as 'cars'"):
        spec.parse()


def test_the_only_member_of_a_group_has_no_pair_and_still_has_a_trace_in_dense_time():
    apart = 'group cars = "car_*"; forall v in cars: forall w in cars where v != w: abs(v.x - w.x) > '
    alone = {"car_1.x": [(0, 1.0), (2, 3.0)]}
    assert rtamt.parse(apart + "1", time="dense").evaluate(alone).signal.points() == [(0, inf), (2, inf)]
    to_y = rtamt.parse(apart + "y", time="dense").evaluate({"y": [(1, 1.0), (5, 1.0)], **alone})
    assert to_y.signal.points() == [(1, inf), (5, inf)]
