"""Specifications and results that could not be copied, compared or kept."""

from __future__ import annotations

import copy
import pickle

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
