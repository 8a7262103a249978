"""Settings and formulas that ended in a traceback, or in an error that did not say what was wrong."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.language.operators import STL

BACKENDS = ["cpp", "python"]


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_bound_that_no_machine_can_keep(backend: str) -> None:
    spec = rtamt.parse("once[0:1e30] x", backend=backend)
    message = (
        "1000000000000000000000000000000 s is 1e+30 periods of 1 s, more than can be counted; "
        "shorten the bound, leave it open with inf, or choose a longer period (the period is the default; "
        "period=, or on the command line --period, sets it)\n"
        "  line 1, column 5:\n"
        "    once[0:1e30] x\n"
        "        ^^^^^^^^"
    )
    for call in (spec.monitor, lambda: spec.evaluate({"x": [1.0]})):
        with pytest.raises(rtamt.BoundError) as info:
            call()
        assert str(info.value) == message


def test_more_memory_than_there_is() -> None:
    with pytest.raises(rtamt.UsageError) as info:
        rtamt.parse("once[0:1e13] x").monitor()
    assert str(info.value) == (
        "the monitor needs 7.45e+04 GiB of memory, which this machine does not give; "
        "shorten the longest bound or lengthen the period"
    )


@pytest.mark.parametrize("tolerance", [-1, float("nan"), "a"])
def test_a_tolerance_that_is_none(tolerance: Any) -> None:
    for backend in BACKENDS:
        with pytest.raises(rtamt.UsageError) as info:
            rtamt.parse("x", backend=backend).monitor(tolerance=tolerance)
        assert str(info.value) == f"the tolerance is {tolerance!r}; give a fraction of the period, 0 or more"


@pytest.mark.parametrize("value", [float("nan"), "a", None])
def test_a_constant_that_is_no_number(value: Any) -> None:
    with pytest.raises(rtamt.UsageError) as info:
        rtamt.parse("x >= c", constants={"c": value})
    assert str(info.value) == f"the constant 'c' is {value!r}; give a number"


def test_a_sub_formula_over_what_was_not_read() -> None:
    result = rtamt.parse("x").evaluate({"x": [1.0, 2.0]})
    with pytest.raises(rtamt.UsageError) as info:
        result["z >= 1"]
    assert str(info.value) == (
        "'z >= 1' reads 'z', which the formula does not; the recording was read for x only"
    )


@pytest.mark.parametrize("reads", [{}, {"guards": ()}])
def test_what_has_no_rule_for_pastification_is_refused(reads: dict[str, Any]) -> None:
    once, always = STL["once"], STL["always"]
    coming = type(always)(
        "coming", ("coming",), always.fixity, 75, always.operands, always.result, "doc", "coming x", "{0}",
        always.definition, always.tense, always.bounds, **reads,
    )  # fmt: skip
    behind = type(once)(
        "behind", ("behind",), once.fixity, 75, once.operands, once.result, "doc", "behind x", "{0}",
        once.definition, once.tense, once.bounds, **reads,
    )  # fmt: skip
    language = STL.extend(coming, behind)
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse("coming[0:2] x", language=language).pastified()
    assert info.value.message == (
        "Cannot pastify 'coming': its record names no past twin; "
        "monitor the formula as it is, which needs no pastification"
    )
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse("behind[0:2](next x)", language=language).pastified()
    assert info.value.message == (
        "Cannot pastify 'behind': its record names no guards; "
        "monitor the formula as it is, which needs no pastification"
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_an_inner_name_in_a_message(time: str) -> None:
    data: Any = {"time": [0.0, 1.0], "x": [-1.0, -2.0]}
    with pytest.raises(rtamt.EvaluationError) as info:
        rtamt.parse("always(sqrt(eventually x) >= 0)").evaluate(data, time=time)
    where = "sample 0, time 0 s" if time == "discrete" else "time 0 s"
    assert str(info.value) == (
        f"'sqrt(eventually x)' has no value at {where}: it is 0/0, inf - inf, 0 * inf, "
        f"or a function outside its domain; change the formula or the data so that this cannot happen"
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_both_back_ends_report_the_same_for_an_operation_that_has_no_value(time: str) -> None:
    """The core told of 'x - y', without the last digits of the time; the definition of 'x >= y'."""
    timestamps, values = [1.7e9, 1.7e9 + 1], [1.0, np.inf]
    data: Any = {"time": timestamps, "x": values, "y": values}
    if time == "dense":
        data = {"x": (timestamps, values), "y": (timestamps, values)}
    where = ("sample 1, " if time == "discrete" else "") + "time 1700000001 s"
    for backend in BACKENDS:
        with pytest.raises(rtamt.EvaluationError) as info:
            rtamt.parse("always(x >= y)", backend=backend, time=time).evaluate(data)
        assert str(info.value) == (
            f"'x >= y' has no value at {where}: it is 0/0, inf - inf, 0 * inf, "
            f"or a function outside its domain; change the formula or the data so that this cannot happen"
        )
