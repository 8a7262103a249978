"""Moving constants out of windows and delays changes no bit of a result, zeros included."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rtamt.compiler.plan import compile_program
from rtamt.engine.native import core
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar

if TYPE_CHECKING:
    from rtamt.compiler.program import Program
    from rtamt.language.formula import Formula

#: Constants, and values of signals: numbers whose sums and differences are rounded, or zeros of either sign.
CONSTANTS = ["0", "0.1", "0.3", "3", "1e16", "1e308", "5e-324", "inf", "(-0.0)", "(-0.1)", "(-3)"]
VALUES = st.sampled_from(
    [0.0, -0.0, 0.1, 0.3, -0.1, 3.0, -3.0, 1e16, 1e16 + 2, 1.0, 5e-324, 1e308, -1e308, np.inf, -np.inf]
)


@st.composite
def predicates(draw: st.DrawFn) -> str:
    one, other = (draw(st.sampled_from(CONSTANTS)) for _ in range(2))
    shape = draw(
        st.sampled_from(
            [
                "x >= {0}",
                "x <= {0}",
                "x + {1} >= {0}",
                "{1} - x > {0}",
                "not (x < {0})",
                "-x <= {0}",
                "{0} + x - {1} >= 0",
            ]
        )
    )
    return "(" + shape.format(one, other) + ")"


@st.composite
def requirements(draw: st.DrawFn) -> list[str]:
    """Draw formulas that differ in their predicates alone, with constants in front of the same windows."""
    shape = "P"
    for _ in range(draw(st.integers(1, 3))):
        begin = draw(st.integers(0, 2))
        bounds = f"[{begin}:{begin + draw(st.integers(0, 3))}]"
        shape = draw(
            st.sampled_from(
                [
                    f"(always{bounds} {shape})",
                    f"(eventually{bounds} {shape})",
                    f"(once{bounds} {shape})",
                    f"(historically{bounds} {shape})",
                    f"(historically {shape})",
                    f"(prev {shape})",
                    f"(next {shape})",
                    f"(not {shape})",
                    f"({shape} and eventually[0:2] P)",
                    f"(P since[0:2] {shape})",
                ]
            )
        )
    count = draw(st.integers(2, 4))
    return [
        "".join(draw(predicates()) if part == "P" else part for part in split(shape)) for _ in range(count)
    ]


def split(shape: str) -> list[str]:
    return shape.replace("P", "\0P\0").split("\0")


def programs(texts: list[str]) -> tuple[Program, Program]:
    formulas: list[Formula] = [desugar(parse_formula(text)) for text in texts]
    hoisted, plain = (
        compile_program(formulas, Fraction(1), ("x",), without=names) for names in ((), ("hoist",))
    )
    return hoisted, plain


def offline(program: Program, x: np.ndarray) -> list[bytes] | None:
    try:
        return [values.tobytes() for values in core().evaluate(program.code(), [x], len(x))]
    except core().Undefined:
        return None


def online(program: Program, x: np.ndarray, size: int) -> list[bytes] | None:
    """Push chunks, half of them to a copy of the monitor."""
    monitor = core().Monitor(program.code(), ["x"])
    known: list[list[np.ndarray]] = []
    try:
        for begin in range(0, len(x), size):
            known.append(monitor.push(None, [x[begin : begin + size]]))
            copy = core().Monitor(program.code(), ["x"])
            copy.restore(monitor.state())
            monitor = copy
        known.append(monitor.finish())
    except core().Undefined:
        return None
    return [np.concatenate(values).tobytes() for values in zip(*known, strict=True)]


@given(requirements(), st.lists(VALUES, min_size=1, max_size=30), st.integers(1, 12))
def test_results_have_the_same_bits_with_and_without_hoisting(texts, values, size):
    hoisted, plain = programs(texts)
    x = np.array(values)
    assert len([ins for ins in hoisted.instructions if ins.n]) <= len(
        [ins for ins in plain.instructions if ins.n]
    )
    assert offline(hoisted, x) == offline(plain, x)
    assert online(hoisted, x, size) == online(plain, x, size)
