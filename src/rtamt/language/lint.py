"""Warnings about valid but probably unintended specifications: a table of rules, each with a code to silence it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from rtamt.errors import caret
from rtamt.language.formula import Apply, Const, Var, postorder
from rtamt.language.parsing.grammar import is_number, is_predicate
from rtamt.language.records import Fixity, Sort
from rtamt.language.units.check import unit_findings
from rtamt.language.units.dimensions import DIMENSION, SCALE, UNCHECKED
from rtamt.language.units.durations import format_duration

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rtamt.language.document import Assertion, Document, Severity
    from rtamt.language.formula import Formula, Span

    Found = Iterator[tuple[Span | None, str]]


@dataclass(frozen=True, slots=True)
class Rule:
    """One kind of warning: its code, its summary, an example, and the function that finds it in a document.

    ``severity``: "error" for what is certainly a mistake, though the text is legal; "note" for what is not checked.
    """

    code: str
    about: str
    example: str
    find: Callable[[Document], Found]
    severity: Severity = "warning"


@dataclass(frozen=True, slots=True)
class LintWarning:
    """A valid but probably unintended part of a specification; ``str()`` shows the line and a caret.

    ``severity``: "warning"; "error" for what is certainly a mistake, "note" for what is not checked.
    """

    code: str
    message: str
    text: str
    span: Span | None
    severity: Severity = "warning"

    def __str__(self) -> str:
        where = "" if self.span is None else f"\n{caret(self.text, self.span)}"
        return f"{self.code}: {self.message}{where}"


def warnings_of(document: Document) -> tuple[LintWarning, ...]:
    """Return the warnings about the text of a document, in the order of the text; a selection has no effect.

    >>> from rtamt.language.parsing.specfile import parse_document
    >>> print(*warnings_of(parse_document("x and y >= 3")))
    RT101: 'x' is a number where a formula is expected; compare it, such as x > 0
      line 1, column 1:
        x and y >= 3
        ^
    """
    document = document.origin or document
    found = {
        LintWarning(rule.code, message, document.text, span, rule.severity)
        for rule in RULES
        for span, message in rule.find(document)
    }
    return tuple(sorted(found, key=lambda each: (each.span.start if each.span else 0, each.code)))


# ---- the rules -----------------------------------------------------------------------------------


def _nodes(document: Document) -> Iterator[Apply]:
    for node in postorder(*(assertion.formula for assertion in document.assertions)):
        if isinstance(node, Apply):
            yield node


def _operands(document: Document, *sorts: Sort) -> Iterator[tuple[Formula, str]]:
    """Yield every operand that is read as one of these sorts, and the formula at its position."""
    for node in _nodes(document):
        for wanted, operand in zip(node.op.operands, node.args, strict=False):
            if wanted in sorts:
                span = operand.span
                yield operand, "this" if span is None else f"'{document.text[span.start : span.end]}'"


def _number_as_formula(document: Document) -> Found:
    for operand, written in _operands(document, Sort.FORMULA, Sort.CONDITION):
        if is_number(operand):
            such = f", such as {operand.name} > 0" if isinstance(operand, Var) else ""
            yield operand.span, f"{written} is a number where a formula is expected; compare it{such}"


def _formula_as_number(document: Document) -> Found:
    for operand, written in _operands(document, Sort.NUMBER):
        if not is_number(operand):
            yield operand.span, f"{written} is a formula where a number is expected: its robustness is taken"


def _constant_comparison(document: Document) -> Found:
    for node in _nodes(document):
        if is_predicate(node.op) and not any(isinstance(each, Var) for each in postorder(node)):
            yield node.span, "this compares constants: it always holds or never does"


def _division_by_zero(document: Document) -> Found:
    for node in _nodes(document):
        if node.op.name == "div" and isinstance(node.args[1], Const) and node.args[1].value == 0:
            yield node.span, "this divides by 0"


def _held_too_short(document: Document) -> Found:
    rule = document.sampling
    if rule is not None and rule.limit is not None and rule.limit < rule.period:
        yield (
            rule.span,
            "a value is held for less than the sampling period, so a signal that is recorded once a period has gaps; "
            f"hold it for {format_duration(rule.period)} or longer",
        )


def _past_parenthesis(document: Document) -> Found:
    """An operator is written like a function, directly before a parenthesis, but also applies to what follows it."""
    text = document.text
    for node in _nodes(document):
        if node.op.fixity is not Fixity.PREFIX or node.span is None or node.args[0].span is None:
            continue
        spelled = next((s for s in node.op.spellings if text.startswith(s, node.span.start)), "")
        interval = None if node.interval is None else node.interval.span
        begin = node.span.start + len(spelled) if interval is None else interval.end
        operand = node.args[0].span
        # The span of a group begins after its parenthesis.
        if operand.start == begin and text.startswith("(", begin):
            operator, whole = text[node.span.start : begin], text[operand.start : operand.end]
            yield (
                node.span,
                f"'{operator}' applies to all of '{whole}'; write {operator}({whole}) if that is meant",
            )


def _never_used(document: Document) -> Iterator[Assertion]:
    """Yield the named assertions that nothing uses, requires or publishes."""
    required = {requirement.span for requirement in document.requirements}
    declared = {declaration.name for declaration in document.declarations}
    for assertion in document.assertions:
        name = assertion.name
        if assertion.span in required or (name is not None and name in document.used):
            continue
        if name is None or name.partition(".")[0] not in declared:
            yield assertion


def _unused_number(document: Document) -> Found:
    for assertion in _never_used(document):
        if is_number(assertion.formula):
            what = "this number" if assertion.name is None else f"the number '{assertion.name}'"
            yield assertion.span, f"{what} is never used"
    declared = {declaration.name for declaration in document.declarations}
    names = {assertion.span: assertion.name for assertion in reversed(document.assertions)}
    for requirement in document.requirements:  # a number if the text has nothing else
        name = names.get(requirement.span)
        if is_number(requirement.formula) and name is not None and name.partition(".")[0] not in declared:
            yield (
                requirement.span,
                f"the number '{name}' is never used, and checked in place of a formula; to compare write '=='",
            )


def _not_required(document: Document) -> Found:
    for assertion in _never_used(document):
        if not is_number(assertion.formula):
            what = "this formula" if assertion.name is None else f"'{assertion.name}'"
            yield (
                assertion.span,
                f"{what} is not checked, because the text uses 'require'; require it too, or remove it",
            )


def _units(document: Document, *, kind: str) -> Found:
    for found in unit_findings(document):
        if found.kind == kind:
            yield found.span, found.message


RULES: tuple[Rule, ...] = (
    Rule("RT101", "a number where a formula is expected", "x and y >= 3", _number_as_formula),
    Rule("RT102", "a formula where a number is expected", "(x >= 3) + 1 > 2", _formula_as_number),
    Rule("RT103", "a comparison of constants", "3 >= 2 and x >= 1", _constant_comparison),
    Rule("RT104", "a division by the constant 0", "x / 0 >= 1", _division_by_zero),
    Rule(
        "RT105",
        "a prefix operator directly before a parenthesis, whose operand extends past it",
        "prev(x) - x <= 3",
        _past_parenthesis,
    ),
    Rule(
        "RT106",
        "a value that is held for less than the sampling period",
        "sample 100ms hold for 50ms  x >= 3",
        _held_too_short,
    ),
    Rule("RT201", "a number that has a name and is never used", "sum = x + y; x >= 3", _unused_number),
    Rule(
        "RT202",
        "a formula that is no requirement, because the text uses 'require'",
        "require R1: x >= 3; y >= 2",
        _not_required,
    ),
    Rule(
        "RT301",
        "different quantities in a sum or comparison, or in a function of angles or plain numbers",
        "input float speed [m/s]  input float gap [m]  speed + gap > 3",
        partial(_units, kind=DIMENSION),
        "error",
    ),
    Rule(
        "RT302",
        "the same quantity in different units, such as degrees and radians",
        "input float heading [deg]  sin(heading) > 0",
        partial(_units, kind=SCALE),
        "error",
    ),
    Rule(
        "RT303",
        "units that cannot be checked",
        "input float v [kmh]  parameter float limit = 30 [m/s]  v < limit",
        partial(_units, kind=UNCHECKED),
        "note",
    ),
)
CODES = tuple(rule.code for rule in RULES)
