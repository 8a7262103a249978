"""``rtamt.read`` and ``rtamt.scan``: one interface for recordings in every format."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError
from rtamt.files import is_device, is_pipe
from rtamt.language.units.durations import check_unit, positive_period
from rtamt.readers import frames
from rtamt.readers.assemble import chunks_of, trace_of
from rtamt.readers.formats import FORMATS, format_of
from rtamt.readers.selection import Choice
from rtamt.readers.sql import is_url, open_sql
from rtamt.signals.arrays import TIME
from rtamt.signals.coding import NO_TYPES

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from rtamt.language.units.durations import Duration
    from rtamt.readers.source import Source
    from rtamt.signals.coding import Types
    from rtamt.signals.trace import Trace


def read(
    source: Any,
    *,
    time: str | None = None,
    time_unit: str | None = None,
    columns: Iterable[str] | None = None,
    names: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    sheet: str | None = None,
    query: str | None = None,
    skip_nan: Iterable[str] = (),
    types: Types = NO_TYPES,
    hold_for: Duration | None = None,
    recover: bool = False,
) -> Trace:
    r"""Read a recording as a trace, for ``Specification.evaluate`` and ``update_many``.

    ``source``: a file, whose extension selects the format (CSV, Parquet, Arrow, Excel, PX4 ULog, MDF, ROS bag); the
    address of a database (``sqlite:///log.db``, ``postgresql://user@host/name``), with a ``query`` whose
    rows are samples; a dict, a pandas, polars, xarray or arrow object, or a structured numpy array.
    ``columns``: the signals to read (default: all numeric ones). ``names``: other names for columns, as a mapping from
    the name to the column: ``{"v": "battery_status[1].voltage_v"}``. ``time``: the column of timestamps, ``""`` for
    none; by default the column called time, t, timestamp, stamp or datetime, with an optional unit (``Time [ms]``,
    ``time_ms``), else the only column of dates. ``time_unit``: the unit of numeric timestamps (``"s"``, ``"ms"``,
    ``"us"``, ``"ns"``); by default the unit of their column, else seconds; numbers that are too large
    for seconds are an error. ``units``: from column to unit, if the source does not contain it.
    ``sheet``: the sheet of an Excel workbook with several sheets. ``recover``: read a truncated or damaged MCAP file
    up to the damage instead of raising an error; flight logs are always read that far.

    A missing value (an empty cell, null, pandas' NaN) is not a sample: the signal then has
    its own time base, and in discrete time ``evaluate`` bounds the robustness.
    Any other NaN is kept, and an evaluation that reads it raises an error; for the signals
    in ``skip_nan`` it counts as missing, too. ``types``: the types of a specification (``spec.types``); text
    columns, and the value tables of MDF and ROS, are then read as the codes of its enumerations. ``hold_for``: how
    long, in seconds or as text such as ``"500ms"``, the previous value may replace missing samples; a longer gap is
    an error.

    ``Trace.notes`` lists what was inferred or left out, and is printed with the trace; ``Trace.losses`` lists
    missing data.

    Raises :class:`TraceError` if the data is invalid or columns are ambiguous, and
    :class:`UsageError` if a library is missing: ``pip install 'rtamt[data]'``.

    >>> import pathlib, tempfile
    >>> import rtamt
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "log.csv")
    ...     _ = path.write_text("t [ms],speed [m/s],note\n0,5,go\n100,4,stop\n")
    ...     trace = rtamt.read(path)
    >>> trace["speed"]
    Signal(times=array([0. , 0.1]), values=array([5., 4.]))
    >>> trace.channel("speed").unit, trace.notes
    ('m/s', ("time is 't [ms]', by its name", 'left out, not numbers: note'))
    >>> import numpy as np
    >>> rtamt.read({"time": [0, 1, 2], "v": np.array([5, np.nan, 4])}, skip_nan=["v"])
    Trace of a dict: 1 signal, 0 s to 2 s
      left out, NaN: 1 sample of v, the first at 1 s
      v  2 samples, 0 s to 2 s
    """
    with opened(source, sheet, query, recover) as found:
        return trace_of(found, choice(time, columns, names, units, skip_nan, hold_for, time_unit, types))


def scan(
    source: Any,
    *,
    time: str | None = None,
    time_unit: str | None = None,
    columns: Iterable[str] | None = None,
    names: Mapping[str, str] | None = None,
    units: Mapping[str, str] | None = None,
    sheet: str | None = None,
    query: str | None = None,
    skip_nan: Iterable[str] = (),
    types: Types = NO_TYPES,
    hold_for: Duration | None = None,
) -> Iterator[Trace]:
    r"""Read a recording in chunks, with memory use independent of its length; arguments as for :func:`read`.

    For :func:`rtamt.check_stream` and ``update_many``. CSV, Parquet, Arrow and Excel files and SQL queries
    can be read in chunks; what is inferred from the timestamps of the first chunk applies to all. Pass
    ``columns=spec.input_names`` to read only the columns of a formula.

    >>> import pathlib, tempfile
    >>> import rtamt
    >>> spec = rtamt.parse("always(speed <= 30)")
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "log.csv")
    ...     _ = path.write_text("t,speed\n0,5\n1,31\n2,4\n")
    ...     result = rtamt.check_stream(spec, rtamt.scan(path, columns=spec.input_names))
    >>> result.robustness, result.first_violation
    (-1.0, 1.0)
    """
    with opened(source, sheet, query) as found:
        if any(table.chunks is None for table in found.tables) or len(found.tables) != 1:
            raise UsageError(f"{found.name} cannot be read in chunks; read it whole with rtamt.read")
        yield from chunks_of(found, choice(time, columns, names, units, skip_nan, hold_for, time_unit, types))


def choice(
    time: str | None,
    columns: Iterable[str] | None,
    names: Mapping[str, str] | None,
    units: Mapping[str, str] | None,
    skip_nan: Iterable[str] = (),
    hold_for: Duration | None = None,
    time_unit: str | None = None,
    types: Types = NO_TYPES,
) -> Choice:
    """Return the arguments of :func:`read` as one record."""
    for argument, given in (("columns", columns), ("skip_nan", skip_nan)):
        if isinstance(given, str):
            raise UsageError(f"{argument} is the text '{given}'; give a list of names, such as ['{given}']")
    return Choice(
        time,
        None if columns is None else tuple(columns),
        dict(names or {}),
        dict(units or {}) if time_unit is None else {**(units or {}), TIME: check_unit(time_unit)},
        tuple(skip_nan),
        types,
        None if hold_for is None else positive_period(hold_for, "longest time for which a value is held"),
    )


@contextmanager
def opened(
    source: Any, sheet: str | None = None, query: str | None = None, recover: bool = False
) -> Iterator[Source]:
    """Open any source, and close it at the end."""
    found = _open(source, sheet, query, recover)
    try:
        yield found
    finally:
        if found.close is not None:
            found.close()


def _open(source: Any, sheet: str | None, query: str | None, recover: bool) -> Source:
    if isinstance(source, str) and is_url(source):
        return open_sql(source, query)
    if query is not None:
        raise UsageError("a query is for a database, whose address looks like sqlite:///log.db")
    if isinstance(source, (str, os.PathLike)):
        path = os.fspath(source)
        known = format_of(path)
        if is_device(path):  # which has no end
            raise TraceError(f"'{path}' is a device, expected a file")
        if is_pipe(path):  # which cannot be read twice, and may never begin
            raise TraceError(
                f"'{path}' is a pipe, expected a file; 'rtamt monitor SPEC < PIPE' reads it as a stream"
            )
        return known.open(path, sheet, recover)
    found = frames.source_of(source)
    if found is None:
        kinds = ", ".join(known.name for known in FORMATS)
        raise UsageError(
            f"cannot read data of type {type(source).__name__}: give a file ({kinds}), the address of a "
            f"database, or {', '.join(frames.known_kinds())}"
        )
    return found
