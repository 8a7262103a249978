"""The interval after a temporal operator: exact bounds, their units, and errors."""

from __future__ import annotations

from fractions import Fraction
from math import isinf
from typing import TYPE_CHECKING

from rtamt.errors import BoundError, NameInFormulaError, choices, did_you_mean
from rtamt.language.formula import Interval, Span
from rtamt.language.operators import Bounds, Fixity
from rtamt.language.parsing.grammar import INFINITY
from rtamt.language.parsing.templates import bound, constants_of
from rtamt.language.units.durations import UNITS, exact
from rtamt.language.value_types import BOOLEAN

if TYPE_CHECKING:
    from rtamt.errors import SpecificationError
    from rtamt.language.operators import Operator
    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.parser import FormulaParser

    #: A number of units (None: infinite), the unit as written, and the place.
    Bound = tuple[Fraction | None, str, Span]


def parse_interval(parser: FormulaParser, op: Operator, token: Token) -> Interval | None:
    """``interval = ( "[" | "(" ) , bound , [ ( ":" | "," ) , bound ] , ( "]" | ")" )``: read one after ``op``.

    ``token``: the operator as it is written. A bound without a unit has the default unit of the parser; a lower
    bound without a unit has that of the upper bound, as in RTAMT. A parenthesis excludes the bound beside it.
    Returns None if there is no interval and the operator does not require one.
    """
    opening = parser.token
    if opening.text != "[" and not (opening.text == "(" and _begins_open(parser, op)):
        if op.bounds is Bounds.REQUIRED:
            raise _unbounded(parser, token, token.span)
        return None
    if op.bounds is Bounds.NONE:
        raise parser.error(f"'{token.text}' takes no interval", opening.span)
    parser.next()
    first = parser.index
    begin, begin_unit, begin_span = _bound(parser)
    separator = parser.token
    end, end_unit, end_span = begin, begin_unit, begin_span
    if op.bounds is not Bounds.DURATION:
        if not parser.accept(":") and not parser.accept(","):
            raise parser.error(f"expected ':' or ',' and an upper bound, got {separator}", separator.span)
        end, end_unit, end_span = _bound(parser)
    elif separator.text in (":", ","):
        raise parser.error(
            f"'{token.text}' takes one duration, such as {token.text}[5], got {separator}", separator.span
        )
    closing = parser.token
    if not parser.accept("]") and (op.bounds is Bounds.DURATION or not parser.accept(")")):
        raise parser.error(f"expected ']' after the bounds, got {closing}", closing.span)
    begin_open, end_open = opening.text == "(", closing.text == ")"
    span = Span(opening.start, closing.end)
    if begin is None:
        what = "a duration" if op.bounds is Bounds.DURATION else "the lower bound of an interval"
        raise parser.error(f"{what} may not be infinite", begin_span, BoundError)
    if op.positive and not begin:
        raise parser.error(
            f"'{token.text}' divides by its duration, which may not be 0; write one such as {token.text}[1]",
            begin_span,
            BoundError,
        )
    if end is None and op.bounds is Bounds.REQUIRED:
        raise _unbounded(parser, token, end_span)
    default = "" if parser.unit == "s" else parser.unit
    begin_unit, end_unit = begin_unit or end_unit or default, end_unit or default
    if begin_unit:
        begin *= UNITS[begin_unit]
    if end is not None:
        if end_unit:
            end *= UNITS[end_unit]
        if end <= begin and (end < begin or begin_open or end_open):
            raise _nothing_between(parser, span, reverse=end < begin)
    read = parser.tokens[first : parser.index]
    names = tuple(token.name for token in read if token.kind in ("name", "quoted"))
    constants = constants_of(parser, names) if names else ()
    return Interval(
        begin, end, begin_unit, "" if end is None else end_unit, span, constants, begin_open, end_open
    )


def _nothing_between(parser: FormulaParser, span: Span, *, reverse: bool) -> SpecificationError:
    why = (
        "is reversed: it ends before it begins"
        if reverse
        else "is empty: it excludes its only instant; close both bounds, or move one"
    )
    return parser.error(f"the interval {parser.text[span.start : span.end]} {why}", span, BoundError)


def _begins_open(parser: FormulaParser, op: Operator) -> bool:
    """Return whether a parenthesis begins an interval: two bounds, ``]``, or ``)`` in front of an operand.

    Otherwise it begins an operand: ``always(x)``. What is taken for an interval here has no other reading.
    """
    if op.bounds in (Bounds.NONE, Bounds.DURATION):
        return False
    separator = _behind_bound(parser, parser.index + 1)
    if separator is None or parser.tokens[separator].text not in (",", ":"):
        return False
    closing = _behind_bound(parser, separator + 1)
    if closing is None or parser.tokens[closing].text != ")":
        return closing is not None and parser.tokens[closing].text == "]"
    if op.fixity is Fixity.FUNCTION:
        return parser.tokens[closing + 1].text == "("
    return parser.opens(closing + 1)


def _behind_bound(parser: FormulaParser, at: int) -> int | None:
    """Return the index of the token after a bound that begins at this token; None if none does."""
    tokens = parser.tokens
    at += tokens[at].text == "-"
    if tokens[at].kind not in ("number", "name", "quoted"):
        return None
    at += 1
    if tokens[at].text == "/" and tokens[at + 1].kind == "number":
        at += 2
    return at + 1 if tokens[at].text in UNITS else at


def _unbounded(parser: FormulaParser, token: Token, span: Span) -> SpecificationError:
    return parser.error(
        f"'{token.text}' needs an interval with an upper bound, such as {token.text}[0:5]", span, BoundError
    )


def _bound(parser: FormulaParser) -> Bound:
    """``bound = ( number , [ "/" , number ] | constant ) , [ unit ] | "inf"``."""
    first = token = parser.next()
    negative = first.text == "-"
    if negative:
        token = parser.next()
    value: Fraction | None
    unit = ""
    if token.kind == "number":
        value = _literal(parser, token)
        if parser.accept("/"):
            below = parser.next()
            if below.kind != "number":
                raise parser.error(f"expected a number after '/', got {below}", below.span)
            divisor = _literal(parser, below)
            if divisor == 0:
                raise parser.error(
                    "a bound may not be divided by zero", Span(token.start, below.end), BoundError
                )
            value /= divisor
    elif token.kind in ("name", "quoted"):
        stands_for = bound(parser, token.name, token.span)
        value, unit = stands_for or (_constant(parser, token), parser.scope.units.get(token.name, ""))
        if unit and unit not in UNITS:
            *most, last = UNITS
            raise parser.error(
                f"'{token.name}' is in {unit}, and a bound is a time: declare it in {', '.join(most)} or {last}, "
                f"or without a unit",
                token.span,
                BoundError,
            )
    else:
        raise parser.error(f"expected a bound (a number or a constant), got {token}", token.span)
    span = Span(first.start, parser.tokens[parser.index - 1].end)
    if negative or (value is not None and value.numerator < 0):
        raise parser.error("a bound may not be negative; for the past use a past operator", span, BoundError)
    name, after = parser.token, parser.tokens[min(parser.index + 1, len(parser.tokens) - 1)]
    if name.text in UNITS and unit:
        raise parser.error(
            f"'{token.name}' has a unit already, {unit}; leave out the unit here", name.span, BoundError
        )
    if name.text in UNITS and value is not None:
        unit = parser.next().text
    elif name.kind == "name" and after.text in (":", ",", "]", ")"):
        raise parser.error(
            f"'{name.text}' is not a unit of time{choices(name.text, UNITS, 'units')}", name.span
        )
    return value, unit, span


def _literal(parser: FormulaParser, token: Token) -> Fraction:
    try:
        return exact(token.text)
    except ValueError:
        raise parser.error("the bound is beyond the range of a double", token.span, BoundError) from None


def _constant(parser: FormulaParser, token: Token) -> Fraction | None:
    constants, name = parser.scope.constants, token.name
    value = constants.get(name)
    if value is None:
        if token.text == INFINITY:
            return None
        hint = did_you_mean(name, constants) or f"; a bound is a number, a constant or {INFINITY}"
        raise parser.error(f"'{name}' is not a declared constant{hint}", token.span, NameInFormulaError)
    type_ = parser.scope.types.get(name)
    if type_ is not None:
        kind = "a Boolean" if type_ is BOOLEAN else f"of the enumeration {type_.name}"
        raise parser.error(
            f"'{name}' is {kind}, and a bound is a number; declare it as float, such as const float {name} = 5",
            token.span,
            BoundError,
        )
    if isinf(value):
        # Minus infinity is negative, too.
        return None if value > 0 else Fraction(-1)
    return exact(str(float(value)))
