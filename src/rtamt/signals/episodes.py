"""Episodes: the maximal runs of instants at which a requirement is violated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray


def plain_times(times: NDArray[Any]) -> list[Any]:
    """Return timestamps one by one: Python numbers, or dates and durations of numpy."""
    return times.tolist() if times.dtype.kind in "fiu" else list(times)


@dataclass(frozen=True, slots=True)
class Episode:
    """A maximal run of violation: its ``begin`` and ``end``, and the ``worst`` robustness, first reached ``at``.

    In discrete time ``end`` is the last sample of the run; in dense time the run extends up to, and without, ``end``,
    unless the signal ends there.

    >>> from rtamt import Episode
    >>> Episode(begin=3.0, end=5.0, worst=-1.5, at=4.0)
    Episode(begin=3.0, end=5.0, worst=-1.5, at=4.0)
    """

    begin: Any
    end: Any
    worst: float
    at: Any


class EpisodeTracker:
    """Collects episodes from the values of one formula, which come in order of time.

    ``continuous``: whether a value holds up to the next one. A robustness below 0 is a violation.

    >>> tracker = EpisodeTracker(continuous=False)
    >>> tracker.take(zip(range(6), [1, -1, -3, 2, 0, -2]))
    >>> tracker.episodes()
    [Episode(begin=1, end=2, worst=-3, at=2), Episode(begin=5, end=5, worst=-2, at=5)]
    """

    def __init__(self, *, continuous: bool) -> None:
        self._continuous = continuous
        self._ended: list[Episode] = []
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
                self._ended.append(Episode(episode.begin, end, episode.worst, episode.at))
                self._open = None

    def cut(
        self, values: Iterable[tuple[int, float]], begin: int, end: int | None
    ) -> list[tuple[int, float]]:
        """Return the values within [begin, end]; None: as far as there are any."""
        inside: list[tuple[int, float]] = []
        for time, value in values:
            if time <= begin and self._continuous:
                inside = [(begin, value)]  # which may hold from earlier on
            elif end is not None and time > end:
                if inside and self._continuous:
                    inside.append((end, inside[-1][1]))
                break
            elif time >= begin:
                inside.append((time, value))
        return inside

    def episodes(self) -> list[Episode]:
        """Return all episodes so far; the last one may still go on."""
        return [*self._ended, *([] if self._open is None else [self._open])]

    def copied(self) -> EpisodeTracker:
        """Return a tracker that goes on independently."""
        twin = EpisodeTracker(continuous=self._continuous)
        twin._ended, twin._open = list(self._ended), self._open
        return twin
