"""Errors for data without what the formula needs: numbers, variables, columns."""

from __future__ import annotations

from contextlib import contextmanager
from os import PathLike, fspath

from rtamt.errors import TraceError, UsageError, choices, shown, with_article
from rtamt.language.units.moments import time_text
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME, WithTimeBases
from rtamt.signals.time_columns import is_labelled

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from rtamt.language.quantifiers import Group

#: How to mend a NaN in the data.
NAN_MEND = "fill the gap or leave the sample out"


def nan_error(name: str, index: int, time: float, *, dated: bool = False) -> TraceError:
    """Return the error for a NaN in the data; ``dated``: whether the caller's times are dates."""
    return TraceError(
        f"'{name}' is NaN at sample {index}, time {time_text(time, dated=dated)}: {NAN_MEND}",
        variable=name,
        index=index,
        time=time,
    )


@contextmanager
def nan_of_members(groups: Mapping[str, tuple[Group, tuple[str, ...]]]) -> Iterator[None]:
    """Add to the error for a NaN in a field of a group how to make the member absent there."""
    try:
        yield
    except TraceError as error:
        text, name = str(error), error.variable or ""
        if not text.endswith(NAN_MEND) or all(group.member(name) is None for group, _ in groups.values()):
            raise
        raise TraceError(
            f"{text}; where the member is absent, give None, a nullable dtype such as pandas' Float64, or "
            f"rtamt.read(data, skip_nan=['{name}'])",
            variable=name,
            index=error.index,
            time=error.time,
        ) from None


def unknown_variable(name: str, names: Collection[str]) -> TraceError:
    """Return the error for a variable that the formula does not read."""
    return TraceError(
        f"the formula has no variable '{name}'{choices(name, names, 'variables')}", variable=name
    )


#: How to mend a missing sample: in a stream on the command line, in a file there, and in a trace in Python.
STREAM_MENDS = "fill the gap, or use dense time (--time dense)"
FILE_MENDS = (
    "fill the gap, hold the value before it (--hold-for DURATION), use dense time (--time dense), or put "
    "all on one time base (--resample PERIOD)"
)
TRACE_MENDS = (
    "fill the gap, hold the value before it (trace.hold(), or hold_for= of rtamt.read), use dense time (time='dense'), "
    "put all on one time base (trace.resample(period=...)), or read the bounds of the robustness "
    "(spec.evaluate(trace).interval)"
)


def missing_sample(name: str, index: int, source: str | None, mends: str) -> TraceError:
    """Return the error for a variable without a value at a sample of discrete time: every reader raises this one.

    ``source``: where the samples are from; None for a stream.
    """
    where = f"sample {index}" if source is None else f"sample {index} of {source}"
    return TraceError(
        f"'{name}' is missing at {where}, but discrete time needs a value at every sample: {mends}",
        variable=name,
        index=index,
    )


def missing_outside(name: str, index: int) -> TraceError:
    """Return the error for a field of a member that is missing at a sample, and that a formula reads as a variable."""
    return TraceError(
        f"'{name}' is missing at sample {index}, and the formula reads it outside of its quantifiers, where it needs a "
        f"value: fill the gap, or read it of the members alone",
        variable=name,
        index=index,
    )


def missing_field(member: str, field: str, index: int | None = None) -> TraceError:
    """Return the error for a field that a member of a stream lacks at a sample; without ``index``, at all of them."""
    where = "at any sample" if index is None else f"at sample {index}"
    return TraceError(
        f"'{member}' has no '{field}' {where}; give '{member}.{field}', or leave out all fields of a member that "
        f"is absent",
        variable=f"{member}.{field}",
        index=index,
    )


def missing_variable(name: str, keys: Collection[str]) -> TraceError:
    """Return the error for a variable that the formula reads and the data lacks."""
    return TraceError(f"the data has no '{name}'{choices(name, keys, 'signals')}", variable=name)


def possible_times(column: str) -> TraceError:
    """Return the error for a first column that may hold the timestamps, where nothing gives the times of samples."""
    from shlex import quote

    from rtamt.signals.time_columns import counts_time

    why = ", and its name has a unit of time" if counts_time(column) else ", but not by 1 from row to row"
    called = f" '{column}'" if column else ", which has no name,"
    choice = f"choose it with time={column!r}, on the command line --time-column {quote(column)}"
    return TraceError(
        f"the first column{called} may hold the timestamps: its values increase{why}; "
        f"{choice if column else 'give it a name and choose it with time=, on the command line --time-column'}, "
        f"or give the period of the samples, such as period='1s', on the command line --period 1s",
        variable=TIME,
    )


def not_a_mapping(data: Any, to: str) -> TraceError:
    """Return the error for data that is not a mapping from variables to ``to``; a file must be read first."""
    if isinstance(data, str | PathLike):
        path = shown(fspath(data))
        return TraceError(f"expected data, got {path}; to read a file write rtamt.read({path})")
    if type(data).__name__ == "LazyFrame":
        return TraceError("expected data, got a LazyFrame; write frame.collect()")
    if hasattr(data, "column_names"):
        return TraceError(f"expected data, got an Arrow {type(data).__name__}; write rtamt.read(table)")
    if is_labelled(data):
        return TraceError(f"expected data, got an xarray {type(data).__name__}; write rtamt.read(data)")
    if getattr(getattr(data, "dtype", None), "names", None):
        return TraceError("expected data, got a structured NumPy array; write rtamt.read(array)")
    return TraceError(f"expected a mapping from variable to {to}, got {type(data).__name__}")


def refuse_one_recording(data: Any, name: str, instead: str) -> None:
    """Raise :class:`UsageError` for one recording in place of several: it would be taken apart by its columns.

    ``name``: of the argument; ``instead``: what else can be given, as the end of a sentence.
    """
    columns = hasattr(data, "keys") or hasattr(data, "columns")
    if columns or isinstance(data, str | PathLike | WithTimeBases):
        raise UsageError(f"{name} is {with_article(type(data).__name__)}; give a list of recordings{instead}")


def refuse_unknown(keys: Sequence[str], names: Sequence[str], declared: Collection[str]) -> None:
    """Raise :class:`TraceError` at a key that is neither a variable of the formula, nor declared, nor the time.

    For data that need not hold every variable, where such a key may be a misspelt one; where all variables are
    there, others do no harm.
    """
    if all(name in keys or name.split(".")[0] in keys for name in names):
        return
    for key in keys:
        if key in names or key == TIME or key in declared:
            continue
        if key not in {name.split(".")[0] for name in names}:
            raise unknown_variable(str(key), names)
