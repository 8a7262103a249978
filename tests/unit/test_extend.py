"""Operators of the user's own: by their definition alone, made fast in Python, and what is said when they fail."""

from __future__ import annotations

import inspect
import re
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.compiler.plan import compile_program
from rtamt.extend import (
    QUARTERS,
    STL,
    Blocks,
    Bounds,
    Compiled,
    Fixity,
    Language,
    Operator,
    Sort,
    Steps,
    Tense,
    get_cmake_dir,
    get_include,
)
from rtamt.rewrite.desugar import desugar

F, N = Sort.FORMULA, Sort.NUMBER


def avg(x: Any, a: int, b: int) -> Any:
    return np.array([x[max(0, t - b) : t - a + 1].mean() if t >= a else 0.0 for t in range(len(x))])


AVG = Operator(
    "avg", ("avg",), Fixity.PREFIX, 75, (F,), F, "The mean over the window behind.", "avg[0:2](x >= 3)",
    definition=avg, tense=Tense.PAST, bounds=Bounds.REQUIRED,
)  # fmt: skip


def flips(t: int, x: Steps, a: int, b: int) -> float:
    return float(sum(t - b < c <= t - a for c in x.times[1:]))


FLIPS = Operator(
    "flips", ("flips",), Fixity.PREFIX, 115, (N,), N, "Changes in the window behind.", "flips[0:2] x <= 1",
    definition=lambda x, a, b: np.array(
        [sum(x[s] != x[s - 1] for s in range(max(1, t - b + 1), t - a + 1)) for t in range(len(x))], float
    ),
    dense=flips, tense=Tense.PAST, bounds=Bounds.REQUIRED,
)  # fmt: skip
BETWEEN = Operator(
    "between", ("between",), Fixity.FUNCTION, 200, (N, N, N), N, "Held between two.", "between(x, 0, 1) > 0",
    definition=lambda x, low, high: x.clip(low, high),
)  # fmt: skip


def parsed(text: str, *operators: Operator, **more: Any) -> rtamt.Specification:
    return rtamt.parse(text, language=STL.extend(*operators), **more)


def test_a_definition_alone_runs_beside_compiled_operators() -> None:
    spec = parsed("always[0:1](avg[0:2](x >= 0) or y > 5)", AVG)
    data = {"x": [0, 3, 6, 9, 3], "y": [0, 0, 9, 0, 0]}
    assert spec.evaluate(data).signal.values.tolist() == [0, 1.5, 4, 6, 6]
    monitor = spec.monitor()
    known = [monitor.update(i, x=x, y=y) for i, (x, y) in enumerate(zip(*data.values(), strict=True))]
    assert known == [None, 0, 1.5, 4, 6]
    assert monitor.finish().values.tolist() == [6]


def test_a_function_of_three_numbers_runs_in_dense_time() -> None:
    spec = parsed("once[0:1](between(x, 0, y) >= 1)", BETWEEN, time="dense")
    data = {"x": ([0, 2.0, 4.0], [5, -5, 5]), "y": ([0, 3.0], [2, 3])}
    signal = spec.evaluate(data).signal
    assert list(zip(signal.times, signal.values, strict=True)) == [(0, 1), (3, -1), (4, 2)]


def test_a_dense_definition_runs_beside_compiled_operators() -> None:
    spec = parsed("historically[0:1](flips[0:2] x <= 1)", FLIPS, time="dense")
    data = {"x": ([0, 1.0, 2.0, 6.0], [5, -5, 5, 4])}
    signal = spec.evaluate(data).signal
    assert list(zip(signal.times, signal.values, strict=True)) == [
        (0, 1),
        (1, 0),
        (2, -1),
        (4, 0),
        (5, 1),
        (6, 0),
    ]
    monitor = spec.monitor(time="dense")
    told = [monitor.update(t, x=v) for t, v in zip(*data["x"], strict=True)] + [monitor.finish()]
    assert [v for s in told for t, v in zip(s.times, s.values, strict=True) if t in (0, 1, 2, 4, 5, 6)] == [
        1, 0, -1, 0, 1, 0,
    ]  # fmt: skip


def test_without_a_dense_definition_dense_time_refuses_on_both_back_ends() -> None:
    for backend in ("cpp", "python"):
        with pytest.raises(rtamt.UsageError) as info:
            parsed("avg[0:2] x", AVG, time="dense", backend=backend).evaluate({"x": [[0, 1.0]]})
        assert str(info.value) == (
            "'avg' has no meaning in dense time; give its record a dense definition (dense=...) or an "
            "expansion, or use discrete time"
        )


def test_unbounded_future_runs_by_the_definition_offline() -> None:
    later = replace(STL["eventually"], name="later", spellings=("later",), kernel=None)
    for time in ("discrete", "dense"):
        spec = parsed("historically[1:1](later[2:inf] x)", later, time=time)
        data: Any = {"x": [[0, 1.0], [1, 5.0], [2, 2.0], [3, 4.0], [4, 0.0]]}
        if time == "discrete":
            data = {"x": [1, 5, 2, 4, 0]}
        values = spec.evaluate(data).signal.values
        expected = parsed("historically[1:1](eventually[2:inf] x)", time=time).evaluate(data)
        np.testing.assert_array_equal(values, expected.signal.values)
    text = "always later x"
    assert parsed(text, later).evaluate({"x": [1, 5, 2]}).robustness == 2


def test_a_derived_operator_is_one_entry() -> None:
    nearly = Operator(
        "nearly", ("nearly",), Fixity.PREFIX, 75, (F,), F, "Within a second.", "nearly (x >= 3)",
        expansion=lambda a, _i: STL["eventually"](
            a, interval=rtamt.parse("eventually[0:1] x").formula.interval
        ),
    )  # fmt: skip
    for backend in ("cpp", "python"):
        spec = parsed("nearly(x >= 3) and y > 0", nearly, backend=backend)
        assert str(spec) == "nearly(x >= 3) and y > 0"
        assert spec.horizon == 1
        assert str(spec.pastified()) == "once[0:1](x >= 3) and once[1:1](y > 0)"
        assert spec.evaluate({"x": [1, 5, 1], "y": [1, 1, 9]}).signal.values.tolist() == [1, 1, -2]
        monitor = spec.monitor()
        assert [monitor.update(0, x=1, y=1), monitor.update(1, x=5, y=1)] == [None, 1]
    assert spec.formula.latex() == r"\mathrm{nearly} (\mathrm{x} \geq 3) \wedge y > 0".replace(
        r"\mathrm{x}", "x"
    )


class Cumulative:
    """The sum so far, in place: what a checkpoint must take back."""

    def __init__(self) -> None:
        self.total = [0.0]

    def push(self, x: Any) -> Any:
        known = []
        for value in x:
            if value == 13:
                raise ValueError("thirteen")
            self.total[0] += value
            known.append(self.total[0])
        return known


TOTAL = Operator(
    "total", ("total",), Fixity.FUNCTION, 200, (N,), N, "The sum so far.", "total(x) >= 0",
    definition=np.cumsum, tense=Tense.PAST, reach=None, kernel=Blocks(discrete=Cumulative),
)  # fmt: skip


def test_a_class_over_blocks_keeps_its_state_and_a_failed_update_takes_it_back() -> None:
    monitor = parsed("total(x) + sqrt(y) >= 0", TOTAL).monitor()
    assert monitor.update(0, x=1, y=4) == 3
    with pytest.raises(rtamt.EvaluationError) as info:
        monitor.update(1, x=13, y=4)
    assert str(info.value) == (
        "the operator 'total' failed in 'total(x)': ValueError: thirteen; mend the operator"
    )
    assert isinstance(info.value.__cause__, ValueError)
    with pytest.raises(rtamt.EvaluationError):  # after total has taken its sample
        monitor.update(1, x=2, y=-4)
    with pytest.raises(rtamt.EvaluationError):  # more than one block, the last one bad
        monitor.update_many({"x": [1.0] * 999 + [13], "y": [0.0] * 1000})
    assert monitor.update(1, x=2, y=4) == 5
    monitor.reset()
    assert monitor.update(0, x=2, y=4) == 4


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_what_a_definition_raises_is_told_with_its_cause(backend: str, time: str) -> None:
    broken = replace(BETWEEN, definition=lambda x, _low, _high: x[99])
    spec = parsed("between(x, 0, 1)", broken, backend=backend, time=time)
    data: Any = {"x": [1.0, 2.0]} if time == "discrete" else {"x": ([0.0, 1.0], [1.0, 2.0])}
    with pytest.raises(rtamt.EvaluationError) as info:
        spec.evaluate(data)
    assert str(info.value).startswith(
        "the operator 'between' failed in 'between(x, 0, 1)': IndexError: index 99 is out"
    )
    assert isinstance(info.value.__cause__, IndexError)


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_definition_of_the_wrong_shape_is_told(backend: str) -> None:
    broken = replace(BETWEEN, definition=lambda x, _low, _high: x[:1])
    with pytest.raises(rtamt.UsageError) as info:
        parsed("between(x, 0, 1)", broken, backend=backend).evaluate({"x": [1.0, 2.0]})
    assert str(info.value) == (
        "the definition of 'between' returned an array of shape (1,) for 2 samples; it must return one value a "
        "sample, shape (2,)"
    )


def test_nan_from_an_operator_names_it_and_the_time() -> None:
    broken = replace(BETWEEN, definition=lambda x, _low, _high: np.where(x > 1, np.nan, x))
    with pytest.raises(rtamt.EvaluationError) as info:
        parsed("always between(x, 0, 1)", broken).evaluate({"time": [0, 0.5], "x": [1.0, 2.0]})
    assert str(info.value) == (
        "the operator 'between' gave NaN: 'between(x, 0, 1)' has no value at sample 1, time 0.5 s; mend the operator, "
        "or change the formula or the data so that this cannot happen"
    )
    monitor = parsed("between(x, 0, 1)", broken, time="dense").monitor()
    monitor.update(0.0, x=1.0)
    with pytest.raises(rtamt.EvaluationError) as info:
        monitor.update(0.5, x=2.0)
    assert str(info.value).startswith(
        "the operator 'between' gave NaN: 'between(x, 0, 1)' has no value at time 0.5 s;"
    )


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_complex_numbers_and_text_from_an_operator_are_not_taken_for_numbers(backend: str, time: str) -> None:
    data: Any = {"x": [1.0, -4.0]} if time == "discrete" else {"x": ([0.0, 1.0], [1.0, -4.0])}
    for gives, kind in ((np.emath.sqrt, "complex128"), (lambda x: x.astype(str), "<U32")):
        broken = replace(BETWEEN, definition=lambda x, _low, _high, gives=gives: gives(x))
        with pytest.raises(rtamt.EvaluationError) as info:
            parsed("between(x, 0, 1)", broken, backend=backend, time=time).evaluate(data)
        assert str(info.value) == (
            f"the operator 'between' gave values of type {kind} in 'between(x, 0, 1)', "
            f"expected real numbers; mend the operator"
        )


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_verdict_that_an_operator_does_not_give_names_the_predicate_as_it_was_written(backend: str) -> None:
    broken = replace(BETWEEN, operands=(F, N, N), result=F, definition=lambda x, _low, _high: x - x)
    for text in ("between(x < 3, 0, 1)", "between(3 != x, 0, 1)", "between(x >= 3, 0, 1)"):
        spec = parsed(text, broken, backend=backend, semantics="boolean")
        with pytest.raises(rtamt.EvaluationError) as info:
            spec.monitor().update(0, x=1)
        assert str(info.value).startswith(
            f"the operator 'between' gave NaN: '{text}' has no value at sample 0, time 0 s"
        )


def test_a_class_that_gives_too_few_values_is_told() -> None:
    class Idle:
        def push(self, x: Any) -> Any:
            return x[1:]

    with pytest.raises(rtamt.EvaluationError) as info:
        parsed("total(x)", replace(TOTAL, kernel=Blocks(discrete=Idle))).evaluate({"x": [1.0, 2.0]})
    assert str(info.value) == (
        "the kernel of 'total' returned an array of shape (1,), expected (2,): after 2 samples of its operands "
        "2 values are known, and it has given 0"
    )


def test_a_class_that_cannot_be_made_is_told() -> None:
    class Picky:
        def __init__(self) -> None:
            raise RuntimeError("not today")

    spec = parsed("total(x)", replace(TOTAL, kernel=Blocks(discrete=Picky)))
    for make in (spec.monitor, lambda: spec.evaluate({"x": [1.0]})):
        with pytest.raises(rtamt.EvaluationError) as info:
            make()
        assert str(info.value) == (
            "the operator 'total' failed in 'total(x)': RuntimeError: not today; mend the operator"
        )


def test_a_program_with_a_call_lists_it_and_does_not_serialise() -> None:
    spec = parsed("(avg[0:2] x) >= 3", AVG)
    program = compile_program([desugar(spec.formula)], Fraction(1, 10))
    assert "call avg[0:20] %0" in program.disassemble()
    with pytest.raises(rtamt.UsageError) as info:
        program.to_bytes()
    assert str(info.value) == (
        "the program calls 'avg', which the core does not know: bytes cannot carry an operator's own code; "
        "expand it into the operators of STL, or run the program in Python"
    )


def test_a_library_that_is_not_there_is_told() -> None:
    for library, kernel, message in [
        ("./nowhere.so", "avg", "the kernel of 'avg' cannot be loaded: ./nowhere.so: cannot open"),
        (
            "libc.so.6",
            "avg_",
            "the kernel of 'avg' cannot be loaded: 'libc.so.6' has no kernel 'avg_'; name it",
        ),
    ]:
        compiled = replace(AVG, kernel=Compiled(library, discrete=kernel))
        with pytest.raises(rtamt.UsageError) as info:
            parsed("avg[0:2] x", compiled).evaluate({"x": [1.0]})
        assert str(info.value).startswith(message)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            {"definition": None},
            "the operator 'avg' has no definition: give a function on arrays, or an expansion",
        ),
        ({"definition": 3}, "the definition of 'avg' is no function: give one on arrays"),
        (
            {"kernel": Blocks(), "expansion": lambda a, _i: a},
            "the operator 'avg' has an expansion and a kernel: keep one of them",
        ),
        (
            {"definition": None, "kernel": Blocks(), "expansion": lambda a, _i: a},
            "the operator 'avg' has a kernel and no definition that it could be held against: give one, "
            "a function on arrays",
        ),
        (
            {"bounds": Bounds.NONE},
            "the operator 'avg' reads the past and takes no interval: say how far it reads, reach= a number of "
            "samples, or None for all of them",
        ),
        (
            {"bounds": Bounds.NONE, "reach": 2, "dense": flips},
            "the operator 'avg' has a dense definition and a reach in samples, which dense time does not have: "
            "give it an interval, or reach=None",
        ),
        (
            {"tense": Tense.NONE},
            "the operator 'avg' takes an interval and reads one instant only: say where it reads, "
            "tense=Tense.PAST or Tense.FUTURE",
        ),
    ],
)
def test_a_record_that_cannot_be_an_operator_is_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(rtamt.UsageError) as info:
        Language.of([replace(AVG, **change)])
    assert str(info.value) == message


def test_the_header_and_the_cmake_package_are_installed() -> None:
    from pathlib import Path

    assert Path(get_include(), "rtamt", "kernel.hpp").is_file()
    assert Path(get_cmake_dir(), "rtamt-config.cmake").is_file()
    assert QUARTERS == 4


def test_the_signature_of_parse_does_not_print_every_operator_of_the_language():
    assert len(str(inspect.signature(rtamt.parse))) < 1000
    assert re.fullmatch(r"<language of \d+ operators>", repr(STL))
