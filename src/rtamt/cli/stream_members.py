"""The members of groups in a stream of lines: keys of JSON objects, or columns of CSV."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.cli.json_lines import STDIN, flat, number_of
from rtamt.readers.frames import field_of
from rtamt.signals.arrays import TIME
from rtamt.signals.members import declared_fields, members_of, require_members

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rtamt.language.quantifiers import Field
    from rtamt.signals.members import Fields


class StreamMembers:
    """Finds the members of groups in lines.

    The result is passed to a monitor unchanged: a field that is None has no sample there.
    """

    def __init__(self, groups: Fields) -> None:
        self._groups = groups

    def in_object(self, data: Mapping[str, Any], number: int) -> dict[str, Any]:
        """Return the fields of members in the JSON object of line ``number``, under names with dots."""
        found: dict[str, Any] = {}
        for name, value in flat(data):
            owners = [(group, own[1]) for group, _ in self._groups.values() if (own := group.member(name))]
            read = [group.values(field) for group, field in owners if field in self._groups[group.name][1]]
            if read and value is not None:
                type_ = next((each for each in read if each is not None), None)
                found[name] = number_of(value, name, number, type_)
            elif owners:
                found[name] = None  # fields that no formula reads still show that the member is present
            elif any(group.matches(name) for group, _ in self._groups.values()):
                found[name] = value
        return found

    def in_header(self, columns: Iterable[str]) -> dict[str, Field]:
        """Return the fields of members among columns, by name, with their types and units.

        Raises :class:`TraceError` for a group without members, and for a member that lacks a field.
        """
        names = [name for name in (field_of(column).name for column in columns) if name != TIME]
        members = members_of(self._groups, names)
        require_members(members, self._groups, names, STDIN)
        return declared_fields(members, self._groups)
