"""Lint never fails; fixes keep robustness and are final; what ranges decide is decided on every recording in them."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError, SpecificationError
from rtamt.language.formula import Apply, Const, Interval, Var
from rtamt.language.operators import STL
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.printing.printer import to_text
from rtamt.lint.fix import with_fixes
from rtamt.lint.found import Text
from rtamt.lint.ranges import Decided
from rtamt.lint.report import findings
from tests.support.strategies import formulas, traces

RANGES = "float x in [-1, 2]; float y in [0.5, 3]; "


@st.composite
def repetitive(draw):
    """Draw a formula of operators and operands that rules look for."""
    atoms = [STL["gt"](Var(name), Const(limit)) for name in "xy" for limit in (1.0, 2.0)]
    atoms += [STL["true"](), STL["false"](), draw(formulas(max_depth=2))]
    prefixes = [STL[name] for name in ("not", "always", "eventually", "once", "historically")]
    infixes = [STL[name] for name in ("and", "or", "implies", "until", "since")]
    formula = draw(st.sampled_from(atoms))
    for _ in range(draw(st.integers(1, 6))):
        op = draw(st.sampled_from(prefixes + infixes))
        interval = None
        if op.bounds.value == "optional" and draw(st.booleans()):
            begin = draw(st.integers(0, 1))
            interval = Interval(begin, begin + draw(st.integers(0, 2)))
        other = draw(st.sampled_from(atoms))
        operands = (formula,) if len(op.operands) == 1 else draw(st.permutations((formula, other)))
        formula = Apply(op, tuple(operands), interval)
    return formula


def robustness(document, columns):
    spec = rtamt.parse(document.text)
    return spec.evaluate({name: columns[name] for name in spec.input_names}).signal.values


@given(repetitive(), traces(max_size=6))
def test_fixes_keep_the_robustness_and_leave_nothing_to_fix(formula, columns):
    text = f"/* before */ {to_text(formula)} // behind"
    document = parse_document(text)
    found = with_fixes(document, parse_document, STL)
    assert found.text.startswith("/* before */ ")
    assert found.text.endswith(" // behind")
    assert with_fixes(found.document, parse_document, STL).text == found.text
    assert not any(each.fix for each in findings(found.document))
    assume(rtamt.parse(text).input_names == rtamt.parse(found.text).input_names != ())
    try:
        before = robustness(document, columns)
    except EvaluationError:  # it has no value there
        assume(False)
    np.testing.assert_array_equal(robustness(found.document, columns), before)


@given(formulas(), st.data())
def test_what_ranges_decide_holds_on_every_recording(formula, data):
    assume(not is_number(formula))
    try:
        document = parse_document(RANGES + to_text(formula))
    except SpecificationError:  # a name that only an undeclared variable may have
        return
    findings(document)
    decided = Decided(Text(document, STL, None)).formulas
    n = data.draw(st.integers(1, 7))
    halves = st.lists(st.integers(-2, 4).map(lambda k: k / 2), min_size=n, max_size=n)
    columns = {"x": data.draw(halves), "y": [max(0.5, value + 1) for value in data.draw(halves)]}
    for node, holds in decided:
        spec = rtamt.parse(to_text(node), semantics="boolean")
        try:
            values = spec.evaluate({name: columns[name] for name in spec.input_names}).signal.values
        except EvaluationError:
            continue
        assert set(values) == {np.inf if holds else -np.inf}
