"""Formula to an English sentence, from the phrases of the operator table.

Operands are in parentheses where a reader could attach them to another operator, so that different formulas have
different sentences. An operand at the end of a phrase extends as far to the right as it can.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Formula, Parameter, Var, children
from rtamt.language.operators import STL, Bounds, Fixity, Sort, Tense
from rtamt.language.parsing.grammar import is_infix, is_literal, is_number
from rtamt.language.printing.parentheses import is_member, member_name, written_operand
from rtamt.language.printing.printer import number, rational_text
from rtamt.language.printing.writing import LONGEST, text_of
from rtamt.language.units.durations import UNITS
from rtamt.language.unwritten import TRUTH, WHERE_PRESENT, is_truth
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from fractions import Fraction

    from rtamt.language.formula import Interval
    from rtamt.language.operators import Operator
    from rtamt.language.printing.writing import Piece

_PLACE = lazy_pattern(r"\{(\w)\}")


def to_english(
    formula: Formula,
    *,
    names: Mapping[int, str] | None = None,
    units: Mapping[str, str] | None = None,
    limit: int = LONGEST,
) -> str:
    """Return a formula in English, without a capital letter and a full stop.

    ``names``: from the ID of a part to the name that stands for it; the whole is written out. ``units``: of
    variables, constants and parameters.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> to_english(parse_formula("always(req >= 3 -> eventually[0:500ms](gnt >= 3))"))
    'at every instant from now on, if req is at least 3, then at some instant within the next 500 ms, gnt is at least 3'
    >>> to_english(parse_formula("(a > 1 or b > 1) and c > abs(a - b)"))
    '(a is more than 1 or b is more than 1) and c is more than |a minus b|'
    """
    english = _English(formula, names or {}, units or {})
    return text_of(formula, english.pieces, limit)


def begins_with_name(formula: Formula, names: Mapping[int, str]) -> bool:
    """Return whether a formula in English begins with a name or a number instead of a word; ``names`` as above."""
    english = _English(formula, names, {})
    first = formula
    while isinstance(first, Apply) and english.name(first) is None:
        if first.op is WHERE_PRESENT:
            first = first.args[0]
            continue
        piece = next(piece for piece in english.pieces(first) if piece != "")
        if isinstance(piece, str):
            return False
        first = piece
    return True


class _English:
    """The printer of the nodes of a formula."""

    def __init__(self, whole: Formula, names: Mapping[int, str], units: Mapping[str, str]) -> None:
        self._whole = whole
        self._names = names
        self._units = units

    def name(self, part: Formula) -> str | None:
        """Return the name that stands for a part, if there is one; the whole has none."""
        return None if part is self._whole else self._names.get(id(part))

    def pieces(self, node: Formula) -> tuple[Piece, ...]:
        """Return a node as text and operands."""
        name = self.name(node)
        if name is not None:
            return (name,)
        if isinstance(node, Const):
            return (self._constant(node),)
        if isinstance(node, Var):
            return (node.name,)
        assert isinstance(node, Apply)
        if node.op is WHERE_PRESENT:
            return (written_operand(node),)
        if node.op is TRUTH:
            return (*self._operand(node.args[0], alone=False), " is true")
        if _is_false(node):
            return (*self._operand(children(node.args[0])[0], alone=False), " is false")
        if node.op.fixity is Fixity.ATOM:
            return (node.op.spellings[0],)
        return tuple(self._phrase(node))

    def _phrase(self, node: Apply) -> Iterator[Piece]:
        phrase = phrase_of(node)
        parts = _PLACE.split(phrase)
        for number_, part in enumerate(parts):
            if number_ % 2 == 0:
                yield part
            elif part == "I":
                yield window(node.interval, node.op.tense)
            elif part == "D":
                yield _duration_of(node.interval)
            elif part == "S":
                assert node.interval is not None
                assert node.interval.share is not None
                yield node.interval.share.text()
            elif part == "B":
                yield str(node.op.binder)
            else:
                yield from self._placed(node, int(part), before=parts[number_ - 1], after=parts[number_ + 1])

    def _placed(self, node: Apply, place: int, before: str, after: str) -> Iterator[Piece]:
        """Yield an operand in its place of a phrase, in parentheses where it needs them."""
        operand = node.args[place]
        if place == 0 and not before and self._continues(node, operand):
            yield operand
            return
        last, enclosed = not after, bool(before) and after[:1] in (",", "|", ")")
        unit = self._unit(node, operand)
        yield from self._operand(operand, alone=last and bool(before), enclosed=enclosed)
        yield unit

    def _continues(self, node: Apply, operand: Formula) -> bool:
        """Return whether an operand continues a chain of the same operator: ``a and b and c``."""
        chain = isinstance(operand, Apply) and operand.op is node.op and is_infix(node.op)
        return (
            chain
            and node.op.fixity is Fixity.LEFT
            and self.name(operand) is None
            and not self._is_open(operand)
        )

    def _operand(self, operand: Formula, *, alone: bool, enclosed: bool = False) -> tuple[Piece, ...]:
        if self._is_simple(operand):
            return (operand,)
        assert isinstance(operand, Apply)
        if alone and not is_number(operand) and not phrase_of(operand).startswith("{"):
            return (operand,)
        if enclosed and phrase_of(operand).startswith("{") and not self._is_open(operand):
            return (operand,)
        return ("(", operand, ")")

    def _is_simple(self, formula: Formula) -> bool:
        """Return whether nothing can be attached to a part: a name, a number, a comparison, notation with brackets."""
        if not isinstance(formula, Apply) or self.name(formula) is not None or not formula.args:
            return True
        if formula.op in (TRUTH, WHERE_PRESENT) or _is_false(formula):
            return self._is_simple(formula.args[0])
        phrase = phrase_of(formula)
        if phrase[:1] == "|" or (formula.op.phrase == "" and not is_truth(formula.op)):
            return formula.op.fixity is Fixity.FUNCTION or phrase[:1] == "|"
        if is_number(formula):
            return False
        return _is_comparison(formula.op)

    def _is_open(self, formula: Formula) -> bool:
        """Return whether what follows a part could be read as the end of it."""
        while isinstance(formula, Apply) and self.name(formula) is None:
            phrase = phrase_of(formula)
            places = _PLACE.findall(phrase)
            if self._is_simple(formula) or not phrase.endswith("}") or not places[-1].isdigit():
                return False
            last = formula.args[int(places[-1])]
            if not phrase.startswith("{"):
                return True
            if self._operand(last, alone=True)[0] == "(":
                return False
            formula = last
        return False

    def _constant(self, node: Const) -> str:
        if is_literal(node):
            return str(node.name)
        if is_member(node):
            return member_name(node)
        value = "infinity" if node.value == float("inf") else number(node.value)
        if node.name is None:
            return value
        unit = self._units.get(node.name, "")
        return f"{node.name} ({value}{' ' * bool(unit)}{unit})"

    def _unit(self, node: Apply, operand: Formula) -> str:
        """Return the unit of a literal number beside a variable: ``speed is at most 30 m/s``."""
        if not isinstance(operand, Const) or isinstance(operand, Parameter) or operand.name is not None:
            return ""
        if not _is_comparison(node.op) or operand.type is not None:
            return ""
        beside = [arg.name for arg in node.args if isinstance(arg, Var)]
        unit = self._units.get(beside[0], "") if beside else ""
        return f" {unit}" if unit else ""


def phrase_of(node: Apply) -> str:
    """Return the phrase of an operator with its operands; by default its notation."""
    op = node.op
    like = STL.get(op.name.removeprefix("holds_"))
    phrase = op.phrase or (like.phrase if like is not None and is_truth(op) else "")
    if not phrase:
        return _notation(op, len(node.args))
    more = [k for k in range(len(node.args)) if f"{{{k}}}" not in phrase]
    return phrase + "".join(f" (at first {{{k}}})" for k in more)


def _notation(op: Operator, count: int) -> str:
    word = op.spellings[0]
    if is_infix(op):
        return f"{{0}} {word} {{1}}"
    bounds = "" if op.bounds is Bounds.NONE else f" {{{'D' if op.bounds is Bounds.DURATION else 'I'}}}"
    operands = ", ".join(f"{{{k}}}" for k in range(count))
    if op.fixity is Fixity.FUNCTION:
        return f"{word}{bounds}({operands})"
    return f"{word}{bounds} {operands}"


def _is_false(node: Apply) -> bool:
    """Return whether a formula is the negation of a Boolean: ``armed is false``."""
    return node.op is STL["not"] and isinstance(node.args[0], Apply) and node.args[0].op is TRUTH


def _is_comparison(op: Operator) -> bool:
    return op.result is Sort.FORMULA and bool(op.operands) and set(op.operands) == {Sort.NUMBER}


# ---- times ---------------------------------------------------------------------------------------


def window(interval: Interval | None, tense: Tense) -> str:
    """Return a window as a phrase.

    >>> from fractions import Fraction
    >>> from rtamt.language.formula import Interval
    >>> window(Interval(Fraction(2), Fraction(5)), Tense.PAST), window(None, Tense.FUTURE)
    ('from 5 s to 2 s ago', 'from now on')
    """
    past = tense is Tense.PAST
    if interval is None:
        return "until now" if past else "from now on"
    interval = interval.written or interval
    begin, end = _duration(interval.begin, interval.begin_unit), interval.end
    more = "more than " if interval.begin_open else ""
    if end is None:
        if not interval.begin and not interval.begin_open:
            return "until now" if past else "from now on"
        return f"until {more}{begin} ago" if past else f"from {more}{begin} ahead on"
    less = "less than " if interval.end_open else ""
    last = _duration(end, interval.end_unit)
    if interval.begin == end:
        return f"exactly {last} {'ago' if past else 'ahead'}"
    if not interval.begin and not interval.begin_open:
        return f"within {'the last' if past else 'the next'} {less}{last}"
    return f"from {less}{last} to {more}{begin} ago" if past else f"from {more}{begin} to {less}{last} ahead"


def _duration_of(interval: Interval | None) -> str:
    return "one sample" if interval is None else _duration(interval.begin, interval.end_unit)


def _duration(seconds: Fraction, unit: str) -> str:
    unit = unit or "s"
    return f"{rational_text(seconds / UNITS[unit])} {unit}"
