"""Expanding operators while they are lowered yields the program of the expanded formulas."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtamt.compiler.order import is_lowerable
from rtamt.compiler.plan import compile_program
from rtamt.language.contents import operators_of, variables
from rtamt.language.formula import Apply, Var, postorder
from rtamt.language.operators import STL, Bounds
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.merge import merged
from rtamt.signals.time_domains import DOMAINS
from tests.support.strategies import formulas

DERIVED = [op for op in STL if op.kernel is None and op.bounds is Bounds.NONE and is_lowerable(op)]


def assert_same_program(asked, domain, **options):
    inputs = variables(*asked)
    expanded, found = (
        compile_program(each, Fraction(1), inputs, domain=domain, **options)
        for each in (merged(asked), asked)
    )
    assert found == expanded
    assert found.code() == expanded.code()
    assert [origin.span for origin in found.origins] == [origin.span for origin in expanded.origins]
    return found


@given(st.lists(formulas(), min_size=1, max_size=3), st.sampled_from(list(DOMAINS.values())))
def test_formulas_have_the_instructions_and_origins_of_their_expansions(asked, domain):
    asked = tuple(each for each in asked if all(map(is_lowerable, operators_of(each))))
    assert_same_program(asked, domain)
    program = assert_same_program(asked, domain, without=["hoist"])  # which removes instructions
    cores = list(map(desugar, asked))
    assert {*program.value_of} == {*postorder(*cores)}
    assert [program.place_of(core) for core in cores] == [*program.outputs]


@pytest.mark.parametrize("op", DERIVED, ids=lambda op: op.name)
def test_every_operator_with_a_recipe_has_the_instructions_of_its_expansion(op):
    def node(*names):
        return Apply(op, tuple(Var(name) for name in names[: len(op.operands)]))

    delayed = [STL["next"](Var(name)) for name in "xyz"[: len(op.operands)]]
    asked = (
        node("x", "y", "z"),
        Apply(op, tuple(delayed)),
        node("x", "x", "x"),
        STL["prev"](node("z", "y", "x")),
    )
    assert_same_program(asked, DOMAINS["discrete"])
