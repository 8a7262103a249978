"""A specification with quantifiers over the members of groups, and the ordinary one that it is over known members."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.language.document import Declaration
from rtamt.language.groups import Field, Group, fields_of, quantifiers
from rtamt.rewrite.members import Members, resolved_document
from rtamt.rewrite.presence import channel_of
from rtamt.specification_recorded import RecordedSpecification

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import Self


@dataclass(frozen=True, eq=False, repr=False)
class QuantifiedText(RecordedSpecification):
    """The groups of a specification, and its formulas over their members."""

    @cached_property
    def groups(self) -> Mapping[str, tuple[Group, tuple[str, ...]]]:
        """The groups that quantifiers range over, each with the fields of its members: those declared, or those read.

        >>> import rtamt
        >>> spec = rtamt.parse('group cars = "car_*"; always forall v in cars: v.x - ego > 5')
        >>> {name: fields for name, (_, fields) in spec.groups.items()}
        {'cars': ('x',)}
        """
        if self.resolved is not None:
            return MappingProxyType({})
        formulas = [assertion.formula for assertion in self.document.assertions]
        if self.document.replaced:
            formulas.append(self.formula)
        found: dict[str, tuple[Group, dict[str, None]]] = {}
        for node in quantifiers(*formulas):
            assert node.op.binder is not None
            group = node.op.binder.group
            found.setdefault(group.name, (group, dict.fromkeys(each.name for each in group.fields)))
        for field_of in fields_of(*formulas):
            assert field_of.group is not None
            found[field_of.group.name][1].setdefault(field_of.field)
        return MappingProxyType({name: (group, tuple(fields)) for name, (group, fields) in found.items()})

    def over(self, members: Members) -> Self:
        """Return the specification over these members of its groups: an ordinary one, without quantifiers."""
        key = tuple(members.names.items()), members.throughout
        made = self._over.get(key)
        if made is None:
            made = self._over[key] = self._resolved_over(members)
        return made

    @cached_property
    def _over(self) -> dict[Any, Any]:
        return {}

    def _resolved_over(self, members: Members) -> Self:
        roles = dict(self.roles)
        declarations = {each.name: each for each in self.document.declarations}
        for group, fields in self.groups.values():
            declared = {each.name: each for each in group.fields}
            for member in members.names[group.name]:
                role = roles.get(group.name, group.role)
                if role is not None:
                    roles[member] = roles[channel_of(member)] = role
                for name in fields:
                    known = declared.get(name, Field(name))
                    column = f"{member}.{name}"
                    declarations.setdefault(
                        column,
                        Declaration(column, known.type, role=group.role, unit=known.unit, span=group.span),
                    )
        document = resolved_document(self.document, members, tuple(declarations.values()))
        return replace(self, document=document, roles=roles, resolved=(self, members))

    def require_no_groups(self, what: str) -> None:
        """Raise :class:`UsageError` for quantifiers over members that are not known yet, where they have to be."""
        for name in self.groups:
            raise UsageError(
                f"the formula quantifies over '{name}', whose members are known with the data, and {what} needs "
                f"them before; evaluate recordings with evaluate(), or name the members: spec.over(...)"
            )
