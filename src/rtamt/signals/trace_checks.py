"""Checks of the channels of a trace that a formula reads together."""

from __future__ import annotations

from rtamt.errors import TraceError
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import WithTimeBases
from rtamt.signals.listing import extent

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping

    from rtamt.signals.trace import Channel


def require_own_clock(channels: Mapping[str, Channel], source: str) -> None:
    """Raise :class:`TraceError` if all channels lack their own times because of others, which are not among them.

    Read alone, they have them. ``channels``: those that a formula reads, by their names. ``source``: of the trace.
    """
    if not channels or not all(channel.retimed for channel in channels.values()):
        return
    columns = ", ".join(repr(channel.column or name) for name, channel in channels.items())
    raise TraceError(
        f"the times of '{next(iter(channels))}' are those of its recording, because topics of {source} that the "
        f"formula does not read have another clock: read the bag with columns=[{columns}], on the command line give "
        f"this requirement alone",
        variable=next(iter(channels)),
    )


def require_own_clocks(data: Any, requirements: Iterable[Collection[str]]) -> None:
    """Raise the error of :func:`require_own_clock` for any of several requirements, each given by its variables.

    What is read for one of them may have changed the clock of another. ``data``: any, also a chunk of a trace.
    """
    if isinstance(data, WithTimeBases):
        for names in requirements:
            data.require_own_clock(names)


def require_one_time_base(channels: Mapping[str, Channel]) -> None:
    """Raise :class:`TraceError` unless channels have the same times."""
    first, *others = channels.items()
    for other in others:
        mine, its = first[1].times, other[1].times
        if mine is its or (mine is not None and its is not None and np.array_equal(mine, its)):
            continue
        if mine is None and its is None and len(first[1].values) == len(other[1].values):
            continue
        raise TraceError(
            f"'{first[0]}' and '{other[0]}' have different time bases "
            f"({extent(first[1])}; {extent(other[1])}): evaluate in dense time, or put them on one time base "
            f"with trace.resample(period=...) or trace.hold(), on the command line with --resample PERIOD",
            variable=other[0],
        )
