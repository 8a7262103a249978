"""The paper's API in dense time: shapes, chunks, units, values, and every message in full."""

from __future__ import annotations

import copy
import sys
from math import inf, nan
from types import ModuleType

import numpy as np
import pytest

import rtamt
from rtamt.spec.stl.dense_time import specification
from tests.unit.compat.test_discrete import Message

OFFLINE = (rtamt.StlDenseTimeOfflineSpecification, rtamt.StlDenseTimeSpecification)
ONLINE = (rtamt.StlDenseTimeOnlineSpecification, rtamt.StlDenseTimeSpecification)


def declared(text, names="x y", cls=rtamt.StlDenseTimeSpecification, unit="s"):
    spec = cls()
    for name in names.split():
        spec.declare_var(name, "float")
    spec.unit = unit
    spec.spec = text
    spec.parse()
    return spec


def message_of(call, *args):
    with pytest.raises(rtamt.RTAMTException) as info:
        call(*args)
    return str(info.value).removeprefix("RTAMT Exception: ")


def test_all_names_are_there():
    assert rtamt.STLCTSpecification is rtamt.STLDenseTimeSpecification is rtamt.StlDenseTimeSpecification
    for name in (name for name in vars(specification) if name[:3].lower() == "stl"):
        assert getattr(specification, name) is getattr(rtamt, name)
        assert name in rtamt.__all__


def at(points, time):
    """Return the value of a signal that holds between its points."""
    return [value for begin, value in points if begin <= time][-1]


# ---- shapes ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cls", OFFLINE)
def test_offline_there_is_a_point_for_each_change_and_one_at_the_end(cls):
    spec = declared("x >= 3", cls=cls)
    robustness = spec.evaluate(["x", [[0, 5], [1, 5], [2.5, 4], [7, 4]]])
    assert robustness == [[0.0, 2.0], [2.5, 1.0], [7.0, 1.0]]
    assert {type(number) for point in robustness for number in point} == {float}


def test_offline_the_trace_is_from_the_latest_start_to_the_latest_end():
    spec = declared("x + y >= 0")
    assert spec.evaluate(["x", [[1, 1], [2, 2]]], ["y", [[0, 0], [9, 5]]]) == [
        [1.0, 1.0],
        [2.0, 2.0],
        [9.0, 7.0],
    ]


def test_samples_may_be_tuples_arrays_or_anything_that_gives_pairs():
    spec = declared("x >= 3")
    pairs = [(0, 5), (2, 4)]
    expected = [[0.0, 2.0], [2.0, 1.0]]
    for samples in (pairs, tuple(pairs), np.array(pairs), np.array(pairs, float), iter(pairs)):
        assert spec.evaluate(("x", samples)) == expected
        assert spec.get_value("x") == [[0.0, 5.0], [2.0, 4.0]]


def test_evaluate_changes_nothing_and_ignores_other_names():
    spec = declared("always[0:1](x >= 3)")
    data = [["x", [[0, 5], [2, 4]]], ["other", [[0, 1]]]]
    before = copy.deepcopy(data)
    assert spec.evaluate(*data) == [[0.0, 2.0], [1.0, 1.0], [2.0, 1.0]]
    assert data == before


@pytest.mark.parametrize("cls", ONLINE)
def test_online_every_update_tells_up_to_the_earliest_last_time(cls):
    spec = declared("x + y >= 0", cls=cls)
    assert spec.update(["x", [[0, 1], [2, 2]]]) == []
    assert spec.update(["y", [[0, 0], [1, 5]]]) == [[0.0, 1.0], [1.0, 6.0]]
    assert spec.update(["y", [[9, 5]]], ["x", []]) == [[2.0, 7.0]]
    assert spec.update() == []
    assert spec.update(["x", [[4, 2]]]) == [[4.0, 7.0]]


@pytest.mark.parametrize("text", ["once[0.5:2](x) and y", "x since[1:3] y", "historically[1:1](x + y)"])
def test_chunks_say_what_the_whole_says(text):
    x = [[0, 1], [0.7, -2], [1.5, 4], [3, 0], [4.25, 2], [6, 1]]
    y = [[0, 3], [1.5, -1], [2, 2], [5, 6], [6, 0]]
    whole = declared(text).update(["x", x], ["y", y])
    spec, parts = declared(text), []
    for i in range(6):
        parts += spec.update(["x", x[i : i + 1]], ["y", y[i : i + 1]])
    changes = [point for i, point in enumerate(parts) if i == 0 or point[1] != parts[i - 1][1]]
    assert changes == whole[: len(changes)]
    assert parts[-1] == whole[-1]
    assert whole[-1][0] == 6.0


@pytest.mark.parametrize("cls", ONLINE)
def test_reset_begins_anew(cls):
    spec = declared("once[0:2](x)", cls=cls)
    spec.reset()
    for _ in range(2):
        assert spec.update(["x", [[0, 5], [1, 3]]]) == [[0.0, 5.0], [1.0, 5.0]]
        assert spec.update(["x", [[4, 1]]]) == [[3.0, 3.0], [4.0, 3.0]]
        spec.reset()


def test_pastified_it_is_the_same_one_horizon_later():
    spec = declared("x until[0:2] y")
    x, y = ["x", [[0, 4], [3, -1], [9, -1]]], ["y", [[0, -5], [1.5, 2], [4, -3], [9, -3]]]
    offline = spec.evaluate(x, y)
    spec.pastify()
    online = spec.update(x, y)
    assert offline == [[0.0, 2.0], [4.0, -3.0], [9.0, -3.0]]
    assert [at(online, time + 2) for time in (0, 1, 3.9, 4, 7)] == [2.0, 2.0, 2.0, -3.0, -3.0]


# ---- units -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("unit", "each"), [("s", 0.001), ("ms", 1.0), ("us", 1000.0), ("ns", 1e6)])
def test_stamps_and_bounds_are_in_the_unit_of_the_specification(unit, each):
    spec = declared(f"once[0:{100 * each:.10g}](x)", unit=unit)
    points = [[0, 0], [1100 * each, 7], [1101 * each, 0], [2000 * each, 0]]
    expected = [[0.0, 0.0], [1100 * each, 7.0], [1201 * each, 0.0], [2000 * each, 0.0]]
    assert spec.evaluate(["x", points]) == pytest.approx(np.array(expected), rel=1e-15)
    assert spec.update(["x", points]) == spec.evaluate(["x", points])


def test_a_unit_set_after_parse_counts():
    spec = declared("eventually[0:100](x)")
    spec.unit = "ms"
    spec.pastify()
    spec.unit = "us"
    assert spec.spec_print() == "once[0,100us](x)"
    assert spec.update(["x", [[0, 7], [1, 0], [200, 0]]]) == [[0.0, 7.0], [101.0, 0.0], [200.0, 0.0]]


# ---- values ------------------------------------------------------------------------------------------


def test_values_of_subformulas_offline():
    spec = declared("low = x <= 3; once[0:1](low and y >= 2)")
    spec.evaluate(["x", [[0, 1], [2, 4]]], ["y", [[0, 5], [2, 5]]])
    assert spec.get_value("x") == [[0.0, 1.0], [2.0, 4.0]]
    assert spec.get_value("low") == spec.get_value("(x)<=(3.0)") == [[0.0, 2.0], [2.0, -1.0]]
    assert spec.get_value("out") == [[0.0, 2.0], [2.0, 2.0]]


def test_an_assertion_that_the_result_does_not_use_changes_nothing():
    spec = declared("late = y >= 1; x >= 3")
    assert spec.evaluate(["x", [[0, 5], [2, 4]]], ["y", [[1, 0], [9, 0]]]) == [[0.0, 2.0], [2.0, 1.0]]
    assert spec.get_value("late") == [[1.0, -1.0], [9.0, -1.0]]
    assert spec.evaluate(["x", [[0, 5]]]) == [[0.0, 2.0]]
    assert spec.update(["x", [[0, 5]]]) == [[0.0, 2.0]]


@pytest.mark.parametrize("compiled", [True, False])
def test_values_of_subformulas_online_are_what_the_update_made_known(monkeypatch, compiled):
    if not compiled:
        monkeypatch.setitem(sys.modules, "rtamt.engine._core", None)
        monkeypatch.delattr("rtamt.engine._core", raising=False)
    spec = declared("low = x <= 3; high = once[0:2](y >= 2); far = y >= 9; once[0:1](low and high)")
    assert spec.get_value("x") == 0.0
    spec.update(["x", [[0, 1], [2, 4]]])
    assert spec.get_value("low") == []
    assert spec.get_value("x") == [[0, 1.0], [2, 4.0]]
    spec.update(["y", [[0, 5], [1, 1], [4, 5]]])
    assert spec.get_value("x") == []
    assert spec.get_value("y") == [[0, 5.0], [1, 1.0], [4, 5.0]]
    assert spec.get_value("low") == spec.get_value("(x)<=(3.0)") == [[0.0, 2.0], [2.0, -1.0]]
    assert spec.get_value("high") == [[0.0, 3.0], [2.0, 3.0]]
    assert spec.get_value("far") == [[0.0, -4.0], [1.0, -8.0], [2.0, -8.0]]
    assert spec.get_value("9.0") == [[0.0, 9.0], [2.0, 9.0]]
    assert spec.get_value("out") == [[0.0, 2.0], [2.0, 2.0]]
    spec.update(["x", [[7.5, 5]]])
    assert spec.get_value("x") == [[7.5, 5.0]]
    assert spec.get_value("high") == [[3.0, -1.0], [4.0, 3.0]]
    assert spec.get_value("low") == [[4.0, -1.0]]
    spec.update()
    assert spec.get_value("low") == []
    spec.reset()
    assert message_of(spec.get_value, "low") == "'low' has no value yet; call update() or evaluate() first"


def test_an_assertion_over_other_variables_is_not_watched():
    spec = declared("late = y >= 1; ahead = eventually(x >= 1); x >= 3")
    spec.update(["x", [[0, 5]]])
    for name, text in (("late", "(y)>=(1.0)"), ("ahead", "eventually((x)>=(1.0))")):
        assert message_of(spec.get_value, name) == (
            f"'{text}' is no part of what is watched: the result, and past assertions that read no other "
            f"variables; evaluate the finished signals offline"
        )


def test_objects_are_read_and_written(monkeypatch):
    module = ModuleType("some_msgs")
    module.Message = Message
    monkeypatch.setitem(sys.modules, "some_msgs", module)
    spec = rtamt.StlDenseTimeSpecification()
    spec.import_module("some_msgs", "Message")
    spec.declare_var("req", "Message")
    spec.declare_var("rob", "Message")
    spec.spec = "rob.value = once(req.value >= 3)"
    spec.parse()
    points = [[0, Message(5.0)], [2, Message(1.0)]]
    assert spec.evaluate(["req", points]) == spec.update(["req", points]) == [[0.0, 2.0], [2.0, 2.0]]
    assert spec.get_value("rob").value == 2.0
    assert spec.get_value("req") is points[-1][1]


def test_the_definition_serves_where_the_core_cannot_be_loaded(monkeypatch):
    with_core = declared("once[0:1](x)").evaluate(["x", [[0, 5], [2, 4], [9, 3]]])
    monkeypatch.setitem(sys.modules, "rtamt.engine._core", None)
    monkeypatch.delattr("rtamt.engine._core", raising=False)
    spec = declared("once[0:1](x)")
    assert spec.evaluate(["x", [[0, 5], [2, 4], [9, 3]]]) == with_core
    assert spec.update(["x", [[0, 5], [2, 4], [9, 3]]]) == with_core
    assert with_core == [[0.0, 5.0], [3.0, 4.0], [9.0, 4.0]]


# ---- messages ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("dataset", "message"),
    [
        ([], "the data has no 'x'; signals: none"),
        ([["xx", []]], "the data has no 'x'; did you mean 'xx'? (signals: xx)"),
        (
            [{"x": 1}],
            "expected a name and samples for each variable, such as ['x', [[0.0, 5.0], [2.5, 1.0]]], "
            "got {'x': 1}",
        ),
        (
            [["x", [1, 2]]],
            "'x' is no dense signal: give a list of [time, value] pairs, such as [[0.0, 5.0], [2.5, 1.0]]",
        ),
        ([["x", [[0, 1]]], ["x", [[1, 1]]]], "'x' is given twice: give all its samples at once"),
        ([["x", [[0, "a"]]]], "'x' is 'a' at sample 0, expected a number"),
        ([["x", [["a", 0]]]], "the time of 'x' is 'a' at sample 0, expected a number"),
        ([["x", [[0, nan]]]], "'x' is NaN at sample 0, time 0 s: fill the gap or leave the sample out"),
        ([["x", [[inf, 1]]]], "the time of 'x' is inf at sample 0: give a finite time"),
        (
            [["x", [[2, 1], [1, 1]]]],
            "the time of 'x' does not increase at sample 1: 1 s comes after 2 s; sort the samples",
        ),
    ],
)
def test_messages_about_data(dataset, message):
    spec = declared("once[0:1](x)")
    assert message_of(spec.evaluate, *dataset) == message


def test_a_failed_update_leaves_the_monitor_as_it_was():
    spec = declared("once(x)")
    assert spec.update(["x", [[0, 5]]]) == [[0.0, 5.0]]
    assert message_of(spec.update, ["x", [[1, 9], [1, 9]]]) == (
        "'x' has two samples at 1 s (sample 2 and the one before, with ticks of 1 ns): keep one of them"
    )
    assert message_of(spec.update, ["q", []]) == "the formula has no variable 'q'; variables: x"
    assert spec.get_value("x") == [[0.0, 5.0]]
    assert spec.update(["x", [[1, 4]]]) == [[1.0, 5.0]]


@pytest.mark.parametrize("cls", ONLINE)
def test_unpastified_future_is_refused_before_the_data_is_looked_at(cls):
    spec = declared("x and always[0:2](y)", cls=cls)
    assert message_of(spec.update, "no data at all") == (
        "Always operator is not implemented in the STL online monitor. "
        "Call pastify() after parse(), or evaluate the finished trace offline\n"
        "  line 1, column 7:\n"
        "    x and always[0:2](y)\n"
        "          ^^^^^^^^^^^^^^"
    )


def test_unbounded_future_cannot_be_pastified():
    assert message_of(declared("always(x)").pastify) == (
        "Cannot pastify an unbounded always. Give it an upper bound, such as always[0:10]\n"
        "  line 1, column 1:\n"
        "    always(x)\n"
        "    ^^^^^^^^^"
    )


@pytest.mark.parametrize("name", ["prev", "next", "rise", "fall"])
@pytest.mark.parametrize("use", ["evaluate", "update", "final_update", "pastify"])
def test_what_counts_samples_is_read_and_has_no_value(name, use):
    spec = declared(f"y or {name}(x)")
    dataset = () if use == "pastify" else (["x", [[0, 1], [1, 2]]], ["y", [[0, 1], [1, 2]]])
    assert message_of(getattr(spec, use), *dataset) == (
        f"'{name}' means one sample away, which dense time does not have; "
        f"use a window such as once[0:1], or discrete time\n"
        f"  line 1, column 6:\n"
        f"    y or {name}(x)\n"
        f"         {'^' * len(f'{name}(x)')}"
    )


def test_an_assertion_that_counts_samples_does_not_keep_the_others_from_being_watched():
    spec = declared("a = prev(x); once(x)")
    assert spec.update(["x", [[0, 1], [1, 2]]]) == [[0, 1.0], [1, 2.0]]
    assert message_of(spec.get_value, "a").startswith("'previous(x)' is no part of what is watched")


def test_a_bound_finer_than_a_nanosecond_is_refused():
    assert message_of(declared, "once[0:0.5ns](x)").splitlines() == [
        "The operator bound must be a multiple of the resolution: 0.5 ns is not a whole number of ticks of 1 ns; "
        "change the bound or the tick",
        "  line 1, column 5:",
        "    once[0:0.5ns](x)",
        "        ^^^^^^^^^",
    ]


def test_a_formula_without_variables_has_no_time():
    message = (
        "the formula reads no variable, so that it has no instants in dense time: let it read a variable, or "
        "evaluate it in discrete time"
    )
    assert message_of(declared("true").evaluate) == message_of(declared("true").update) == message


def test_no_variable_is_called_time():
    assert message_of(declared, "time + x >= 0", "time x") == (
        "'time' means the timestamps; give the variable another name\n"
        "  line 1, column 1:\n"
        "    time + x >= 0\n"
        "    ^^^^"
    )


def test_before_parse():
    message = "no specification has been read; set spec and call parse() first"
    spec = rtamt.StlDenseTimeSpecification()
    assert message_of(spec.evaluate, ["x", [[0, 1]]]) == message_of(spec.update, ["x", [[0, 1]]]) == message


@pytest.mark.parametrize(
    "formula", ["x and y", "once[0:3](x) xor y", "historically(x) or y", "x since[1:2] y"]
)
def test_the_final_update_tells_all_that_offline_tells(formula):
    x, y = [[0, 1], [2, -3], [7, 4]], [[0, 2], [3, -1], [5, 2]]
    expected = declared(formula).evaluate(["x", x], ["y", y])
    spec = declared(formula)
    assert spec.final_update(["x", x], ["y", y]) == expected
    with pytest.raises(rtamt.RTAMTException, match="reset"):
        spec.update(["x", [[8, 0]]])
    spec.reset()
    told = spec.update(["x", x[:2]], ["y", y[:1]])
    told += spec.final_update(["x", x[2:]], ["y", y[1:]])
    assert {time: value for time, value in told if [time, value] in expected} == dict(expected)
    assert [time for time, _ in told] == sorted({time for time, _ in told})


def test_a_final_update_that_fails_takes_nothing():
    spec = declared("x and y")
    spec.update(["x", [[0, 1]]])
    with pytest.raises(rtamt.RTAMTException, match="'y' has no samples"):
        spec.final_update(["x", [[4, 3]]])
    assert spec.final_update(["x", [[2, 3]]], ["y", [[0, 2]]]) == [[0, 1.0], [2, 2.0]]
