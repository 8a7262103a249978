"""The paper's classes say what the definition says, whatever text the formula comes in, with the core and without."""

from __future__ import annotations

import sys
import warnings
from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, Formula, Var, fold, postorder
from rtamt.language.parsing.grammar import is_number
from rtamt.language.printing.printer import canonical
from rtamt.language.shares import ShareKind
from rtamt.language.units.durations import UNITS
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import boolean
from rtamt.rewrite.truth import is_part_of_a_condition
from tests.laws.test_engine_laws import by_definition
from tests.support.strategies import formulas, traces

if TYPE_CHECKING:
    from collections.abc import Iterator

ONE = Fraction(1)
WAYS = st.sampled_from([canonical, str])
UNIT = st.sampled_from(list(UNITS))
PERIOD = st.sampled_from([Fraction(1), Fraction(1, 4), Fraction(3)])  # in that unit


@pytest.fixture(params=["core", "no core"], autouse=True, scope="module")
def core(request: pytest.FixtureRequest) -> Iterator[None]:
    """Run every law with the compiled core, and where it cannot be loaded."""
    with pytest.MonkeyPatch.context() as patch:
        if request.param == "no core":
            patch.setitem(sys.modules, "rtamt.engine._core", None)
            patch.delattr("rtamt.engine._core", raising=False)
        yield


def specification(
    text: str, *sub_specs: str, period: Fraction = ONE, unit: str = "s"
) -> rtamt.StlDiscreteTimeSpecification:
    spec = rtamt.StlDiscreteTimeSpecification()
    for name in ("x", "y"):
        spec.declare_var(name, "float")
    for sub_spec in sub_specs:
        spec.add_sub_spec(sub_spec)
    spec.unit = unit
    spec.set_sampling_period(period, unit)
    spec.spec = text
    with warnings.catch_warnings():
        # A chain that RTAMT read differently is warned of; here it is read as it was printed.
        warnings.simplefilter("ignore", UserWarning)
        spec.parse()
    return spec


def defined(formula: Formula, columns: dict[str, Any], period: Fraction = ONE) -> np.ndarray:
    """Return the definition's values; a formula that has none somewhere is drawn again."""
    values = by_definition(formula, columns, period)
    assume(values is not None)
    assert values is not None
    return values


def offline(spec: Any, columns: dict[str, Any], step: float = 1.0) -> list[float]:
    n = len(columns["x"])
    result = spec.evaluate({"time": [i * step for i in range(n)], **columns})
    assert [time for time, _ in result] == [i * step for i in range(n)]
    return [value for _, value in result]


def parts(formula: Formula) -> list[Formula]:
    return list(dict.fromkeys(postorder(formula)))


def online(spec: Any, columns: dict[str, Any], step: float = 1.0) -> list[float] | None:
    """Return what each update says, or None where one has no value to say.

    A variable is given only where it changes.
    """
    results = []
    held: dict[str, float] = {}
    for i, (x, y) in enumerate(zip(columns["x"], columns["y"], strict=True)):
        new = {name: value for name, value in (("x", x), ("y", y)) if held.get(name) != value}
        held |= new
        try:
            results.append(spec.update(i * step, list(new.items())))
        except rtamt.RTAMTException as error:
            if not isinstance(error.__cause__, EvaluationError):
                raise
            return None
    return results


def values_of(part: Formula, formula: Formula, columns: dict[str, Any]) -> np.ndarray:
    """Return the values of a part of a formula by definition: numbers as they are, a condition by its truth."""
    condition = not is_number(part) and is_part_of_a_condition(part, (formula,))
    return defined(boolean(part) if condition else part, columns)


def in_unit(formula: Formula, unit: str, *, bounds: bool) -> Formula:
    """Return the formula with as many ``unit`` as it has seconds: its shares, and perhaps its bounds."""
    factor = UNITS[unit]

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        interval = node.interval
        if interval is not None:
            share = interval.share
            if share is not None and share.kind is ShareKind.DURATION:
                interval = replace(interval, share=replace(share, amount=share.amount * factor, unit=unit))
            if bounds:
                end = None if interval.end is None else interval.end * factor
                interval = replace(interval, begin=interval.begin * factor, end=end)
        return replace(node, args=args, interval=interval)

    return fold(formula, step)


def named_apart(formula: Formula, part: Formula) -> Formula:
    """Return the formula with the variable ``part`` wherever that part stands."""

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if node == part:
            return Var("part")
        return replace(node, args=args) if isinstance(node, Apply) else node

    return fold(formula, step)


@given(formulas(unbounded_future=True), traces(infinite=True), WAYS)
def test_evaluate_is_the_definition(formula: Formula, columns: dict[str, Any], way: Any) -> None:
    expected = defined(formula, columns)
    np.testing.assert_array_equal(offline(specification(way(formula)), columns), expected)


@given(formulas(future=False), traces(), WAYS)
def test_update_is_the_definition_at_every_sample(
    formula: Formula, columns: dict[str, Any], way: Any
) -> None:
    expected = defined(formula, columns)
    spec = specification(way(formula))
    for _ in range(2):  # a specification that was reset answers as a new one
        np.testing.assert_array_equal(online(spec, columns), expected)
        spec.reset()


@given(st.data(), WAYS, UNIT, PERIOD)
def test_a_pastified_specification_says_the_same_one_horizon_later_in_any_unit(
    data: st.DataObject, way: Any, unit: str, period: Fraction
) -> None:
    formula, columns = data.draw(formulas(period=period)), data.draw(traces())
    depth = horizon(formula, period)
    assert depth is not None
    delay = int(depth / period)
    assume(delay < len(columns["x"]))
    # Bounds without a unit are in that of the specification; a share has its own, and integrals are in seconds.
    expected = defined(in_unit(formula, unit, bounds=True), columns, period * UNITS[unit])
    spec = specification(way(in_unit(formula, unit, bounds=False)), period=period, unit=unit)
    np.testing.assert_array_equal(offline(spec, columns, float(period)), expected)
    spec.pastify()
    late = online(spec, columns, float(period))
    # Before the horizon a delayed operand is infinite, so that arithmetic on it may have no value.
    assume(late is not None)
    assert late is not None
    np.testing.assert_array_equal(late[delay:], expected[: len(expected) - delay])
    again = specification(spec.spec_print(), period=period, unit=unit)
    assert again.spec_print() == spec.spec_print()
    assert online(again, columns, float(period)) == late


@given(st.data(), traces(), WAYS, st.booleans())
def test_sub_specifications_change_no_result(
    data: st.DataObject, columns: dict[str, Any], way: Any, watched: bool
) -> None:
    formula = data.draw(formulas(future=not watched, unbounded_future=not watched))
    expected = defined(formula, columns)
    part = data.draw(st.sampled_from(parts(formula)))
    apart = specification(way(named_apart(formula, part)), "unused = once(x)", f"part = {way(part)};")
    results = online(apart, columns) if watched else offline(apart, columns)
    np.testing.assert_array_equal(results, expected)


@given(formulas(max_depth=3, unbounded_future=True), traces(), WAYS)
def test_after_evaluate_every_part_has_the_values_of_its_definition(
    formula: Formula, columns: dict[str, Any], way: Any
) -> None:
    defined(formula, columns)
    spec = specification(way(formula))
    offline(spec, columns)
    for part in parts(formula):
        np.testing.assert_array_equal(spec.get_value(way(part)), values_of(part, formula, columns))


@given(formulas(max_depth=3, future=False), traces(max_size=8), WAYS)
def test_after_each_update_every_part_has_the_value_of_its_definition(
    formula: Formula, columns: dict[str, Any], way: Any
) -> None:
    defined(formula, columns)
    values = {part: values_of(part, formula, columns) for part in parts(formula)}
    spec = specification(way(formula))
    for i, (x, y) in enumerate(zip(columns["x"], columns["y"], strict=True)):
        spec.update(i, [("x", x), ("y", y)])
        for part, expected in values.items():
            assert spec.get_value(way(part)) == expected[i]
