"""Assembly of a trace from a source: which columns, under which names, with which timestamps."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, choices, did_you_mean
from rtamt.language.units.durations import NANOSECOND
from rtamt.lazy import dataclasses
from rtamt.lazy.modules import np
from rtamt.readers.first_column import FirstColumn, possible_field
from rtamt.readers.gaps import Gaps
from rtamt.readers.numbers import numbers_of, rounded
from rtamt.readers.silence import Silences
from rtamt.readers.timestamps import TimestampColumn, guess_field
from rtamt.signals.arrays import TIME
from rtamt.signals.data_errors import FILE_MENDS, missing_sample
from rtamt.signals.trace import LEFT_OUT, Channel, Trace, in_seconds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.readers.source import Field, Raw, Source, Table
    from rtamt.signals.coding import Types


@dataclasses.dataclass(frozen=True, slots=True)
class Choice:
    """The caller's selection; see :func:`rtamt.read`."""

    time: str | None = None
    columns: tuple[str, ...] | None = None
    names: Mapping[str, str] = dataclasses.field(default_factory=dict)
    units: Mapping[str, str] = dataclasses.field(default_factory=dict)
    skip_nan: tuple[str, ...] = ()
    #: The types of signals whose values may be names.
    types: Types = dataclasses.field(default_factory=dict)
    #: Seconds for which a value takes the place of samples that are left out.
    hold_for: Fraction | None = None
    #: Whether a value may be missing; discrete time needs one of every signal at every sample.
    gaps: bool = True
    #: Further columns of signals, for sources without the one in ``names``.
    others: Mapping[str, tuple[str, ...]] = dataclasses.field(default_factory=dict)

    def column_of(self, name: str, has: Callable[[str], bool]) -> str:
        """Return the column of a signal: the first of its columns that the source has, else the preferred one."""
        column = self.names.get(name, name)
        return next((each for each in (column, *self.others.get(name, ())) if has(each)), column)

    @property
    def recorded(self) -> tuple[str, ...] | None:
        """All columns that may be read; None: those of the whole source."""
        if self.columns is None:
            return None
        return tuple(
            column
            for name in self.columns
            for column in (self.names.get(name, name), *self.others.get(name, ()))
        )


@dataclasses.dataclass(frozen=True, slots=True)
class Selection:
    """The selection of one table: the field of timestamps, and the fields to read with the names of their signals."""

    table: Table
    time_field: Field | None
    guessed: bool
    signals: tuple[tuple[str, Field], ...]
    #: Whether the caller named the columns, so that one that is no number is an error.
    named: bool
    #: The first column, read in addition because it may hold the timestamps.
    possible: Field | None = None

    @property
    def fields(self) -> tuple[Field, ...]:
        """The columns to read from the table: the timestamps first."""
        return self.leading + tuple(field for _, field in self.signals)

    @property
    def leading(self) -> tuple[Field, ...]:
        """The column of timestamps, or that which may hold them, if there is one."""
        first = self.time_field or self.possible
        return () if first is None else (first,)


def trace_of(source: Source, choice: Choice) -> Trace:
    """Read a source whole."""
    source = source.completed(choice.recorded)
    channels: dict[str, Channel] = {}
    notes, losses = list(source.notes), list(source.losses)
    silences = Silences()
    selections = _aligned(source, choice)
    first_column = _first_column(selections)
    for place, selection in enumerate(selections):
        raws = selection.table.load(selection.fields)
        if first_column is not None:
            first_column.take(raws[0])
        losses += selection.table.losses
        timestamps = timestamps_of(source, selection, choice)
        gaps = _gaps(source, selection, choice)
        made, left_out = _channels(source, selection, timestamps, raws, choice, gaps)
        notes += [] if timestamps is None else [note for note in timestamps.notes if note not in notes]
        channels.update(made)
        silences.take(place, made)
        if choice.columns is None:
            taken = {timestamps.field if timestamps else None, *(f for _, f in selection.signals)}
            left_out += [f.column for f in selection.table.fields if f.kind == "text" and f not in taken]
        notes += [] if not left_out else [LEFT_OUT + ", ".join(left_out)]
        losses += [loss for each in gaps.values() for loss in each.losses()]
    if choice.columns is not None:  # in the caller's order, whatever the tables'
        channels = {name: channels[name] for name in choice.columns if name in channels}
    channels = _one_kind(channels, source.name)
    losses += silences.losses()
    return Trace(
        channels,
        source=source.name,
        notes=notes,
        losses=losses,
        origin=source.origin,
        possible_times=None if first_column is None else first_column.possible_times,
    )


def chunks_of(source: Source, choice: Choice) -> Iterator[Trace]:
    """Read a source in chunks: consecutive traces; the notes of each refer to all so far."""
    source = source.completed(choice.recorded)
    selections = _aligned(source, choice)
    timestamps = [timestamps_of(source, selection, choice) for selection in selections]
    gaps = [_gaps(source, selection, choice) for selection in selections]
    before = [0] * len(selections)
    silences = Silences()
    first_column = _first_column(selections)
    for chunk in _raw_chunks(source, selections):
        channels: dict[str, Channel] = {}
        if first_column is not None:
            first_column.take(chunk[0][0])
        for i, (selection, raws) in enumerate(zip(selections, chunk, strict=True)):
            if len(selections) > 1 and not len(raws[0]):
                continue  # nothing of this table
            made, _ = _channels(
                source,
                selection,
                timestamps[i],
                raws,
                choice,
                gaps[i],
                before[i],
                copy=not selection.table.fresh,
            )
            channels.update(made)
            silences.take(i, made)
            before[i] += len(raws[0]) if raws else 0
        notes = (
            *source.notes,
            *dict.fromkeys(note for column in timestamps if column for note in column.notes),
        )
        lost = (loss for each in gaps for gap in each.values() for loss in gap.losses())
        left_out = (loss for each in selections for loss in each.table.losses)
        losses = (*source.losses, *left_out, *lost, *silences.losses())
        yield Trace(
            _one_kind(channels, source.name),
            source=source.name,
            notes=notes,
            losses=losses,
            origin=source.origin,
            possible_times=None if first_column is None else first_column.possible_times,
        )


def _aligned(source: Source, choice: Choice) -> list[Selection]:
    """Return the selection of each table, all with the same clock; that of the only one may lack it."""
    selections = select(source, choice)
    if len(selections) == 1 and selections[0].signals and not selections[0].leading and choice.time is None:
        (only,) = selections
        selections = [dataclasses.replace(only, possible=possible_field(only.table.fields))]
    if source.align is not None:
        source.align(_places(source, selections))
    return selections


def has_one_clock(source: Source, choice: Choice, parts: Sequence[Choice]) -> bool:
    """Return whether tables have the same clock where they are read together as where parts of them are read alone."""
    if source.align is None:
        return True
    together = source.align(_places(source, select(source, choice)))
    alone = [_places(source, select(source, part)) for part in parts]
    return all(source.align(places) == together.intersection(places) for places in alone)


def with_clock_of(source: Source, read: Choice, every: Choice) -> Choice:
    """Return what ``every`` selects of the tables that do not change the clock of those of ``read``."""
    if source.align is None:
        return every
    own, selections = _places(source, select(source, read)), select(source, every)
    clock = source.align(own)
    kept = [
        selection
        for place, selection in zip(_places(source, selections), selections, strict=True)
        if source.align([*own, place]).intersection(own) == clock
    ]
    if len(kept) == len(selections):
        return every
    return dataclasses.replace(every, columns=tuple(name for each in kept for name, _ in each.signals))


def _first_column(selections: Sequence[Selection]) -> FirstColumn | None:
    possible = next((each.possible for each in selections if each.possible is not None), None)
    return None if possible is None else FirstColumn(possible)


def _places(source: Source, selections: Sequence[Selection]) -> list[int]:
    of_table = {id(table): place for place, table in enumerate(source.tables)}
    return [of_table[id(each.table)] for each in selections]


def _raw_chunks(source: Source, selections: Sequence[Selection]) -> Iterator[list[list[Raw]]]:
    if source.in_one_pass is not None:
        fields = [each.fields for each in selections]
        yield from source.in_one_pass(list(zip(_places(source, selections), fields, strict=True)))
        return
    (selection,) = selections
    assert selection.table.chunks is not None
    for raws in selection.table.chunks(selection.fields):
        yield [raws]


_LEAVE_OUT_UNIT = "leave out time_unit=, on the command line --time-unit"
_NO_UNIT = f"name their column, or {_LEAVE_OUT_UNIT}"


# ---- column selection ----------------------------------------------------------------------------


def select(source: Source, choice: Choice) -> list[Selection]:
    """Find the columns that the caller asks for, and the one of timestamps."""
    if choice.time:
        everything = [(table, field) for table in source.tables for field in table.fields]
        if not any(choice.time in (field.name, field.column) for _, field in everything):
            _Columns(source, everything).find(choice.time)  # raises
    of_table: dict[int, list[tuple[str, Field]]] = defaultdict(list)
    skipped = set(choice.skip_nan)
    for name, table, field in _wanted_signals(source, choice):
        of_table[id(table)].append(
            (name, dataclasses.replace(field, skip_nan=name in skipped, type=choice.types.get(name)))
        )
    found = []
    for table in source.tables:
        time_field, guessed = _time_field(source, table, choice)
        mine = of_table[id(table)]
        if choice.columns is None:
            mine = [(name, f) for name, f in mine if f != time_field or name in choice.names]
        if mine or len(source.tables) == 1:
            found.append(Selection(table, time_field, guessed, tuple(mine), choice.columns is not None))
    named = {name for each in found for name, _ in each.signals}
    if TIME in choice.units and TIME not in named and not any(each.time_field for each in found):
        raise TraceError(f"{source.name} has no timestamps: {_NO_UNIT}")
    return found


def _wanted_signals(source: Source, choice: Choice) -> list[tuple[str, Table, Field]]:
    everything = [(table, field) for table in source.tables for field in table.fields]
    columns = _Columns(source, everything)
    if choice.columns is None:
        for name, column in choice.names.items():
            columns.find(column, name)
        new = {column: name for name, column in choice.names.items()}
        result = [
            (new.get(field.column, new.get(field.name, field.name)), table, field)
            for table, field in everything
            if field.kind != "text" or field.column in new or field.name in choice.types
        ]
        _check_unique(source, result)
        _check_skipped(source, result, choice)
        return result
    found = []
    for name in dict.fromkeys(choice.columns):
        if name == TIME and name not in choice.names and _has_clock_called_otherwise(source, choice):
            continue
        found.append((name, *columns.find(choice.column_of(name, columns.__contains__), name)))
    _check_skipped(source, found, choice)
    return found


def _check_skipped(source: Source, found: Sequence[tuple[str, Table, Field]], choice: Choice) -> None:
    names = {name for name, _, _ in found}
    for name in choice.skip_nan:
        if name not in names:
            raise TraceError(
                f"NaN is to be skipped in '{name}', which is none of the signals that are read of {source.name}"
                f"{did_you_mean(name, names)}",
                variable=name,
            )


def _has_clock_called_otherwise(source: Source, choice: Choice) -> bool:
    """Return whether 'time' means the timestamps; the engine reads them under that name."""
    fields = [field for table in source.tables for field in table.fields]
    if any(TIME in (field.column, field.name) for field in fields):
        return any(_time_field(source, table, choice)[0] is not None for table in source.tables)
    for table in source.tables:
        time_field, _ = _time_field(source, table, choice)
        if time_field is not None:
            raise TraceError(
                f"the formula reads '{TIME}', but the timestamps of {source.name} are its column "
                f"'{time_field.column}'; name that column '{TIME}', or the variable something else",
                variable=TIME,
            )
    return False


class _Columns:
    """Columns by their names in the source, else by their names in formulas."""

    def __init__(self, source: Source, everything: Sequence[tuple[Table, Field]]) -> None:
        self._source = source
        self._by_column: dict[str, list[tuple[Table, Field]]] = defaultdict(list)
        self._by_name: dict[str, list[tuple[Table, Field]]] = defaultdict(list)
        for table, field in everything:
            self._by_column[field.column].append((table, field))
            self._by_name[field.name].append((table, field))
            if field.alias:
                self._by_name[field.alias].append((table, field))

    def __contains__(self, column: str) -> bool:
        return column in self._by_column or column in self._by_name

    def find(self, column: str, name: str = "") -> tuple[Table, Field]:
        """Return the column of a name; raise :class:`TraceError` if there is none, or several.

        ``name``: of the signal that is read of it.
        """
        found = self._by_column.get(column) or self._by_name.get(column) or []
        if len(found) == 1:
            return found[0]
        if found:
            raise TraceError(
                f"{self._source.name} has {len(found)} columns called '{column}'; rename all but one of them",
                variable=column,
            )
        names = [field.name for same in self._by_column.values() for _, field in same]
        of = f", the recorded name of '{name}'" if name and name != column else ""
        raise TraceError(
            f"{self._source.name} has no column '{column}'{of}{choices(column, names, 'columns')}",
            variable=name or column,
        )


def _check_unique(source: Source, found: Sequence[tuple[str, Table, Field]]) -> None:
    seen: set[str] = set()
    for name, _, field in found:
        if name in seen:
            same = [f.column for n, _, f in found if n == name]
            if len(set(same)) > 1:
                listing = ", ".join(f"'{column}'" for column in same)
                raise TraceError(
                    f"{source.name} has several columns for '{name}': {listing}; say which are meant "
                    f"with columns= or names="
                )
            raise TraceError(
                f"{source.name} has {len(same)} columns called '{field.column}'; rename all but one"
            )
        seen.add(name)


def _time_field(source: Source, table: Table, choice: Choice) -> tuple[Field | None, bool]:
    """Return the field of timestamps, and whether it was guessed."""
    if choice.time == "":
        return None, False
    if choice.time is not None:
        if table.time_field is not None and all(choice.time not in (f.name, f.column) for f in table.fields):
            return table.time_field, False
        return _Columns(source, [(table, field) for field in table.fields]).find(choice.time)[1], False
    if table.time_field is not None:
        return table.time_field, False
    wanted = {choice.names.get(name, name) for name in choice.columns or ()}
    return guess_field(table.fields, source.name, wanted.union(choice.names.values())), True


# ---- values --------------------------------------------------------------------------------------


def timestamps_of(source: Source, selection: Selection, choice: Choice) -> TimestampColumn | None:
    """Return the conversion of a table's timestamps to times; None if it has none."""
    if selection.time_field is None:
        return None
    unit = choice.units.get(selection.time_field.column, choice.units.get(TIME))
    table = selection.table
    if unit is not None and table.has_unit and selection.time_field == table.time_field:
        raise TraceError(
            f"the timestamps of {source.name} have a unit, {table.time_field.unit}: {_LEAVE_OUT_UNIT}",
            variable=TIME,
        )
    guessed = selection.guessed and selection.time_field.column.lower() != TIME
    return TimestampColumn(selection.time_field, unit, guessed, source.name)


def _gaps(source: Source, selection: Selection, choice: Choice) -> dict[str, Gaps]:
    return {name: Gaps(name, source.name, choice.hold_for) for name, _ in selection.signals}


def _channels(
    source: Source,
    selection: Selection,
    timestamps: TimestampColumn | None,
    raws: Sequence[Raw],
    choice: Choice,
    gaps: Mapping[str, Gaps],
    before: int = 0,
    *,
    copy: bool = True,
) -> tuple[dict[str, Channel], list[str]]:
    """Return the signals of a table, and the columns that were left out."""
    times = None
    if timestamps is not None:
        times = timestamps.times(raws[0], before, copy=copy)
    values = raws[len(selection.leading) :]
    made, left_out = {}, []
    for (name, field), raw in zip(selection.signals, values, strict=True):
        try:
            numbers, missing = numbers_of(raw, field, source.name, before, copy=copy)
        except TraceError:
            if selection.named or name in choice.names:
                raise
            left_out.append(field.column)
            continue
        inexact = rounded(raw)
        if inexact is not None:
            gaps[name].round(inexact, times, before)
        mine, first_gap, table = times, None, None
        if field.skip_nan and np.isnan(numbers).any():
            nan = np.isnan(numbers)
            gaps[name].skip(nan, times, before)
            missing = nan if missing is None else missing | nan
        if choice.hold_for is not None:
            absent = np.zeros(len(numbers), dtype=bool) if missing is None else missing
            numbers, missing = gaps[name].hold(numbers, absent, times, before)
        if missing is not None and missing.any():
            row = before + int(missing.argmax())
            if not choice.gaps:
                raise missing_sample(name, row, source.name, FILE_MENDS)
            if times is None:
                raise TraceError(
                    f"'{name}' is missing at sample {row} of {source.name}: fill the gap, or name the "
                    f"column of timestamps, so that each signal has its own time base",
                    variable=name,
                    index=row,
                )
            numbers, mine = numbers[~missing], times[~missing]
            first_gap, table = row, times
        unit = choice.units.get(name, choice.units.get(field.column, field.unit))
        alias = field.alias if name == field.name else ""
        stepped = field.type is not None
        made[name] = Channel(mine, numbers, unit, field.column, first_gap, table, alias, stepped)
    if times is not None and TIME in (choice.columns or ()) and TIME not in choice.names:
        # The formula reads the time; in discrete time the engine gives it.
        made[TIME] = Channel(times, in_seconds(times), "s", TIME)
    return made, left_out


def _one_kind(channels: dict[str, Channel], source: str) -> dict[str, Channel]:
    """Return channels whose times all have one type: nanoseconds where one of them needs them."""
    kinds = {c.times.dtype.kind for c in channels.values() if c.times is not None}
    if len(kinds) < 2:
        return channels
    if "M" in kinds:
        raise TraceError(
            f"some signals of {source} have dates for times and others numbers: use one of them for all"
        )
    from rtamt.signals.ticks import TimeScale

    def exact(times: Any, name: str) -> Any:
        if times is None or times.dtype.kind != "f":
            return times
        return TimeScale(NANOSECOND, "seconds").ticks(times, name).view("m8[ns]")

    return {
        name: dataclasses.replace(c, times=exact(c.times, name), table=exact(c.table, name))
        for name, c in channels.items()
    }
