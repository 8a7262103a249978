"""The sampling rule of a specification file: ``sample 100ms hold for 1s``.

::

    sampling = "sample" , duration , [ "hold" , [ "for" , duration ] , [ "skip" , "nan" ] ] , [ ";" ]
    duration = number , [ "/" , number ] , [ unit of time ]

It holds in discrete time: the sampling period and, with ``hold``, that each variable has its latest value at each
instant, whenever its samples arrived; with ``skip nan`` samples that are NaN are left out.
"""

from __future__ import annotations

from rtamt.errors import UsageError, choices
from rtamt.language.formula import Span
from rtamt.language.units.durations import UNITS, format_duration, positive_period
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

    from rtamt.language.parsing.requirements import RequirementParser


@dataclass(frozen=True, slots=True)
class Sampling:
    """A sampling rule; times in seconds.

    ``hold``: whether each variable has its latest value at each instant, and ``limit``: how old that value may be.
    ``skip_nan``: whether samples that are NaN are left out.
    """

    period: Fraction
    hold: bool = False
    limit: Fraction | None = None
    skip_nan: bool = False
    span: Span | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        limit = "" if self.limit is None else f" for {_format_seconds(self.limit)}"
        skip = " skip nan" if self.skip_nan else ""
        return f"sample {_format_seconds(self.period)}{' hold' * self.hold}{limit}{skip}"


def _format_seconds(seconds: Fraction) -> str:
    return format_duration(seconds).replace(" ", "")


def parse_sampling(parser: RequirementParser) -> Sampling:
    """``sampling = "sample" , duration , [ "hold" , [ "for" , duration ] , [ "skip" , "nan" ] ] , [ ";" ]``."""
    start = parser.next().start
    period, limit = _duration(parser, "sampling period"), None
    hold = _keyword(parser, "hold")
    if hold and _keyword(parser, "for"):
        limit = _duration(parser, "longest time for which a value is held")
    if not hold and parser.token.text == "skip" and parser.tokens[parser.index + 1].text == "nan":
        rule = str(Sampling(period, hold=True, skip_nan=True))
        raise parser.error(f"'skip nan' stands after 'hold': write {rule}", parser.token.span)
    skip = hold and _keyword(parser, "skip")
    if skip and not _keyword(parser, "nan"):
        raise parser.error(f"expected 'nan' after 'skip', got {parser.token}", parser.token.span)
    span = Span(start, parser.tokens[parser.index - 1].end)
    parser.accept(";")
    return Sampling(period, hold, limit, skip, span)


def _keyword(parser: RequirementParser, *words: str) -> bool:
    """Consume a word, unless it is the first operand of a formula or defined here."""
    after = parser.tokens[min(parser.index + 1, len(parser.tokens) - 1)].text
    if parser.token.text not in words or parser.language.infix(after) is not None or after == "=":
        return False
    parser.next()
    return True


def _duration(parser: RequirementParser, what: str) -> Fraction:
    """``duration = number , [ "/" , number ] , [ unit of time ]``."""
    first = parser.next()
    if first.kind != "number":
        raise parser.error(f"expected the {what}, such as 100ms, got {first}", first.span)
    number = first.text
    if parser.token.text == "/" and parser.tokens[parser.index + 1].kind == "number":
        parser.next()
        number += f"/{parser.next().text}"
    span = Span(first.start, parser.tokens[parser.index - 1].end)
    unit = parser.token
    if unit.kind == "name" and unit.start == span.end and unit.text not in UNITS:
        raise parser.error(
            f"'{unit.text}' is not a unit of time{choices(unit.text, UNITS, 'units')}", unit.span
        )
    written = unit.text if _keyword(parser, *UNITS) else parser.unit
    try:
        return positive_period(f"{number}{written}", what)
    except UsageError as error:
        raise parser.error(str(error), span) from None
