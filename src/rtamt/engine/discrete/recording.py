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
    """The columns of a frame that was read, and the variables in them, each with its place in an index of pandas.

    Frames that are parts of one frame share its index, and frames of one source have equal columns.
    """

    columns: Any
    names: Sequence[str]
    wanted: dict[str, Any]


_last_seen = _Seen(None, (), {})


def frame_columns(data: Any, names: Sequence[str]) -> dict[str, Any] | None:
    """Return the columns of a frame of pandas or polars as arrays; None for anything else."""
    library = _library_of(data.__class__)
    if library is None:
        return None
    global _last_seen  # noqa: PLW0603 - replaced as a whole
    columns, seen = data.columns, _last_seen
    listed = columns.__class__ is list
    same = seen.columns is columns or (listed and seen.columns.__class__ is list and seen.columns == columns)
    if not same or seen.names != names:
        wanted = {
            name: None if listed else columns.get_loc(name) for name in (TIME, *names) if name in columns
        }
        if len(wanted) != len(columns) or TIME not in wanted:
            check_frame(data, TIME, names)
        seen = _Seen(columns, names, wanted)
        if TIME in wanted:  # otherwise the check depends on more than names
            _last_seen = seen
    if TIME not in seen.wanted and (
        (len(columns) and columns[0] not in names)
        or (library == "pandas" and getattr(data.index, "step", 0) != 1)
    ):
        return None  # the conversion of the samples considers whether a period is given
    if library == "pandas" and len(columns) * len(data.index) <= _SMALL and columns.is_unique:
        rows = data.values.T  # a frame takes longer to return a column than an evaluation of it takes
        return {name: rows[place] for name, place in seen.wanted.items()}
    column = data.__getitem__ if library == "pandas" else data.get_column
    try:
        return {name: column(name).to_numpy() for name in seen.wanted}
    except Exception:  # noqa: BLE001 - a library's own: polars has integers of 128 bits
        return None


@lru_cache(16)
def _library_of(kind: type) -> str | None:
    """Return the library of a class of frames; None for any other class."""
    library = kind.__module__.partition(".")[0]
    return library if kind.__name__ == "DataFrame" and library in ("pandas", "polars") else None


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
