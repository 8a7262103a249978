"""Formula to text and to RTAMT's canonical text: parentheses only where the parser needs them."""

from __future__ import annotations

from functools import lru_cache
from math import isinf

from rtamt.language.formula import Apply, Const, Formula, Interval, Parameter, Var
from rtamt.language.operators import STL, Bounds, Fixity, Language
from rtamt.language.parsing.grammar import ELSE, INFINITY, THEN, is_infix, is_literal, sign
from rtamt.language.parsing.lexer import is_word
from rtamt.language.printing.parentheses import (
    falls_apart,
    hides_choice,
    is_choice,
    is_member,
    member_name,
    name_text,
    needs_group,
    reads_on,
    truth_of,
    written_operand,
)
from rtamt.language.printing.writing import EXCERPT, LONGEST, excerpts_of, text_of
from rtamt.language.units.durations import UNITS, decimal
from rtamt.language.unwritten import PRESENT, TRUTH, WHERE_PRESENT
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence
    from fractions import Fraction

    from rtamt.language.printing.writing import Piece

#: RTAMT identifiers that are not names here: RTAMT treats a slash as a letter.
_RTAMT_PATH = lazy_pattern(r"[^\W\d][\w$.]*(?:/[\w$.]+)+")


def to_text(
    formula: Formula, language: Language = STL, *, limit: int = LONGEST, parameters: bool = False
) -> str:
    """Return text that parses back to an equal formula, with the first spelling of each operator.

    A parameter is written as its value, with ``parameters`` by its name. ``language``: that of the formula.
    Variables whose names would be read as something else are put in parentheses or double quotes. A text of
    more than ``limit`` characters is abbreviated and marked: see :func:`excerpt`.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> to_text(parse_formula("G((req>=3)->(F[0,5](gnt>=3)))"))
    'always(req >= 3 -> eventually[0:5](gnt >= 3))'
    >>> to_text(parse_formula("a - (b - c)"))
    'a - (b - c)'
    """
    return text_of(formula, _writer(language, parameters=parameters), limit)


def excerpt(formula: Formula) -> str:
    """Return the text of a formula for a message, at most about 200 characters.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> excerpt(parse_formula("x >= 3"))
    'x >= 3'
    >>> doubled = parse_formula("x + y")
    >>> for _ in range(40):
    ...     doubled = parse_formula("a + a", definitions={"a": doubled})
    >>> excerpt(doubled)[-61:]
    '… (abbreviated: 4.39805e+12 operators, variables and numbers)'
    """
    return to_text(formula, limit=EXCERPT)


def excerpts(formulas: Sequence[Formula]) -> tuple[str, ...]:
    """Return the excerpts of several formulas, which may contain each other, in time proportional to their nodes.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formula = parse_formula("x >= 3 and y < 2")
    >>> excerpts([formula, formula.args[0]])
    ('x >= 3 and y < 2', 'x >= 3')
    """
    return excerpts_of(formulas, _writer(STL))


def _writer(language: Language, *, parameters: bool = False) -> Callable[[Formula], Iterable[Piece]]:
    """Return what writes one node: text, and formulas below it."""
    minus = sign(language)

    def group(child: Formula, needed: bool) -> tuple[Piece, ...]:
        return ("(", child, ")") if needed else (child,)

    def pieces(node: Formula) -> Iterable[Piece]:
        if isinstance(node, Var) or (parameters and isinstance(node, Parameter)):
            return (name_text(node.name, language),)
        if isinstance(node, Const):
            return (_constant(node, language),)
        if not isinstance(node, Apply):
            raise TypeError(f"{type(node).__name__} is not a formula")
        if node.op is TRUTH:
            return (written_operand(node),) if parameters else (truth_of(node),)
        op, word = node.op, node.op.spellings[0] + _bounds(node)
        if op is PRESENT and isinstance(node.args[0], Var):
            return (node.args[0].name,)  # of a channel, which no text contains
        if op is WHERE_PRESENT:
            return (written_operand(node),)
        if op.fixity is Fixity.ATOM:
            return (word,)
        if op.fixity is Fixity.QUANTIFIER:
            return (f"{word} {op.binder}: ", *node.args)
        if op.fixity is Fixity.FUNCTION:
            return (f"{word}({share_text(node, ', ')}", *_join(_operands(node), ", "), ")")
        if op.fixity is Fixity.CONDITIONAL:
            condition, first, second = node.args
            return (
                f"{word} ",
                *group(condition, is_choice(condition) or hides_choice(condition, language)),
                f" {THEN} ",
                *group(first, is_choice(first)),
                f" {ELSE} ",
                second,
            )
        if op.fixity is Fixity.PREFIX:
            (operand,) = node.args
            if needs_group(operand, op) or reads_on(operand, op, language):
                return (word, "(", operand, ")")
            return (word, " ", operand) if is_word(op.spellings[0]) else (word, operand)
        left, right = node.args
        return (
            *group(
                left, falls_apart(left, op, Fixity.LEFT, minus) or reads_on(left, op, language, left=True)
            ),
            f" {word} ",
            *group(right, falls_apart(right, op, Fixity.RIGHT, minus) or reads_on(right, op, language)),
        )

    return pieces


def canonical(formula: Formula, language: Language = STL, *, limit: int = LONGEST) -> str:
    """Return the formula in the form of RTAMT's node names: ``((a)>=(2.0))and(b)``, every operand in parentheses.

    ``limit``: as for :func:`to_text`. Deviations: unless is not expanded, a negative literal is one
    number, a bound has the unit in which it was read.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> canonical(parse_formula("always[0:5](a >= 2) and not prev(b)"))
    '(always[0,5]((a)>=(2.0)))and(not(previous(b)))'
    """

    def pieces(node: Formula) -> Iterable[Piece]:
        if isinstance(node, Const):
            return (repr(float(node.value)),)
        if isinstance(node, Var):
            return (node.name if _RTAMT_PATH.fullmatch(node.name) else name_text(node.name, language),)
        if not isinstance(node, Apply):
            raise TypeError(f"{type(node).__name__} is not a formula")
        op = node.op
        if op is TRUTH:
            return (truth_of(node),)
        if op in (PRESENT, WHERE_PRESENT):
            return (written_operand(node),)
        word = _longest(op.spellings) + _bounds(node, ",", str)
        if op.fixity is Fixity.ATOM:
            return (word,)
        if is_infix(op):
            return ("(", node.args[0], ")", word, "(", node.args[1], ")")
        if op.fixity is Fixity.QUANTIFIER:
            return (f"{word} {op.binder}:(", *node.args, ")")
        if op.fixity is Fixity.CONDITIONAL:
            return (f"{word}(", node.args[0], f"){THEN}(", node.args[1], f"){ELSE}(", node.args[2], ")")
        return (f"{word}({share_text(node, ',')}", *_join(node.args, ","), ")")

    return text_of(formula, pieces, limit)


def _constant(node: Const, language: Language) -> str:
    """Return a number, the name of a member of an enumeration, or true or false."""
    if is_literal(node):
        return str(node.name)
    return name_text(member_name(node), language) if is_member(node) else number(node.value)


def number(value: float) -> str:
    """Return the shortest text of a double that reads back as the same double.

    >>> number(3.0), number(-0.5), number(1e300)
    ('3', '-0.5', '1e+300')
    """
    if isinf(value):
        return INFINITY if value > 0 else f"-{INFINITY}"
    return repr(float(value)).removesuffix(".0")


def _join(operands: Iterable[Formula], separator: str) -> list[Piece]:
    joined: list[Piece] = []
    for operand in operands:
        joined += (separator, operand) if joined else (operand,)
    return joined


def _operands(node: Apply) -> tuple[Formula, ...]:
    """Return the operands of a function; f(f(a, b), c) is written f(a, b, c) where the function folds."""
    if not node.op.folds:
        return node.args
    last: list[Formula] = []
    first: Formula = node
    while isinstance(first, Apply) and first.op is node.op and first.interval == node.interval:
        last.extend(reversed(first.args[1:]))
        first = first.args[0]
    return (first, *reversed(last))


# ---- names, bounds -------------------------------------------------------------------------------


@lru_cache(maxsize=256)
def _longest(spellings: tuple[str, ...]) -> str:
    """Return RTAMT's spelling: the first spelling if it is a symbol, else the longest word."""
    if not is_word(spellings[0]):
        return spellings[0]
    return max((s for s in spellings if is_word(s)), key=len)


def rational_text(value: Fraction) -> str:
    """Return a number of a bound as a decimal, else as a fraction."""
    return decimal(value) or str(value)


def _bounds(node: Apply, separator: str = ":", form: Callable[[Fraction], str] = rational_text) -> str:
    """Return an operator's interval or duration as it was written, or nothing if there is none."""
    if node.interval is not None and node.op.bounds is Bounds.DURATION and not node.interval.implied:
        unit = node.interval.end_unit
        return f"[{form(node.interval.begin / UNITS[unit or 's'])}{unit}]"
    return interval_text(node.interval, separator, form)


def share_text(node: Apply, separator: str) -> str:
    """Return an operator's share of its window as the first of its operands, or nothing if it has none."""
    share = None if node.interval is None else node.interval.share
    return "" if share is None else f"{share.text()}{separator}"


def interval_text(
    interval: Interval | None, separator: str = ":", form: Callable[[Fraction], str] = rational_text
) -> str:
    """Return an interval as it was written, or nothing if there is none."""
    if interval is None or interval.implied:
        return ""
    interval = interval.written or interval
    begin_unit, end_unit = interval.begin_unit, interval.end_unit
    if interval.end is not None and end_unit:
        # A lower bound without a unit would be read in the unit of the upper bound; zero needs no unit.
        begin_unit = "" if interval.begin == 0 else begin_unit or "s"
    begin = form(interval.begin / UNITS[begin_unit or "s"]) + begin_unit
    end = INFINITY if interval.end is None else form(interval.end / UNITS[end_unit or "s"]) + end_unit
    opening, closing = "(" if interval.begin_open else "[", ")" if interval.end_open else "]"
    return f"{opening}{begin}{separator}{end}{closing}"
