"""Whether a value hangs on the sign of a zero that min or max chose: -0.0 == 0.0, and they may give either.

Only division and powers tell one zero from the other, as IEEE double has it: 1/0.0 is not 1/-0.0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rtamt.language.formula import Apply, Const, Formula, Var, fold, postorder
from rtamt.language.operators import Bounds, Pointwise

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_CHOOSES = ("min", "max")
_TELLS_APART = ("div", "pow")


def _opcode(node: Formula) -> str | None:
    kernel = node.op.kernel if isinstance(node, Apply) else None
    return kernel.opcode if isinstance(kernel, Pointwise) else None


def matters(formula: Formula, columns: Mapping[str, Array], n: int, period: Fraction) -> bool:
    """Tell whether the values of a formula, or of what lies below it, change with the sign of such a zero."""
    if all(_opcode(node) not in _TELLS_APART for node in postorder(formula)):
        return False
    plus, minus = (_values(formula, columns, n, period, zero) for zero in (0.0, -0.0))
    return any(not np.array_equal(plus[k], minus[k], equal_nan=True) for k in plus)


def _values(
    formula: Formula, columns: Mapping[str, Array], n: int, period: Fraction, zero: float
) -> dict[int, Array]:
    values: dict[int, Array] = {}

    def step(node: Formula, below: tuple[Array, ...]) -> Array:
        if isinstance(node, Const):
            value = np.full(n, node.value)
        elif isinstance(node, Var):
            value = np.array(columns[node.name], float)
        else:
            assert isinstance(node, Apply)
            window: tuple[int | None, ...] = ()
            if node.op.bounds is not Bounds.NONE:
                begin, end = (0, None) if node.interval is None else (node.interval.begin, node.interval.end)
                window = (int(begin / period), None if end is None else int(end / period))
            value = node.op.definition(*(below or (n,)), *window)
            opcode = _opcode(node)
            if opcode is None or opcode in _CHOOSES:
                value = np.where(value == 0, zero, value)
        values[id(node)] = value
        return value

    with np.errstate(all="ignore"):
        fold(formula, step)
    return values
