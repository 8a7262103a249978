"""Assembly of a trace from a source: the selected columns with their timestamps, whole or in chunks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.language.units.durations import NANOSECOND
from rtamt.lazy import dataclasses
from rtamt.lazy.modules import np
from rtamt.readers.first_column import FirstColumn, possible_field
from rtamt.readers.gaps import Gaps
from rtamt.readers.numbers import numbers_of, rounded
from rtamt.readers.selection import LEAVE_OUT_UNIT, places_of, select
from rtamt.readers.silence import Silences
from rtamt.readers.timestamps import TimestampColumn
from rtamt.signals.arrays import TIME
from rtamt.signals.data_errors import FILE_MENDS, missing_sample
from rtamt.signals.trace import LEFT_OUT, Channel, Trace, in_seconds

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from rtamt.readers.selection import Choice, Selection
    from rtamt.readers.source import Raw, Source


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
        losses += selection.losses
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
        left_out = (loss for each in selections for loss in each.losses)
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
        places = places_of(source, selections)
        retimed = source.align(places)
        selections = [
            dataclasses.replace(each, retimed=place in retimed)
            for each, place in zip(selections, places, strict=True)
        ]
    return selections


def _first_column(selections: Sequence[Selection]) -> FirstColumn | None:
    possible = next((each.possible for each in selections if each.possible is not None), None)
    return None if possible is None else FirstColumn(possible)


def _raw_chunks(source: Source, selections: Sequence[Selection]) -> Iterator[list[list[Raw]]]:
    if source.in_one_pass is not None:
        fields = [each.fields for each in selections]
        yield from source.in_one_pass(list(zip(places_of(source, selections), fields, strict=True)))
        return
    (selection,) = selections
    assert selection.table.chunks is not None
    for raws in selection.table.chunks(selection.fields):
        yield [raws]


# ---- values --------------------------------------------------------------------------------------


def timestamps_of(source: Source, selection: Selection, choice: Choice) -> TimestampColumn | None:
    """Return the conversion of a table's timestamps to times; None if it has none."""
    if selection.time_field is None:
        return None
    unit = choice.units.get(selection.time_field.column, choice.units.get(TIME))
    table = selection.table
    if unit is not None and table.has_unit and selection.time_field == table.time_field:
        raise TraceError(
            f"the timestamps of {source.name} have a unit, {table.time_field.unit}: {LEAVE_OUT_UNIT}",
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
        made[name] = Channel(
            mine, numbers, unit, field.column, first_gap, table, alias, stepped, selection.retimed
        )
    if times is not None and TIME in (choice.columns or ()) and TIME not in choice.names:
        # The formula reads the time; in discrete time the engine gives it.
        made[TIME] = Channel(times, in_seconds(times), "s", TIME, retimed=selection.retimed)
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
