"""The declared range and rate of a variable: ``input float speed [m/s] in [0, 60] rate [-8, 3]``.

::

    range = "in" , "[" , value , "," , value , "]"
    rate  = "rate" , "[" , value , "," , value , "]"

Analyses that know no recording suppose that the variable stays in its range, and that its change from sample to sample,
divided by the sampling period in seconds, stays in its rate. Verdicts before the horizon suppose the range of
future samples, and reject a sample outside. Evaluations of exact recordings check neither.
"""

from __future__ import annotations

from rtamt.language.formula import Span
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.language.parsing.declarations import DeclarationParser


def parse_range(parser: DeclarationParser, name: str, *, number: bool) -> tuple[float, float] | None:
    """``[ range ]``: the range of the variable ``name``, None where none is written.

    ``number``: whether the variable is a number.
    """
    if _words(parser, 2) != ["in", "["]:
        return None
    return _pair(
        parser,
        f"the range of '{name}'",
        "in [0, 60]",
        None if number else f"'{name}' is no number, so it has no range; leave out the range",
    )


def parse_rate(parser: DeclarationParser, name: str, *, number: bool) -> tuple[float, float] | None:
    """``[ rate ]``: the rate of the variable ``name``, None where none is written.

    ``number``: whether the variable is a number.
    """
    words = [word for word in _words(parser, 5) if word != "-"]
    if words[:2] != ["rate", "["] or words[3:4] != [","]:  # rate[2](x) is a formula
        return None
    return _pair(
        parser,
        f"the rate of '{name}'",
        "rate [-8, 3]",
        None if number else f"'{name}' is no number, so it has no rate; leave out the rate",
    )


def _words(parser: DeclarationParser, count: int) -> list[str]:
    """Return the texts of the next tokens."""
    return list(parser.texts[parser.index : parser.index + count])


def _pair(parser: DeclarationParser, what: str, example: str, unfit: str | None) -> tuple[float, float]:
    """``word , "[" , value , "," , value , "]"``; ``unfit``: the error where there is no such pair."""
    start = parser.next().start
    parser.next()
    low = parser.signed_number()
    comma = parser.accept(",")
    high = parser.signed_number() if comma else low
    if not comma or not parser.accept("]"):
        raise parser.error(f"expected {what}, such as {example}, got {parser.token}", parser.token.span)
    span = Span(start, parser.tokens[parser.index - 1].end)
    if unfit is not None:
        raise parser.error(unfit, span)
    if low > high:
        raise parser.error(f"{what} ends before it begins; exchange its ends", span)
    return low, high
