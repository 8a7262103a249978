"""A program of bounds that left Python gives what the monitor at the start of the trace gives, to the last bit."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.compiler.program import Program, records_of
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Var, fold
from rtamt.language.printing.printer import to_text
from rtamt.verdicts.early.at_start import StartMonitor
from tests.support import c_api
from tests.support.strategies import formulas, traces


def _continued(monitor, code, how):
    """Return the monitor, or one of the same program that goes on from its state."""
    if not how:
        return monitor
    twin = c_api.Monitor(code)
    twin.restore(monitor.save())
    return twin


@settings(max_examples=60)
@given(formulas(unbounded_future=True), traces(max_size=15), st.data())
def test_a_program_of_bounds_gives_the_bits_of_the_monitor(formula, columns, data):
    spec = rtamt.parse(to_text(formula), period=1)
    assume(spec.input_names)
    program = spec.compile(verdict="interval")
    code = program.to_bytes()
    assert Program.from_bytes(code).to_bytes() == code
    there, here = c_api.Monitor(code), StartMonitor(spec)
    for i in range(len(columns[spec.input_names[0]])):
        row = [float(columns[name][i]) for name in spec.input_names]
        there = _continued(there, code, data.draw(st.booleans()))
        try:
            here.update(i, **dict(zip(spec.input_names, row, strict=True)))
        except EvaluationError:
            with pytest.raises(c_api.RefusedError) as error:
                there.step(row, 4)
            assert error.value.args[0] == c_api.UNDEFINED
            return
        known = here.interval()
        decided = None if here.decided_at is None else float(here.decided_at)
        verdict = None if here.satisfied is None else float("inf") if here.satisfied else -float("inf")
        assert there.step(row, 4) == [known.lower, known.upper, verdict, decided]
    try:
        here.finish()
    except EvaluationError:
        return
    there.finish()
    at_end = here.interval()
    assert [there.last_output(k)[1].tolist() for k in (0, 1)] == [[at_end.lower], [at_end.upper]]
    expected = {None: [], True: [float("inf")], False: [-float("inf")]}[here.satisfied]
    assert there.last_output(2)[1].tolist() == expected


@settings(max_examples=30)
@given(formulas(unbounded_future=True), traces(max_size=8), st.data())
def test_a_parameter_of_a_program_of_bounds_has_the_value_that_is_set(formula, columns, data):
    values = {}

    def named(node, args):
        if isinstance(node, Const):
            name = f"p{len(values)}"
            values[name] = node.value
            return Var(name)
        return Apply(node.op, args, node.interval) if isinstance(node, Apply) else node

    text = to_text(fold(formula, named))
    names = variables(formula)
    assume(values and names)
    # All have one value at first: two parameters are two, also where their values are equal.
    declared = "".join(f"parameter float {name} = 1 " for name in values) + "".join(
        f"float {n} " for n in names
    )
    program = rtamt.parse(declared + text, period=1).compile(verdict="interval")
    there = c_api.Monitor(program.to_bytes())
    for index, name in enumerate(program.metadata.parameters):
        there.set_parameter(index, values[name])
    here = c_api.Monitor(rtamt.parse(to_text(formula), period=1).compile(verdict="interval").to_bytes())
    if data.draw(st.booleans()):
        there = _continued(there, program.to_bytes(), True)
    for i in range(len(columns[names[0]])):
        row = [float(columns[name][i]) for name in names]
        told = [_stepped(monitor, row) for monitor in (here, there)]
        assert told[0] == told[1]
        if not isinstance(told[0], list):
            return


def _stepped(monitor, row):
    try:
        return monitor.step(row, 4)
    except c_api.RefusedError as error:
        return error.args[0]


def test_a_graph_that_does_not_fit_its_instructions_is_refused():
    program = rtamt.parse("always(x > 3)").compile(verdict="interval")
    for instructions in (program.instructions[:-1], (*program.instructions, program.instructions[-1])):
        last = (len(instructions) - 1,) * len(program.outputs)
        metadata = replace(program.metadata, meanings={})
        code = replace(program, records=records_of(instructions), outputs=last, metadata=metadata).to_bytes()
        with pytest.raises(c_api.RefusedError, match="its graph is damaged"):
            c_api.Monitor(code)


def test_a_reset_begins_a_new_trace():
    code = rtamt.parse("always(x > 0)", period=Fraction(1, 10)).compile(verdict="interval").to_bytes()
    monitor = c_api.Monitor(code)
    assert monitor.step([3.0], 4) == [-float("inf"), 3.0, None, None]
    assert monitor.step([-1.0], 4) == [-float("inf"), -1.0, -float("inf"), 0.1]
    monitor.reset()
    assert monitor.step([2.0], 4) == [-float("inf"), 2.0, None, None]


def test_an_operation_without_a_value_is_named_and_changes_nothing():
    monitor = c_api.Monitor(rtamt.parse("always(ln(x) > 0)").compile(verdict="interval").to_bytes())
    before = monitor.step([3.0], 4)
    with pytest.raises(c_api.RefusedError, match=r"'ln\(x\)' has no value at sample 1"):
        monitor.step([-1.0], 4)
    assert monitor.step([3.0], 4) == before


def test_memory_stays_the_same_however_long_the_trace():
    monitor = c_api.Monitor(
        rtamt.parse("always(x > 0 -> eventually[0:9] y > 0)").compile(verdict="interval").to_bytes()
    )
    sizes = set()
    for i in range(2000):
        monitor.step([float(i % 3), float(i % 5)], 4)
        if i > 500 and i % 60 == 0:
            sizes.add(len(monitor.save()))
    assert max(sizes) < 20_000
