"""The mutation operators: they replace operators, constants, bounds and shares of windows.

Which operators replace one another follows from the operator table of the language.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Formula, postorder
from rtamt.language.operators import STL, Bounds, Fixity, Pointwise, Sort, Tense, Window
from rtamt.language.parsing.grammar import is_infix, is_number, is_predicate
from rtamt.language.printing.printer import interval_text, to_text
from rtamt.language.quantifiers import QUANTIFIERS, quantified
from rtamt.language.shares import Share, ShareKind
from rtamt.language.units.durations import UNITS
from rtamt.language.unwritten import EQ, NE, TRUTH
from rtamt.language.value_types import BOOLEAN, Enumeration
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.language.formula import Interval
    from rtamt.language.operators import Operator

#: The share by which constants and bounds are changed.
STEP = Fraction(1, 10)
#: Percentage points by which a share of a window is changed.
_POINTS = 10

#: Characters of a part that is shown before and after the change.
_LONGEST = 60

OPERATOR, THRESHOLD, BOUND = "operator", "threshold", "bound"


class Change(NamedTuple):
    """A part of a formula, what replaces it, and the kind: operator, threshold or bound."""

    kind: str
    old: Formula
    new: Formula


def changes_of(formula: Formula, step: Fraction | None) -> Iterator[Change]:
    """Yield the changes of a formula, outermost parts first.

    ``step``: what bounds are multiples of; None in dense time.
    """
    for node in reversed(postorder(formula)):
        if isinstance(node, Apply):
            for new in _operators(node):
                yield Change(OPERATOR, node, new)
            for operand in node.args:
                if isinstance(operand, Const):
                    for changed in _constants(operand, node):
                        args = tuple(changed if arg is operand else arg for arg in node.args)
                        yield Change(THRESHOLD, node, Apply(node.op, args, node.interval, node.span))
            for interval in _intervals(node, step):
                yield Change(BOUND, node, Apply(node.op, node.args, interval, node.span))


# ---- operators -----------------------------------------------------------------------------------


def _operators(node: Apply) -> Iterator[Formula]:
    """Yield the formulas with another operator in the place of this one, or without it."""
    op, args, interval, span = node.op, node.args, node.interval, node.span
    for other in _similar(op):
        if other.bounds is not Bounds.REQUIRED or (interval is not None and interval.end is not None):
            yield Apply(other, args, interval, span)
    if op is TRUTH:
        yield STL["not"](node)
    elif _is_removable(node):
        yield args[0]


def _is_removable(node: Apply) -> bool:
    """Return whether an operator can be replaced by its only operand."""
    op, args = node.op, node.args
    if len(args) != 1 or op.operands[0] is not op.result or op.binder is not None:
        return False
    return is_number(args[0]) == is_number(node)


def _similar(op: Operator) -> list[Operator]:
    """Return the replacements of an operator: its dual and the similar ones."""
    found = [STL[op.dual]] if op.dual else []
    if op.fixity is Fixity.QUANTIFIER:
        found += _other_quantifier(op)
    elif op in _TRUTHS:
        found += [_TRUTHS[op]]
    elif is_predicate(op):
        # The same distance, with or without equality; and the other direction.
        found += [other for other in STL if is_predicate(other) and not other.equates and other is not op]
        found = [other for other in dict.fromkeys(found) if op.equates == other.equates]
    elif not found:
        found += [other for other in STL if other is not op and _is_exchangeable(op, other)]
    return found


#: Comparisons of members, which are true or false.
_TRUTHS = {EQ: NE, NE: EQ}


def _other_quantifier(op: Operator) -> list[Operator]:
    """Return ``exists`` over the same members for ``forall``, and the reverse."""
    assert op.binder is not None
    others = [row.name for row in QUANTIFIERS.values() if row.result is op.result and row.name != op.name]
    return [quantified(name, op.binder) for name in others]


def _is_exchangeable(op: Operator, other: Operator) -> bool:
    """Return whether two operators without duals have the same operands, the same tense, and are similar."""
    same = _shape(op) == _shape(other)
    if not same or op.presence or other.presence:
        return False
    if op.result is Sort.FORMULA:
        return (op.reach == other.reach) if op.tense is not Tense.NONE else is_infix(op)
    if is_infix(op):
        return op.power == other.power
    extrema = isinstance(op.kernel, Window) and isinstance(other.kernel, Window)
    return extrema or {_opcode(op), _opcode(other)} == {"min", "max"}


def _shape(op: Operator) -> tuple[object, ...]:
    fixity = Fixity.LEFT if is_infix(op) else op.fixity
    return op.operands, op.result, op.tense, fixity, op.bounds is Bounds.NONE, op.share


def _opcode(op: Operator) -> str:
    return op.kernel.opcode if isinstance(op.kernel, Pointwise) else ""


# ---- constants -----------------------------------------------------------------------------------


def _constants(value: Const, under: Apply) -> Iterator[Const]:
    """Yield other constants: a tenth more and less, the neighbours of a member, the other Boolean."""
    if value.type is BOOLEAN:
        yield Const(1.0 - value.value, value.span, type=BOOLEAN, name="false" if value.value else "true")
    elif isinstance(value.type, Enumeration):
        codes = [code for _, code in value.type.members]
        at = codes.index(int(value.value)) if int(value.value) in codes else 0
        for other in dict.fromkeys((codes[at - 1], codes[(at + 1) % len(codes)])):
            if other != value.value:
                yield Const(float(other), value.span, value.type.member(other), value.type)
    elif value.type is None and abs(value.value) != float("inf"):
        for sign in (1, -1):
            # As in the text: 1.2 and a tenth are 1.32, not 1.3199999999999998.
            written = Fraction(repr(value.value))
            changed = float(written + sign * _distance(written, under))
            if changed != value.value:
                yield Const(changed, value.span)


def _distance(value: Fraction, under: Apply) -> Fraction:
    """Return the change of a constant; a count in whole numbers."""
    if any(isinstance(arg, Apply) and arg.op is STL["count"] for arg in under.args):
        return Fraction(1)
    return abs(value * STEP) or STEP


# ---- bounds --------------------------------------------------------------------------------------


def _intervals(node: Apply, step: Fraction | None) -> Iterator[Interval]:
    """Yield other bounds and shares: a tenth more and less, by whole steps."""
    interval = node.interval
    if interval is None or interval.implied:
        return
    begin, end = interval.begin, interval.end
    if node.op.bounds is Bounds.DURATION:
        for changed in _durations(begin, step):
            if changed > 0 or not node.op.positive:
                yield _change_interval(interval, changed, changed)
        return
    for changed in _durations(begin, step) if begin else ():
        if end is None or changed <= end:
            yield _change_interval(interval, changed, end)
    for changed in () if end is None else _durations(end, step):
        if changed >= begin:
            yield _change_interval(interval, begin, changed)
    if interval.share is not None:
        for share in _shares(interval.share, step):
            yield replace(interval, share=share)


def _durations(duration: Fraction, step: Fraction | None) -> list[Fraction]:
    distance = duration * STEP
    if step is not None:
        distance = max(step, round(distance / step) * step)
    elif not distance:
        distance = UNITS["ms"]
    return [changed for changed in (duration + distance, duration - distance) if changed >= 0]


def _shares(share: Share, step: Fraction | None) -> Iterator[Share]:
    if share.kind is ShareKind.PERCENT:
        changed = [share.amount + _POINTS, share.amount - _POINTS]
    elif share.kind is ShareKind.SAMPLES:
        changed = [share.amount + 1, share.amount - 1]
    else:
        changed = _durations(share.amount, step)
    for amount in changed:
        if amount > 0 and (share.kind is not ShareKind.PERCENT or amount <= 100):
            yield replace(share, amount=Fraction(amount), span=None)


def _change_interval(interval: Interval, begin: Fraction, end: Fraction | None) -> Interval:
    """Return an interval with other bounds, in the units in which it was written."""
    return replace(interval, begin=begin, end=end, constants=(), written=None)


# ---- descriptions of changes ---------------------------------------------------------------------


def describe_change(change: Change) -> str:
    """Return a change for a table, ``old -> new``; long parts are reduced to their operator.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> for each in list(changes_of(parse_formula("always[0:9](speed >= 30 and gap > 2 and brake < 0.5)"), None))[:3]:
    ...     print(describe_change(each))
    'always[0:9]' → 'eventually[0:9]' in always[0:9](speed >= 30 and gap > 2 and brake < 0.5)
    'always[0:9]' removed from always[0:9](speed >= 30 and gap > 2 and brake < 0.5)
    'always[0:9]' → 'always[0:9.9]' in always[0:9](speed >= 30 and gap > 2 and brake < 0.5)
    """
    old, new = (to_text(each, limit=_LONGEST) for each in change[1:])
    if len(old) + len(new) <= _LONGEST or not isinstance(change.old, Apply):
        return f"{old} → {new}"
    if change.new in change.old.args:
        return f"'{_word(change.old)}' removed from {old}"
    if isinstance(change.new, Apply) and _word(change.new) != _word(change.old):
        return f"'{_word(change.old)}' → '{_word(change.new)}' in {old}"
    return f"{old} → {new}"


def _word(node: Apply) -> str:
    """Return an operator with its bounds and share."""
    share = "" if node.interval is None or node.interval.share is None else f" {node.interval.share.text()}"
    return f"{node.op.spellings[0]}{interval_text(node.interval)}{share}"
