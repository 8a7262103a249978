"""A suite has the values of ``evaluate`` on each requirement, bit for bit, also when it was read from bytes."""

from __future__ import annotations

import struct
from typing import Any

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import StlError
from rtamt.fleet.verdict_table import Row, VerdictTable
from tests.support.strategies import dense_traces, formulas, traces

SEMANTICS = st.sampled_from(("standard", "boolean", "output_robustness", "input_vacuity"))


def alone(spec: rtamt.Specification, data: Any, select: tuple[str, ...], name: str, **more: Any) -> Row:
    """Return the row of a requirement that is evaluated by itself."""
    row = Row("", name)
    try:
        result = spec.evaluate(data, **more)
        if "robustness" in select:
            row = row._replace(robustness=result.robustness)
        if "satisfied" in select:
            row = row._replace(satisfied=result.satisfied)
        if "first_violation" in select:
            row = row._replace(first_violation=rtamt.first_violation(result))
    except StlError as error:
        return row._replace(error=str(error))
    return row


def bits(row: Row) -> Any:
    """Return a row with the bits of its numbers, and errors apart from their text: it may name an equal formula."""
    floats = [None if x is None else struct.pack("d", x) for x in (row.robustness, row.first_violation)]
    return (*floats, row.satisfied, row.unchecked, row.error is None)


def assert_same(table: VerdictTable, expected: list[Row]) -> None:
    assert [row.requirement for row in table] == [row.requirement for row in expected]
    for row, other in zip(table, expected, strict=True):
        assert bits(row) == bits(other), (row, other)


@st.composite
def selections(draw: st.DrawFn) -> tuple[str, ...]:
    every = ("robustness", "satisfied", "first_violation")
    chosen = draw(st.sets(st.sampled_from(every), min_size=1))
    return tuple(name for name in every if name in chosen)


@settings(max_examples=80)
@given(
    st.lists(formulas(max_depth=4, unbounded_future=True), min_size=1, max_size=5),
    traces(),
    SEMANTICS,
    selections(),
)
def test_discrete(drawn: list[Any], columns: Any, semantics: str, select: tuple[str, ...]) -> None:
    specs = {
        f"R{i}": rtamt.parse(str(formula), period=1, semantics=semantics) for i, formula in enumerate(drawn)
    }
    data = {"time": np.arange(len(columns["x"]), dtype=float), **columns}
    expected = [alone(spec, data, select, name) for name, spec in specs.items()]
    suite = rtamt.Suite(specs, select=select)
    assert_same(suite.evaluate(data), expected)
    assert rtamt.Suite.from_bytes(suite.to_bytes()).evaluate(data) == suite.evaluate(data)


@settings(max_examples=80)
@given(
    st.lists(formulas(max_depth=4, discrete=False, unbounded_future=True), min_size=1, max_size=5),
    dense_traces(),
    SEMANTICS,
    selections(),
)
def test_dense(drawn: list[Any], trace: Any, semantics: str, select: tuple[str, ...]) -> None:
    settings_ = {"time": "dense", "resolution": 1, "semantics": semantics}
    specs = {f"R{i}": rtamt.parse(str(formula), **settings_) for i, formula in enumerate(drawn)}
    assume(all(spec.input_names for spec in specs.values()))
    data = {name: (times.astype(float), values) for name, (times, values) in trace.items()}
    expected = [alone(spec, data, select, name) for name, spec in specs.items()]
    suite = rtamt.Suite(specs, select=select)
    assert_same(suite.evaluate(data), expected)
    assert rtamt.Suite.from_bytes(suite.to_bytes()).evaluate(data) == suite.evaluate(data)


@settings(max_examples=40)
@given(st.lists(formulas(max_depth=3), min_size=1, max_size=4), traces(), st.sampled_from([0.5, 1.0, 2.0]))
def test_a_period_that_the_recording_decides(drawn: list[Any], columns: Any, period: float) -> None:
    specs = {f"R{i}": rtamt.parse(str(formula)) for i, formula in enumerate(drawn)}
    assume(len(columns["x"]) > 1)
    data = {"time": np.arange(len(columns["x"])) * period, **columns}
    select = ("robustness", "satisfied", "first_violation")
    expected = [alone(spec, data, select, name) for name, spec in specs.items()]
    assert_same(rtamt.Suite(specs).evaluate(data), expected)


@settings(max_examples=40)
@given(
    st.lists(formulas(max_depth=3, unbounded_future=True), min_size=1, max_size=4),
    traces(),
    st.sampled_from([np.nan, np.inf, -np.inf]),
    st.data(),
)
def test_wrong_data_concern_only_the_requirements_that_read_them(
    drawn: list[Any], columns: Any, value: float, data: st.DataObject
) -> None:
    specs = {f"R{i}": rtamt.parse(str(formula), period=1) for i, formula in enumerate(drawn)}
    name = data.draw(st.sampled_from(sorted(columns)))
    at = data.draw(st.integers(0, len(columns[name]) - 1))
    columns = {**columns, name: np.array(columns[name], float)}
    columns[name][at] = value
    select = ("robustness", "satisfied", "first_violation")
    expected = [alone(spec, columns, select, label) for label, spec in specs.items()]
    suite = rtamt.Suite(specs)
    assert_same(suite.evaluate(columns), expected)
    assert rtamt.Suite.from_bytes(suite.to_bytes()).evaluate(columns) == suite.evaluate(columns)


def test_an_operand_that_a_window_of_one_sample_does_not_need_has_its_errors() -> None:
    """The suite reported a verdict, and evaluate the error."""
    spec = rtamt.parse("sqrt(x) > 1 until[0:0] y > 0", period=1)
    (row,) = rtamt.Suite([spec]).evaluate({"x": [1, -1], "y": [1, 2]})
    assert "'sqrt(x)' has no value at sample 1" in str(row.error)
