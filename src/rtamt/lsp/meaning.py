"""The meaning of a text, to compare two texts that differ in one name."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Parameter, Var, postorder
from rtamt.language.quantifiers import FieldOf
from rtamt.language.value_types import Enumeration
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtamt.language.document import Declaration, Document
    from rtamt.language.formula import Formula
    from rtamt.language.quantifiers import Binder, Group
    from rtamt.language.records import Operator
    from rtamt.lsp.symbols import Symbol


class Renamed(NamedTuple):
    """A symbol that is called ``new`` in a text, and is to be compared under its own name."""

    symbol: Symbol
    new: str

    def name(self, name: str | None) -> str | None:
        """Return the name of a variable, a constant, a formula, a template, a group, a table, an enumeration."""
        if name is None or self.symbol.kind in ("value", "member", "field", "argument"):
            return name
        if name == self.new:
            return self.symbol.name
        # A field of a message, a member of an enumeration.
        return f"{self.symbol.name}{name[len(self.new) :]}" if name.startswith(f"{self.new}.") else name

    def local(self, kind: str, of: str, name: str) -> str:
        """Return the name of a field, a member of an enumeration, a parameter of a template: of what it belongs to."""
        mine = self.symbol.kind == kind and self.symbol.of == of and name == self.new
        return self.symbol.name if mine else name

    def member(self, name: str) -> str:
        """Return the name of the variable of a quantifier."""
        return self.symbol.name if self.symbol.kind == "member" and name == self.new else name


def meaning(document: Document, renamed: Renamed) -> tuple[object, ...]:
    """Return the meaning of a document, which is equal for equivalent documents."""
    called = renamed.name
    return (
        [_declaration(each, renamed) for each in document.declarations],
        [called(each.name) for each in document.assertions],
        [(called(each.name), each.description, each.severity) for each in document.requirements],
        [
            (
                called(name),
                [(renamed.local("argument", name, p.name), p.default is None) for p in each.parameters],
            )
            for name, each in document.templates.items()
        ],
        sorted((called(each) or "", topic) for each, topic in document.topics.items()),
        [_enumeration(each, renamed) for each in document.enumerations.values()],
        [_group(each, renamed) for each in document.groups.values()],
        [_operator(each, renamed) for each in document.tables.values()],
        document.sampling,
        list(_nodes([each.formula for each in document.assertions], renamed)),
    )


def _declaration(each: Declaration, renamed: Renamed) -> object:
    columns = each.columns or (each.name,) if each.kind == "var" else ()
    return (
        renamed.name(each.name), renamed.name(each.type), each.kind, each.role, each.value, each.unit, columns,
        each.optional, each.range, each.rate,
    )  # fmt: skip


def _enumeration(each: Enumeration, renamed: Renamed) -> object:
    members = [(renamed.local("value", each.name, name), code) for name, code in each.members]
    return renamed.name(each.name), members


def _group(group: Group, renamed: Renamed) -> object:
    fields = [
        (
            renamed.local("field", group.name, each.called or each.name),
            each.name, renamed.name(each.type), _type(each.values, renamed), each.unit,
        )
        for each in group.fields
    ]  # fmt: skip
    return renamed.name(group.name), group.pattern, group.role, fields


def _type(type_: object, renamed: Renamed) -> object:
    return _enumeration(type_, renamed) if isinstance(type_, Enumeration) else type_


def _operator(op: Operator, renamed: Renamed) -> object:
    """Return an operator; a table by its points, a quantifier by its variables and its group."""
    if op.binder is not None:
        return op.name, _binder(op.binder, renamed)
    if op.maker is not None:
        return renamed.name(op.name), op.maker[1][1:]
    return op.name


def _binder(binder: Binder, renamed: Renamed) -> object:
    apart = [(renamed.member(one), renamed.member(other)) for one, other in binder.apart]
    return renamed.member(binder.variable), _group(binder.group, renamed), apart


def _nodes(formulas: Iterable[Formula], renamed: Renamed) -> Iterator[object]:
    """Yield the nodes of formulas, operands first, each with the numbers of its operands."""
    numbers: dict[int, int] = {}
    for node in postorder(*formulas):
        numbers[id(node)] = len(numbers)
        if isinstance(node, Apply):
            constants = (
                [] if node.interval is None else [renamed.name(each) for each in node.interval.constants]
            )
            yield (
                _operator(node.op, renamed),
                node.interval,
                constants,
                [numbers[id(each)] for each in node.args],
            )
        elif isinstance(node, Parameter):
            yield renamed.name(node.name), repr(node.value), _type(node.type, renamed)
        elif isinstance(node, Const):
            of = node.type.name if isinstance(node.type, Enumeration) else ""
            name = node.name if of == "" or node.name is None else node.name.removeprefix(f"{of}.")
            named = renamed.name(name) if of == "" else renamed.local("value", of, name or "")
            yield repr(node.value), named, _type(node.type, renamed)
        elif isinstance(node, FieldOf):
            assert node.group is not None
            yield (
                renamed.member(node.variable),
                node.field,
                _group(node.group, renamed),
                _type(node.type, renamed),
            )
        else:
            assert isinstance(node, Var)
            yield renamed.name(node.name), _type(node.type, renamed)
