"""The interval after a temporal operator: exact bounds, their units, and errors."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache
from math import isinf

from rtamt.errors import BoundError, NameInFormulaError, choices, did_you_mean
from rtamt.language.formula import Interval, Span, span_of
from rtamt.language.operators import Bounds, Fixity
from rtamt.language.parsing.grammar import INFINITY
from rtamt.language.parsing.lexer import is_name, is_numeral, is_quoted
from rtamt.language.parsing.template_names import bound, constants_of
from rtamt.language.units.durations import UNITS, exact, is_less, why_not_exact
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.errors import SpecificationError
    from rtamt.language.operators import Operator
    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.parser import FormulaParser

    #: A number of units (None: infinite), the unit as written, the name if it is one, and the indices of its tokens.
    Bound = tuple[Fraction | None, str, str | None, tuple[int, int]]

_UNTIMED, _LASTING, _REQUIRED = Bounds.NONE, Bounds.DURATION, Bounds.REQUIRED
_WINDOWS = (Bounds.OPTIONAL, _REQUIRED)
_NAMED = frozenset(("name", "quoted"))
_SEPARATORS = frozenset(":,")
#: What follows a bound.
_AFTER = frozenset(":,])")


def parse_interval(parser: FormulaParser, op: Operator, at: int) -> Interval | None:
    """``interval = ( "[" | "(" ) , bound , [ ( ":" | "," ) , bound ] , ( "]" | ")" )``: read one after ``op``.

    ``at``: the operator's token. A bound without a unit has the default unit of the parser; a lower
    bound without a unit has that of the upper bound, as in RTAMT. A parenthesis excludes the bound beside it.
    Returns None if there is no interval and the operator does not require one.
    """
    texts, first = parser.texts, parser.index
    opening = texts[first]
    plain = _plain_interval(parser, op)
    if plain is not None:
        return plain
    if opening != "[" and not (opening == "(" and _begins_open(parser, op)):
        if op.bounds is _REQUIRED:
            raise _unbounded_error(parser, at, at, at)
        return None
    if op.bounds is _UNTIMED:
        raise parser.error(f"'{texts[at]}' takes no interval", _span(parser, first, first))
    parser.index = first + 1
    begin, begin_unit, name, begin_tokens = _bound(parser)
    end, end_unit, end_tokens = begin, begin_unit, begin_tokens
    names = [] if name is None else [name]
    separator = texts[parser.index]
    if op.bounds is not _LASTING:
        if separator not in _SEPARATORS:
            raise parser.error(
                f"expected ':' or ',' and an upper bound, got {parser.token}", parser.token.span
            )
        parser.index += 1
        end, end_unit, name, end_tokens = _bound(parser)
        names += [] if name is None else [name]
    elif separator in _SEPARATORS:
        raise parser.error(
            f"'{texts[at]}' takes one duration, such as {texts[at]}[5], got {parser.token}", parser.token.span
        )
    last = parser.index
    closing = texts[last]
    if closing != "]" and (op.bounds is _LASTING or closing != ")"):
        raise parser.error(f"expected ']' after the bounds, got {parser.token}", parser.token.span)
    parser.index = last + 1
    begin_open, end_open = opening == "(", closing == ")"
    if begin is None:
        what = "a duration" if op.bounds is _LASTING else "the lower bound of an interval"
        raise parser.error(f"{what} may not be infinite", _span(parser, *begin_tokens), BoundError)
    if op.positive and not begin:
        raise parser.error(
            f"'{texts[at]}' divides by its duration, which may not be 0; write one such as {texts[at]}[1]",
            _span(parser, *begin_tokens),
            BoundError,
        )
    if end is None and op.bounds is _REQUIRED:
        raise _unbounded_error(parser, at, *end_tokens)
    default = "" if parser.unit == "s" else parser.unit
    begin_unit, end_unit = begin_unit or end_unit or default, end_unit or default
    if begin_unit:
        begin *= UNITS[begin_unit]
    if end is None:
        end_unit = ""
    else:
        if end_unit:
            end *= UNITS[end_unit]
        if is_less(end, begin) or ((begin_open or end_open) and end == begin):
            raise _nothing_between(parser, _span(parser, first, last), reverse=is_less(end, begin))
    constants = constants_of(parser, names) if names else ()
    span = _span(parser, first, last)
    return Interval(begin, end, begin_unit, end_unit, span, constants, begin_open, end_open)


def _plain_interval(parser: FormulaParser, op: Operator) -> Interval | None:
    """Read an interval of two numbers without units, which most are; None, and nothing is read, for any other."""
    first = parser.index
    written = parser.texts[first : first + 5]
    if len(written) < 5 or written[0] != "[" or written[4] != "]" or op.bounds not in _WINDOWS:
        return None
    bounds = _plain_bounds(written[1], written[2], written[3], parser.unit)
    if bounds is None:
        return None
    parser.index = first + 5
    return Interval(*bounds, "", "", _span(parser, first, first + 4))


@lru_cache(1024)
def _plain_bounds(lower: str, separator: str, upper: str, unit: str) -> tuple[Fraction, Fraction] | None:
    """Return the bounds of such an interval, None if there are none or they are reversed."""
    if separator not in _SEPARATORS or unit != "s" or not (is_numeral(lower) and is_numeral(upper)):
        return None
    try:
        begin, end = exact(lower), exact(upper)
    except ValueError:
        return None
    return None if end < begin else (begin, end)


def _span(parser: FormulaParser, first: int, last: int) -> Span:
    """Return the position of the tokens from ``first`` to ``last``."""
    return span_of((parser.starts[first], parser.ends[last]))


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
    if op.bounds is _UNTIMED or op.bounds is _LASTING:
        return False
    near = parser.texts[parser.index + 2 : parser.index + 7]
    if ":" not in near and "," not in near:
        return False
    separator = _behind_bound(parser, parser.index + 1)
    if separator is None or parser.texts[separator] not in (",", ":"):
        return False
    closing = _behind_bound(parser, separator + 1)
    if closing is None or parser.texts[closing] != ")":
        return closing is not None and parser.texts[closing] == "]"
    if op.fixity is Fixity.FUNCTION:
        return parser.texts[closing + 1] == "("
    return parser.opens(closing + 1)


def _behind_bound(parser: FormulaParser, at: int) -> int | None:
    """Return the index of the token after a bound that begins at this token; None if none does."""
    texts = parser.texts
    at += texts[at] == "-"
    if not (is_numeral(texts[at]) or is_name(texts[at]) or is_quoted(texts[at])):
        return None
    at += 1
    if texts[at] == "/" and is_numeral(texts[at + 1]):
        at += 2
    return at + 1 if texts[at] in UNITS else at


def _unbounded_error(parser: FormulaParser, at: int, first: int, last: int) -> SpecificationError:
    name = parser.texts[at]
    return parser.error(
        f"'{name}' needs an interval with an upper bound, such as {name}[0:5]",
        _span(parser, first, last),
        BoundError,
    )


def _bound(parser: FormulaParser) -> Bound:
    """``bound = ( number , [ "/" , number ] | constant ) , [ unit ] | "inf"``."""
    texts, first = parser.texts, parser.index
    at = first
    negative = texts[at] == "-"
    at += negative
    value: Fraction | None
    unit, name = "", None
    parser.index = at + 1 if texts[at] else at  # the end is never consumed
    if is_numeral(texts[at]):
        value = _literal(parser, at)
        if parser.accept("/"):
            below = parser.next()
            if below.kind != "number":
                raise parser.error(f"expected a number after '/', got {below}", below.span)
            divisor = _literal(parser, parser.index - 1)
            if divisor == 0:
                raise parser.error(
                    "a bound may not be divided by zero", _span(parser, at, parser.index - 1), BoundError
                )
            value /= divisor
    elif parser.tokens[at].kind in _NAMED:
        token = parser.tokens[at]
        name = token.name
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
        token = parser.tokens[at]
        raise parser.error(f"expected a bound (a number or a constant), got {token}", token.span)
    tokens = first, parser.index - 1
    if negative or (value is not None and value.numerator < 0):
        raise parser.error(
            "a bound may not be negative; for the past use a past operator",
            _span(parser, *tokens),
            BoundError,
        )
    if texts[parser.index] in _AFTER:
        return value, unit, name, tokens
    follows, after = parser.token, parser.tokens[min(parser.index + 1, len(parser.tokens) - 1)]
    if follows.text in UNITS and unit:
        raise parser.error(
            f"'{name}' has a unit already, {unit}; leave out the unit here", follows.span, BoundError
        )
    if follows.text in UNITS:
        if value is None:
            message = f"an infinite bound has no unit; leave out '{follows.text}'"
            raise parser.error(message, follows.span)
        unit = parser.next().text
    elif follows.kind == "name" and after.text in _AFTER:
        raise parser.error(
            f"'{follows.text}' is not a unit of time{choices(follows.text, UNITS, 'units')}", follows.span
        )
    return value, unit, name, tokens


def _literal(parser: FormulaParser, at: int) -> Fraction:
    literal = parser.texts[at]
    try:
        return exact(literal)
    except ValueError:
        span = _span(parser, at, at)
        raise parser.error(f"the bound {why_not_exact(literal)}", span, BoundError) from None


def _constant(parser: FormulaParser, token: Token) -> Fraction | None:
    from rtamt.language.exact_number import exact_value

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
    return exact_value(value)
