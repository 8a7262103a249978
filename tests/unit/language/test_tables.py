"""Lookup tables: exact at their points, linear between them, in every engine."""

import pickle
from bisect import bisect_right
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.language.printing.printer import number
from rtamt.language.tables import Table, table_operator
from rtamt.testing import check_operator

TEXT = """
input float x
table curve = {(0, 1), (10, 4), (20, -2)}
table "my table" = {(-1, 0), (1, 5),}
low = curve(x) <= 3
require A: always[0:1](low)
require B: "my table"(x - 1) >= 0
"""

FINITE = st.floats(-1e6, 1e6, allow_nan=False)


@st.composite
def tables(draw):
    xs = sorted(draw(st.lists(FINITE, min_size=2, max_size=7, unique=True)))
    ys = draw(st.lists(FINITE, min_size=len(xs), max_size=len(xs)))
    return Table(tuple(xs), tuple(ys))


def spec_of(table, formula="c(x)", **more):
    points = ", ".join(f"({number(x)}, {number(y)})" for x, y in zip(table.xs, table.ys, strict=True))
    return rtamt.parse(f"table c = {{{points}}} float x; {formula}", **more)


def exact(table, x):
    """Return the value at x in exact arithmetic."""
    place = bisect_right(table.xs, x) - 1
    if place < 0 or place == len(table.xs) - 1:
        return Fraction(table.ys[max(place, 0)])
    (x0, x1), (y0, y1) = (tuple(map(Fraction, each[place : place + 2])) for each in (table.xs, table.ys))
    return y0 + (Fraction(x) - x0) * (y1 - y0) / (x1 - x0)


@settings(max_examples=60)
@given(tables(), st.lists(FINITE, min_size=1, max_size=5), st.sampled_from(["cpp", "python"]))
def test_a_table_is_exact_at_its_points_and_linear_between_them(table, others, backend):
    xs = [*table.xs, *others, float("-inf"), float("inf")]
    signal = spec_of(table, backend=backend).evaluate({"x": xs}).signal
    values = dict(zip(xs, signal.values.tolist(), strict=True))
    assert [values[x] for x in table.xs] == list(table.ys)
    assert (values[float("-inf")], values[float("inf")]) == (table.ys[0], table.ys[-1])
    largest = max(map(abs, table.ys))
    for x in others:
        assert abs(Fraction(values[x]) - exact(table, x)) <= Fraction(largest) * Fraction(2) ** -50


@settings(max_examples=40)
@given(tables(), FINITE, st.floats(0, 1e6), st.sampled_from(["discrete", "dense"]))
def test_bounds_of_a_table_are_the_hull_of_its_values(table, x, around, time):
    data = {"x": [x]} if time == "discrete" else {"x": ([0.0], [x])}
    found = spec_of(table, time=time).evaluate(data, uncertainty={"x": around}).interval
    ends = x - around, x + around
    values = [*table.definition(np.array(ends)).tolist()]
    values += [y for at, y in zip(table.xs, table.ys, strict=True) if ends[0] <= at <= ends[1]]
    assert (found.lower, found.upper) == (min(values), max(values))


def test_a_table_obeys_the_laws_of_operators():
    curve = table_operator("curve", Table((-1.0, 0.0, 0.5, 3.0), (2.0, -1.0, -1.0, 0.1)))
    check_operator(replace(curve, strict=False), examples=15)


@pytest.mark.parametrize("verdict", ["eager", "interval", "causation"])
def test_early_verdicts_of_a_table(verdict):
    text = "always[0:1](curve(x) <= 3)"
    spec = rtamt.parse(f"table curve = {{(0, 1), (10, 4)}} {text}")
    same = rtamt.parse(text.replace("curve(x)", "clip(1 + 0.3 * x, 1, 4)"))
    told = [
        [str(monitor.update(t, x=x)) for t, x in enumerate([0, 20, 5])]
        for monitor in (spec.monitor(verdict=verdict), same.monitor(verdict=verdict))
    ]
    assert told[0] == told[1]


def test_a_formula_names_its_tables():
    spec = rtamt.parse(TEXT)
    assert str(spec) == 'always[0:1](curve(x) <= 3) and "my table"(x - 1) >= 0'
    assert spec.monitor(watch=["curve(x) + 1"]) is not None
    assert rtamt.parse(TEXT).formula == spec.formula
    assert r"\mathrm{curve}(x) \leq 3" in spec.formula.latex()


def test_a_specification_with_tables_is_pickled():
    spec = rtamt.parse(TEXT)
    again = pickle.loads(pickle.dumps(spec))
    assert again.formula == spec.formula
    assert pickle.loads(pickle.dumps(spec.formula)) == spec.formula
    past = pickle.loads(pickle.dumps(spec.with_formula(spec.pastified())))
    assert past.monitor().update(0, x=5) is not None


def test_a_program_with_a_table_leaves_python():
    spec = rtamt.parse("table curve = {(0, 1), (10, 4)} curve(x) <= 3")
    program = rtamt.compiler.program.Program.from_bytes(spec.compile().to_bytes())
    assert program.metadata.formula == "curve(x) <= 3"


def test_tables_in_templates_and_imported_files(tmp_path):
    (tmp_path / "tables.stl").write_text("table curve = {(0, 1), (10, 4)}\ndef low(y) = curve(y) <= 3")
    (tmp_path / "spec.stl").write_text('import "tables.stl"\nfloat x; low(x) and curve(x) >= 0')
    assert rtamt.load(tmp_path / "spec.stl").evaluate({"x": [5]}).robustness == 0.5


def test_a_parameter_is_looked_up_in_a_table():
    spec = rtamt.parse("table curve = {(0, 1), (10, 4)} parameter float limit = 0 x <= curve(limit)")
    assert spec.evaluate({"x": [0]}).robustness == 1.0
    assert spec.with_parameters(limit=10).evaluate({"x": [0]}).robustness == 4.0


@pytest.mark.parametrize(
    "text", ["table >= 3", "float table; always(table > 3)", "table = x > 3; always(table)", "G table > 3"]
)
def test_the_word_table_is_not_reserved(text):
    assert not rtamt.parse(text).document.tables
