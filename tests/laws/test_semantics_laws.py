"""Every semantics is what SEMANTICS says, over random formulas and interfaces, in all modes and back ends."""

from __future__ import annotations

from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, children, postorder
from rtamt.language.operators import Sort
from rtamt.language.printing.printer import canonical
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import SEMANTICS
from rtamt.rewrite.truth import is_part_of_a_condition, truth
from tests.laws.test_dense_definition_laws import TICK, dense_formulas, value
from tests.laws.test_engine_laws import by_definition, online
from tests.oracle import interface
from tests.oracle.boolean import satisfied
from tests.oracle.dense_grid import on_grid
from tests.support.strategies import chunkings, dense_chunkings, dense_traces, formulas, traces

if TYPE_CHECKING:
    from rtamt.language.formula import Formula

ONE = Fraction(1)
NAMED = st.sampled_from(interface.NAMES)
INPUTS = st.sets(st.sampled_from("xy"))
BACKENDS = pytest.mark.parametrize("backend", ["cpp", "python"])
FEW = settings(max_examples=50)


def specification(formula: Formula, inputs: set[str], **settings: Any) -> rtamt.Specification:
    """Return the formula with its interface, an undeclared variable being an output."""
    roles = {name: "input" for name in variables(formula) if name in inputs}
    return rtamt.parse(str(formula), roles=roles, **settings)


def recording(formula: Formula, columns: dict[str, Any]) -> dict[str, Any]:
    data = {name: columns[name] for name in variables(formula)}
    return {"time": np.arange(len(columns["x"])), **data}


def test_the_oracle_knows_every_named_semantics() -> None:
    assert {*interface.NAMES, "standard"} == set(SEMANTICS)


# ---- the definition, in all modes ----------------------------------------------------------------


@BACKENDS
@given(formulas(unbounded_future=True), traces(infinite=True), NAMED, INPUTS)
def test_discrete_offline_is_the_definition(
    backend: str, formula: Formula, columns: dict[str, Any], semantics: str, inputs: set[str]
) -> None:
    ordinary = by_definition(formula, columns)
    assume(ordinary is not None)
    spec = specification(formula, inputs, semantics=semantics, backend=backend)
    data, n = recording(formula, columns), len(columns["x"])
    result = spec.evaluate(data)
    expected = interface.values(formula, semantics, inputs, columns, n, ONE)
    np.testing.assert_array_equal(result.signal.values, expected)
    assert result.satisfied is satisfied(formula, columns, n, ONE)[0]
    np.testing.assert_array_equal(spec.evaluate(data, semantics="standard").signal.values, ordinary)


@BACKENDS
@FEW
@given(data=st.data(), semantics=NAMED, inputs=INPUTS)
def test_discrete_online_is_the_definition(
    backend: str, data: st.DataObject, semantics: str, inputs: set[str]
) -> None:
    formula, columns = data.draw(formulas()), data.draw(traces(infinite=True))
    assume(by_definition(formula, columns) is not None)
    n = len(columns["x"])
    spec = specification(formula, inputs, backend=backend)
    monitor = spec.monitor(semantics=semantics)
    assert monitor.input_names == spec.input_names
    assert monitor.horizon == spec.horizon
    expected = interface.values(formula, semantics, inputs, columns, n, ONE)
    np.testing.assert_array_equal(online(monitor, columns, data.draw(chunkings(n))), expected)


def in_seconds(formula: Formula, trace: dict[str, Any]) -> dict[str, Any]:
    return {name: (trace[name][0] * float(TICK), trace[name][1]) for name in variables(formula)}


def on_ticks(signal: Any) -> tuple[list[int], list[float]]:
    return (np.array(signal.times) / float(TICK)).astype(int).tolist(), np.array(signal.values).tolist()


def same_steps(told: tuple[list[int], list[float]], expected: list[float], start: int) -> None:
    """Compare what was told with the value at each tick and in each gap after it."""
    times, values = told
    last = start + len(expected) // 2
    assert (times[0], times[-1]) == (start, last)
    ticks = np.arange(start, last + 1)
    held = np.array(values)[np.searchsorted(times, ticks, side="right") - 1]
    np.testing.assert_array_equal(held, expected[::2])
    np.testing.assert_array_equal(held[:-1], expected[1::2])


@BACKENDS
@FEW
@given(data=st.data(), semantics=NAMED, inputs=INPUTS)
def test_dense_offline_and_online_are_the_definition(
    backend: str, data: st.DataObject, semantics: str, inputs: set[str]
) -> None:
    formula = data.draw(dense_formulas(max_depth=3, unbounded_future=True))
    assume(variables(formula))
    trace = data.draw(dense_traces(max_size=6))
    trace = {name: trace[name] for name in variables(formula)}
    value(formula, trace)  # or there is none
    start, expected = on_grid(
        formula, trace, TICK, truth=False, case=lambda p: interface.case(p, semantics, inputs)
    )
    settings = {"backend": backend, "semantics": semantics, "resolution": TICK, "time": "dense"}
    spec = specification(formula, inputs, **settings)
    try:
        result = spec.evaluate(in_seconds(formula, trace))
    except EvaluationError:
        assume(False)
    same_steps(on_ticks(result.signal), expected, start)
    _, held = on_grid(formula, trace, TICK, truth=True)
    assert result.satisfied is held[0]
    if spec.horizon == inf:
        return  # offline only

    monitor = spec.monitor(time="dense")
    assert monitor.input_names == spec.input_names
    times, values = [], []
    for update in data.draw(dense_chunkings(trace)):
        try:
            signal = monitor.update_many({k: (t * float(TICK), v) for k, (t, v) in update.items()})
        except EvaluationError:
            assume(False)
        told = on_ticks(signal)
        times += told[0]
        values += told[1]
    told = on_ticks(monitor.finish())
    same_steps((times + told[0], values + told[1]), expected, start)


@FEW
@given(formulas(), traces(), NAMED, INPUTS)
def test_a_pastified_formula_says_the_same_one_horizon_later(
    formula: Formula, columns: dict[str, Any], semantics: str, inputs: set[str]
) -> None:
    n, delay = len(columns["x"]), int(horizon(formula) or 0)
    assume(delay < n)
    assume(by_definition(formula, columns) is not None)
    spec = specification(formula, inputs, semantics=semantics)
    past = specification(spec.pastified(), inputs, semantics=semantics)
    try:
        late = past.evaluate(recording(formula, columns)).signal.values
    except EvaluationError:
        assume(False)  # before the horizon a delayed operand is infinite
    now = spec.evaluate(recording(formula, columns)).signal.values
    np.testing.assert_array_equal(late[delay:], now[: n - delay])


@FEW
@given(formulas(unbounded_future=True), traces(infinite=True), NAMED, INPUTS)
def test_a_function_that_says_the_same_is_the_same(
    formula: Formula, columns: dict[str, Any], semantics: str, inputs: set[str]
) -> None:
    def judge(predicate: Formula, roles: Any) -> Formula:
        assert {name for name, role in roles.items() if role == "input"} == inputs & set(variables(formula))
        which = interface.case(predicate, semantics, inputs)
        return {"zero": rtamt.parse("0").formula, "ordinary": predicate, "truth": truth(predicate)}[which]

    assume(by_definition(formula, columns) is not None)
    spec = specification(formula, inputs)
    by_name, by_function = (
        spec.evaluate(recording(formula, columns), semantics=chosen).signal.values
        for chosen in (semantics, judge)
    )
    np.testing.assert_array_equal(by_function, by_name)


# ---- what the semantics have to do with each other ------------------------------------------------


def under(formula: Formula, columns: dict[str, Any], inputs: set[str], *semantics: str) -> list[Any]:
    assume(by_definition(formula, columns) is not None)
    spec = specification(formula, inputs)
    data = recording(formula, columns)
    return [spec.evaluate(data, semantics=one).signal.values for one in semantics]


@given(formulas(unbounded_future=True), traces(infinite=True), NAMED, INPUTS)
def test_the_sign_under_any_semantics_is_a_verdict(
    formula: Formula, columns: dict[str, Any], semantics: str, inputs: set[str]
) -> None:
    values, verdict = under(formula, columns, inputs, semantics, "boolean")
    assert set(verdict) <= {inf, -inf}
    assert (verdict[values > 0] == inf).all()
    assert (verdict[values < 0] == -inf).all()


@FEW
@given(formulas(unbounded_future=True), traces(infinite=True), INPUTS, st.booleans())
def test_what_is_vacuous_cannot_be_changed_by_the_other_side(
    formula: Formula, columns: dict[str, Any], inputs: set[str], swapped: bool
) -> None:
    names = ("output_vacuity", "input_robustness") if swapped else ("input_vacuity", "output_robustness")
    vacuity, robustness = under(formula, columns, inputs, *names)
    assert (robustness[vacuity > 0] == inf).all()
    assert (robustness[vacuity < 0] == -inf).all()


@FEW
@given(formulas(unbounded_future=True), traces(infinite=True), INPUTS)
def test_inputs_and_outputs_are_two_sides_of_one_definition(
    formula: Formula, columns: dict[str, Any], inputs: set[str]
) -> None:
    others = {"x", "y"} - inputs
    for one, other in (("output_robustness", "input_robustness"), ("output_vacuity", "input_vacuity")):
        np.testing.assert_array_equal(
            under(formula, columns, inputs, one), under(formula, columns, others, other)
        )


# ---- the paper's classes --------------------------------------------------------------------------


def read_as_formulas(formula: Formula) -> set[Formula]:
    """Return the parts that stand where a formula is expected, and not below a predicate."""
    found, stack = set(), [formula]
    while stack:
        node = stack.pop()
        found.add(node)
        if not interface.is_predicate(node):
            stack.extend(children(node))
    return found


@FEW
@given(formulas(), traces(), NAMED, INPUTS)
def test_the_papers_classes_are_the_definition_and_so_is_every_part(
    formula: Formula, columns: dict[str, Any], semantics: str, inputs: set[str]
) -> None:
    ordinary, n = by_definition(formula, columns), len(columns["x"])
    assume(ordinary is not None)
    spec = rtamt.StlDiscreteTimeSpecification(semantics=semantics)
    for name in ("x", "y"):
        spec.declare_var(name, "float")
        spec.set_var_io_type(name, "input" if name in inputs else "output")
    spec.spec = canonical(formula)
    spec.parse()
    expected = interface.values(formula, semantics, inputs, columns, n, ONE)
    data = {"time": list(range(n)), **columns}
    np.testing.assert_array_equal(spec.evaluate(data), list(enumerate(expected)))
    judged = read_as_formulas(formula)
    for part in postorder(formula):
        number = not isinstance(part, Apply) or part.op.result is Sort.NUMBER
        if part in judged and not number:
            wanted = interface.values(part, semantics, inputs, columns, n, ONE)
        elif not number and is_part_of_a_condition(part, (formula,)):
            wanted = interface.values(part, "boolean", inputs, columns, n, ONE)
        else:
            wanted = by_definition(part, columns)
        np.testing.assert_array_equal(spec.get_value(canonical(part)), wanted)

    delay = int(horizon(formula) or 0)
    spec.pastify()
    try:
        late = [spec.update(i, [(k, columns[k][i]) for k in ("x", "y")]) for i in range(n)]
    except rtamt.RTAMTException:
        assume(False)  # before the horizon a delayed operand is infinite
    np.testing.assert_array_equal(late[delay:], expected[: max(0, n - delay)])
