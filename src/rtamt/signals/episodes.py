"""Episodes: the maximal runs of instants at which a requirement is violated."""

from __future__ import annotations

from itertools import pairwise

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray

    #: Positions in order; a range of those that are one apart, which takes no memory.
    Positions = NDArray[np.int64] | range

#: Episodes that a summary contains.
_FIRST = 100


def plain_times(times: NDArray[Any]) -> list[Any]:
    """Return timestamps one by one: Python numbers, or dates and durations of numpy."""
    return times.tolist() if times.dtype.kind in "fiu" else list(times)


@dataclass(frozen=True, slots=True)
class Episode:
    """A maximal run of violation: its ``begin`` and ``end``, and the ``worst`` robustness, first reached ``at``.

    In discrete time ``end`` is the last sample of the run; in dense time the run extends up to but excluding ``end``,
    unless the signal ends there.

    >>> from rtamt import Episode
    >>> Episode(begin=3.0, end=5.0, worst=-1.5, at=4.0)
    Episode(begin=3.0, end=5.0, worst=-1.5, at=4.0)
    """

    begin: Any
    end: Any
    worst: float
    at: Any

    def with_times(self, time: Callable[[Any], Any]) -> Episode:
        """Return the same with other times."""
        return Episode(time(self.begin), time(self.end), self.worst, time(self.at))


@dataclass(frozen=True, slots=True)
class Episodes:
    """A summary of episodes: how many there are, the worst one (None: there is none), and the ``first`` ones."""

    count: int
    worst: Episode | None
    first: tuple[Episode, ...]

    @staticmethod
    def of(episodes: Sequence[Episode]) -> Episodes:
        """Return the summary of all of them."""
        worst = min(episodes, key=lambda each: each.worst, default=None)
        return Episodes(len(episodes), worst, tuple(episodes[:_FIRST]))

    def with_times(self, time: Callable[[Any], Any]) -> Episodes:
        """Return the same with other times."""
        worst = None if self.worst is None else self.worst.with_times(time)
        return Episodes(self.count, worst, tuple(each.with_times(time) for each in self.first))


class EpisodeTracker:
    """Collects episodes from the values of one formula, which arrive in order of time.

    ``continuous``: whether a value holds up to the next one. A robustness below 0 is a violation. ``few``: to count
    all of them, and to remember the first and the worst ones.

    >>> tracker = EpisodeTracker(continuous=False)
    >>> tracker.take(zip(range(6), [1, -1, -3, 2, 0, -2]))
    >>> tracker.episodes()
    [Episode(begin=1, end=2, worst=-3, at=2), Episode(begin=5, end=5, worst=-2, at=5)]
    """

    def __init__(self, *, continuous: bool, few: bool = False) -> None:
        self._continuous = continuous
        self._few = few
        self._ended: list[Episode] = []
        self._count = 0
        self._worst: Episode | None = None
        self._open: Episode | None = None

    def take(self, values: Iterable[tuple[Any, float]]) -> None:
        """Take times and values that became known."""
        for time, value in values:
            episode = self._open
            if value < 0:
                if episode is None:
                    self._open = Episode(time, time, value, time)
                elif value < episode.worst:
                    self._open = Episode(episode.begin, time, value, time)
                else:
                    self._open = Episode(episode.begin, time, episode.worst, episode.at)
            elif episode is not None:
                end = time if self._continuous else episode.end
                self._end(Episode(episode.begin, end, episode.worst, episode.at))
                self._open = None

    def _end(self, episode: Episode) -> None:
        self._count += 1
        if self._worst is None or episode.worst < self._worst.worst:
            self._worst = episode
        if not self._few or len(self._ended) < _FIRST:
            self._ended.append(episode)

    def episodes(self) -> list[Episode]:
        """Return all episodes so far; the last one may still continue."""
        return [*self._ended, *([] if self._open is None else [self._open])]

    def summary(self) -> Episodes:
        """Return the number of episodes, the worst one and the first ones."""
        known = Episodes.of(self.episodes())
        worst = Episodes.of([each for each in (self._worst, known.worst) if each is not None]).worst
        return Episodes(self._count + (self._open is not None), worst, known.first)

    def copied(self) -> EpisodeTracker:
        """Return a tracker that continues independently."""
        twin = EpisodeTracker(continuous=self._continuous, few=self._few)
        twin._ended, twin._open = list(self._ended), self._open
        twin._count, twin._worst = self._count, self._worst
        return twin


def place_in(positions: Positions, position: int, side: Literal["left", "right"]) -> int:
    """Return where a position would be inserted to keep the order: before equal ones, or after (``right``).

    >>> [place_in(range(3, 6), position, "right") for position in (2, 3, 9)]
    [0, 1, 3]
    """
    if isinstance(positions, range):
        return min(max(position + (side == "right") - positions.start, 0), len(positions))
    return int(positions.searchsorted(position, side))


class WindowTracker:
    """Collects episodes from signals in chunks, within a window [begin, end] of positions.

    ``end``: None: as far as the signal extends. ``positions`` count periods or ticks from the first instant.
    """

    def __init__(self, begin: int, end: int | None, *, continuous: bool, few: bool = False) -> None:
        self._begin, self._end = begin, end
        self._continuous = continuous
        self._tracker = EpisodeTracker(continuous=continuous, few=few)
        # In dense time: the value at the beginning of the window, then the last value so far.
        self._held: float | None = None
        self._last: tuple[int, float] | None = None

    def take(self, positions: Positions, values: FloatArray, times: Any = None) -> None:
        """Take what became known; ``times``: of the samples, in discrete time, if episodes are to have these."""
        first = place_in(positions, self._begin, "right" if self._continuous else "left")
        end = len(positions) if self._end is None else place_in(positions, self._end, "right")
        if self._continuous and first:
            self._held = float(values[first - 1])
        if first >= end:
            return
        self._begun()
        timestamps = (np.asarray(positions) if times is None else times)[first:end]
        self._tracker.take(_notable(timestamps, values[first:end]))
        self._last = int(positions[end - 1]), float(values[end - 1])

    def _begun(self) -> None:
        if self._held is not None:
            self._tracker.take([(self._begin, self._held)])
            self._last, self._held = (self._begin, self._held), None

    def finish(self, last: int) -> None:
        """End the trace at a position: in dense time the last value holds up to it."""
        self._begun()
        stop = last if self._end is None else min(last, self._end)
        if self._continuous and self._last is not None and self._last[0] < stop:
            self._tracker.take([(stop, self._last[1])])

    def episodes(self) -> list[Episode]:
        """Return all episodes."""
        return self._tracker.episodes()

    def summary(self) -> Episodes:
        """Return the number of episodes, the worst one and the first ones."""
        return self._tracker.summary()


def _notable(times: NDArray[Any], values: FloatArray) -> Iterator[tuple[Any, float]]:
    """Yield the first value of each run of equal sign, and of a violation also the worst and the last one."""
    below = values < 0
    edges = [0, *(np.flatnonzero(below[1:] != below[:-1]) + 1).tolist(), len(values)]
    places: list[int] = []
    for begin, end in pairwise(edges):
        places += [begin] if not below[begin] else [begin, begin + int(values[begin:end].argmin()), end - 1]
    return zip(plain_times(times[places]), values[places].tolist(), strict=True)
