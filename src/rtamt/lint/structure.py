"""Rules about the structure of formulas: repeated parts, operators without effect, suspicious nesting."""

from __future__ import annotations

from bisect import bisect_left
from math import inf
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Interval, Span
from rtamt.language.operators import STL, Fixity, Pointwise, Sort, Tense, Window
from rtamt.language.parsing.grammar import is_infix, is_number
from rtamt.language.printing.printer import interval_text
from rtamt.lazy.dataclasses import replace
from rtamt.lint.edits import (
    chain_operands,
    infix_at,
    is_grouped,
    is_infix_here,
    is_prefix_here,
    keep_left,
    keep_right,
    without_prefix,
)
from rtamt.lint.found import Edit, Fix, Found

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.language.formula import Formula
    from rtamt.language.operators import Operator
    from rtamt.lint.found import Text

#: ``always``, ``eventually`` and their past forms.
WINDOWS = tuple(
    op
    for op in STL
    if op.fixity is Fixity.PREFIX and isinstance(op.kernel, Window) and op.result is Sort.FORMULA
)
#: ``and`` and ``or``, with the constant that changes nothing.
JUNCTIONS = {
    op: inf if op.kernel.opcode == "min" else -inf
    for op in STL
    if is_infix(op) and op.result is Sort.FORMULA and isinstance(op.kernel, Pointwise)
}
#: Operators between two formulas or numbers that result in a formula.
_BETWEEN = tuple(op for op in STL if is_infix(op) and op.result is Sort.FORMULA)
_FORMULAS = tuple(op for op in _BETWEEN if set(op.operands) == {Sort.FORMULA})
#: The prefix operators that undo themselves.
_SIGNS = (STL["not"], STL["neg"])
#: The operators whose first operand may be left out if it is true, and what remains.
_WITHOUT_FIRST = {STL["until"]: STL["eventually"], STL["since"]: STL["once"]}


def constant_of(formula: Formula) -> float | None:
    """Return the value of ``true``, ``false`` or a literal number; None of anything else."""
    if type(formula) is Const:
        return formula.value
    if isinstance(formula, Apply) and formula.op.fixity is Fixity.ATOM:
        return inf if formula.op is STL["true"] else -inf
    return None


def _same(a: Formula, b: Formula) -> bool:
    """Return whether two formulas are equal; most are not, which their operators show."""
    if isinstance(a, Apply):
        return isinstance(b, Apply) and a.op is b.op and a == b
    return type(a) is type(b) and a == b


def _fix(edit: Edit | None, old: Apply, new: Formula) -> Fix | None:
    return None if edit is None else Fix((edit,), old, new)


def repeated_operand(text: Text) -> Iterator[Found]:
    """``p and q and p``, ``p -> p``, ``x > x``."""
    chains: dict[int, set[Formula]] = {}  # the operands of each chain so far: a chain is walked once
    for node in text.of(_BETWEEN):
        left, right = node.args
        junction = node.op in JUNCTIONS
        if junction:
            operands = {left}
            if isinstance(left, Apply) and left.op is node.op:
                known = chains.pop(id(left), set())
                operands = known or set(chain_operands(left))
            repeated = right in operands
            operands.add(right)
            chains[id(node)] = operands
        else:
            repeated = _same(left, right)
        if not repeated:
            continue
        if constant_of(right) is not None or not is_infix_here(text, node):
            continue
        fix = _fix(keep_left(text, node), node, left) if junction else None
        written = text.written(right.span)
        yield Found(node.span, f"{written} is an operand of '{node.op.spellings[0]}' twice", fix)


def repeated_requirement(text: Text) -> Iterator[Found]:
    """Two requirements with the same formula."""
    first: dict[Formula, str] = {}
    for requirement in text.document.requirements:
        other = first.setdefault(requirement.formula, requirement.name)
        if other != requirement.name:
            yield Found(
                requirement.span,
                f"'{requirement.name}' requires the same as '{other}'; remove one of them",
            )


def undone_twice(text: Text) -> Iterator[Found]:
    """``not not p`` and ``-(-x)``."""
    for node in text.of(_SIGNS):
        inner = node.args[0]
        if not isinstance(inner, Apply) or inner.op is not node.op or inner.span == node.span:
            continue
        if is_prefix_here(text, node) and is_prefix_here(text, inner):
            edits = without_prefix(text, node), without_prefix(text, inner)
            spelled = node.op.spellings[0]
            yield Found(
                node.span, f"'{spelled}' twice has no effect; remove both", Fix(edits, node, inner.args[0])
            )


def same_window_twice(text: Text) -> Iterator[Found]:
    """``eventually[0:2] eventually[0:3] p``, which is ``eventually[0:5] p``."""
    for node in text.of(WINDOWS):
        inner = node.args[0]
        if not isinstance(inner, Apply) or inner.op is not node.op or inner.span == node.span:
            continue
        if not (is_prefix_here(text, node) and is_prefix_here(text, inner)):
            continue
        interval = _sum(node.interval, inner.interval)
        bounds = [each for each in (node.interval, inner.interval) if each is not None]
        named = any(each.constants for each in bounds)
        # The values of names may change, and with them the sum.
        advice = (
            "add up their bounds in one"
            if named
            else f"write {node.op.spellings[0]}{interval_text(interval)}"
        )
        joined = None
        if not named and not any(each.is_open for each in bounds):
            assert node.span is not None
            end = without_prefix(text, node).span.end
            tokens = text.tokens
            last = bisect_left(tokens.starts, end) - 1
            while tokens.ends[last] > end:
                last -= 1
            edits = (
                Edit(Span(node.span.start, tokens.ends[last]), _spell(text, node) + interval_text(interval)),
                without_prefix(text, inner),
            )
            joined = Fix(edits, node, Apply(node.op, inner.args, interval, node.span))
        yield Found(
            node.span,
            f"'{node.op.spellings[0]}' of '{node.op.spellings[0]}' is one window; {advice}",
            joined,
        )


def _spell(text: Text, node: Apply) -> str:
    assert node.span is not None
    return next(s for s in node.op.spellings if text.document.text.startswith(s, node.span.start))


def _sum(first: Interval | None, second: Interval | None) -> Interval | None:
    """Return the interval of two windows in a row."""
    if first is None or second is None:
        begin = (first.begin if first else 0) + (second.begin if second else 0)
        known = first or second
        if not begin or known is None:
            return None
        return replace(known, end=None, span=None, written=None, end_open=False)
    end = None if first.end is None or second.end is None else first.end + second.end
    unit = second.end_unit if second.end_unit == first.end_unit else ""
    begin_unit = unit if second.begin_unit == first.begin_unit == unit else ""
    same = Interval(first.begin + second.begin, end, begin_unit or unit, unit)
    if unit or not (first.end_unit or second.end_unit):
        return same
    return replace(same, begin_unit="s", end_unit="s")


def last_sample_only(text: Text) -> Iterator[Found]:
    """``always eventually p`` without bounds."""
    for node, inner in _alternating(text):
        if node.op.tense is Tense.FUTURE and _is_unbounded(node.interval) and _is_unbounded(inner.interval):
            both = f"{node.op.spellings[0]} {inner.op.spellings[0]}"
            yield Found(
                node.span,
                f"on a recording, which ends, '{both}' depends on the last sample only; bound the inner operator",
            )


def same_bounds(text: Text) -> Iterator[Found]:
    """``always[0:5] eventually[0:5] p``."""
    for node, inner in _alternating(text):
        bounds = node.interval
        if bounds is None or bounds != inner.interval or bounds.end is None:
            continue
        # A parameter and a number of the same value are different bounds.
        if _parameters(text, bounds) == _parameters(text, inner.interval):
            both = f"{node.op.spellings[0]} and {inner.op.spellings[0]}"
            yield Found(
                node.span,
                f"{both} have the same bounds {_written_bounds(text, bounds)}, and together reach twice as far; "
                f"if one window is meant, remove one of them",
            )


def _parameters(text: Text, interval: Interval | None) -> tuple[str, ...]:
    """Return the parameters in the bounds of a window."""
    names = () if interval is None else interval.constants
    declared = {each.name for each in text.document.declarations if each.kind == "parameter"} if names else ()
    return tuple(name for name in names if name in declared)


def _written_bounds(text: Text, interval: Interval) -> str:
    """Return the bounds of a window with the names in them."""
    if interval.constants and interval.span is not None:
        return " ".join(text.document.text[interval.span.start : interval.span.end].split())
    return interval_text(interval)


def _is_unbounded(interval: Interval | None) -> bool:
    return interval is None or (interval.begin == 0 and interval.end is None)


def _alternating(text: Text) -> Iterator[tuple[Apply, Apply]]:
    """Yield each window operator whose operand is its dual in the same tense, both written there."""
    for node in text.of(WINDOWS):
        inner = node.args[0]
        if not isinstance(inner, Apply) or inner.op.name != node.op.dual or inner.span == node.span:
            continue
        if is_prefix_here(text, node) and is_prefix_here(text, inner):
            yield node, inner


def constant_operand(text: Text) -> Iterator[Found]:
    """``p and true``, ``true until p``."""
    for node in text.of(_FORMULAS):
        for place, operand in enumerate(node.args):
            value = constant_of(operand)
            if value is None or abs(value) != inf or not is_infix_here(text, node):
                continue
            other = node.args[1 - place]
            fix = None
            if JUNCTIONS.get(node.op) == value:
                fix = _fix((keep_left if place else keep_right)(text, node), node, other)
            elif place == 0 and value == inf and node.op in _WITHOUT_FIRST:
                fix = _only_second(text, node)
            truth = "true" if value > 0 else "false"
            yield Found(
                operand.span,
                f"{truth} is an operand of '{node.op.spellings[0]}', which simplifies it; write the shorter formula",
                fix,
            )


def _only_second(text: Text, node: Apply) -> Fix | None:
    """Write ``true until[I] p`` as ``eventually[I](p)``."""
    at = infix_at(text, node)
    if at is None or node.span is None:
        return None
    op: Operator = _WITHOUT_FIRST[node.op]
    interval = node.interval
    begins, end = text.tokens.starts[at + 1], node.span.end
    bounds = ""
    if interval is not None and interval.span is not None:
        begins = next(start for start in text.tokens.starts if start >= interval.span.end)
        bounds = text.document.text[interval.span.start : interval.span.end]
    edits = Edit(Span(node.span.start, begins), f"{op.spellings[0]}{bounds}("), Edit(Span(end, end), ")")
    return Fix(edits, node, Apply(op, node.args[1:], interval, node.span))


def whole_implication(text: Text) -> Iterator[Found]:
    """``always p -> q``, which is ``(always p) -> q``."""
    for node in text.of((STL["implies"],)):
        left = node.args[0]
        if not isinstance(left, Apply) or left.op not in WINDOWS or left.op.kernel != Window("min"):
            continue
        if node.span is None or left.span is None or left.span.start != node.span.start:
            continue
        if not is_prefix_here(text, left) or is_grouped(text, left):
            continue
        word, whole = _spell(text, left), text.document.text[node.span.start : node.span.end]
        start, end = left.span
        edits = Edit(Span(start, start), "("), Edit(Span(end, end), ")")
        yield Found(
            node.span,
            f"'{word}' ends before '->': this is ({text.document.text[start:end]}) -> ...; write {word}(...) around "
            f"'{whole.removeprefix(word).strip()}' if that is meant, or the parentheses",
            Fix(edits, node, node),
        )


def one_instant(text: Text) -> Iterator[Found]:
    """``always[0:0] p``."""
    for node in text.of(WINDOWS):
        interval = node.interval
        if interval is None or _parameters(text, interval):  # the value of a parameter is a default
            continue
        if interval.end == 0 and is_prefix_here(text, node):
            named = bool(interval.constants)
            fix = None if named else Fix((without_prefix(text, node),), node, node.args[0])
            yield Found(
                node.span,
                f"the window of '{node.op.spellings[0]}' is one instant, so that it has no effect; "
                f"give it a longer one, or remove it",
                None if is_number(node.args[0]) else fix,
            )
