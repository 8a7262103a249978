"""What is printed is read again as the same formula, in every language; LaTeX is well formed."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from math import inf

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Interval, Var
from rtamt.language.operators import STL, Bounds, Fixity, Sort
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.parser import parse_formula as parse
from rtamt.language.printing.latex import to_latex
from rtamt.language.printing.printer import canonical, to_text
from rtamt.language.shares import Share, ShareKind
from rtamt.language.units.durations import UNITS
from tests.support.strategies import formulas

# A language in which powers collide, symbols begin other symbols, and a prefix binds tightest.
ODD = STL.extend(
    replace(STL["until"], name="equal", spellings=("~>", "equal"), power=STL["always"].power),
    replace(STL["implies"], name="right", spellings=("right",), power=STL["until"].power),
    replace(STL["mul"], name="power", spellings=("^",), power=130, fixity=Fixity.RIGHT),
    replace(STL["mul"], name="tight", spellings=("@@",), power=130),
    replace(STL["ge"], name="near", spellings=("~",), power=95),
    replace(STL["neg"], name="less", spellings=("--",)),
    replace(STL["not"], name="no", spellings=("no",), power=60),
    replace(STL["always"], name="box", spellings=("<>", "box"), power=140),
)
LANGUAGES = {"STL": STL, "odd": ODD}

NUMBERS = [0.0, -0.0, 1.0, -1.0, 2.5, -2.5, 0.1, 1e16, 1e300, -1e-300, inf, -inf]
NAMES = ["x", "req.value", "/ns/req", "a/b", "my col", 'the "x"', "", "1x", "x.", "inf", "$a", "é", "s"]
NAMES += [spelling for operator in ODD for spelling in operator.spellings]


@st.composite
def intervals(draw, bounds):
    if bounds is Bounds.NONE or (bounds is Bounds.OPTIONAL and draw(st.booleans())):
        return None
    begin = draw(st.fractions(0, 10, max_denominator=1000))
    length = draw(st.fractions(0, 10, max_denominator=7))
    if bounds is Bounds.DURATION:
        return None if draw(st.booleans()) or begin == 0 else Interval(begin, begin)
    unit = st.sampled_from(["", *UNITS])
    begin_open, end_open = (draw(st.booleans()) and length > 0 for _ in range(2))
    if bounds is Bounds.OPTIONAL and draw(st.booleans()):
        return Interval(begin, None, draw(unit), begin_open=begin_open, end_open=end_open)
    return Interval(begin, begin + length, draw(unit), draw(unit), begin_open=begin_open, end_open=end_open)


def operands_of(operator, sort, below):
    """Return operands that the parser takes, from formulas."""
    if operator.presence:
        return st.sampled_from(NAMES).map(Var)
    if sort is Sort.CONDITION:
        return below.map(lambda one: STL["gt"](one, Const(0.0)) if is_number(one) else one)
    return below.filter(is_number) if operator.strict else below


@st.composite
def spelled(draw, language):
    """Draw a formula of any names, numbers and units: it need have no value, only a text."""

    @st.composite
    def applied(inner, below):
        operator = inner(st.sampled_from(language.operators))
        args = tuple(inner(operands_of(operator, sort, below)) for sort in operator.operands)
        interval = inner(intervals(operator.bounds))
        if operator.share:
            kind = inner(st.sampled_from(ShareKind))
            amount = Fraction(inner(st.integers(1, 100)), 1 if kind is ShareKind.SAMPLES else 3)
            interval = replace(interval, share=Share(amount, kind, "s" if kind is ShareKind.DURATION else ""))
        return Apply(operator, args, interval)

    leaf = st.sampled_from(NUMBERS).map(Const) | st.sampled_from(NAMES).map(Var)
    return draw(st.recursive(leaf, applied, max_leaves=12))


def balanced(latex):
    """Return whether every brace that groups is closed after it was opened."""
    latex = latex.replace(r"\{", "").replace(r"\}", "")
    depths = [latex[:k].count("{") - latex[:k].count("}") for k in range(len(latex) + 1)]
    return min(depths) == 0 == depths[-1]


@given(formulas(unbounded_future=True))
def test_what_is_evaluated_can_be_printed_and_read_again(formula):
    text = str(formula)
    assert parse(text) == formula
    assert str(parse(text)) == text
    assert balanced(formula.latex())


@pytest.mark.parametrize("name", LANGUAGES)
@given(data=st.data())
def test_printing_then_parsing_is_the_identity(name, data):
    language = LANGUAGES[name]
    formula = data.draw(spelled(language))
    text = to_text(formula, language)
    again = parse(text, language=language)
    assert again == formula
    assert to_text(again, language) == text


@given(data=st.data())
def test_canonical_text_parses_back_where_all_names_are_declared(data):
    formula = data.draw(spelled(STL))
    names = variables(formula)
    # Const(inf) cannot be told from a declared variable of that name, nor can the operator `if`.
    if not {"inf", "if"}.intersection(names):
        assert parse(canonical(formula), variables=names) == formula


@given(data=st.data())
def test_latex_braces_balance(data):
    assert balanced(to_latex(data.draw(spelled(STL))))


@pytest.mark.parametrize("latex", ["{", "}", "}{", "{{}"])
def test_braces_that_do_not_balance_are_seen(latex):
    assert not balanced(latex)
