"""Grounding of formulas for a known step: closed bounds, counted in whole steps.

A step is the sampling period in discrete time and a tick (``resolution``) in dense time. A formula is grounded
before its horizon is computed, and before it is expanded and compiled: see ``TimeDomain.check``. The result has the
nodes of the formula with other intervals; it is printed, and its spans point, as the formula was written.
"""

from __future__ import annotations

from rtamt.language.contents import contents, timed
from rtamt.language.formula import Apply, Formula, Interval, folds
from rtamt.language.records import Bounds
from rtamt.language.units.durations import UNITS
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.truth import rebuilt

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from rtamt.language.records import Operator


def ground(formula: Formula, step: Fraction, *, continuous: bool = False) -> Formula:
    """Return the formula in a time domain with steps of ``step`` seconds; ``continuous`` in dense time.

    Half-open bounds become closed ones: (a, b] is [a + step, b]. In dense time an operator that compares an
    instant with the one before (``rise``) is given the length of a tick; in discrete time a duration that was left out
    (``delay(x)``) is a period. If there is nothing to do, the result is
    the same object; a grounded formula is left as it is. The bounds must have been checked (``check_bounds``).

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> grounded = ground(parse_formula("eventually(0, 5](x > 3)"), Fraction(1, 10))
    >>> print(grounded, grounded.interval.begin)
    eventually(0:5](x > 3) 1/10
    """
    return grounds((formula,), step, continuous=continuous)[0]


def grounds(formulas: Sequence[Formula], step: Fraction, *, continuous: bool = False) -> tuple[Formula, ...]:
    """Ground several formulas, which keep their shared nodes."""

    def changed(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        interval = _ground(node, step, continuous=continuous)
        if interval is node.interval:
            return rebuilt(node, args)
        return Apply(node.op, args, interval, node.span)

    implied = any(_implied(op, continuous=continuous) for each in formulas for op in contents(each).operators)
    if not implied and not any(
        node.interval.is_open for each in formulas for node in timed(each) if node.interval
    ):
        return tuple(formulas)
    return folds(formulas, changed)


def closed(interval: Interval, step: Fraction) -> Interval:
    """Return an interval with closed bounds; it is empty if it then ends before it begins.

    >>> from fractions import Fraction
    >>> closed(Interval(Fraction(0), Fraction(5), begin_open=True), Fraction(1)).begin
    Fraction(1, 1)
    """
    if not interval.is_open:
        return interval
    begin = interval.begin + step if interval.begin_open else interval.begin
    end = interval.end - step if interval.end_open and interval.end is not None else interval.end
    return replace(
        interval, begin=begin, end=end, begin_open=False, end_open=False, written=interval, implied=False
    )


def _implied(op: Operator, *, continuous: bool) -> bool:
    """Return whether an operator without an interval is given that of one step."""
    return op.one_tick if continuous else op.bounds is Bounds.DURATION


def _ground(node: Apply, step: Fraction, *, continuous: bool) -> Interval | None:
    if node.interval is not None:
        return closed(node.interval, step)
    if not _implied(node.op, continuous=continuous):
        return None
    unit = next((unit for unit, seconds in UNITS.items() if (step / seconds).denominator == 1), "")
    return Interval(step, step, unit, unit, implied=True)
