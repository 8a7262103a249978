"""Values over time: what evaluations and monitors return."""

from __future__ import annotations

from rtamt.lazy.typing import TYPE_CHECKING, Any
from rtamt.signals.sampling_period import DeferredTimes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray


def read_only(array: NDArray[Any]) -> NDArray[Any]:
    """Return an array, or a view of it if it can be written, that cannot be written."""
    if array.flags.writeable:
        array = array.view()
        array.flags.writeable = False
    return array


class Signal:
    """Values over time: ``times`` and ``values``, arrays of the same length.

    Times come as the caller gave them: float64 seconds, numbers in the unit of ``time_unit=``, datetime64 or
    timedelta64. In dense time there is a point for every change and one at the end.
    The times of a discrete recording are shared by its signals and cannot be written.

    >>> import rtamt
    >>> signal = rtamt.parse("x >= 3").evaluate({"time": [0, 1, 2], "x": [5, 1, 4]}).signal
    >>> len(signal), signal.times[signal.values < 0]
    (3, array([1.]))
    """

    __slots__ = ("_times", "_values")

    def __init__(self, times: NDArray[Any] | DeferredTimes, values: FloatArray) -> None:
        self._times: Any = times
        self._values = values

    @property
    def times(self) -> NDArray[Any]:
        """The times: in seconds, or in the caller's format."""
        times: NDArray[Any] | DeferredTimes = self._times
        return times.array if isinstance(times, DeferredTimes) else times

    @property
    def values(self) -> FloatArray:
        """The values, one for each time."""
        return self._values

    def points(self) -> list[tuple[Any, float]]:
        """Return (time, value) pairs of Python's own numbers: the cheapest way to read the result of an update.

        >>> import rtamt
        >>> monitor = rtamt.parse("historically[0:1](x >= 3)").monitor(time="dense")
        >>> monitor.update(0.5, x=5.0).points()
        [(0.5, 2.0)]
        """
        times = self.times.tolist() if self.times.dtype.kind in "fi" else self.times  # dates stay numpy's
        return list(zip(times, self.values.tolist(), strict=True))

    def __len__(self) -> int:
        return len(self._times)

    def __repr__(self) -> str:
        return f"Signal(times={self.times!r}, values={self.values!r})"
