"""Formula to text, to RTAMT's canonical text and to LaTeX: parentheses only where the parser needs them.

Nothing here recurses: a formula is written from the outside in, from a stack of pieces, in time
proportional to the output. The text of a formula with shared sub-formulas may be astronomically long, so
a text beyond a limit is abbreviated: its beginning, followed by the size of the formula.
"""

from __future__ import annotations

import re
from functools import lru_cache
from math import copysign, isinf
from string import Formatter
from typing import TYPE_CHECKING, TypeGuard

from rtamt.language.formula import COUNTLESS, Apply, Const, Formula, Interval, Parameter, Var, size
from rtamt.language.grammar import ELSE, INFINITY, THEN, is_infix, is_predicate, passes_on, sign
from rtamt.language.lexer import NAME, TOPIC, is_word, quoted
from rtamt.language.operators import STL, TRUTH, Bounds, Fixity, Language, Operator
from rtamt.language.units import UNITS, decimal
from rtamt.language.value_types import Enumeration

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from fractions import Fraction

    #: Text, or a formula that is still to be written.
    Piece = str | Formula

#: The longest text in characters that is written in full by default,
LONGEST = 1_000_000
#: in tables and reports,
PAGE = 10_000
#: and in a message; a longer text is cut to this length.
EXCERPT = 200

#: RTAMT identifiers that are not names here: RTAMT treats a slash as a letter.
_RTAMT_PATH = re.compile(r"[^\W\d][\w$.]*(?:/[\w$.]+)+")


def to_text(
    formula: Formula, language: Language = STL, *, limit: int = LONGEST, parameters: bool = False
) -> str:
    """Return text that parses back to an equal formula, with the first spelling of each operator.

    A parameter is written as its value, with ``parameters`` by its name. ``language``: that of the formula.
    Variables whose names would be read as something else are put in parentheses or double quotes. A text of
    more than ``limit`` characters is abbreviated and marked: see :func:`excerpt`.

    >>> from rtamt.language.parser import parse_formula
    >>> to_text(parse_formula("G((req>=3)->(F[0,5](gnt>=3)))"))
    'always(req >= 3 -> eventually[0:5](gnt >= 3))'
    >>> to_text(parse_formula("a - (b - c)"))
    'a - (b - c)'
    """
    minus = sign(language)

    def group(child: Formula, needed: bool) -> tuple[Piece, ...]:
        return ("(", child, ")") if needed else (child,)

    def pieces(node: Formula) -> Iterable[Piece]:
        if isinstance(node, Var) or (parameters and isinstance(node, Parameter)):
            return (_name(node.name, language),)
        if isinstance(node, Const):
            return (_constant(node, language),)
        if not isinstance(node, Apply):
            raise TypeError(f"{type(node).__name__} is not a formula")
        if node.op is TRUTH:
            return (_written_operand(node),) if parameters else (_truth(node),)
        op, word = node.op, node.op.spellings[0] + _bounds(node)
        if op.fixity is Fixity.ATOM:
            return (word,)
        if op.fixity is Fixity.FUNCTION:
            return (f"{word}({_share(node, ', ')}", *_joined(_operands(node), ", "), ")")
        if op.fixity is Fixity.CONDITIONAL:
            condition, first, second = node.args
            return (
                f"{word} ",
                *group(condition, _is_choice(condition)),
                f" {THEN} ",
                *group(first, _is_choice(first)),
                f" {ELSE} ",
                second,
            )
        if op.fixity is Fixity.PREFIX:
            (operand,) = node.args
            if _needs_group(operand, op) or _reads_on(operand, op, language):
                return (word, "(", operand, ")")
            return (word, " ", operand) if is_word(op.spellings[0]) else (word, operand)
        left, right = node.args
        return (
            *group(
                left, _falls_apart(left, op, Fixity.LEFT, minus) or _reads_on(left, op, language, left=True)
            ),
            f" {word} ",
            *group(right, _falls_apart(right, op, Fixity.RIGHT, minus) or _reads_on(right, op, language)),
        )

    return _written(formula, pieces, limit)


def excerpt(formula: Formula) -> str:
    """Return the text of a formula for a message, at most about 200 characters.

    >>> from rtamt.language.parser import parse_formula
    >>> excerpt(parse_formula("x >= 3"))
    'x >= 3'
    >>> doubled = parse_formula("x + y")
    >>> for _ in range(40):
    ...     doubled = parse_formula("a + a", definitions={"a": doubled})
    >>> excerpt(doubled)[-61:]
    '… (abbreviated: 4.39805e+12 operators, variables and numbers)'
    """
    return to_text(formula, limit=EXCERPT)


def canonical(formula: Formula, language: Language = STL, *, limit: int = LONGEST) -> str:
    """Return the formula in the form of RTAMT's node names: ``((a)>=(2.0))and(b)``, every operand in parentheses.

    ``limit``: as for :func:`to_text`. Deviations: unless is not expanded, a negative literal is one
    number, a bound has the unit in which it was read.

    >>> from rtamt.language.parser import parse_formula
    >>> canonical(parse_formula("always[0:5](a >= 2) and not prev(b)"))
    '(always[0,5]((a)>=(2.0)))and(not(previous(b)))'
    """

    def pieces(node: Formula) -> Iterable[Piece]:
        if isinstance(node, Const):
            return (repr(float(node.value)),)
        if isinstance(node, Var):
            return (node.name if _RTAMT_PATH.fullmatch(node.name) else _name(node.name, language),)
        if not isinstance(node, Apply):
            raise TypeError(f"{type(node).__name__} is not a formula")
        op = node.op
        if op is TRUTH:
            return (_truth(node),)
        word = _longest(op.spellings) + _bounds(node, ",", str)
        if op.fixity is Fixity.ATOM:
            return (word,)
        if is_infix(op):
            return ("(", node.args[0], ")", word, "(", node.args[1], ")")
        if op.fixity is Fixity.CONDITIONAL:
            return (f"{word}(", node.args[0], f"){THEN}(", node.args[1], f"){ELSE}(", node.args[2], ")")
        return (f"{word}({_share(node, ',')}", *_joined(node.args, ","), ")")

    return _written(formula, pieces, limit)


def to_latex(formula: Formula) -> str:
    r"""Return the formula as LaTeX mathematics, without dollar signs, from the operators' templates.

    For a formula of more than :data:`LONGEST` characters, the result is a text that gives the size of
    the formula.

    >>> from rtamt.language.parser import parse_formula
    >>> print(to_latex(parse_formula("always(req >= 3 -> eventually[0:5](gnt >= 3))")))
    \mathbf{G} (\mathrm{req} \geq 3 \to \mathbf{F}_{[0, 5]} (\mathrm{gnt} \geq 3))
    """
    minus = sign(STL)

    def grouped(node: Apply, k: int) -> bool:
        child, op = node.args[k], node.op
        if is_infix(op):
            return _falls_apart(child, op, Fixity.RIGHT if k else Fixity.LEFT, minus)
        if op.fixity is Fixity.CONDITIONAL:
            return k < 2 and _is_choice(child)
        if op.fixity is Fixity.PREFIX and isinstance(child, Apply) and child.op.fixity is Fixity.PREFIX:
            return not passes_on(op)
        return _needs_group(child, op) or (op.fixity is Fixity.FUNCTION and isinstance(child, Apply))

    def pieces(node: Formula) -> Iterable[Piece]:
        if isinstance(node, Const):
            yield _latex_name(str(node.name)) if _is_member(node) else _latex_number(node.value)
        elif isinstance(node, Var):
            yield _latex_name(node.name)
        elif isinstance(node, Apply) and node.op is TRUTH:
            truth = _truth(node)
            yield STL[truth].latex if isinstance(truth, str) else truth
        elif isinstance(node, Apply):
            for literal, operand, exposed in _template(
                _latex_of(node.op, len(node.args)), node.interval is not None
            ):
                yield literal
                if operand == "I":
                    yield _latex_interval(node)
                elif operand == "S":
                    yield _share(node, "").replace("%", r"\%")
                elif operand is not None:
                    k = int(operand)
                    yield from ("(", node.args[k], ")") if exposed and grouped(node, k) else (node.args[k],)
        else:
            raise TypeError(f"{type(node).__name__} is not a formula")

    text = _write(formula, pieces, LONGEST)
    return rf"\text{{a formula of {_extent(formula)}}}" if text is None else text


def _constant(node: Const, language: Language) -> str:
    """Return a number, or the name of a member of an enumeration."""
    return _name(str(node.name), language) if _is_member(node) else number(node.value)


def number(value: float) -> str:
    """Return the shortest text of a double that reads back as the same double.

    >>> number(3.0), number(-0.5), number(1e300)
    ('3', '-0.5', '1e+300')
    """
    if isinf(value):
        return INFINITY if value > 0 else f"-{INFINITY}"
    return repr(float(value)).removesuffix(".0")


# ---- writing -------------------------------------------------------------------------------------


def _written(formula: Formula, pieces: Callable[[Formula], Iterable[Piece]], limit: int) -> str:
    """Write a formula; if the text is longer than ``limit``, its beginning and the size of the formula."""
    text = _write(formula, pieces, limit)
    if text is not None:
        return text
    begin = ""
    for more in _texts(formula, pieces):
        begin += more
        if len(begin) >= EXCERPT:
            break
    return f"{begin[:EXCERPT]}… (abbreviated: {_extent(formula)})"


def _write(formula: Formula, pieces: Callable[[Formula], Iterable[Piece]], limit: int) -> str | None:
    """Write a formula, given the pieces of one node; None if the text has more than ``limit`` characters."""
    if size(formula) > limit:  # every node takes at least one character
        return None
    out: list[str] = []
    for text in _texts(formula, pieces):
        out.append(text)
        limit -= len(text)
        if limit < 0:
            return None
    return "".join(out)


def _texts(formula: Formula, pieces: Callable[[Formula], Iterable[Piece]]) -> Iterator[str]:
    stack: list[Piece] = [formula]
    while stack:
        piece = stack.pop()
        if isinstance(piece, str):
            yield piece
        else:
            stack.extend(reversed(tuple(pieces(piece))))


def _extent(formula: Formula) -> str:
    count = size(formula)
    number = f"more than {COUNTLESS:.0e}" if count == COUNTLESS else f"{count:.6g}"
    return f"{number} operators, variables and numbers"


def _joined(operands: Iterable[Formula], separator: str) -> list[Piece]:
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


# ---- parentheses ---------------------------------------------------------------------------------


def _written_operand(formula: Formula) -> Formula:
    """Return what stands in the text: a Boolean itself, not its truth."""
    return formula.args[0] if isinstance(formula, Apply) and formula.op is TRUTH else formula


def _truth(node: Apply) -> Piece:
    """Return what stands for the truth of a Boolean in the text: of a parameter, its value as a formula."""
    (operand,) = node.args
    return ("true" if operand.value else "false") if isinstance(operand, Parameter) else operand


def _is_member(formula: Formula) -> TypeGuard[Const]:
    """Return whether a formula is a member of an enumeration, which is written as its name."""
    return isinstance(formula, Const) and isinstance(formula.type, Enumeration) and formula.name is not None


def _is_negative(formula: Formula) -> bool:
    return isinstance(formula, Const) and not _is_member(formula) and copysign(1.0, formula.value) < 0


def _is_choice(formula: Formula) -> bool:
    return isinstance(formula, Apply) and formula.op.fixity is Fixity.CONDITIONAL


def _needs_group(operand: Formula, op: Operator) -> bool:
    """Return whether the operand of a prefix operator needs parentheses (also a number after a minus)."""
    operand = _written_operand(operand)
    if isinstance(operand, Apply):
        return operand.op.fixity not in (Fixity.FUNCTION, Fixity.ATOM)
    return isinstance(operand, Const) and (_is_negative(operand) or not passes_on(op))


def _falls_apart(child: Formula, op: Operator, side: Fixity, minus: Operator | None) -> bool:
    """Return whether an infix operator's operand needs parentheses, on the side to which ``side`` chains."""
    child = _written_operand(child)
    if _is_negative(child):
        return minus is None or minus.power <= op.power
    if not isinstance(child, Apply) or child.op.fixity in (Fixity.FUNCTION, Fixity.ATOM):
        return False
    if _is_choice(child) or (is_predicate(child.op) and is_predicate(op)):
        return True
    chain = child.op.power == op.power and child.op.fixity is op.fixity is side
    return child.op.power <= op.power and not chain


def _reads_on(child: Formula, op: Operator, language: Language, *, left: bool = False) -> bool:
    """Return whether a variable such as ``G`` or ``S`` would be read as the operator of that spelling.

    This happens where a symbol may follow that can also begin an operand: ``G - 3`` is always(-3).
    """
    child = _written_operand(child)
    name = child.name if isinstance(child, Var) or _is_member(child) else None
    if name is None or _name(name, language) != name:
        return False
    prefix, infix = language.opening(name), language.infix(name)
    if infix is None and (prefix is None or prefix.fixity is not Fixity.PREFIX):
        # A topic after a word could also be a division.
        return TOPIC.fullmatch(name) is not None and is_word(op.spellings[0])
    if op.fixity is Fixity.PREFIX and infix is not None:
        return True
    if left:
        return language.opening(op.spellings[0]) is not None
    return any(
        other.power <= op.power and any(map(language.opening, other.spellings))
        for other in language
        if is_infix(other)
    )


# ---- names, bounds -------------------------------------------------------------------------------


def _name(name: str, language: Language) -> str:
    """Return a variable's name, in double quotes if it would not be read as a name."""
    if NAME.fullmatch(name) is None and TOPIC.fullmatch(name) is None:
        return quoted(name)
    opening, infix = language.opening(name), language.infix(name)
    spelled_out = (
        name == INFINITY
        or (opening is not None and opening.fixity is Fixity.ATOM)
        or (opening is not None and opening.fixity is Fixity.PREFIX and len(name) > 2)
        or (infix is not None and len(name) > 1)
        or (opening is not None and opening.fixity is Fixity.CONDITIONAL)
        or name in (THEN, ELSE)
    )
    return quoted(name) if spelled_out else name


@lru_cache(maxsize=256)
def _longest(spellings: tuple[str, ...]) -> str:
    """Return RTAMT's spelling: the first spelling if it is a symbol, else the longest word."""
    if not is_word(spellings[0]):
        return spellings[0]
    return max((s for s in spellings if is_word(s)), key=len)


def _rational(value: Fraction) -> str:
    return decimal(value) or str(value)


def _bounds(node: Apply, separator: str = ":", form: Callable[[Fraction], str] = _rational) -> str:
    """Return an operator's interval or duration as it was written, or nothing if there is none."""
    if node.interval is not None and node.op.bounds is Bounds.DURATION and not node.interval.implied:
        unit = node.interval.end_unit
        return f"[{form(node.interval.begin / UNITS[unit or 's'])}{unit}]"
    return interval_text(node.interval, separator, form)


def _share(node: Apply, separator: str) -> str:
    """Return an operator's share of its window as the first of its operands, or nothing if it has none."""
    share = None if node.interval is None else node.interval.share
    return "" if share is None else f"{share.text()}{separator}"


def interval_text(
    interval: Interval | None, separator: str = ":", form: Callable[[Fraction], str] = _rational
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


# ---- LaTeX ---------------------------------------------------------------------------------------


def _latex_of(op: Operator, operands: int) -> str:
    """Return an operator's template for so many operands, or one built from its first spelling."""
    if op.latex:
        return op.latex
    word = op.spellings[0].replace("{", "{{").replace("}", "}}")
    name = rf"\mathrm{{{{{_escaped(word)}}}}}_{{I}}"
    fields = [f"{{{k}}}" for k in range(operands)]
    if is_infix(op):
        return rf"{fields[0]} \mathbin{{{{{name}}}}} {fields[1]}"
    return f"{name}({', '.join(fields)})" if op.fixity is Fixity.FUNCTION else " ".join([name, *fields])


@lru_cache(maxsize=256)
def _template(template: str, timed: bool) -> tuple[tuple[str, str | None, bool], ...]:
    """Split a template into (text, field or None, whether the field is not enclosed)."""
    if not timed:
        template = template.replace("_{I}", "").replace("{I}", "")
    parts, before = [], ""
    for literal, name, _spec, _conversion in Formatter().parse(template):
        before += literal
        seen = before.rstrip()
        exposed = not seen.strip("{") or seen[-1] not in "({[|,"
        parts.append((literal, name, exposed))
        before += name or ""
    return tuple(parts)


def _latex_interval(node: Apply) -> str:
    interval = node.interval
    if interval is None or interval.implied:
        return ""
    interval = interval.written or interval

    def bound(value: Fraction, unit: str) -> str:
        return _rational(value / UNITS[unit or "s"]) + (rf"\,\mathrm{{{unit}}}" if unit else "")

    begin = bound(interval.begin, interval.begin_unit if interval.begin else "")
    if node.op.bounds is Bounds.DURATION:
        return f"{{{begin}}}"
    opening, closing = "(" if interval.begin_open else "[", ")" if interval.end_open else "]"
    end = r"\infty)" if interval.end is None else bound(interval.end, interval.end_unit) + closing
    return f"{{{opening}{begin}, {end}}}"


def _latex_number(value: float) -> str:
    text = number(value).replace(INFINITY, r"\infty")
    if "e" not in text:
        return text
    mantissa, exponent = text.split("e")
    return rf"{mantissa} \cdot 10^{{{int(exponent)}}}"


def _latex_name(name: str) -> str:
    escaped = _escaped(name)
    return escaped if len(name) == 1 else rf"\mathrm{{{escaped}}}"


def _escaped(name: str) -> str:
    special = {"\\": r"\backslash ", "^": r"\hat{\ }", "~": r"\sim ", " ": r"\ "}
    return "".join(special.get(c, f"\\{c}" if c in "{}$&#_%" else c) for c in name)
