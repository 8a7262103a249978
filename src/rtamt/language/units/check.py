"""Dimensional analysis: check declared units of signals, constants and parameters through the formulas of a text."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Var, fold, postorder
from rtamt.language.printing.printer import excerpt
from rtamt.language.quantifiers import FieldOf
from rtamt.language.records import Tense
from rtamt.language.units.dimensions import UNCHECKED, MisfitError, Number, Quantity, declared
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula, Span
    from rtamt.language.units.dimensions import Measure


class UnitFinding(NamedTuple):
    """Operands whose units do not fit, or cannot be checked; ``kind``: as of :class:`MisfitError`."""

    kind: str
    span: Span | None
    message: str


def unit_findings(document: Document) -> Iterator[UnitFinding]:
    """Yield the findings about the units of a text; none if it declares no unit.

    A sub-formula that has a finding counts as unknown above it, so that a mistake is reported once.

    >>> from rtamt.language.parsing.specfile import parse_document
    >>> (found,) = unit_findings(parse_document("input float v [m/s]  input float gap [m]  v > 3 and v + gap > 3"))
    >>> found.message
    "'v' is in m/s and 'gap' is in m, which are different quantities; correct a declaration, or multiply 'v' by a \
constant in s"
    """
    units = {each.name: declared(each.unit) for each in document.declarations if each.unit}
    for group in document.groups.values():
        units |= {f"{group.name}.{each.name}": declared(each.unit) for each in group.fields if each.unit}
    if not units:
        return
    measures: dict[int, Measure] = {}
    unchecked: set[str] = set()
    for node in postorder(*(assertion.formula for assertion in document.assertions)):
        if not isinstance(node, Apply):
            measures[id(node)] = _leaf(node, units)
            continue
        operands = [measures[id(operand)] for operand in node.args]
        measures[id(node)] = None
        if node.op.units is None:
            continue
        try:
            measures[id(node)] = node.op.units(operands)
        except MisfitError as error:
            message = error.message.format(*map(_operand_name, node.args))
            if error.kind != UNCHECKED or message not in unchecked:
                where = node if error.operand is None else node.args[error.operand]
                yield UnitFinding(error.kind, where.span, message)
            if error.kind == UNCHECKED:
                unchecked.add(message)
            continue
        if isinstance(measures[id(node)], Number):
            measures[id(node)] = _computed_number(node, operands)


def _operand_name(operand: Formula) -> str:
    """Return an operand for a message, constants by their names."""

    def named(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Apply):
            return Apply(node.op, args, node.interval, node.span)
        return Var(node.name) if isinstance(node, Const) and node.name and node.type is None else node

    return excerpt(fold(operand, named))


def _leaf(node: Formula, units: Mapping[str, Quantity]) -> Measure:
    if isinstance(node, FieldOf) and node.group is not None:
        return units.get(f"{node.group.name}.{node.field}")
    if isinstance(node, Var):
        return units.get(node.name)
    assert isinstance(node, Const)
    if node.type is not None:
        return None
    return Number(node.value) if node.name is None else units.get(node.name)


def _computed_number(node: Apply, operands: Sequence[Measure]) -> Number:
    """Return a number that is made of numbers of the text, such as 1000 / 3600."""
    values = [each.value for each in operands if isinstance(each, Number) and each.value is not None]
    if node.op.tense is not Tense.NONE or node.op.definition is None or len(values) != len(operands):
        return Number(None)
    with np.errstate(all="ignore"):
        value = float(node.op.definition(*(np.array([each]) for each in values))[0])
    return Number(value if isfinite(value) else None)
