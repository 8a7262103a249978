"""A program that left Python gives what the monitor in Python gives, to the last bit, in both time domains."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from rtamt.compiler.program import Program
from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.engine.discrete.monitor import Monitor
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, fold
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.semantics import SEMANTICS, apply_semantics, boolean
from rtamt.signals.dense import Dense
from rtamt.signals.discrete import Discrete
from rtamt.verdicts.standalone import carried_program
from tests.support import c_api
from tests.support.strategies import dense_chunkings, dense_traces, formulas, traces

if TYPE_CHECKING:
    from rtamt.signals.time_domain_interface import TimeDomain

ONE = Fraction(1)
SAMPLES, TICKS = Discrete(ONE), Dense(ONE)


def compile_requirement(
    formula: Formula, domain: TimeDomain = SAMPLES, applied: Formula | None = None
) -> bytes:
    return carried_program(formula, domain, applied=applied).to_bytes()


def draw_with_semantics(data: st.DataObject, formula: Formula) -> Formula:
    """Return the formula under any semantics, any of its variables being inputs."""
    inputs = data.draw(st.sets(st.sampled_from(("x", "y"))))
    roles = {name: "input" for name in variables(formula) if name in inputs}
    return apply_semantics(formula, data.draw(st.sampled_from(tuple(SEMANTICS))), roles)


def bits(values: Any) -> list[int]:
    """Return doubles as integers: 0.0 and -0.0 differ."""
    return np.array(values, np.float64).view(np.int64).tolist()


def known_bits(value: float | None) -> list[int] | None:
    """Return the same of a value that need not be known."""
    return None if value is None else bits(value)


def rows_of(formula: Formula, columns: dict[str, Any]) -> list[tuple[float, ...]]:
    names = variables(formula)
    return [tuple(columns[name][i] for name in names) for i in range(len(columns["x"]))]


@settings(max_examples=50)
@given(st.data())
def test_samples_in_the_same_bits_out(data: st.DataObject) -> None:
    formula, columns = data.draw(formulas()), data.draw(traces(infinite=True))
    rows = rows_of(formula, columns)
    judged = draw_with_semantics(data, formula)
    code = compile_requirement(formula, applied=judged)
    here, there, truth = Monitor(judged), c_api.Monitor(code), Monitor(boolean(formula))
    cut = data.draw(st.integers(0, len(rows)))
    for i, row in enumerate(rows):
        if i == cut:  # a state can go to another monitor
            state, there = there.save(), c_api.Monitor(code)
            there.restore(state)
        try:
            expected = here.step(*row)
            named = dict(zip(here.input_names, row, strict=True))
            holds = truth.step(*(named[name] for name in truth.input_names))
        except EvaluationError as error:
            # Why an operator has no value is in the operator table, which a program leaves behind.
            where = str(error).rpartition(": ")[0]
            with pytest.raises(c_api.RefusedError, match=re.escape(where)):
                there.step(row)
            return
        got = there.step(row)
        assert known_bits(got[0]) == known_bits(expected)
        assert known_bits(got[1]) == known_bits(holds)
    try:
        rest = here.finish()
    except EvaluationError:
        return
    assert bits(there.finish()[1]) == bits(rest.values)
    there.reset()
    first = Monitor(judged).step(*rows[0])
    assert known_bits(there.step(rows[0])[0]) == known_bits(first)


@settings(max_examples=50)
@given(st.data())
def test_events_in_the_same_events_out(data: st.DataObject) -> None:
    formula = data.draw(formulas(discrete=False))
    names = variables(formula)
    assume(names)
    trace = {name: column for name, column in data.draw(dense_traces()).items() if name in names}
    updates = data.draw(dense_chunkings(trace))
    judged = draw_with_semantics(data, formula)
    code = compile_requirement(formula, TICKS, judged)
    here, there = DenseMonitor(judged, TICKS), c_api.Monitor(code)
    cut = data.draw(st.integers(0, len(updates)))
    try:
        for i, update in enumerate(updates):
            if i == cut:
                state, there = there.save(), c_api.Monitor(code)
                there.restore(state)
            samples = [
                (names.index(name), int(tick), float(value))
                for name, column in update.items()
                for tick, value in zip(*column, strict=True)
            ]
            seconds = {name: (times.astype(float), values) for name, (times, values) in update.items()}
            assert_same_steps(there.push(samples), here.update_many(seconds))
        assert_same_steps(there.finish(), here.finish())
    except (EvaluationError, c_api.RefusedError):
        assume(False)


def assert_same_steps(got: tuple[Any, Any], expected: Any) -> None:
    """The monitor in Python tells the last known instant too, where nothing changes."""
    told = dict(zip(expected.times.tolist(), bits(expected.values), strict=True))
    changes = dict(zip(got[0].tolist(), bits(got[1]), strict=True))
    assert changes.items() <= told.items()
    extra = {time: value for time, value in told.items() if time not in changes}
    assert len(extra) <= 1
    if changes and extra:
        assert list(extra.values()) == [list(changes.values())[-1]]


@settings(max_examples=50)
@given(st.data())
def test_what_is_written_is_read(data: st.DataObject) -> None:
    domain = data.draw(st.sampled_from((SAMPLES, TICKS)))
    formula = data.draw(formulas(discrete=domain == SAMPLES))
    assume(variables(formula))
    program = carried_program(formula, domain)
    code = program.to_bytes()
    read = Program.from_bytes(code)
    assert read.to_bytes() == code
    assert read.disassemble() == program.disassemble()
    assert read.metadata == program.metadata


@settings(max_examples=50)
@given(st.data())
def test_a_parameter_has_the_value_that_is_set(data: st.DataObject) -> None:
    formula, columns = data.draw(formulas()), data.draw(traces())
    named = fold(formula, name_finite_numbers)
    program = carried_program(named, SAMPLES)
    names = list(program.metadata.parameters)
    values = {name: data.draw(st.integers(-6, 6)) / 2 for name in names}

    def set_value(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Const) and node.name in values:
            return Const(values[node.name])
        return Apply(node.op, args, node.interval) if isinstance(node, Apply) else node

    here, there = Monitor(fold(named, set_value)), c_api.Monitor(program.to_bytes())
    for index, name in enumerate(names):
        there.set_parameter(index, values[name])
    order = here.input_names
    for i in range(len(columns["x"])):
        row = [columns[name][i] for name in order]
        try:
            expected = here.step(*row)
        except EvaluationError:
            return
        assert known_bits(there.step(row)[0]) == known_bits(expected)


def name_finite_numbers(node: Formula, args: tuple[Formula, ...]) -> Formula:
    if isinstance(node, Const) and np.isfinite(node.value):
        return Const(node.value, name=f"c{node.value}")
    return Apply(node.op, args, node.interval) if isinstance(node, Apply) else node


def test_a_part_of_an_operator_without_a_value_is_called_by_the_name_of_the_operator() -> None:
    """The sum below an integral was "Instruction 1"."""
    formula = parse_formula("integral[0:1](x) >= 0")
    monitor = c_api.Monitor(compile_requirement(formula))
    monitor.step((-np.inf,))
    with pytest.raises(c_api.RefusedError, match=r"'integral\[0:1\]\(x\)' has no value at sample 1"):
        monitor.step((np.inf,))
