"""Read a recording that needs no conversion, and evaluate it, in one call of the compiled core."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

from rtamt.engine.native import read_columns
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.arrays import TIME
from rtamt.signals.discrete import Discrete, DiscreteTrace
from rtamt.signals.sampling_period import RegularTimes
from rtamt.signals.time_columns import check_frame

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.signal import Signal

_SECOND = Fraction(1)
#: The numbers of a frame that may all be copied to read some of them.
_SMALL = 4096


def read_discrete(data: Any, names: Sequence[str], domain: Discrete) -> DiscreteTrace | None:
    """Return the trace that ``record_discrete`` makes of these data; None where it has to convert or reject them."""
    if data.__class__ is not dict:
        data = frame_columns(data, names)
        if data is None:
            return None
    period = domain.period
    found = read_columns(
        data, names, TIME, None if period is None else float(period), float(domain.tolerance)
    )
    if found is None:
        return None
    times, inferred, columns, count = found
    if times is None:
        period = period or _SECOND
        return DiscreteTrace(RegularTimes(count, period), columns, period)
    return DiscreteTrace(times, columns, period or _decimal(inferred), period is None)


class _Seen(NamedTuple):
    """A frame that was read: its class, its columns, the variables, and the columns to read with their places.

    Frames that are parts of one frame share its index of columns in pandas, and frames of one source have equal lists
    of columns in polars. ``at_once``: the rows up to which all columns of a frame of pandas are read at once, None for
    polars.
    """

    kind: Any
    columns: Any
    names: Sequence[str]
    wanted: dict[str, Any]
    at_once: int | None


_last_seen = _Seen(None, (), (), {}, None)


def frame_columns(data: Any, names: Sequence[str]) -> dict[str, Any] | tuple[Any, dict[str, int]] | None:
    """Return the columns of a frame of pandas or polars for the core; None for anything else.

    They are arrays by name, or those of one array, and the place of each name.
    """
    global _last_seen  # noqa: PLW0603 - replaced as a whole
    kind, columns, variables, wanted, at_once = _last_seen
    if (
        data.__class__ is not kind
        or variables != names
        or ((given := data.columns) is not columns and (given.__class__ is not list or given != columns))
    ):
        seen = _look(data, names) if _is_frame(data.__class__) else None
        if seen is None:
            return None
        wanted, at_once = seen.wanted, seen.at_once
        if TIME in wanted:  # otherwise what is read depends on more than names
            _last_seen = seen
    if at_once is not None and len(data.index) <= at_once:
        values = data.values  # a frame takes longer to return a column than an evaluation of it takes
        if values.dtype.kind != "O":
            return values, wanted
        if TIME in wanted:  # numbers beside texts, truth values or dates, as probably in the next frame
            _last_seen = _Seen(data.__class__, data.columns, names, wanted, -1)
    column = data.get_column if at_once is None else data.__getitem__
    try:
        return {name: column(name).to_numpy() for name in wanted}
    except Exception:  # noqa: BLE001 - a library's own: polars has integers of 128 bits
        return None


def _look(data: Any, names: Sequence[str]) -> _Seen | None:
    """Return what to read of a frame; None if that depends on whether a period is given.

    Raises :class:`TraceError` if the timestamps may be in another column than ``time``, or in the index.
    """
    columns = data.columns
    found = [name for name in (TIME, *names) if name in columns]
    if len(found) != len(columns) or TIME not in found:
        check_frame(data, TIME, names)
    index = getattr(data, "index", None)
    if TIME not in found and (
        (len(columns) and columns[0] not in names) or (index is not None and getattr(index, "step", 0) != 1)
    ):
        return None
    if index is None:
        return _Seen(data.__class__, columns, names, dict.fromkeys(found), None)
    at_once = _SMALL // len(columns) if len(columns) and columns.is_unique else -1
    return _Seen(data.__class__, columns, names, {name: columns.get_loc(name) for name in found}, at_once)


@lru_cache(16)
def _is_frame(kind: type) -> bool:
    """Return whether a class is that of frames of pandas or polars."""
    return kind.__name__ == "DataFrame" and kind.__module__.partition(".")[0] in ("pandas", "polars")


class Reading(NamedTuple):
    """The reading settings of the core's ``DirectEvaluator``: variables, period, and whether it was given.

    What it returns is ``found``: the columns, the number of samples, whether there are timestamps, and the robustness.
    """

    names: tuple[str, ...]
    period: Fraction
    given: bool

    def trace(self, found: Any) -> DiscreteTrace:
        """Return the recording, with the timestamps of the robustness."""
        memory, count, timed, signal = found
        columns = {name: _row(memory, count, place) for place, name in enumerate(self.names)}
        return DiscreteTrace(signal._times, columns, self.period, timed and not self.given)

    def signal(self, found: Any) -> Signal:
        """Return the robustness; if it is all that is kept, it keeps no columns of a long recording."""
        memory, _, timed, signal = found
        if timed and memory.__class__ is list:
            signal._times.forget_columns()
        robustness: Signal = signal
        return robustness

    def samples(self, found: Any) -> int:
        """Return the number of samples of each variable."""
        count: int = found[1]
        return count


def _row(memory: Any, count: int, place: int) -> FloatArray:
    if memory.__class__ is list:
        array: FloatArray = memory[place]
        return array
    return np.frombuffer(memory, np.float64, count, 8 * count * place)


@lru_cache(64)
def _decimal(period: float) -> Fraction:
    return Fraction(repr(period))
