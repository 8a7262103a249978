"""The Simulink block of matlab/, in Octave, against a double of what Simulink hands to a block."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.engine.discrete.monitor import Monitor
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.signals.discrete import Discrete
from rtamt.verdicts.standalone import carried_program
from tests.integration.matlab.octave import DOUBLES, ROOT, needs_octave, run_octave
from tests.support.strategies import formulas, traces

BLOCK = "block = RuntimeBlock({{{}}});"
RESPONSE = "const float limit = 3  always[0:0.2]((req >= limit) -> eventually[0:0.3](gnt / scale >= limit))"
PERIOD = 0.1
Octave = Callable[..., str]


@pytest.fixture
def octave(installed, tmp_path) -> Octave:
    return lambda script: run_octave(script, tmp_path, installed, DOUBLES)


def bits(values: Any) -> list[int]:
    return np.array(values, np.float64).view(np.int64).tolist()


def expected_of(text: str, names: list[str], rows: np.ndarray) -> list[float]:
    monitor = rtamt.parse(text).monitor(period=PERIOD)
    told = [
        monitor.update(i * PERIOD, **dict(zip(names, row, strict=True)))
        for i, row in enumerate(rows.tolist())
    ]
    return [np.nan if value is None else value for value in told]


def wave(n: int) -> np.ndarray:
    rng = np.random.default_rng(11)
    return np.column_stack([rng.normal(4, 3, n), rng.uniform(0.5, 2, n), rng.normal(3, 2, n)])


FILES = """
rows = reshape(fread(fopen('rows', 'r'), Inf, 'double'), 3, [])';
write = @(values) fwrite(fopen('values', 'w'), values, 'double');
times = (0:size(rows, 1) - 1)' * 0.1;
"""


@pytest.mark.parametrize("how", ["text", "file", "program", "offline"])
@needs_octave
def test_the_block_gives_the_bits_of_the_monitor_in_python(octave, tmp_path, how):
    rows = wave(40)
    rows.tofile(tmp_path / "rows")
    names = ["gnt", "scale", "req"]
    (tmp_path / "spec.stl").write_text(RESPONSE, encoding="utf-8")
    (tmp_path / "spec.rtamt").write_bytes(rtamt.parse(RESPONSE, period=PERIOD).compile().to_bytes())
    spec = {"file": "spec.stl", "program": "spec.rtamt"}.get(how, RESPONSE)
    expected = expected_of(RESPONSE, names, rows)
    if how == "offline":
        octave(FILES + f"write(rtamt_robustness('{spec}', 'gnt, scale, req', 0.1, rows));")
        columns = {name: rows[:, i] for i, name in enumerate(names)}
        result = rtamt.parse(RESPONSE, period=PERIOD).evaluate(columns)
        expected = list(result.signal.values)
    else:
        octave(
            FILES
            + BLOCK.format(f"'{spec}', {{'gnt', 'scale', 'req'}}, 0.1")
            + "write(simulate(block, times, rows));"
        )
        assert np.isnan(expected[4])
        assert not np.isnan(expected[5])
    assert bits(np.fromfile(tmp_path / "values")) == bits(expected)


@needs_octave
def test_minor_steps_and_algebraic_loops_do_not_advance_the_state(octave, tmp_path):
    rows = wave(40)
    rows.tofile(tmp_path / "rows")
    octave(
        FILES
        + BLOCK.format(f"'{RESPONSE}', 'gnt, scale, req', -1")
        + "write(simulate_roughly(block, times, rows));"
    )
    expected = expected_of(RESPONSE, ["gnt", "scale", "req"], rows)
    assert bits(np.fromfile(tmp_path / "values")) == bits(expected)


#: A program, the names of the elements of the input, samples, and what Python says of them.
Case = tuple[bytes, list[str], np.ndarray, list[float]]


@st.composite
def cases(draw: st.DrawFn) -> Case | None:
    """Draw a case; None where the block has nothing to do."""
    formula, columns = draw(formulas()), draw(traces(infinite=True))
    names = draw(st.permutations(variables(formula)))
    monitor = Monitor(formula)
    expected: list[float] = []
    rows = [{name: float(columns[name][i]) for name in names} for i in range(len(columns["x"]))]
    for row in rows:
        try:
            value = monitor.step(*(row[name] for name in monitor.input_names))
        except EvaluationError:
            break
        expected.append(np.nan if value is None else value)
    if not names or len(expected) < 2:
        return None
    taken = np.array([[row[name] for name in names] for row in rows[: len(expected)]])
    program = carried_program(formula, Discrete(period=1)).to_bytes()
    return program, list(names), taken, expected


MANY = """
for i = 0:{last}
    names = strsplit(fileread(sprintf('%d.names', i)), ' ');
    rows = reshape(fread(fopen(sprintf('%d.rows', i), 'r'), Inf, 'double'), numel(names), [])';
    block = RuntimeBlock({{sprintf('%d.rtamt', i), names, 1}});
    values = simulate(block, 0:size(rows, 1) - 1, rows);
    fwrite(fopen(sprintf('%d.values', i), 'w'), values, 'double');
    fclose('all');
end
"""


@settings(max_examples=3, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(st.lists(cases(), min_size=15, max_size=25))
@needs_octave
def test_whatever_the_requirement_is(octave, tmp_path, drawn):
    many = [case for case in drawn if case is not None]
    for i, (program, names, rows, _) in enumerate(many):
        (tmp_path / f"{i}.rtamt").write_bytes(program)
        (tmp_path / f"{i}.names").write_text(" ".join(names), encoding="utf-8")
        rows.tofile(tmp_path / f"{i}.rows")
    octave(MANY.format(last=len(many) - 1))
    for i, (_, _, _, expected) in enumerate(many):
        assert bits(np.fromfile(tmp_path / f"{i}.values")) == bits(expected)


@needs_octave
def test_the_block_takes_part_in_the_callbacks_of_the_engine(octave):
    said = octave(
        BLOCK.format("'always[0:1](x >= 3)', 'x', 1")
        + "disp(simulate(block, 0:2, [5; 4; 2])'); disp(strjoin(block.Called));"
        "disp([block.InputPort(1).DirectFeedthrough, block.SampleTimes]); disp(block.Dwork(1).Data);"
    )
    assert said.split("\n")[:4] == [
        "   NaN     1    -1",
        "SetInputPortDimensions PostPropagationSetup Start InitializeConditions "
        "Outputs Update Outputs Update Outputs Update Terminate",
        "   1   1   0",
        "0",
    ]


@needs_octave
def test_named_constants_are_set_beside_the_specification_and_outlast_a_reset(octave):
    said = octave(
        "spec = 'const float limit = 3  const float scale = 1  historically(x >= limit * scale)';"
        "block = RuntimeBlock({{spec, 'scale', 2, 'limit', single(2.5)}, 'x', 1}); block.prepare(1, -1);"
        "disp(block.step(0, 9)); block.call('InitializeConditions'); disp(block.step(0, 8));"
        "block.call('Terminate'); disp(rtamt_robustness({spec, 'limit', -1}, 'x', 1, [5; 3])');"
    )
    assert said.split() == ["4", "3", "6", "4"]


@needs_octave
def test_initial_conditions_begin_a_new_trace_at_any_time_and_two_blocks_are_two_monitors(octave):
    said = octave(
        "a = RuntimeBlock({'historically(x >= 3)', 'x', 0.1}); a.prepare(1, -1);"
        "b = RuntimeBlock({'historically(x >= 3)', 'x', 0.1}); b.prepare(1, -1);"
        "disp([a.step(0, 1), b.step(0, 7), a.step(0.1, 9), b.step(0.1, 8)]);"
        "a.call('InitializeConditions');"  # a subsystem that is enabled again
        "disp([a.step(0.7, 9), b.step(0.2, 6), a.step(0.8, 8)]);"
        "a.call('Terminate'); disp(b.step(0.3, 5)); b.call('Terminate');"
        "b.call('Start'); b.call('InitializeConditions'); disp(b.step(0, 4)); b.call('Terminate');"
    )
    assert said.split() == ["-2", "4", "-2", "4", "6", "3", "5", "2", "1"]


@needs_octave
def test_after_an_error_the_monitor_is_as_it_was(octave):
    said = octave(
        BLOCK.format("'always[0:1](x / y >= 1)', 'x y', 1") + "block.prepare(2, -1); block.step(0, [3 1]);"
        "for bad = [NaN 0; 1 0], try, block.step(1, bad), catch failure, disp(failure.message), end, end\n"
        "disp(block.step(1, [2 1]))"
    )
    assert said.splitlines() == [
        "'x' is NaN at sample 1, time 1 s: fill the gap or leave the sample out.",
        "'x / y' has no value at sample 1, time 1 s: it is 0/0, inf - inf, 0 * inf, "
        "or a function outside its domain; change the formula or the data so that this cannot happen.",
        "1",
    ]


def test_the_page_shows_a_specification_that_has_a_monitor():
    page = (ROOT / "docs/how-to/simulink.md").read_text(encoding="utf-8")
    (text,) = re.findall(r"`'([^'`]+->[^'`]+)'`", page)
    assert rtamt.parse(text, period=PERIOD).compile().inputs == ("req", "gnt")
