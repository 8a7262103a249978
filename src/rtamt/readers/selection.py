"""The selection of a recording: which columns are read, under which names, and which are the timestamps."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from rtamt.errors import TraceError, choices, did_you_mean
from rtamt.lazy import dataclasses
from rtamt.readers.timestamps import guess_field
from rtamt.signals.arrays import TIME

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    from rtamt.readers.source import Field, Source, Table
    from rtamt.signals.coding import Types

#: What an error about a unit of timestamps recommends.
LEAVE_OUT_UNIT = "leave out time_unit=, on the command line --time-unit"
_NO_UNIT = f"name their column, or {LEAVE_OUT_UNIT}"


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
    #: Whether the timestamps are replaced by those of the recording, since other tables have another clock.
    retimed: bool = False

    @property
    def fields(self) -> tuple[Field, ...]:
        """The columns to read from the table: the timestamps first."""
        return self.leading + tuple(field for _, field in self.signals)

    @property
    def losses(self) -> tuple[str, ...]:
        """What the table and its timestamps lost, once they have been read."""
        losses, of_times = tuple(self.table.losses), self.table.losses_of_times
        if of_times is None or self.time_field is None:
            return losses
        return (*losses, *of_times(self.time_field))

    @property
    def leading(self) -> tuple[Field, ...]:
        """The column of timestamps, or that which may hold them, if there is one."""
        first = self.time_field or self.possible
        return () if first is None else (first,)


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


# ---- tables with several clocks ------------------------------------------------------------------


def places_of(source: Source, selections: Sequence[Selection]) -> list[int]:
    """Return the places of tables in a source."""
    of_table = {id(table): place for place, table in enumerate(source.tables)}
    return [of_table[id(each.table)] for each in selections]


def has_one_clock(source: Source, choice: Choice, parts: Sequence[Choice]) -> bool:
    """Return whether tables have the same clock where they are read together as where parts of them are read alone."""
    if source.align is None:
        return True
    together = source.align(places_of(source, select(source, choice)))
    alone = [places_of(source, select(source, part)) for part in parts]
    return all(source.align(places) == together.intersection(places) for places in alone)


def with_clock_of(source: Source, read: Choice, every: Choice) -> Choice:
    """Return what ``every`` selects of the tables that do not change the clock of those of ``read``."""
    if source.align is None:
        return every
    own, selections = places_of(source, select(source, read)), select(source, every)
    clock = source.align(own)
    kept = [
        selection
        for place, selection in zip(places_of(source, selections), selections, strict=True)
        if source.align([*own, place]).intersection(own) == clock
    ]
    if len(kept) == len(selections):
        return every
    return dataclasses.replace(every, columns=tuple(name for each in kept for name, _ in each.signals))
