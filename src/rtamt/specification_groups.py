"""A specification with quantifiers over the members of groups, and the ordinary one that it is over known members.

How quantifiers are replaced is imported on use: most texts have none.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from itertools import product
from types import MappingProxyType

from rtamt.errors import UsageError, choices
from rtamt.language.document import Declaration, groups_in
from rtamt.language.quantifiers import Field, Group
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.specification_recorded import RecordedSpecification

if TYPE_CHECKING:
    from collections.abc import Iterable

    from typing_extensions import Self

    from rtamt.language.formula import Formula
    from rtamt.language.units.durations import Duration
    from rtamt.rewrite.quantifiers import Members


@dataclass(frozen=True, eq=False, repr=False)
class QuantifiedText(RecordedSpecification):
    """The groups of a specification, and its formulas over their members."""

    @cached_property
    def groups(self) -> Mapping[str, tuple[Group, tuple[str, ...]]]:
        """The groups that quantifiers range over, each with the fields of its members: those declared, or those read.

        Of one requirement of several those that it reads, with the fields that any of them reads.

        >>> import rtamt
        >>> spec = rtamt.parse('group cars = "car_*"; always forall v in cars: v.x - ego > 5')
        >>> {name: fields for name, (_, fields) in spec.groups.items()}
        {'cars': ('x',)}
        """
        if self.resolved is not None:
            return MappingProxyType({})
        if not self.document.groups and not self.document.replaced:
            return MappingProxyType({})  # without a declared group there is no quantifier to look for
        every = groups_in(*self._all_formulas) if self.document.replaced else self.document.quantified_groups
        if not self.document.selected:
            return every
        return MappingProxyType({name: every[name] for name in groups_in(self.formula)})

    def refuse_recorded_fields(self) -> None:
        """Raise :class:`UsageError` for a variable that is recorded under the name of a field of a member."""
        recorded = ((name, column) for name, columns in self._recorded_names.items() for column in columns)
        for (name, column), (group, fields) in product(recorded, self.groups.values()):
            member = group.member(column)
            if name != column and member is not None and member[1] in fields:
                raise UsageError(
                    f"'{column}' is the recorded name of '{name}', and a field of '{member[0]}' of the group "
                    f"'{group.name}': read '{column}' in formulas in place of '{name}'"
                )

    @property
    def _all_formulas(self) -> list[Formula]:
        formulas = [assertion.formula for assertion in self.document.assertions]
        return [*formulas, self.formula] if self.document.replaced else formulas

    def over(self, members: Members | Mapping[str, Iterable[str]]) -> Self:
        """Return the specification over these members of its groups: an ordinary one, without quantifiers.

        ``members``: from each group to its members, which are present throughout, such as
        ``{"cars": ["car_1", "car_2"]}``.

        >>> import rtamt
        >>> spec = rtamt.parse('group cars = "car_*"; forall v in cars: v.x > 3')
        >>> print(spec.over({"cars": ["car_1", "car_2"]}))
        car_1.x > 3 and car_2.x > 3
        """
        from rtamt.rewrite.quantifiers import Members

        if not isinstance(members, Members):
            members = self._checked_members(members)
        key = tuple(members.names.items()), members.throughout
        made = self._over.get(key)
        if made is None:
            made = self._over[key] = self._resolve_over(members)
        return made

    @cached_property
    def _over(self) -> dict[Any, Any]:
        return {}

    def _resolve_over(self, members: Members) -> Self:
        from rtamt.rewrite.presence import channel_of
        from rtamt.rewrite.quantifiers import resolved_document

        self.refuse_recorded_fields()
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

    def pastified(self, period: Duration | None = None) -> Formula:
        """See :meth:`SpecificationText.pastified`; the members must be known."""
        self.require_no_groups("pastification")
        return super().pastified(period)

    def require_no_groups(self, what: str) -> None:
        """Raise :class:`UsageError` for quantifiers over members that are not known yet, where they have to be."""
        for name in self.groups:
            raise UsageError(
                f"the formula quantifies over '{name}', whose members are known with the data, and {what} needs "
                f"them before; evaluate recordings, or name the members: spec.over({{'{name}': [...]}})"
            )

    def _checked_members(self, given: Any) -> Members:
        if not isinstance(given, Mapping) or any(isinstance(found, str) for found in given.values()):
            groups = {name: [group.pattern.replace("*", "1")] for name, (group, _) in self.groups.items()}
            raise UsageError(
                f"over() takes a list of members for each group, such as {groups}; got {given!r}"
            )
        names = {name: tuple(given.get(name, ())) for name in self.groups}
        for name in given:
            if name not in names:
                raise UsageError(f"there is no group '{name}'{choices(name, names, 'groups')}")
        for name, found in names.items():
            if name not in given:
                raise UsageError(f"the members of '{name}' are missing; give {{'{name}': [...]}}")
            for member in found:
                if not self.groups[name][0].matches(member):
                    pattern = self.groups[name][0].pattern
                    raise UsageError(f"'{member}' is no member of '{name}', whose pattern is \"{pattern}\"")
        from rtamt.rewrite.quantifiers import Members

        return Members(names, frozenset(member for found in names.values() for member in found))
