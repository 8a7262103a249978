"""The columns of a recording that a requirement over the members of groups reads."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import replace
from rtamt.signals import members

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.readers.selection import Choice
    from rtamt.readers.source import Source
    from rtamt.specification import Specification


def choice_of_members(
    spec: Specification, source: Source, choice_of: Callable[[Specification], Choice]
) -> Choice:
    """Return which columns a requirement over members of groups reads of a source, and how.

    ``choice_of``: what a specification over known members reads. Raises :class:`TraceError` for a member that lacks a
    field.
    """
    names = members_in(source, spec)
    fields = members.declared_fields(names, spec.groups)
    choice = choice_of(spec.over(names))
    # A cell that is empty ends the presence of a member, also that of a field that no formula reads.
    return replace(
        choice,
        columns=tuple(dict.fromkeys((*(choice.columns or ()), *fields))) or None,
        types={name: each.values for name, each in fields.items() if each.values} | dict(choice.types),
        gaps=True,
    )


def members_in(source: Source, spec: Specification) -> dict[str, tuple[str, ...]]:
    """Return the members of each group of a specification in a source; columns of timestamps are none.

    Raises :class:`TraceError` for a member that lacks a field.
    """
    clocks = [table.time_field for table in source.tables if table.time_field is not None]
    patterns = [group for group, _ in spec.groups.values()]
    no_members = {
        name
        for clock in clocks
        for name in (clock.column, clock.name)
        if any(group.matches(name) for group in patterns)
    }
    return members.members_of(spec.groups, sorted(source.signals - no_members), source.aliases)
