"""The times at which messages of a bag were recorded, by the timestamps in their headers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.lazy.modules import np
from rtamt.readers.bag_topic import is_foreign
from rtamt.readers.formats import BAG
from rtamt.readers.message_fields import header_time
from rtamt.readers.rosbag import clock_of, messages

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from numpy.typing import NDArray

    #: Nanoseconds.
    Instants = NDArray[np.int64]


class RecordingTimes:
    """The times of recording of a bag at instants of simulated time, or of any other clock than its own.

    Each topic is read once, as a whole only if its timestamps are from another clock.
    """

    def __init__(self, reader: Any) -> None:
        self._reader = reader
        self._known: dict[str, tuple[Instants, Instants] | None] = {}

    def at(self, times: Instants, topics: Sequence[str]) -> Instants:
        """Return when the instants of a requirement that reads some topics were recorded.

        A requirement has the timestamps in the headers of its topics if all of these are from another clock than that
        of the recording. Between two messages the time of recording is interpolated. All other requirements have
        instants of the recording already.
        """
        clocks = [self._clock(topic) for topic in topics]
        others = [clock for clock in clocks if clock is not None]
        if not others or len(others) < len(clocks):
            return times
        stamps, recorded = (np.concatenate(parts) for parts in zip(*others, strict=True))
        order = np.lexsort((recorded, stamps))
        stamps, recorded = stamps[order], recorded[order]
        first = np.diff(stamps, prepend=stamps[0] - 1) > 0
        return _interpolated(times, stamps[first], np.maximum.accumulate(recorded[first]))

    def _clock(self, topic: str) -> tuple[Instants, Instants] | None:
        """Return the timestamps on a topic and their times of recording; None if both are from one clock."""
        if topic not in self._known:
            self._known[topic] = self._read(topic)
        return self._known[topic]

    def _read(self, topic: str) -> tuple[Instants, Instants] | None:
        connections = [known for known in self._reader.connections if known.topic == topic]
        found = self._stamps(connections)
        first = next(found, None)
        if first is None or not is_foreign(clock_of(self._reader, connections, *first)[0]):
            return None
        pairs = np.array([first, *found], dtype=np.int64)
        return pairs[:, 0], pairs[:, 1]

    def _stamps(self, connections: Sequence[Any]) -> Iterator[tuple[int, int]]:
        for known, recorded, raw in messages(self._reader, connections):
            with BAG.guard(str(self._reader.paths[0])):
                yield header_time(self._reader.deserialize(raw, known.msgtype)), recorded


def _interpolated(times: Instants, stamps: Instants, recorded: Instants) -> Instants:
    """Return the times of recording at some times, exact at ``stamps``; after the last one both clocks run alike."""
    place = np.maximum(np.searchsorted(stamps, times, side="right") - 1, 0)
    after = np.minimum(place + 1, len(stamps) - 1)
    gap = stamps[after] - stamps[place]
    pace = np.where(gap > 0, (recorded[after] - recorded[place]) / np.maximum(gap, 1), 1.0)
    since: Instants = np.rint((times - stamps[place]) * pace).astype(np.int64)
    return recorded[place] + since
