"""A specification whose parameters are set means what it means with the values written in its text."""

from __future__ import annotations

import pickle
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import SpecificationError, StlError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, Var, fold
from rtamt.language.printing.printer import number, to_text
from rtamt.language.units.durations import UNITS
from tests.support.strategies import dense_traces, formulas, traces

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

BACKENDS = st.sampled_from(["cpp", "python"])
#: Other values than those of generated constants, as defaults.
DEFAULTS = st.sampled_from([-1.0, 0.0, 0.25, 7.0, float("inf")])


def draw_parameters(
    data: st.DataObject, formula: Formula, **settings: Any
) -> tuple[Any, Any, dict[str, float]]:
    """Return a specification whose constants are parameters, the one without any, and the values."""
    values: dict[str, float] = {}

    def named(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Const):
            name = f"p{len(values)}"
            values[name] = node.value
            return Var(name)
        return Apply(node.op, args, node.interval) if isinstance(node, Apply) else node

    body = to_text(fold(formula, named))
    assume(values)
    declared = "".join(f"parameter float {name} = {number(data.draw(DEFAULTS))} " for name in values)
    inputs = "".join(f"float {name} " for name in variables(formula))
    return (
        rtamt.parse(f"{declared}{inputs}{body}", **settings),
        rtamt.parse(to_text(formula), **settings),
        values,
    )


#: Formulas over x bounded by k, which are as if the duration in its place were written there.
BOUNDED = st.sampled_from(
    [
        "always[0:{k}](x >= 3)",
        "eventually[{k}:1h] always[0:{k}](x >= 3)",
        "(x >= 3) since[0:{k}] (x <= 1)",
        "delay[{k}](x) >= 3 and rate[{k}](x) < 1",
        "atleast[0:{k}](80%, x >= 3)",
        "recent(x, {k})",
    ]
)


@settings(max_examples=60)
@given(BOUNDED, st.sampled_from(list(UNITS)), st.integers(1, 900), st.integers(1, 900), st.booleans())
def test_a_bound_has_the_declared_unit_of_its_parameter(
    formula: str, unit: str, default: int, later: int, through: bool
) -> None:
    def parsed(k: str, declared: str = "") -> Any:
        assume(unit not in ("h", "min") or "1h" not in formula)
        template = "def recent(y, w) = once[0:w](y >= 3)\n"
        template += f"def whole(y, x, w) = {formula.format(k='w')}\n" if through else ""
        use = f"whole(x, x, {k})" if through else formula.format(k=k)
        return rtamt.parse(f"input float x {declared}\n{template}{use}")

    spec = parsed("k", f"parameter float k = {default} [{unit}]")
    for value, known in ((default, spec), (later, spec.with_parameters(k=later))):
        plain = parsed(f"{value}{unit}")
        assert known.formula == plain.formula
        assert str(known) == str(plain)
        assert known.horizon == plain.horizon == rtamt.parse(str(known)).horizon
        assert known.parameters == {"k": value}


def test_a_parameter_bounds_an_interval_of_an_imported_template(tmp_path: Path) -> None:
    (tmp_path / "soon.stl").write_text("def soon(y, within) = eventually[0:within](y > 3)")
    text = 'import "soon.stl"  input float x  parameter float k = 500 [ms]\nsoon(x, k)'
    spec = rtamt.parse(text, folder=tmp_path)
    assert str(spec) == "eventually[0:500ms](x > 3)"
    assert str(spec.with_parameters(k=20)) == "eventually[0:20ms](x > 3)"


def outcome(call: Callable[[], Any]) -> str:
    """Return what a call returns, or the sentence with which it fails, without the position in the text."""
    try:
        return repr(call())
    except StlError as error:
        return str(error).partition("\n")[0]


@settings(max_examples=40)
@given(st.data(), traces(), BACKENDS)
def test_parameters_set_later_give_the_bits_of_constants_in_the_text(
    data: st.DataObject, columns: dict[str, Any], backend: str
) -> None:
    spec, plain, values = draw_parameters(data, data.draw(formulas(max_depth=3)), backend=backend)
    given = {name: columns[name] for name in plain.input_names}
    assume(given)
    assigned = spec.with_parameters(**values)
    offline = outcome(lambda: plain.evaluate(given).signal)
    assert outcome(lambda: assigned.evaluate(given).signal) == offline
    again = pickle.loads(pickle.dumps(assigned))
    assert outcome(lambda: again.evaluate(given).signal) == offline
    assert str(assigned) == str(plain)
    rows = [{name: float(column[i]) for name, column in given.items()} for i in range(len(columns["x"]))]
    for verdict in ("delayed", "eager", "interval"):
        try:
            expected = plain.monitor(verdict=verdict)
        except SpecificationError:  # unbounded future
            continue
        monitor = spec.monitor(verdict=verdict)
        outcome(partial(monitor.update, 0.0, **rows[0]))
        monitor.reset(**values)
        for i, row in enumerate(rows):
            assert outcome(partial(monitor.update, float(i), **row)) == outcome(
                partial(expected.update, float(i), **row)
            )


@settings(max_examples=30)
@given(st.data(), dense_traces(), BACKENDS)
def test_parameters_set_later_give_the_bits_of_constants_in_the_text_in_dense_time(
    data: st.DataObject, columns: dict[str, Any], backend: str
) -> None:
    formula = data.draw(formulas(max_depth=3, discrete=False))
    settings: Any = {"backend": backend, "time": "dense", "resolution": 1}
    spec, plain, values = draw_parameters(data, formula, **settings)
    given = {name: (np.asarray(columns[name][0]) * 1.0, columns[name][1]) for name in plain.input_names}
    assume(given)
    expected = outcome(lambda: plain.evaluate(given).signal)
    assert outcome(lambda: spec.with_parameters(**values).evaluate(given).signal) == expected
    monitor = spec.monitor()
    monitor.reset(**values)
    expected = outcome(lambda: plain.monitor().update_many(given))
    assert outcome(lambda: monitor.update_many(given)) == expected
