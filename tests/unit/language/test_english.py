"""Sentences of formulas: readable, and different for different formulas."""

from itertools import product

import pytest
from hypothesis import given

import rtamt
from rtamt.language.formula import Apply, Interval, Var
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.printing.english import to_english
from rtamt.language.printing.printer import to_text
from rtamt.mutation.operators import changes_of
from tests.support.strategies import formulas


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "always(req >= 3 -> eventually[0:5](gnt >= 3))",
            "at every instant from now on, if req is at least 3, then at some instant within the next 5 s, gnt is at "
            "least 3",
        ),
        ("(a > 1 or b > 1) and c > 1", "(a is more than 1 or b is more than 1) and c is more than 1"),
        ("a > 1 -> b > 1 -> c > 1", "if a is more than 1, then if b is more than 1, then c is more than 1"),
        (
            "(a > 1 -> b > 1) -> c > 1",
            "if (if a is more than 1, then b is more than 1), then c is more than 1",
        ),
        (
            "a > 1 and always b > 1 and c > 1",
            "(a is more than 1 and at every instant from now on, b is more than 1) and c is more than 1",
        ),
        ("x - delay[2](x) <= -y", "(x minus (x of 2 s ago)) is at most (minus y)"),
        ("once(2, 5](x > 1)", "at some instant from 5 s to more than 2 s ago, x is more than 1"),
        ("historically[500ms:inf](x > 1)", "at every instant until 500 ms ago, x is more than 1"),
        ("eventually[3:3](x > 1)", "at some instant exactly 3 s ahead, x is more than 1"),
        ("atleast[0:5](80%, x > 1)", "in at least 80% of the window within the next 5 s, x is more than 1"),
        ("delay(x, 0) > sqrt(x)", "(x of one sample ago (at first 0)) is more than sqrt(x)"),
        ("a > 1 and b > 1 and c > 1", "a is more than 1 and b is more than 1 and c is more than 1"),
    ],
)
def test_sentences(text, sentence):
    assert to_english(parse_formula(text)) == sentence


def test_the_example_of_every_operator_has_its_own_sentence():
    sentences = [to_english(parse_formula(op.example)) for op in STL]
    assert len(set(sentences)) == len(list(STL))


def test_names_units_parameters_and_members():
    spec = rtamt.parse("""
        enum Mode { MANUAL, AUTO }
        input Mode mode
        input bool armed
        input float speed [m/s]
        const float city = 13.9 [m/s]
        parameter float least = 2 [m]
        input float gap [m]
        near = gap < least
        calm = not near and speed <= 5
        require R1 "keeps away": always(mode == AUTO and not armed -> not near)
        require R2: always(calm or speed <= city)""")
    found = spec.describe()
    assert found["R1"].text == (
        "At every instant from now on, if mode is AUTO and armed is false, then it is not the case that near."
    )
    assert found["R1"].names == {"near": "gap is less than least (2 m)."}
    assert found["R2"].text == "At every instant from now on, (calm or speed is at most city (13.9 m/s))."
    assert found["R2"].names == {
        "calm": "(it is not the case that near) and speed is at most 5 m/s.",
        "near": "gap is less than least (2 m).",
    }


def test_members_of_groups():
    spec = rtamt.parse('group cars = "car_*"; always forall c in cars: c.x > 3')
    (sentence,) = spec.describe().values()
    assert sentence.text == "At every instant from now on, for every c in cars, c.x is more than 3."


def test_small_formulas_have_different_sentences():
    prefixes = [STL[name] for name in ("not", "always", "prev")]
    infixes = [STL[name] for name in ("and", "or", "implies", "until")]
    known = atoms = [STL["gt"](Var(name), Var("c")) for name in "ab"]
    for _ in range(2):
        known = [
            *atoms,
            *(op(each) for op, each in product(prefixes, known)),
            *(op(*each) for op, each in product(infixes, product(known, known))),
        ]
    sentences = {}
    for formula in known:
        assert sentences.setdefault(to_english(formula), formula) == formula


@given(formulas(unbounded_future=True))
def test_every_formula_has_a_sentence_and_its_mutants_have_others(formula):
    sentence = to_english(formula)
    for change in changes_of(formula, None):
        if to_text(change.old) != to_text(change.new):
            assert to_english(change.old) != to_english(change.new)
    always = Apply(STL["always"], (formula,), Interval(0, 2))
    assert to_english(always).startswith("at every instant within the next 2 s, ")
    assert sentence.strip("()")
