"""Samples without timestamps: whether their period is known, or a column that nothing reads may hold timestamps."""

from __future__ import annotations

from rtamt.errors import TraceError
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME, WithTimeBases, is_mapping
from rtamt.signals.time_columns import check_first_column

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence


class FrameColumns(dict[str, Any]):
    """The columns of a frame under the names of variables: the first one is the first of the frame."""

    __slots__ = ()


def is_known(data: Any, samples: int, *, given: bool) -> bool:
    """Return whether the period of a chunk after some samples is known: it was given, or theirs was assumed.

    A frame is looked at until it has shown a step of its first column: in a short later chunk, any variable may happen
    to increase.
    """
    return given or (samples > 1 and not isinstance(data, WithTimeBases))


def require_times(data: Any, names: Collection[str]) -> None:
    """Raise :class:`TraceError` if the first column of data may hold the timestamps, and nothing reads it.

    For samples whose period nothing gives. ``names``: the variables.
    """
    if isinstance(data, WithTimeBases):
        data.require_period(names)
    elif isinstance(data, FrameColumns) or (not is_mapping(data) and hasattr(data, "columns")):
        check_first_column(data, list(data if isinstance(data, FrameColumns) else data.columns), TIME, names)


def require_times_of_each(data: Any, requirements: Sequence[Collection[str]]) -> None:
    """Raise the error of :func:`require_times` for any of several requirements, each given by its variables.

    One that reads what may be the timestamps does not decide for the others. Nothing is asked for a single one, whose
    data are asked for when they are read.
    """
    if len(requirements) > 1:
        for names in requirements:
            require_times(data, names)


def lack_of_times(data: WithTimeBases, requirements: Sequence[Collection[str]]) -> TraceError | None:
    """Return the first error of :func:`require_times` for any of several requirements; None if there is none."""
    try:
        for names in requirements:
            require_times(data, names)
    except TraceError as error:
        return error
    return None
