"""Rules about the sorts of operands, declarations, names, units and times."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from rtamt.language.formula import Const, Parameter, Var, postorder
from rtamt.language.operators import STL, Fixity, Sort
from rtamt.language.parsing.grammar import is_number, is_predicate
from rtamt.language.units.dimensions import DIMENSION, SCALE, UNCHECKED
from rtamt.language.units.durations import format_duration
from rtamt.lint.found import Found

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.language.document import Assertion
    from rtamt.language.formula import Formula, Span
    from rtamt.lint.found import Text

_PREDICATES = tuple(op for op in STL if is_predicate(op))
_PREFIXES = tuple(op for op in STL if op.fixity is Fixity.PREFIX)


def _operands(text: Text, *sorts: Sort) -> Iterator[Formula]:
    """Yield every operand that is read as one of these sorts."""
    for op, nodes in text.by_operator.items():
        places = [k for k, sort in enumerate(op.operands) if sort in sorts]
        if places:
            yield from (node.args[k] for node in nodes for k in places if k < len(node.args))


def number_as_formula(text: Text) -> Iterator[Found]:
    """``x and y >= 3``."""
    for operand in _operands(text, Sort.FORMULA, Sort.CONDITION):
        if is_number(operand):
            such = f", such as {operand.name} > 0" if isinstance(operand, Var) else ""
            written = text.written(operand.span)
            yield Found(operand.span, f"{written} is a number where a formula is expected; compare it{such}")


def formula_as_number(text: Text) -> Iterator[Found]:
    """``(x >= 3) + 1``."""
    for operand in _operands(text, Sort.NUMBER):
        if not is_number(operand):
            written = text.written(operand.span)
            yield Found(
                operand.span, f"{written} is a formula where a number is expected: its robustness is taken"
            )


def constant_comparison(text: Text) -> Iterator[Found]:
    """``3 >= 2``."""
    for node in text.of(_PREDICATES):
        if any(isinstance(each, Var) for each in node.args):
            continue
        # The value of a parameter is a default.
        if not any(isinstance(each, Var | Parameter) for each in postorder(node)):
            written = text.written(node.span)
            yield Found(node.span, f"{written} reads no variable: it always holds or never does")


def division_by_zero(text: Text) -> Iterator[Found]:
    """``x / 0``."""
    for node in text.of((STL["div"],)):
        if isinstance(node.args[1], Const) and node.args[1].value == 0:
            yield Found(node.span, "this divides by 0")


def past_parenthesis(text: Text) -> Iterator[Found]:
    """``prev(x) - x <= 3``, which is ``prev(x - x <= 3)``."""
    characters = text.document.text
    for node in text.of(_PREFIXES):
        if node.span is None or node.args[0].span is None:
            continue
        spelled = next((s for s in node.op.spellings if characters.startswith(s, node.span.start)), "")
        interval = None if node.interval is None else node.interval.span
        begin = node.span.start + len(spelled) if interval is None else interval.end
        operand = node.args[0].span
        # The span of a group begins after its parenthesis.
        if operand.start == begin and characters.startswith("(", begin):
            operator, whole = characters[node.span.start : begin], characters[operand.start : operand.end]
            yield Found(
                node.span,
                f"'{operator}' applies to all of '{whole}'; write {operator}({whole}) if that is meant",
            )


def held_too_short(text: Text) -> Iterator[Found]:
    """``sample 100ms hold for 50ms``."""
    rule = text.document.sampling
    if rule is not None and rule.limit is not None and rule.limit < rule.period:
        yield Found(
            rule.span,
            "a value is held for less than the sampling period, so a signal that is recorded once a period has gaps; "
            f"hold it for {format_duration(rule.period)} or longer",
        )


def shorter_than_a_period(text: Text) -> Iterator[Found]:
    """``always[0:50ms](x >= 3)`` with a sampling period of 100 ms."""
    if text.period is None:
        return
    for node in text.nodes:
        interval = node.interval
        if interval is None:
            continue
        short = [
            bound for bound in (interval.begin, interval.end) if bound is not None and 0 < bound < text.period
        ]
        if short:
            yield Found(
                interval.span or node.span,
                f"{format_duration(short[-1])} is shorter than the sampling period of {format_duration(text.period)}, "
                f"so no sample lies there; lengthen the bound to a multiple of the period, or shorten the period",
            )


# ---- names ---------------------------------------------------------------------------------------


def _never_used(text: Text) -> Iterator[Assertion]:
    """Yield the named assertions that nothing uses, requires or publishes."""
    document = text.document
    required = {requirement.span for requirement in document.requirements}
    declared = {declaration.name for declaration in document.declarations}
    for assertion in document.assertions:
        name = assertion.name
        if assertion.span in required or (name is not None and name in document.used):
            continue
        if name is None or name.partition(".")[0] not in declared:
            yield assertion


def unused_number(text: Text) -> Iterator[Found]:
    """``sum = x + y; x >= 3``."""
    document = text.document
    for assertion in _never_used(text):
        if is_number(assertion.formula):
            what = "this number" if assertion.name is None else f"the number '{assertion.name}'"
            yield Found(assertion.span, f"{what} is never used")
    declared = {declaration.name for declaration in document.declarations}
    names = {assertion.span: assertion.name for assertion in reversed(document.assertions)}
    for requirement in document.requirements:  # a number if the text has nothing else
        name = names.get(requirement.span)
        if is_number(requirement.formula) and name is not None and name.partition(".")[0] not in declared:
            yield Found(
                requirement.span,
                f"the number '{name}' is never used, and checked in place of a formula; to compare write '=='",
            )


def not_required(text: Text) -> Iterator[Found]:
    """``require R1: x >= 3; y >= 2``."""
    for assertion in _never_used(text):
        if not is_number(assertion.formula):
            what = "this formula" if assertion.name is None else f"'{assertion.name}'"
            yield Found(
                assertion.span,
                f"{what} is not checked, because the text uses 'require'; require it too, or remove it",
            )


def unused_declaration(text: Text) -> Iterator[Found]:
    """``const float limit = 3; x >= 2``."""
    document = text.document
    if not document.assertions:  # a file that others import
        return
    called = {"const": "constant"}
    declared: list[tuple[str, str, Span | None]] = [
        (each.name, called.get(each.kind, each.kind), each.span)
        for each in document.declarations
        if each.kind != "var"
    ]
    declared += [(name, "table", None) for name in document.tables]
    declared += [(name, "enumeration", None) for name in document.enumerations]
    if not declared:
        return
    read = {part.name for part in text.parts if isinstance(part, Const)}
    unread = [each for each in declared if each[0] not in read]
    for name, kind, span in unread:
        if text.names[name] != 1:  # 0: declared by an imported file
            continue
        at = next(k for k, token in enumerate(text.tokens.texts) if token in (name, f'"{name}"'))
        place = text.tokens[at].span
        if span is None or span == place:
            yield Found(place, f"the {kind} '{name}' is never used; use it, or remove it")


# ---- units ---------------------------------------------------------------------------------------


def _units(text: Text, *, kind: str) -> Iterator[Found]:
    for found in text.unit_findings:
        if found.kind == kind:
            yield Found(found.span, found.message)


different_quantities = partial(_units, kind=DIMENSION)
different_units = partial(_units, kind=SCALE)
unchecked_units = partial(_units, kind=UNCHECKED)
