"""The horizon of a formula: how far ahead of t its value at t depends on signals (the paper's Definition 3)."""

from __future__ import annotations

from fractions import Fraction

from rtamt.language.formula import Apply, Formula, children, fold, postorder
from rtamt.language.operators import Bounds, Tense
from rtamt.rewrite.desugar import spelled_out

_NONE = Fraction(0)


def horizon(formula: Formula, period: Fraction = Fraction(1)) -> Fraction | None:
    """Return the temporal depth H(φ) in seconds, exact; None if it is unbounded.

    A monitor reports ρ(φ, w, t) when its input has reached t + H(φ). ``next`` counts one ``period``
    (seconds); past operators add nothing.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> horizon(parse_formula("always[0:10](x >= 3 -> eventually[0:5] y >= 3)"))
    Fraction(15, 1)
    """
    formula = spelled_out(formula)
    return horizons(formula, period)[id(formula)]


def horizons(formula: Formula, period: Fraction) -> dict[int, Fraction | None]:
    """Return the horizon of each sub-formula by its identity; ``formula``: see :func:`spelled_out`."""
    found: dict[int, Fraction | None] = {}

    def step(node: Formula, below: list[Fraction | None]) -> Fraction | None:
        deepest = _NONE
        for depth in below:
            if depth is None:
                return None
            if depth is not deepest:  # fractions are slow to compare
                deepest = max(deepest, depth)
        if not isinstance(node, Apply) or node.op.tense is not Tense.FUTURE:
            return deepest
        if node.op.bounds is Bounds.NONE:
            return None if node.op.reach is None else deepest + node.op.reach * period
        if node.interval is None and node.op.bounds is Bounds.DURATION:
            return deepest + period
        if node.interval is None or node.interval.end is None:
            return None
        return deepest + node.interval.end

    for node in postorder(formula):
        found[id(node)] = step(node, [found[id(operand)] for operand in children(node)])
    return found


def reach(formula: Formula, step: Fraction) -> int:
    """Return the most steps (seconds each) after its variables' last change for which a formula can still change."""

    def own_and_below(node: Formula, below: tuple[int, ...]) -> int:
        own = 0
        if isinstance(node, Apply) and node.interval is not None:
            own = int((node.interval.end or node.interval.begin) / step)
        return own + max(below, default=0)

    return fold(formula, own_and_below)
