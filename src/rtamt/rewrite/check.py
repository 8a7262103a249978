"""What a well-formed formula must also satisfy before it can be evaluated: bounds, time domain, boundedness."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

from rtamt.errors import BoundError, SpecificationError
from rtamt.language.formula import Apply, Formula, children, postorder
from rtamt.language.operators import Bounds, Tense
from rtamt.language.units import format_duration
from rtamt.rewrite.desugar import spelled_out

#: The longest bound; sums of many such lags still fit into an int64.
_MOST_PERIODS = 2**44
_MOST_TICKS = 2**56
#: The longest sum of bounds of nested operators in dense time, where it is added to stamps.
_FARTHEST_TICKS = 2**61


def check_bounds(
    formula: Formula, period: Fraction, text: str | None = None, what: str = "sampling period"
) -> None:
    """Raise :class:`BoundError` unless every bound is a whole multiple of ``period`` (seconds).

    ``what`` is how the message calls the period: in dense time it is the resolution.

    >>> from fractions import Fraction
    >>> from rtamt.language.parser import parse_formula
    >>> check_bounds(parse_formula("always[0:1] x"), Fraction(1, 10))
    """
    discrete = what == "sampling period"
    steps, most = ("periods", _MOST_PERIODS) if discrete else ("ticks", _MOST_TICKS)
    longer = "a longer period" if discrete else "a coarser resolution"
    for node in postorder(spelled_out(formula)):
        if not isinstance(node, Apply) or node.interval is None:
            continue
        for bound in (node.interval.begin, node.interval.end):
            if bound is None:
                continue
            count, rest = divmod(  # of integers: a division of fractions costs ten times as much
                bound.numerator * period.denominator, bound.denominator * period.numerator
            )
            if rest != 0:
                raise BoundError(
                    f"The operator bound must be a multiple of the {what}: "
                    f"{format_duration(bound)} is not a whole number of {steps} of {format_duration(period)}; "
                    f"change the bound or the {steps[:-1]}",
                    text,
                    node.interval.span or node.span,
                )
            if count > most:
                raise BoundError(
                    f"{format_duration(bound)} is {_short(count)} {steps} of {format_duration(period)}, "
                    f"more than can be counted; shorten the bound, leave it open with inf, or choose {longer}",
                    text,
                    node.interval.span or node.span,
                )
    if not discrete:
        _check_sums(spelled_out(formula), period, text)


def _short(count: int) -> str:
    """Return a number that may be beyond every double with three digits."""
    return f"{float(count):.3g}" if count < 10**300 else f"{Decimal(count):.3g}"


def _check_sums(formula: Formula, tick: Fraction, text: str | None) -> None:
    """Raise :class:`BoundError` at an operator whose bounds, with those of its operands, reach too far."""
    reach: dict[int, Fraction] = {}
    none, farthest = Fraction(0), _FARTHEST_TICKS * tick
    for node in postorder(formula):
        far = none
        for operand in children(node):
            if reach[id(operand)] is not far:  # fractions are slow to compare
                far = max(far, reach[id(operand)])
        if isinstance(node, Apply) and node.interval is not None:
            far += node.interval.begin if node.interval.end is None else node.interval.end
            if far > farthest:
                raise BoundError(
                    f"the bounds from here inwards add up to {format_duration(far)}, {_short(int(far / tick))} ticks "
                    f"of {format_duration(tick)}, more than can be counted; shorten them, or choose a coarser "
                    f"resolution",
                    text,
                    node.interval.span or node.span,
                )
        reach[id(node)] = far


def check_online(formula: Formula, text: str | None = None) -> None:
    """Raise :class:`BoundError` at the first operator whose future is unbounded: it can never be known online."""
    node = unbounded_future(formula)
    if node is not None:
        raise BoundError(
            f"'{node.op.name}' without an upper bound needs the whole future and cannot be monitored online; "
            f"give it a bound, such as {node.op.name}[0:10], or evaluate the finished trace offline",
            text,
            node.span,
        )


def check_dense(formula: Formula, text: str | None = None) -> None:
    """Raise :class:`SpecificationError` at the first operator that only makes sense between samples."""
    for node in postorder(spelled_out(formula)):
        if isinstance(node, Apply) and node.op.discrete_only:
            raise SpecificationError(
                f"'{node.op.name}' means one sample away, which dense time does not have; "
                f"use a window such as once[0:1], or discrete time",
                text,
                node.span,
            )


def unbounded_future(formula: Formula) -> Apply | None:
    """Return the first (innermost, leftmost) operator that reads an unbounded future, or None."""
    for node in postorder(spelled_out(formula)):
        if isinstance(node, Apply) and reads_unbounded_future(node):
            return node
    return None


def reads_unbounded_future(node: Apply) -> bool:
    """Tell whether this operator itself, whatever its operands, reads an unbounded future."""
    if node.op.tense is not Tense.FUTURE:
        return False
    if node.op.bounds is Bounds.NONE:
        return node.op.reach is None
    return node.interval is None or node.interval.end is None


def has_future(formula: Formula) -> bool:
    """Tell whether any operator of the formula reads the future."""
    return any(isinstance(n, Apply) and n.op.tense is Tense.FUTURE for n in postorder(spelled_out(formula)))
