"""Interface-aware and Boolean semantics as SEMANTICS writes them: sets of variables, case by case.

Y are the variables of a predicate, U those whose change is measured, V those held fixed. Written by
hand over the definitions of the operators, it knows nothing of how a formula is lowered.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.language.formula import Apply, Formula, fold, postorder
from rtamt.language.formula import Var as Variable
from rtamt.language.operators import Bounds, Sort
from rtamt.language.shares import rank_arguments
from rtamt.reference.discrete_robustness import evaluate
from tests.oracle.boolean import COMPARISONS

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

NAMES = ("output_robustness", "input_vacuity", "input_robustness", "output_vacuity", "boolean")


def sets(semantics: str, variables: set[str], inputs: set[str]) -> tuple[set[str], set[str]]:
    """Return U and V: the table of SEMANTICS; Boolean satisfaction holds everything fixed."""
    outputs = variables - inputs
    return {
        "output_robustness": (outputs, variables - outputs),
        "input_vacuity": (inputs, set()),
        "input_robustness": (inputs, variables - inputs),
        "output_vacuity": (outputs, set()),
        "boolean": (set(), variables),
    }[semantics]


def case(predicate: Formula, semantics: str, inputs: set[str]) -> str:
    """Return which of the three cases a predicate is: worth 0, its ordinary value, or its truth."""
    y = {node.name for node in postorder(predicate) if isinstance(node, Variable)}
    u, v = sets(semantics, y | inputs, inputs)
    if not y <= u | v:
        return "zero"
    return "ordinary" if not y <= v else "truth"


def is_predicate(node: Formula) -> bool:
    return not isinstance(node, Apply) or node.op.result is Sort.NUMBER or node.op.name in COMPARISONS


def values(
    formula: Formula, semantics: str, inputs: set[str], columns: Mapping[str, Any], n: int, period: Fraction
) -> np.ndarray:
    """Return the value of a formula at each of n samples."""

    def step(node: Formula, below: tuple[Any, ...]) -> Any:
        return lambda: value(node, below)  # what is inside a predicate has no value of its own

    def value(node: Formula, below: tuple[Any, ...]) -> np.ndarray:
        if is_predicate(node):
            return _predicate(node, case(node, semantics, inputs), columns, n, period)
        assert isinstance(node, Apply)
        window: tuple[float | None, ...] = ()
        if node.op.bounds is not Bounds.NONE:
            begin, end = (0, None) if node.interval is None else (node.interval.begin, node.interval.end)
            window = (int(begin / period), None if end is None else int(end / period))
        window = (*window, *rank_arguments(node.interval, period, continuous=False))
        return node.op.definition(*([operand() for operand in below] or (n,)), *window)

    return fold(formula, step)()


def _predicate(node: Formula, which: str, columns: Mapping[str, Any], n: int, period: Fraction) -> np.ndarray:
    if which == "zero":
        return np.zeros(n)
    if which == "ordinary":
        return evaluate(node, columns, n, period)
    if isinstance(node, Apply) and node.op.name in COMPARISONS:
        operands = (evaluate(operand, columns, n, period).tolist() for operand in node.args)
        holds = [COMPARISONS[node.op.name](*values) for values in zip(*operands, strict=True)]
    else:
        holds = [value > 0 for value in evaluate(node, columns, n, period)]
    return np.where(holds, inf, -inf)
