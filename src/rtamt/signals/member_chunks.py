"""Chunks of streams with members of groups, any of which they may lack."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.presence import channel_of
from rtamt.signals import dense_arrays
from rtamt.signals.arrays import TIME, is_mapping
from rtamt.signals.members import (
    aliases_of,
    columns_of_members,
    in_objects,
    members_of,
    names_of,
    on_one_time_base,
    require_times_of_members,
    with_absences,
    with_aliases,
    with_gaps,
)
from rtamt.signals.time_columns import check_frame
from rtamt.signals.trace import Trace

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rtamt.signals.members import Fields


class Chunk(NamedTuple):
    """Samples of a stream, in which each member is a set of ordinary variables."""

    data: Any
    #: The variables of members, with their channels.
    columns: tuple[str, ...]
    types: Mapping[str, Any]
    #: By group: its members, each with the names of its channel (None if it is present throughout) and fields.
    groups: Mapping[str, Mapping[str, tuple[str | None, Mapping[str, str]]]]

    def present(self, columns: Mapping[str, Any], i: int) -> dict[str, dict[str, dict[str, float]]]:
        """Return the members of each group that are present at a sample, with their fields."""
        return {
            group: {
                member: {field: float(columns[name][i]) for field, name in fields.items()}
                for member, (channel, fields) in found.items()
                if channel is None or columns[channel][i]
            }
            for group, found in self.groups.items()
        }


def chunk(data: Any, groups: Fields, names: Collection[str], *, regular: bool) -> Chunk:
    """Return some samples of a stream with the members of groups as ordinary variables, of which there may be none.

    ``names``: the variables beside those of members. ``regular``: whether the period of samples without timestamps is
    known.
    """
    found = members_of(groups, names_of(data), aliases_of(data))
    known = columns_of_members(found, groups)
    if not regular:
        require_times_of_members(data, known, names)
    data = with_aliases(data, known)
    if isinstance(data, Trace):
        data = with_absences(data, [each.column(field) for each in known for field in each.fields])
    made, throughout = on_one_time_base(data, known, names)
    channels = {each.name: channel_of(each.name) for each in known if each.name not in throughout}
    types = {
        each.column(field): type_
        for each in known
        for field, type_ in each.fields.items()
        if type_ is not None
    }
    columns = (*(each.column(field) for each in known for field in each.fields), *channels.values())
    return Chunk(
        made,
        columns,
        types,
        {
            name: {
                member: (channels.get(member), {field: f"{member}.{field}" for field in groups[name][1]})
                for member in own
            }
            for name, own in found.items()
        },
    )


def fields_on_own_time_bases(data: Any, groups: Fields) -> dict[str, tuple[Any, Any]]:
    """Return the times and values of the fields of members in samples of a stream, None where a member is absent."""
    found = columns_of_members(members_of(groups, names_of(data), aliases_of(data), partly=True), groups)
    data = with_aliases(data, found)
    columns = [each.column(field) for each in found for field in each.fields]
    if isinstance(data, Trace):
        return {column: with_gaps(data.channel(column)) for column in columns if column in data}
    if not is_mapping(data):
        check_frame(data, TIME, columns)
        data = {name: data[name] for name in data.columns}
    made = dict(dense_arrays.columns_of(data, [column for column in columns if column in data]))
    for each in found:
        if each.name in data:
            ((times, objects),) = dense_arrays.columns_of(data, [each.name]).values()
            made |= {
                each.column(field): (times, in_objects(objects, each.name, field)) for field in each.fields
            }
    return made
