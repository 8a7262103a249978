"""Formula to LaTeX, from the templates of the operators."""

from __future__ import annotations

from functools import lru_cache
from string import Formatter
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Formula, Var
from rtamt.language.operators import STL, Bounds, Fixity, Operator
from rtamt.language.parsing.grammar import INFINITY, is_infix, is_literal, passes_on, sign
from rtamt.language.printing.parentheses import (
    falls_apart,
    is_choice,
    is_member,
    member_name,
    needs_group,
    truth_of,
    written_operand,
)
from rtamt.language.printing.printer import number, rational_text, share_text
from rtamt.language.printing.writing import LONGEST, extent_of, full_text
from rtamt.language.units.durations import UNITS
from rtamt.language.unwritten import PRESENT, TRUTH, WHERE_PRESENT

if TYPE_CHECKING:
    from collections.abc import Iterable
    from fractions import Fraction

    from rtamt.language.printing.writing import Piece
    from rtamt.language.quantifiers import Binder


def to_latex(formula: Formula) -> str:
    r"""Return the formula as LaTeX mathematics, without dollar signs, from the operators' templates.

    For a formula of more than :data:`LONGEST` characters, the result is a text that gives the size of
    the formula.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> print(to_latex(parse_formula("always(req >= 3 -> eventually[0:5](gnt >= 3))")))
    \mathbf{G} (\mathrm{req} \geq 3 \to \mathbf{F}_{[0, 5]} (\mathrm{gnt} \geq 3))
    """
    minus = sign(STL)

    def grouped(node: Apply, k: int) -> bool:
        child, op = node.args[k], node.op
        if is_infix(op):
            return falls_apart(child, op, Fixity.RIGHT if k else Fixity.LEFT, minus)
        if op.fixity is Fixity.CONDITIONAL:
            return k < 2 and is_choice(child)
        if op.fixity is Fixity.PREFIX and isinstance(child, Apply) and child.op.fixity is Fixity.PREFIX:
            return not passes_on(op)
        return needs_group(child, op) or (op.fixity is Fixity.FUNCTION and isinstance(child, Apply))

    def pieces(node: Formula) -> Iterable[Piece]:
        if isinstance(node, Const) and is_literal(node):
            yield STL["true" if node.value else "false"].latex
        elif isinstance(node, Const):
            yield _latex_name(member_name(node)) if is_member(node) else _latex_number(node.value)
        elif isinstance(node, Var):
            yield _latex_name(node.name)
        elif isinstance(node, Apply) and node.op is TRUTH:
            truth = truth_of(node)
            yield STL[truth].latex if isinstance(truth, str) else truth
        elif isinstance(node, Apply) and node.op in (PRESENT, WHERE_PRESENT):
            yield written_operand(node)
        elif isinstance(node, Apply) and node.op.binder is not None:
            yield _latex_binder(node.op.latex, node.op.binder)
            yield from node.args
        elif isinstance(node, Apply):
            for literal, operand, exposed in _template(
                _latex_of(node.op, len(node.args)), node.interval is not None
            ):
                yield literal
                if operand == "I":
                    yield _latex_interval(node)
                elif operand == "S":
                    yield share_text(node, "").replace("%", r"\%")
                elif operand is not None:
                    k = int(operand)
                    yield from ("(", node.args[k], ")") if exposed and grouped(node, k) else (node.args[k],)
        else:
            raise TypeError(f"{type(node).__name__} is not a formula")

    text = full_text(formula, pieces, LONGEST)
    return rf"\text{{a formula of {extent_of(formula)}}}" if text is None else text


def _latex_binder(symbol: str, binder: Binder) -> str:
    apart = "".join(rf", {_latex_name(one)} \neq {_latex_name(other)}" for one, other in binder.apart)
    return rf"{symbol} {_latex_name(binder.variable)} \in {_latex_name(binder.group.name)}{apart}:\ "


def _latex_of(op: Operator, operands: int) -> str:
    """Return an operator's template for a number of operands, or one built from its first spelling."""
    if op.latex:
        return op.latex
    word = op.spellings[0].replace("{", "{{").replace("}", "}}")
    name = rf"\mathrm{{{{{_escape(word)}}}}}_{{I}}"
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
        return rational_text(value / UNITS[unit or "s"]) + (rf"\,\mathrm{{{unit}}}" if unit else "")

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
    escaped = _escape(name)
    return escaped if len(name) == 1 else rf"\mathrm{{{escaped}}}"


def _escape(name: str) -> str:
    special = {"\\": r"\backslash ", "^": r"\hat{\ }", "~": r"\sim ", " ": r"\ "}
    return "".join(special.get(c, f"\\{c}" if c in "{}$&#_%" else c) for c in name)
