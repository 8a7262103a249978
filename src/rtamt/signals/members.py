"""The members of groups in recorded data: which there are, and where each of them is present.

A member is present where all its fields have a sample. A sample that is missing (``None``, a null of Arrow or polars,
``pandas.NA``, a masked value) ends its presence. Where it is absent its fields are 1, which nothing reads, and
a further channel is 1 where the member is present, else 0.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.language.quantifiers import Field
from rtamt.language.value_types import Enumeration
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.presence import channel_of
from rtamt.rewrite.quantifiers import Members
from rtamt.signals import dense_arrays
from rtamt.signals.arrays import (
    TIME,
    WithTimeBases,
    field_of,
    is_frame,
    is_mapping,
)
from rtamt.signals.assumed_period import require_times
from rtamt.signals.data_errors import missing_outside, not_a_mapping
from rtamt.signals.gaps import gaps_of, items_of
from rtamt.signals.sampling_period import merged
from rtamt.signals.time_columns import check_frame
from rtamt.signals.trace import Channel, Trace

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.language.quantifiers import Group
    from rtamt.signals.inexact import Mask

    #: The fields of the members of a group that formulas read.
    Fields = Mapping[str, tuple[Group, tuple[str, ...]]]


class Bound(NamedTuple):
    """Data in which each member is a set of ordinary variables, and the members."""

    data: Any
    members: Members


def members_of(
    groups: Fields,
    names: Iterable[str],
    aliases: Mapping[str, str] = MappingProxyType({}),
    *,
    partly: bool = False,
) -> dict[str, tuple[str, ...]]:
    """Return the members of each group among recorded names, in their order.

    ``aliases``: from other names of the same samples to recorded names; they count where the pattern of a group does
    not match the recorded name. Raises :class:`TraceError` for a member that lacks a field, unless these are ``partly``
    the names.
    """
    names = [name for name in names if name not in aliases]
    found: dict[str, tuple[str, ...]] = {}
    for group, fields in groups.values():
        having: dict[str, set[str] | None] = {}
        others = [alias for alias, name in aliases.items() if group.member(name) is None]
        for name in (*others, *names):
            if group.matches(name):
                having[name] = None  # values with fields
            elif (parts := group.member(name)) is not None:
                known = having.setdefault(parts[0], set())
                if known is not None:
                    known.add(parts[1])
        for member, recorded in having.items():
            missing = [] if recorded is None else [name for name in fields if name not in recorded]
            if missing and not partly:
                raise TraceError(
                    f"'{member}' is a member of the group '{group.name}' and has no '{missing[0]}'; record "
                    f"'{member}.{missing[0]}', or narrow the pattern \"{group.pattern}\"",
                    variable=f"{member}.{missing[0]}",
                )
        found[group.name] = tuple(having)
    return found


def declared_fields(members: Mapping[str, tuple[str, ...]], groups: Fields) -> dict[str, Field]:
    """Return the fields of members by their names in data, with what is declared of them."""
    found: dict[str, Field] = {}
    for name, (group, fields) in groups.items():
        declared = {each.name: each for each in group.fields}
        for member in members[name]:
            for field in fields:
                found.setdefault(f"{member}.{field}", declared.get(field, Field(field)))
    return found


def bound(
    data: Any,
    groups: Fields,
    names: Collection[str],
    *,
    own_time_bases: bool,
    source: str = "the data",
    regular: bool = True,
) -> Bound:
    """Return finished data with the members of groups as ordinary variables.

    ``names``: the variables that formulas read in addition to those of members. ``regular``: whether the period of
    samples without timestamps is known. Raises :class:`TraceError` for a group without members.
    """
    known = names_of(data)
    members = members_of(groups, known, aliases_of(data))
    require_members(members, groups, known, source)
    read = _trace if isinstance(data, Trace) else _on_own_time_bases if own_time_bases else on_one_time_base
    columns = columns_of_members(members, groups)
    if not regular:
        require_times_of_members(data, columns, names)
    made, throughout = read(with_aliases(data, columns), columns, names)
    return Bound(made, Members(members, frozenset(throughout)))


def require_members(
    members: Mapping[str, tuple[str, ...]], groups: Fields, known: Sequence[str], source: str
) -> None:
    """Raise :class:`TraceError` for a group without members; ``known``: the names in the ``source``."""
    for name, found in members.items():
        if not found:
            group = groups[name][0]
            recorded = ", ".join(known[:8]) or "none"
            raise TraceError(
                f"{source} has no member of the group '{name}': no name matches \"{group.pattern}\" and a field, "
                f"such as {group.pattern.replace('*', '1')}.{(*groups[name][1], 'x')[0]}; names: {recorded}"
            )


class Member(NamedTuple):
    """A member with its fields: the type of each, None for numbers."""

    name: str
    fields: Mapping[str, Any]

    def column(self, field: str) -> str:
        """Return the name of a field in data."""
        return f"{self.name}.{field}"


def columns_of_members(members: Mapping[str, tuple[str, ...]], groups: Fields) -> list[Member]:
    """Return each member once, with the fields of all groups that it is a member of."""
    found: dict[str, dict[str, Any]] = {}
    for name, (group, fields) in groups.items():
        for member in members[name]:
            found.setdefault(member, {}).update({field: group.values(field) for field in fields})
    return [Member(member, fields) for member, fields in found.items()]


def require_times_of_members(data: Any, members: Sequence[Member], names: Collection[str]) -> None:
    """Raise :class:`TraceError` if the first column of data may hold the timestamps, see :func:`require_times`."""
    known = {*names_of(data), *aliases_of(data)}
    read = [*names, *(each.column(field) for each in members for field in each.fields)]
    require_times(data, [name for name in read if name in known])


def names_of(data: Any) -> list[str]:
    """Return the names of the variables in data, in their order."""
    if isinstance(data, WithTimeBases) or is_mapping(data):
        return [str(name) for name in data if name != TIME]
    if not is_frame(data):
        raise not_a_mapping(data, "values, such as {'time': [...], 'car_1.x': [...]}")
    return [str(name) for name in data.columns if name != TIME]


def aliases_of(data: Any) -> Mapping[str, str]:
    """Return the other names of recorded samples."""
    return data.aliases if isinstance(data, Trace) else {}


def with_aliases(data: Any, members: Sequence[Member]) -> Any:
    """Return data that has the fields of members under the names of these, also where they are aliases."""
    aliases = aliases_of(data)
    columns = [
        column for each in members for field in each.fields if (column := each.column(field)) in aliases
    ]
    if not columns:
        return data
    own = {name: data.channel(name) for name in data}
    return data.with_channels(own | {column: replace(data.channel(column), alias="") for column in columns})


# ---- samples that all have the same timestamps ---------------------------------------------------


def on_one_time_base(
    data: Any, members: Sequence[Member], names: Collection[str]
) -> tuple[dict[str, Any], list[str]]:
    """Return samples with the fields and channels of members, and the members that are present throughout.

    ``names``: the variables that formulas read outside of quantifiers, which may be fields of members.
    """
    if not is_mapping(data):
        check_frame(data, TIME, [each.column(field) for each in members for field in each.fields])
        data = {name: data[name] for name in data.columns}
    made, throughout = dict(data), []
    for each in members:
        columns = {field: _field_values(data, each, field) for field in each.fields}
        absent = _union([gaps_of(values) for values in columns.values()])
        if absent is None or not absent.any():
            throughout.append(each.name)
            absent = None
        else:
            made[channel_of(each.name)] = np.where(absent, 0.0, 1.0)
        for field, values in columns.items():
            column = each.column(field)
            if column in names:
                _require_values(column, values)
                made[column] = values
            else:
                made[column] = filled(values, absent, each.fields[field])
    return made, throughout


def _require_values(name: str, values: Any) -> None:
    """Raise :class:`TraceError` for a missing value of a field that a formula reads outside of quantifiers."""
    gaps = gaps_of(values)
    if gaps is not None and gaps.any():
        raise missing_outside(name, int(gaps.argmax()))


def _field_values(data: Mapping[str, Any], member: Member, field: str) -> Any:
    """Return the values of a field: its own column, or attributes of the objects in the member's column."""
    column = member.column(field)
    return data[column] if column in data else in_objects(data[member.name], member.name, field)


def in_objects(objects: Any, member: str, field: str) -> list[Any]:
    """Return the values of a field in objects; None where an object is."""
    path = field.split(".")
    return [None if each is None else field_of(each, member, path, i) for i, each in enumerate(objects)]


def _union(masks: Iterable[Mask | None]) -> Mask | None:
    absent: Mask | None = None
    for mask in masks:
        if mask is None:
            continue
        if absent is not None and len(absent) != len(mask):
            return None  # columns of different lengths, which is an error elsewhere
        absent = mask if absent is None else absent | mask
    return absent


def filled(values: Any, absent: Mask | None, type_: Any) -> Any:
    """Return values with a number in place of those that nothing reads."""
    if absent is None:
        return values
    instead = filler(type_)
    return [
        instead if gone else value for value, gone in zip(items_of(values), absent.tolist(), strict=False)
    ]


def filler(type_: Any) -> float:
    """Return the value of a field of an absent member: any value of its type, for numbers 1."""
    return float(type_.members[0][1]) if isinstance(type_, Enumeration) else 1.0


# ---- samples with their own timestamps -----------------------------------------------------------


def _on_own_time_bases(
    data: Any, members: Sequence[Member], names: Collection[str]
) -> tuple[dict[str, Any], list[str]]:
    fields = {each.column(field): each for each in members for field in each.fields}
    if not is_mapping(data):
        check_frame(data, TIME, list(fields))
        data = {name: data[name] for name in data.columns}
    shared = data.get(TIME) if TIME not in names else None
    made = dict(data) if shared is None else {}
    columns = dict(
        dense_arrays.columns_of(data, [name for name in names if name.split(".")[0] in data or name in data])
    )
    if shared is not None:
        made |= columns
    recorded: dict[str, tuple[Any, Any]] = {}
    for each in members:
        for field in each.fields:
            column = each.column(field)
            if column in data:
                recorded |= dense_arrays.columns_of(data, [column])
            else:
                ((times, objects),) = dense_arrays.columns_of(data, [each.name]).values()
                recorded[column] = times, in_objects(objects, each.name, field)
            dense_arrays.require_order(column, recorded[column][0])
    start = _start(columns, recorded)
    throughout = []
    for each in members:
        own = {field: recorded[each.column(field)] for field in each.fields}
        times, present, values = _in_steps(own, start, each.fields)
        if present is None:
            throughout.append(each.name)
        else:
            made[channel_of(each.name)] = times, present
        for field, column_values in values.items():
            column = each.column(field)
            if column in names:
                _require_values(column, own[field][1])
                made[column] = own[field]
            else:
                made[column] = times, column_values
    return made, throughout


def _start(columns: Mapping[str, tuple[Any, Any]], recorded: Mapping[str, tuple[Any, Any]]) -> Any:
    """Return the start of a trace, which members do not move: where there are only members, their first sample."""
    firsts = [times[0] for times, _ in columns.values() if len(times)]
    if firsts:
        return max(firsts)
    return min((times[0] for times, _ in recorded.values() if len(times)), default=None)


def _in_steps(
    recorded: Mapping[str, tuple[Any, Any]], start: Any, types: Mapping[str, Any]
) -> tuple[NDArray[Any], NDArray[np.float64] | None, dict[str, list[Any]]]:
    """Return the times at which a member changes, whether it is present there, and its fields there.

    The presence is None where it is present from the start of the trace on, and never absent.
    """
    bases = {field: np.asarray(times) for field, (times, _) in recorded.items()}
    times = merged(list(bases.values()))
    if not len(times):
        times = np.asarray([start])
    present = np.ones(len(times), bool)
    places = {}
    for field, base in bases.items():
        at = base.searchsorted(times, "right") - 1
        mask = gaps_of(recorded[field][1])
        has = at >= 0
        if mask is not None and len(mask) == len(base) and len(base):
            has &= ~mask[at]
        present &= has
        places[field] = at
    if start is not None and times[0] > start:
        times = np.concatenate((np.asarray([start], times.dtype), times))
        present = np.concatenate(([False], present))
        places = {field: np.concatenate(([-1], at)) for field, at in places.items()}
    values = {}
    for field, at in places.items():
        given, instead = items_of(recorded[field][1]), filler(types[field])
        values[field] = [
            given[place] if here else instead
            for place, here in zip(at.tolist(), present.tolist(), strict=True)
        ]
    return times, None if present.all() else present.astype(float), values


# ---- traces that were read ----------------------------------------------------------------------


def _trace(trace: Trace, members: Sequence[Member], names: Collection[str]) -> tuple[Trace, list[str]]:
    """Return a trace whose members have a sample at each timestamp of their table."""
    made = {name: trace.channel(name) for name in trace}
    throughout = []
    own = [made[each.column(field)] for each in members for field in each.fields]
    start = max(_firsts([made[name] for name in names if name in made]), default=None)
    if start is None:
        start = min(_firsts(own), default=None)
    for each in members:
        channels = {field: made[each.column(field)] for field in each.fields}
        if all(channel.first_gap is None and _begins(channel, start) for channel in channels.values()):
            throughout.append(each.name)
            continue
        recorded = {field: with_gaps(channel) for field, channel in channels.items()}
        for field, (base, _) in recorded.items():
            dense_arrays.require_order(each.column(field), base)
        times, present, values = _in_steps(recorded, start, each.fields)
        if present is None:
            throughout.append(each.name)
            continue
        retimed = all(channel.retimed for channel in channels.values())
        made[channel_of(each.name)] = Channel(times, present, retimed=retimed)
        for field, column_values in values.items():
            column = each.column(field)
            if column in names:
                _require_values(column, recorded[field][1])
            else:
                full = np.array(column_values, float)
                made[column] = replace(channels[field], times=times, values=full, first_gap=None, table=None)
    return trace.with_channels(made), throughout


def with_absences(trace: Trace, columns: Collection[str]) -> dict[str, Any]:
    """Return the samples of a trace on one time base, in which a value of one of the ``columns`` may be None."""
    made, values = {name: trace.channel(name) for name in trace}, {}
    for name in columns:
        if name in made and made[name].table is not None:
            times, values[name] = with_gaps(made[name])
            blank = np.zeros(len(times))
            made[name] = replace(made[name], times=times, values=blank, first_gap=None, table=None)
    return trace.with_channels(made).on_one_time_base([name for name in made if name != TIME]) | values


def _firsts(channels: Iterable[Channel]) -> list[Any]:
    tables = [channel.times if channel.table is None else channel.table for channel in channels]
    return [times[0] for times in tables if times is not None and len(times)]


def _begins(channel: Channel, start: Any) -> bool:
    return channel.times is None or (len(channel.times) > 0 and bool(channel.times[0] <= start))


def with_gaps(channel: Channel) -> tuple[NDArray[Any], list[Any]]:
    """Return the times of a channel's table, and its values there, None where it has none."""
    assert channel.times is not None
    if channel.table is None:
        return channel.times, channel.values.tolist()
    table = channel.table
    values: list[Any] = [None] * len(table)
    for place, value in zip(table.searchsorted(channel.times).tolist(), channel.values.tolist(), strict=True):
        values[place] = value
    return table, values
