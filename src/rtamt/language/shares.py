"""Shares, the part of a window that must satisfy an operand: ``80%``, a number of samples, or a duration.

Such an operator (``atleast``) is the k-th largest value of a window of a nominal length, whatever of it lies outside
the trace: :func:`rank_of` counts both in steps.
"""

from __future__ import annotations

from enum import Enum
from math import ceil, inf

from rtamt.errors import BoundError
from rtamt.language.formula import Apply, Formula, Interval, Span
from rtamt.language.units.durations import UNITS, decimal, exact, why_not_exact
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable
    from fractions import Fraction

    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.parser import FormulaParser


class ShareKind(Enum):
    """The unit of the amount of a share."""

    PERCENT = "percent"
    SAMPLES = "samples"
    DURATION = "duration"  # in seconds


@dataclass(frozen=True, slots=True)
class Share:
    """An exact part of a window; ``unit`` is that of a duration as it was written."""

    amount: Fraction
    kind: ShareKind
    unit: str = field(default="", compare=False)
    span: Span | None = field(default=None, compare=False, repr=False)

    def text(self, form: Callable[[Fraction], str] | None = None) -> str:
        """Return the share as it is written."""
        amount = self.amount / UNITS[self.unit] if self.unit else self.amount
        written = form(amount) if form is not None else decimal(amount) or str(amount)
        if self.kind is ShareKind.PERCENT:
            return f"{written}%"
        return written + (self.unit or "s") if self.kind is ShareKind.DURATION else written


def is_share(formula: Formula) -> bool:
    """Return whether a formula is an operator of a share of its window."""
    return isinstance(formula, Apply) and formula.op.share


class Rank(NamedTuple):
    """The k-th largest of as many values as a window has steps, those outside the trace being ``outside``."""

    k: int
    outside: float


def rank_of(interval: Interval | None, step: Fraction, *, continuous: bool) -> Rank:
    """Return the rank of a share of an interval.

    ``step``: seconds of a period or tick. ``continuous``: in dense time a window has as many ticks as its length, in
    discrete time one sample more.
    """
    assert interval is not None
    assert interval.end is not None
    share = interval.share
    assert share is not None
    if share.kind is ShareKind.PERCENT:
        nominal = (interval.end - interval.begin) / step + (0 if continuous else 1)
        return Rank(ceil(share.amount * nominal / 100), inf)
    amount = share.amount / step if share.kind is ShareKind.DURATION else share.amount
    return Rank(ceil(amount), -inf)


def rank_arguments(
    interval: Interval | None, step: Fraction, *, continuous: bool
) -> tuple[int, float] | tuple[()]:
    """Return what the definition of an operator takes after the bounds: its rank, if it has one."""
    if interval is None or interval.share is None:
        return ()
    return rank_of(interval, step, continuous=continuous)


def _number(parser: FormulaParser, token: Token) -> Fraction:
    try:
        return exact(token.text)
    except ValueError:
        raise parser.error(f"the share {why_not_exact(token.text)}", token.span, BoundError) from None


def parse_share(parser: FormulaParser, name: str) -> Share:
    """``share = number , [ "/" , number ] , [ "%" | unit ]``: read the first operand of ``name``."""
    token = parser.next()
    if token.kind != "number":
        raise parser.error(
            f"expected a share of the window, such as 80%, 3 (samples) or 3s, got {token}; "
            f"write {name}[0:5](80%, ...)",
            token.span,
        )
    amount = _number(parser, token)
    if parser.accept("/"):
        below = parser.next()
        divisor = _number(parser, below) if below.kind == "number" else 0
        if divisor == 0:
            raise parser.error(f"expected a positive number after '/', got {below}", below.span)
        amount /= divisor
    unit, kind = "", ShareKind.SAMPLES
    if parser.accept("%"):
        kind = ShareKind.PERCENT
    elif parser.token.text in UNITS:
        unit, kind = parser.next().text, ShareKind.DURATION
        amount *= UNITS[unit]
    span = Span(token.start, parser.tokens[parser.index - 1].end)
    written = parser.text[span.start : span.end]
    if amount <= 0:
        raise parser.error(
            f"the share {written} is not positive: at least nothing always holds", span, BoundError
        )
    if kind is ShareKind.PERCENT and amount > 100:
        raise parser.error(f"the share {written} is more than the whole window, 100%", span, BoundError)
    if kind is ShareKind.SAMPLES and amount.denominator != 1:
        raise parser.error(
            f"{written} is not a whole number of samples; write a duration with a unit, or a share with %",
            span,
            BoundError,
        )
    if not parser.accept(","):
        raise parser.error(
            f"expected ',' and a formula after the share {written}, got {parser.token}", parser.token.span
        )
    return Share(amount, kind, unit, span)
