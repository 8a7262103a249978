"""The binding of variables to recordings: recorded names, and declared units.

``input float z_sp [m] = "trajectory_setpoint.position[2]"``: the variable z_sp is in metres, and recordings have it
under another name, perhaps in another unit.
"""

from __future__ import annotations

from rtamt.errors import TraceError, choices
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME, is_frame, is_mapping
from rtamt.signals.time_columns import check_frame, split_unit

if TYPE_CHECKING:
    from collections.abc import Container, Iterable, Mapping

    from rtamt.signals.trace import Channel, Trace


@dataclass(frozen=True, slots=True)
class Binding:
    """The recorded names and the declared units of the variables that a specification reads."""

    names: tuple[str, ...]
    #: Pairs of a variable and its recorded name.
    columns: tuple[tuple[str, str], ...] = ()
    #: Pairs of a variable and its declared unit.
    units: tuple[tuple[str, str], ...] = ()
    #: Pairs of a variable and further recorded names: the first that a recording has is read.
    others: tuple[tuple[str, tuple[str, ...]], ...] = ()
    #: Declared variables that the formula does not read, with names of timestamps: data may have them all the same.
    unread: tuple[str, ...] = ()

    def places(self) -> dict[str, tuple[str, str]]:
        """Return the recorded name and the unit of each variable."""
        columns, units = dict(self.columns), dict(self.units)
        return {name: (columns.get(name, name), units.get(name, "")) for name in self.names}

    @property
    def recorded(self) -> tuple[str, ...]:
        """Every recorded name of the variables."""
        columns, others = dict(self.columns), dict(self.others)
        return tuple(each for name in self.names for each in (columns.get(name, name), *others.get(name, ())))

    def found_in(self, known: Container[Any]) -> dict[str, str]:
        """Return the recorded name of each variable in a recording with these signals."""
        others = dict(self.others)
        return {
            name: next((each for each in (column, *others.get(name, ())) if each in known), column)
            for name, column in self.columns
        }

    def applied(self, data: Any, *, partial: bool = False) -> Any:
        """Return data with the variables under their own names, in their declared units.

        Applying it again changes nothing. ``partial``: for a chunk, which need not have all variables. Raises
        :class:`TraceError` for a recorded name that is missing and units that cannot be converted.
        """
        if data.__class__ is not dict:
            from rtamt.signals.trace import Trace

            if isinstance(data, Trace):
                return self._trace(data) if self.columns or self.units else data
        if self.unread and is_mapping(data) and TIME not in data:
            data = {key: value for key, value in data.items() if key not in self.unread}
        if not self.columns:
            return data
        if is_mapping(data):
            return self._mapping(data, partial)
        return self._frame(data) if is_frame(data) else data

    def _trace(self, trace: Trace) -> Trace:
        from rtamt.signals.unit_conversion import converted

        channels = {name: trace.channel(name) for name in trace}
        by_column = {split_unit(channel.column)[0]: name for name, channel in reversed(channels.items())}
        by_column |= {channel.column: name for name, channel in reversed(channels.items())}
        by_column = {**trace.aliases, **by_column}
        columns = self.found_in({*by_column, *channels})
        source = {}
        for name in self.names:
            column = columns.get(name)
            if column is None:
                place = name if name in channels else trace.aliases.get(name)
            else:
                place = by_column.get(column, column if column in channels else name)
                if place not in channels:
                    raise missing(trace.source, name, column, trace.names)
            if place is not None:
                source[name] = place
        made: dict[str, Channel] = {}
        for place, channel in channels.items():
            readers = [name for name, other in source.items() if other == place]
            if place not in source and all(name == channel.alias for name in readers):
                made[place] = channel
            for name in readers:
                alias = channel.alias if name == place else ""
                made[name] = replace(channel, column=columns.get(name, channel.column), alias=alias)
        notes = []
        for name, unit in self.units:
            channel_of = made.get(name)
            if channel_of is None or not channel_of.unit:
                continue
            values = converted(channel_of.values, name, channel_of.unit, unit)
            if values is not channel_of.values:
                notes.append(f"{name} was converted from {channel_of.unit} to {unit}")
            made[name] = replace(channel_of, values=values, unit=unit)
        return trace.with_channels(made, conversions=notes)

    def _mapping(self, data: Mapping[Any, Any], partial: bool) -> dict[Any, Any]:
        found = {}
        columns = self.found_in(data)
        for name, column in columns.items():
            if column in data:
                found[name] = data[column]
            elif name not in data and name.split(".")[0] not in data and not partial:
                raise missing("the data", name, column, [str(key) for key in data if key != TIME])
        used = {column for name, column in columns.items() if name in found} - set(self.names)
        return {**{key: value for key, value in data.items() if key not in used}, **found}

    def _frame(self, data: Any) -> dict[str, Any]:
        from rtamt.signals.assumed_period import FrameColumns  # few bindings meet a frame

        names = list(data.columns)
        columns = self.found_in(set(map(str, names)))
        check_frame(data, TIME, (*self.names, *columns.values()))
        made = self._mapping({name: data[name] for name in names}, partial=False)
        readers = [name for name, column in columns.items() if column in names[:1]]
        return FrameColumns({name: made[name] for name in (*readers, *made)})


def union(bindings: Iterable[Binding]) -> Binding:
    """Combine several bindings, which do not contradict each other."""
    bindings = list(bindings)
    names, columns, units, others = (
        tuple(dict.fromkeys(each for binding in bindings for each in getattr(binding, part)))
        for part in ("names", "columns", "units", "others")
    )
    unread = dict.fromkeys(name for binding in bindings for name in binding.unread if name not in names)
    return Binding(names, columns, units, others, tuple(unread))


def missing(source: str, name: str, column: str, known: Any) -> TraceError:
    """Return the error for a variable that a recording does not have under its recorded name."""
    return TraceError(
        f"{source} has no '{column}', the recorded name of '{name}'{choices(column, known, 'signals')}",
        variable=name,
    )
