"""Windows and delays are shared by predicates that differ in constants."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest

import rtamt
from rtamt.compiler.plan import compile_program
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar
from rtamt.signals.dense import Dense

if TYPE_CHECKING:
    from rtamt.compiler.program import Program


def compiled(*texts: str, **options: object) -> Program:
    return compile_program([desugar(parse_formula(text)) for text in texts], Fraction(1), **options)


def opcodes(program: Program) -> Counter[str]:
    return Counter(ins.opcode for ins in program.instructions)


def test_1000_thresholds_need_one_window_and_one_delay():
    program = compiled(*(f"always[0:20](a >= {c}.5) and b <= {c}.5" for c in range(1000)))
    assert opcodes(program) == {
        "input": 2,
        "const": 1000,
        "slide_min": 1,
        "shift": 1,
        "sub": 2000,
        "min": 1000,
    }


@pytest.mark.parametrize(
    ("texts", "windows"),
    [
        (("once[0:3](x >= 1)", "once[0:3](x >= 2)"), {"slide_max": 1}),
        (("once[0:3](x >= 1)", "historically[0:3](x <= 2)"), {"slide_max": 1}),
        (("once[0:3](x >= 1)", "historically[0:3](not (x >= 2))"), {"slide_max": 1}),
        (("once(x + 1 >= 1)", "once(2 - x <= 2)"), {"run_max": 1}),
        (
            ("always[0:2] once[0:3](x >= 1)", "always[0:2] once[0:3](x >= 2)"),
            {"slide_max": 1, "slide_min": 1},
        ),
        (("once[2:3](x >= 1)", "once[2:3](x >= 2)"), {"slide_max": 1, "shift": 1}),
        (("once[0:3](x >= 1)", "minimum[0:3](x) >= 2"), {"slide_max": 1, "slide_min": 1}),
        (("historically[0:3](x >= 1)", "minimum[0:3](x) >= 2"), {"slide_min": 1}),
        # A window that is not shared stays where it is, as do infinite constants and fills that are seen.
        (("once[0:3](x >= 1)", "once[0:2](x >= 2)"), {"slide_max": 2}),
        (("once[0:3](x >= 1)", "once[0:3](x >= inf)"), {"slide_max": 2}),
        (("delay[1](x - 1, 0) > 0", "delay[1](x - 2, 0) > 0"), {"shift": 2}),
    ],
)
def test_windows_of_the_same_operand_are_shared(texts, windows):
    found = opcodes(compiled(*texts))
    assert {
        name: found[name] for name in ("slide_max", "slide_min", "run_max", "shift") if found[name]
    } == windows


def test_a_single_window_is_not_moved():
    assert compiled("always[0:2](x >= 3)") == compiled("always[0:2](x >= 3)", without=["hoist"])


def test_parameters_may_become_infinite_and_stay_inside():
    spec = rtamt.parse("parameter float limit = 4\nalways[0:2](x <= limit) and always[0:2](x <= 5)")
    result = spec.with_parameters(limit=np.inf).evaluate({"x": [1.0, 2.0, 9.0]})
    assert result.robustness == -4


def test_in_dense_time_nothing_is_moved():
    program = compiled("once[0:3](x >= 1)", "once[0:3](x >= 2)", domain=Dense)
    assert opcodes(program)["slide_max"] == 2


def test_a_predicate_that_is_an_output_is_kept():
    program = compiled("x >= 1", "once[0:3](x >= 1)", "once[0:3](x >= 2)")
    assert opcodes(program) == {"input": 1, "const": 2, "sub": 3, "slide_max": 1}


def test_parts_of_a_formula_are_known_to_rtamts_classes():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.declare_var("x", "float")
    spec.declare_var("out", "float")
    spec.declare_var("low", "float")
    spec.spec = "low = x >= 1\nout = once[0:3](low) and once[0:3](x >= 2)"
    spec.parse()
    spec.update(0, [("x", 4.0)])
    assert spec.get_value("low") == 3.0
