"""Measurement data files (ASAM MDF 3 and 4), with asammdf: a table for each channel group."""

from __future__ import annotations

from collections import Counter
from datetime import timezone
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.readers.source import Field, Source, Table, library, opening

if TYPE_CHECKING:
    from collections.abc import Sequence
    from contextlib import AbstractContextManager

    from rtamt.readers.source import Raw


def open_mdf(path: str) -> Source:
    """Open a measurement file; channels of one name in several groups are called ``group.name``.

    Channels whose values are texts for numbers (modes, states) are read as the numbers.
    """
    asammdf = library("asammdf", "MDF")
    with _reading(path):
        file = asammdf.MDF(path)
    counts = Counter(channel.name for group in file.groups for channel in group.channels)
    tables = tuple(_table(file, path, number, counts) for number in range(len(file.groups)))
    start = file.start_time
    origin = np.datetime64(start.astimezone(timezone.utc).replace(tzinfo=None), "ns")
    return Source(path, tables, origin=origin, close=file.close)


def _table(file: Any, path: str, number: int, counts: Counter[str]) -> Table:
    group = file.groups[number]
    master = file.masters_db.get(number)
    prefix = getattr(group.channel_group, "acq_name", "") or f"group{number}"
    places: dict[str, int] = {}
    fields, clock = [], None
    for index, channel in enumerate(group.channels):
        name = channel.name if counts[channel.name] == 1 else f"{prefix}.{channel.name}"
        field = Field(name, name, _unit(channel), "")
        if index == master:
            clock = field = Field(name, name, "s", "number")
        places[name] = index
        fields.append(field)

    def load(wanted: Sequence[Field]) -> list[Raw]:
        with _reading(path):
            return [
                np.asarray(file.get_master(number))
                if field == clock
                else _samples(file, number, places[field.column])
                for field in wanted
            ]

    return Table(tuple(fields), load, clock=clock)


def _reading(path: str) -> AbstractContextManager[None]:
    # At a damaged block asammdf raises whatever comes first, here and when samples are read.
    return opening(path, "MDF", Exception)


def _unit(channel: Any) -> str:
    conversion = getattr(channel, "conversion", None)
    return str(channel.unit or getattr(conversion, "unit", "") or "").strip()


def _samples(file: Any, group: int, index: int) -> Raw:
    signal = file.get(group=group, index=index, ignore_invalidation_bits=True)
    if signal.samples.dtype.kind in "SUO":
        raw = file.get(group=group, index=index, ignore_invalidation_bits=True, raw=True)
        signal = raw if raw.samples.dtype.kind in "fiub" else signal
    bits = signal.invalidation_bits
    missing = None if bits is None else np.asarray(bits, dtype=bool)
    return signal.samples if missing is None else np.ma.masked_array(signal.samples, missing)
