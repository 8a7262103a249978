"""The horizon of a formula: how far ahead of t its value at t depends on signals (the paper's Definition 3)."""

from __future__ import annotations

from fractions import Fraction
from math import inf, lcm

from rtamt.language.contents import timed
from rtamt.language.formula import Apply, Formula, fold, postorder
from rtamt.language.operators import Bounds, Tense
from rtamt.rewrite.desugar import spelled_out

#: Looking up a member of an enumeration takes as long as the rest of a node.
_FUTURE, _NONE, _DURATION = Tense.FUTURE, Bounds.NONE, Bounds.DURATION


def horizon(formula: Formula, period: Fraction = Fraction(1)) -> Fraction | None:
    """Return the temporal depth H(φ) in seconds, exact; None if it is unbounded.

    A monitor reports ρ(φ, w, t) when its input has reached t + H(φ). ``next`` counts one ``period``
    (seconds); past operators add nothing.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> horizon(parse_formula("always[0:10](x >= 3 -> eventually[0:5] y >= 3)"))
    Fraction(15, 1)
    """
    formula = spelled_out(formula)
    parts, found = _count_horizons(formula, period)
    return _seconds(found.get(id(formula), 0), parts)


def horizons(formula: Formula, period: Fraction) -> dict[int, Fraction | None]:
    """Return the horizon of each sub-formula by its identity; ``formula``: see :func:`spelled_out`."""
    parts, found = _count_horizons(formula, period)
    none = Fraction(0)
    everywhere = dict.fromkeys(map(id, postorder(formula)), none)
    return {**everywhere, **{key: _seconds(depth, parts) for key, depth in found.items()}}


def _seconds(depth: float, parts: int) -> Fraction | None:
    return Fraction(depth, parts) if isinstance(depth, int) else None


def _count_horizons(formula: Formula, period: Fraction) -> tuple[int, dict[int, float]]:
    """Return horizons as whole parts of a second, and how many parts a second has: fractions are slow to add.

    They are integers, and inf where they are unbounded. Nodes without future have none.
    """
    ends = [node.interval.end for node in timed(formula) if node.interval is not None]
    parts = lcm(period.denominator, *[end.denominator for end in ends if end is not None])
    step = period.numerator * (parts // period.denominator)
    found: dict[int, float] = {}
    known = found.get
    for node in postorder(formula):
        if isinstance(node, Apply):
            depth: float = 0
            for operand in node.args:
                below = known(id(operand), 0)
                if below > depth:  # noqa: PLR1730 - max() takes three times as long
                    depth = below
            if node.op.tense is _FUTURE:
                own = _own(node, parts, step)
                depth = inf if inf in (depth, own) else depth + own  # a large integer is no float
            if depth:
                found[id(node)] = depth
    return parts, found


def _own(node: Apply, parts: int, step: int) -> float:
    """Return the distance that an operator reads ahead of its operands; ``step``: one sample."""
    if node.op.bounds is _NONE:
        return inf if node.op.reach is None else node.op.reach * step
    if node.interval is None:
        return step if node.op.bounds is _DURATION else inf
    end = node.interval.end
    if end is None:
        return inf
    numerator, denominator = end.as_integer_ratio()
    return numerator * (parts // denominator)


def reach(formula: Formula, step: Fraction) -> int:
    """Return the most steps (seconds each) after its variables' last change for which a formula can still change."""

    def own_and_below(node: Formula, below: tuple[int, ...]) -> int:
        own = 0
        if isinstance(node, Apply) and node.interval is not None:
            own = int((node.interval.end or node.interval.begin) / step)
        elif isinstance(node, Apply) and node.op.tense is Tense.PAST and node.op.bounds is Bounds.NONE:
            own = node.op.reach or 0  # rise and fall read one tick before
        return own + max(below, default=0)

    return fold(formula, own_and_below)
