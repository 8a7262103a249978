"""Options of commands that read recordings, and the recording of a requirement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.cli.command import (
    NO_STAMPS,
    READING,
    CommandError,
    add_specification_options,
    add_stamp_options,
    add_time_option,
    assumes_period,
    options,
)
from rtamt.errors import TraceError, UsageError, choices
from rtamt.language.units.durations import duration, positive_period
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.modules import np
from rtamt.readers.assemble import trace_of
from rtamt.readers.dates import EXAMPLE, date_in
from rtamt.readers.formats import is_bag
from rtamt.readers.read import choice, opened
from rtamt.readers.selection import has_one_clock, select, with_clock_of
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.epoch import is_epoch

if TYPE_CHECKING:
    import argparse
    from collections.abc import Collection, Sequence
    from fractions import Fraction

    from rtamt.readers.selection import Choice
    from rtamt.readers.source import Source
    from rtamt.results import Result
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class Reading:
    """Options for reading recordings: those of ``rtamt.read``, and a common time base."""

    time: str | None = None
    unit: str | None = None
    sheet: str | None = None
    query: str | None = None
    skip_nan: Sequence[str] = ()
    hold_for: str | None = None
    resample: str | None = None
    how: str = "hold"
    recover: bool = False
    #: Never in chunks: the whole signal is needed.
    whole: bool = False
    #: No further than the verdicts need.
    early: bool = False
    #: Violations are explained, which needs the whole recording, if it is not too large.
    explained: bool = False


# ---- the options ---------------------------------------------------------------------------------


def add_input_options(parser: argparse.ArgumentParser, traces: str) -> None:
    """Add SPEC, TRACE (``traces``: its help), the time domain, and how recordings are read."""
    add_specification_options(parser)
    parser.add_argument("traces", metavar="TRACE", nargs="*", help=traces)
    add_time_option(parser)
    add_reading_options(parser)


def add_reading_options(parser: argparse.ArgumentParser) -> None:
    """Add how recordings are read; see :func:`rtamt.read`."""
    add_stamp_options(parser, "column")
    group = options(parser, READING)
    group.add_argument(
        "--name",
        metavar="NAME=COLUMN",
        action="append",
        default=[],
        help="the column of a variable if it has another name; replaces the recorded name in SPEC; repeatable",
    )
    group.add_argument("--sheet", metavar="NAME", help="the sheet of an Excel workbook with several sheets")
    group.add_argument("--sql", metavar="URL", help="read a database, such as sqlite:///log.db")
    group.add_argument("--query", metavar="TEXT", help="the query for --sql; each row is a sample")
    group.add_argument(
        "--skip-nan",
        metavar="NAME",
        action="append",
        default=[],
        help="leave out NaN samples of a variable instead of reporting an error; repeatable",
    )
    group.add_argument(
        "--hold-for",
        metavar="DURATION",
        help="the longest time for which a value replaces missing samples; longer gaps are errors",
    )
    group.add_argument(
        "--resample", metavar="DURATION", help="resample all signals to one time base with this period"
    )
    group.add_argument(
        "--how",
        metavar="{hold,linear}",
        help="on a new time base, between two samples, hold the last value or interpolate (default: hold)",
    )
    group.add_argument(
        "--recover",
        action="store_true",
        help="read a truncated or damaged MCAP file up to the damage instead of reporting an error",
    )


def add_instant_option(parser: argparse.ArgumentParser) -> None:
    """Add the instant whose verdict is explained; see :func:`instant`."""
    parser.add_argument(
        "--at",
        metavar="TIME",
        help="the instant to explain (default: the first): seconds, a time with a unit such as 500ms, or a date "
        "if the recording has dates",
    )


def reading_of(
    args: argparse.Namespace,
    read: Collection[str],
    *,
    whole: bool,
    early: bool = False,
    explained: bool = False,
) -> Reading:
    """Return the reading that the options select.

    ``read``: the variables of the requirements; ``whole``: never in chunks; ``early``: no further than needed;
    ``explained``: with what explains violations.
    """
    names = names_of(args.name)
    for name in names:
        if name not in read:
            raise CommandError(f"--name {name}={names[name]}: no formula reads '{name}'")
    for name in args.skip_nan:
        if name not in read:
            raise CommandError(f"--skip-nan {name}: no formula reads '{name}'")
    return Reading(
        args.time_column,
        args.time_unit,
        args.sheet,
        args.query,
        tuple(args.skip_nan),
        args.hold_for,
        args.resample,
        how_of(args),
        args.recover,
        whole=whole,
        early=early,
        explained=explained,
    )


def how_of(args: argparse.Namespace) -> str:
    """Return how values between two samples are found."""
    if args.how is None:
        return "hold"
    from rtamt.signals.resampling import HOW

    if args.how not in HOW:
        raise CommandError(f"cannot resample by '{args.how}'{choices(args.how, HOW, 'methods')}")
    return str(args.how)


def require_time_base(
    args: argparse.Namespace, specs: Sequence[Specification], traces: Sequence[str]
) -> None:
    """Raise for ``--how`` where the samples are those of the recordings."""
    how_of(args)
    if args.how is None or args.resample is not None:
        return
    if any(is_resampled(spec, trace, Reading()) for spec in specs for trace in traces):
        return
    raise CommandError("--how is for samples on a new time base: give its period, such as --resample 100ms")


def names_of(texts: Sequence[str]) -> dict[str, str]:
    """Return variables and their columns from texts such as ``v=battery_status[1].voltage_v``."""
    names = {}
    for text in texts:
        name, equals, column = text.partition("=")
        if not (name.strip() and equals and column.strip()):
            raise CommandError(f"--name is '{text}'; give a variable and its column, such as v=voltage")
        names[name.strip()] = column.strip()
    return names


def recording(args: argparse.Namespace, source: str, spec: Specification | None = None) -> Trace:
    """Return all that is in a recording, read and resampled as the options select.

    ``spec``: one over members of groups, which declares the types of signals.
    """
    require_time_base(args, (), ())
    with opened(source, args.sheet, args.query, args.recover) as found:
        types = NO_TYPES
        if spec is not None:
            from rtamt.readers.member_columns import members_in

            types = spec.over(members_in(found, spec)).types
        names = names_of(args.name)
        wanted = choice(
            args.time_column, None, names, None, args.skip_nan, args.hold_for, args.time_unit, types
        )
        trace = trace_of(found, wanted)
    return trace if args.resample is None else trace.resample(args.resample, how_of(args))


# ---- for requirements ----------------------------------------------------------------------------


def read_for(specs: Sequence[Specification], trace: str, reading: Reading) -> Trace:
    """Read the variables of some requirements from a recording.

    Raises :class:`TraceError` also where one of the requirements reads the recording differently if it is alone.
    """
    with opened(trace, reading.sheet, reading.query, reading.recover) as source:
        if not is_read_alike(source, specs, trace, reading):
            raise TraceError("the specifications read topics with different clocks")
        return trace_of(source, choice_for(specs, trace, reading))


def completed_for(source: Source, specs: Sequence[Specification]) -> Source:
    """Return a source with all columns that requirements may read, also those that only later rows have."""
    if source.complete is None:
        return source
    from rtamt.ros.bags import columns_of

    names: list[str] = []
    for spec in specs:
        names += (*spec.binding.recorded, *columns_of(spec).values())
        names += (group.beginning for group, _ in spec.groups.values())
    return source.completed(names)


def is_read_alike(source: Source, specs: Sequence[Specification], trace: str, reading: Reading) -> bool:
    """Return whether samples have the same times where requirements are read together as where each is read alone."""
    if len(specs) == 1 or source.align is None:
        return True
    together, *alone = (choice_for(some, trace, reading) for some in (specs, *([spec] for spec in specs)))
    return has_one_clock(source.completed(together.recorded), together, alone)


def whole_recording(specs: Sequence[Specification], trace: str, reading: Reading) -> Trace | None:
    """Read all signals of a recording without NaN, under the requirements' names; None if these read all of them.

    Topics that would change the clock of the requirements are left out.
    """
    read = {name for spec in specs for name in spec.input_names}
    mine = choice_for(specs, trace, reading)
    every = replace(mine, columns=None, gaps=True, hold_for=None, skip_nan=())
    with opened(trace, reading.sheet, reading.query, reading.recover) as opening:
        source = opening.completed(None)
        every = with_clock_of(source, mine, every)
        names = tuple(name for table in select(source, every) for name, _ in table.signals)
        return None if read.issuperset(names) else trace_of(source, replace(every, skip_nan=names))


def choice_for(specs: Sequence[Specification], trace: str, reading: Reading) -> Choice:
    """Return which columns of a recording some requirements read, and how."""
    columns = dict.fromkeys(name for spec in specs for name in spec.input_names)
    _check_places(specs)
    # In discrete time a gap is an error, unless each signal has its own time base, or is resampled.
    gaps = has_own_time_bases(specs[0], trace, reading)
    names: dict[str, str] = {}
    if is_bag(trace):
        from rtamt.ros.bags import columns_of

        for spec in specs:
            names.update(columns_of(spec))
    others: dict[str, tuple[str, ...]] = {}
    for spec in specs:
        names.update(spec.recorded)
        others.update(spec.binding.others)
    # A value that is held in new samples is too old in these, wherever it is missing.
    held, skips_nan = _sampling_of(specs[0])
    anew = reading.how == "hold" and (held or reading.resample is not None)
    hold_for = None if anew else reading.hold_for
    skipped = [name for name in columns if name in reading.skip_nan or skips_nan]
    types = {name: type_ for spec in specs for name, type_ in spec.types.items()}
    return replace(
        choice(reading.time, columns or None, names, None, skipped, hold_for, reading.unit, types),
        gaps=gaps,
        others=others,
    )


def _check_places(specs: Sequence[Specification]) -> None:
    """Raise where specifications read a recording differently: each then reads it alone."""
    if len(set(map(_sampling_of, specs))) > 1:
        raise TraceError("the specifications sample the recording differently")
    places: dict[str, str] = {}
    for spec in specs:
        for name, (column, _) in spec.binding.places().items():
            if places.setdefault(name, column) != column:
                raise TraceError(f"'{name}' is recorded as '{places[name]}' and as '{column}'", variable=name)


def _sampling_of(spec: Specification) -> tuple[bool, bool]:
    """Return whether a sampling rule holds values, and whether it leaves out NaN."""
    rule = spec.domain.sampling(spec.sampling)
    return rule is not None and rule.hold, rule is not None and rule.skip_nan


def has_own_time_bases(spec: Specification, trace: str, reading: Reading) -> bool:
    """Return whether each signal has its own time base, so that signals may begin at different times."""
    return spec.domain.own_time_bases or is_bag(trace) or is_resampled(spec, trace, reading)


def is_resampled(spec: Specification, trace: str, reading: Reading) -> bool:
    """Return whether each requirement is resampled separately, from the start of all its variables."""
    held, _ = _sampling_of(spec)
    return reading.resample is not None or held or (spec.domain.sampled and is_bag(trace))


def oldest_held(spec: Specification, reading: Reading) -> Fraction | None:
    """Return the maximum age of a held value in the samples of a requirement; None: no limit."""
    if reading.how != "hold":
        return None
    if reading.resample is not None:
        what = "longest time for which a value is held"
        return None if reading.hold_for is None else positive_period(reading.hold_for, what)
    return None if spec.sampling is None else spec.sampling.limit


def on_time_base(data: Trace, spec: Specification, trace: str, reading: Reading) -> Trace:
    """Return the variables of a requirement in a recording, on the time base that the options select.

    Which other requirements were read with it makes no difference. Discrete time samples a bag as a node
    samples topics, the latest message every period; without a period only where the messages are samples.
    """
    bag = spec.domain.sampled and is_bag(trace)
    rule = None if reading.resample is not None else spec.domain.sampling(spec.sampling)
    held = rule is not None and rule.hold
    period = spec.period if (bag or held) and reading.resample is None else reading.resample
    if period is None and not bag:
        return data
    mine = data.select(set(spec.input_names) & set(data.names)) if spec.input_names else data
    if period is not None:
        return mine.resample(period, reading.how, oldest_held(spec, reading))
    from rtamt.signals.sampling import sampled_messages

    return sampled_messages(mine, None)


def with_stamps(data: Trace, spec: Specification) -> Trace:
    """Return a recording, or a chunk of it; raise :class:`TraceError` where it lacks the timestamps of dense time."""
    if not spec.domain.own_time_bases or not spec.input_names:  # without variables, that is the error
        return data
    if any(data.channel(name).times is None for name in data):
        raise TraceError(NO_STAMPS)
    return data


def notes_on(data: Trace, spec: Specification, reading: Reading) -> tuple[str, ...]:
    """Return the notes of a verdict on a recording: on the data, and on a period that nothing determines."""
    if any(data.channel(name).times is not None for name in data) or not assumes_period(spec, reading.time):
        return data.remarks
    return (*data.remarks, "no column holds timestamps: the samples are taken to be 1 s apart")


def how_to_mend(error: Exception, data: Trace | None, before: int = 0) -> str:
    """Return a suffix for an error about a NaN in a recording: the option that leaves it out, or nothing.

    ``before``: the number of samples that were read before ``data``.
    """
    if data is None or not isinstance(error, TraceError) or error.variable not in data.names:
        return ""
    values = data[error.variable].values
    index = -1 if error.index is None else error.index - before
    is_nan = 0 <= index < len(values) and np.isnan(values[index])
    return skipping(error.variable) if is_nan else ""


def skipping(name: str) -> str:
    """Return the suffix of an error about a NaN of this variable."""
    from shlex import quote  # errors need it

    return f" (--skip-nan {quote(name)})"


# ---- an instant ----------------------------------------------------------------------------------


def instant(at: str | None, result: Result, option: str = "--at") -> Any:
    """Return the time of ``--at`` or another option in the format of the recording; None where it is left out."""
    if at is None:
        return None
    times = result.signal.times.dtype.kind
    dated = times == "M"
    date = date_in(at)
    if date is not None and not dated and len(result.signal) and _counts_from_1970(result.signal.times[0]):
        # Such times are printed as dates.
        since = date - np.datetime64(0, "ns")
        return since if times == "m" else (nanoseconds_of(since) or 0) / 10**9
    if (date is not None) != dated:
        has = f"dates: give one such as {EXAMPLE}" if dated else "seconds: give a number of them"
        raise UsageError(f"{option} is '{at}', but the recording has times in {has}")
    if date is not None:
        return date
    sign, text = (-1, at.strip()[1:]) if at.strip().startswith("-") else (1, at)
    try:
        seconds = sign * duration(text)
    except UsageError:
        raise UsageError(
            f"{option} is '{at}'; give seconds, a time with a unit such as 500ms, or a date such as {EXAMPLE}"
        ) from None
    return np.timedelta64(round(seconds * 10**9), "ns") if times == "m" else float(seconds)


def _counts_from_1970(time: Any) -> bool:
    nanoseconds = nanoseconds_of(time) if isinstance(time, np.timedelta64) else None
    return is_epoch(float(time) if nanoseconds is None else nanoseconds / 10**9)
