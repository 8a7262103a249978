"""Whether a formula holds, by quantifiers over samples: the other side of the sign theorem.

Written by hand, an entry an operator, so that it shares no line with the definitions of robustness.
Operands that are read as numbers are numbers here too, and those come from the definition.
"""

from __future__ import annotations

import operator
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Formula, fold
from rtamt.language.operators import Bounds, Sort
from rtamt.reference.discrete_robustness import evaluate
from tests.oracle import over_time

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from fractions import Fraction

    import numpy as np
    from numpy.typing import NDArray

    Truth = list[bool]

COMPARISONS: dict[str, Callable[..., bool]] = {
    "gt": operator.gt,
    "ge": operator.ge,
    "lt": operator.lt,
    "le": operator.le,
    "eq": operator.eq,
    "ne": operator.ne,
    "valid": lambda _: True,
}

POINTWISE: dict[str, Callable[..., bool]] = {
    "not": lambda p: not p,
    "and": lambda p, q: p and q,
    "or": lambda p, q: p or q,
    "implies": lambda p, q: q if p else True,
    "iff": lambda p, q: p is q,
    "xor": lambda p, q: p is not q,
}


def _always(p: Truth, t: int, a: int, b: float) -> bool:
    return all(p[u] for u in range(len(p)) if t + a <= u <= t + b)


def _eventually(p: Truth, t: int, a: int, b: float) -> bool:
    return any(p[u] for u in range(len(p)) if t + a <= u <= t + b)


def _historically(p: Truth, t: int, a: int, b: float) -> bool:
    return all(p[u] for u in range(len(p)) if t - b <= u <= t - a)


def _once(p: Truth, t: int, a: int, b: float) -> bool:
    return any(p[u] for u in range(len(p)) if t - b <= u <= t - a)


def _until(p: Truth, q: Truth, t: int, a: int, b: float) -> bool:
    return any(q[u] and all(p[t:u]) for u in range(len(q)) if t + a <= u <= t + b)


def _since(p: Truth, q: Truth, t: int, a: int, b: float) -> bool:
    return any(q[u] and all(p[u + 1 : t + 1]) for u in range(len(q)) if t - b <= u <= t - a)


def _precedes(p: Truth, q: Truth, t: int, a: int, b: int) -> bool:
    begin = t - b
    return any(q[u] and all(p[max(begin, 0) : u]) for u in range(len(q)) if begin + a <= u <= t)


def _unless(p: Truth, q: Truth, t: int, a: int, b: float) -> bool:
    return all(p[u] for u in range(len(p)) if t <= u <= t + b) or _until(p, q, t, a, b)


IN_TIME: dict[str, Callable[..., bool]] = {
    "always": _always,
    "eventually": _eventually,
    "historically": _historically,
    "once": _once,
    "until": _until,
    "since": _since,
    "precedes": _precedes,
    "unless": _unless,
    "prev": lambda p, t: t == 0 or p[t - 1],
    "s_prev": lambda p, t: t > 0 and p[t - 1],
    "next": lambda p, t: t == len(p) - 1 or p[t + 1],
    "s_next": lambda p, t: t < len(p) - 1 and p[t + 1],
    "rise": lambda p, t: p[t] and not (t > 0 and p[t - 1]),
    "fall": lambda p, t: not p[t] and (t == 0 or p[t - 1]),
}

ATOMS = {"true": True, "false": False}

SHARES = {"atleast", "wasatleast"}

COVERED = {*COMPARISONS, *POINTWISE, *IN_TIME, *ATOMS, *SHARES}


def satisfied(
    formula: Formula, columns: Mapping[str, NDArray[np.float64]], n: int, period: Fraction
) -> list[bool]:
    """Tell at every sample whether the formula holds; a number holds where it is positive."""

    def step(node: Formula, below: tuple[Truth, ...]) -> Truth:
        if not isinstance(node, Apply) or node.op.result is Sort.NUMBER:
            return [bool(v > 0) for v in evaluate(node, columns, n, period)]
        name = node.op.name
        if name in COMPARISONS:
            operands = (evaluate(operand, columns, n, period).tolist() for operand in node.args)
            return [COMPARISONS[name](*values) for values in zip(*operands, strict=True)]
        if name in POINTWISE:
            return [POINTWISE[name](*values) for values in zip(*below, strict=True)]
        if name in ATOMS:
            return [ATOMS[name]] * n
        window: tuple[float, ...] = ()
        if node.op.bounds is not Bounds.NONE:
            window = over_time.window_of(node.interval, period)
        if name in SHARES:
            time = over_time.Time(period, False, int(window[0]), window[1], node.interval)
            past = name == "wasatleast"
            return [over_time.share_at(time, below[0], t, False, True, past=past) for t in range(n)]
        return [IN_TIME[name](*below, t, *window) for t in range(n)]

    return fold(formula, step)
