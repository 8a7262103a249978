"""Specifications and results that could not be copied, compared or kept."""

from __future__ import annotations

import copy
import pickle
from typing import Any

import numpy as np
import pytest

import rtamt


def test_a_specification_can_be_copied_and_sent_to_another_process() -> None:
    spec = rtamt.parse("const float c = 2; low = x <= c; always[0:5] low and x >= d", constants={"d": 1})
    spec.evaluate({"x": [1, 2]})
    for again in (pickle.loads(pickle.dumps(spec)), copy.deepcopy(spec)):
        assert again.formula == spec.formula
        assert again.evaluate({"x": [1, 2]}).robustness == 0
        assert hash(again) != 0


def test_ten_thousand_conjuncts_can_be_shown_and_copied() -> None:
    spec = rtamt.parse(" and ".join(["x >= 1"] * 10_000))
    assert len(repr(spec)) > 10_000
    assert pickle.loads(pickle.dumps(spec)).formula == spec.formula


def test_signals_and_results_can_be_compared() -> None:
    result = rtamt.parse("x").evaluate({"x": [1.0, 2.0]})
    assert result.signal == result.signal
    assert result != rtamt.parse("x").evaluate({"x": [1.0, 2.0]})


def test_writing_into_a_result_changes_no_other() -> None:
    result = rtamt.parse("x").evaluate({"time": [0.0, 1.0], "x": [1.0, 2.0]})
    with pytest.raises(ValueError, match="read-only"):
        result.signal.times[:] = 99
    np.testing.assert_array_equal(result["x"].times, [0.0, 1.0])


AGAIN = [lambda it: pickle.loads(pickle.dumps(it)), copy.deepcopy]


@pytest.mark.parametrize("again", AGAIN)
@pytest.mark.parametrize("text", ["always(x >= 3)", "require A: always(x >= 3); require B: always(x <= 9)"])
def test_a_result_that_a_notebook_has_shown_can_still_be_pickled(text: str, again: Any) -> None:
    result = rtamt.parse(text).evaluate({"x": [5, 4]})
    shown = result._repr_html_()
    copied = again(result)
    assert copied._repr_html_() == shown
    assert copied.requirements.keys() == result.requirements.keys()
    with pytest.raises(TypeError):
        copied.requirements["C"] = copied


@pytest.mark.parametrize("again", AGAIN)
def test_a_result_of_requirements_that_start_at_different_times_can_be_pickled(again: Any) -> None:
    spec = rtamt.parse("require A: always(x >= 3); require B: always(y >= 1)", time="dense")
    result = spec.evaluate({"x": ([0, 1], [4, 5]), "y": ([0.5, 1], [3, 5])})
    copied = again(result)
    assert copied.robustness == result.robustness == 1
    assert {name: part.robustness for name, part in copied.requirements.items()} == {"A": 1, "B": 2}


@pytest.mark.parametrize("again", AGAIN)
@pytest.mark.parametrize("x", [np.array([[5.0, 4], [2, 7]]), np.array([[5, 4], [2, 7]], object)])
def test_the_results_of_a_batch_of_arrays_can_be_pickled(x: Any, again: Any) -> None:
    batch = rtamt.parse("eventually[0:1](x >= 3)").evaluate_batch({"x": x})
    copied = again(batch)
    np.testing.assert_array_equal(copied.signals, batch.signals)
    np.testing.assert_array_equal(copied.satisfied, [True, True])
    assert copied[1].signal.values.tolist() == [4, 4]


@pytest.mark.parametrize("again", AGAIN)
def test_a_compiled_program_can_be_pickled(again: Any) -> None:
    program = rtamt.parse("parameter float c = 3; always[0:2](x >= c)").compile(period=1)
    assert again(program).to_bytes() == program.to_bytes()
