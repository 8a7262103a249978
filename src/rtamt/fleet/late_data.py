"""Batches of samples as they arrive: in the order of their times, or late ones among them."""

from __future__ import annotations

from functools import lru_cache
from math import isnan, nan
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, shown
from rtamt.fleet.fleet_snapshot import FleetState, packed
from rtamt.fleet.updates import FleetUpdate, Released
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.arrays import is_moment, is_truth, number_of, timestamps
from rtamt.signals.caller_times import other_kind

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.engine import OnlineMonitor
    from rtamt.fleet.gaps import Gaps
    from rtamt.signals.arrays import FloatArray


class Output(NamedTuple):
    """The new values of an output: for the samples of a batch, in its order, and for others (``keys`` ...).

    ``keys``, ``at``, ``found``: key, time and value of each that samples made known which are not of the batch.
    """

    values: FloatArray
    known: NDArray[np.bool_]
    times: FloatArray
    warming: NDArray[np.bool_]
    keys: NDArray[Any]
    at: FloatArray
    found: FloatArray


class Taken(NamedTuple):
    """The results of a batch: which of its samples were late, and each output."""

    late: NDArray[np.bool_]
    outputs: list[Output]


class InOrder:
    """Samples that arrive in the order of their times; ``records``: what monitors them."""

    _lateness: float | None = None

    def __init__(self, records: Any, requirements: tuple[str, ...]) -> None:
        self.records, self._requirements = records, requirements
        #: The kind of the dtype of the caller's times; None before the first.
        self._kind: str | None = None

    def take(self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]) -> FleetUpdate:
        """Take a batch as a user gives it; return what it made known."""
        known = None if self._kind in ("M", "m") else self.records.take(keys, times, columns)
        if known is None:
            return self._take_carefully(keys, times, columns)
        if len(keys):
            self._kind = "f"
        return self._updated(_all_in_order(keys, known))

    def _take_carefully(self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]) -> FleetUpdate:
        """Take a batch that has to be converted, checked or put in order first."""
        (seconds, given), found = self.records.columns(keys, times, columns)
        if len(keys) != len(seconds):
            raise TraceError(
                f"there are {len(keys)} keys and {len(seconds)} times: give one of each for every sample"
            )
        before = self._kind
        if len(seconds):
            kind = given.dtype.kind
            if before not in (None, kind):
                raise other_kind(kind, before)
            self._kind = kind
        try:
            return self._updated(self.update(keys, seconds, found))
        except BaseException:
            self._kind = before
            raise

    @property
    def _dated(self) -> bool:
        """Whether the caller's times are dates."""
        return self._kind == "M"

    def watermark(self, time: Any, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> FleetUpdate:
        """Release what waits up to a time; ``arrays``: makes an array of keys."""
        return self._updated(self.release(_seconds(time), arrays), time)

    def advance(self, now: Any, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> FleetUpdate:
        """Set the current time: release what waits up to the lateness before it."""
        return self._updated(self.release(_seconds(now) - (self._lateness or 0.0), arrays), now)

    def release_keys(
        self,
        keys: NDArray[Any],  # noqa: ARG002 - nothing waits
        arrays: Callable[[Sequence[Any]], NDArray[Any]],  # noqa: ARG002 - as above
    ) -> FleetUpdate:
        """Release all that waits of some keys."""
        raise _nothing_waits()

    def _updated(self, taken: Taken, watermark: Any = None) -> FleetUpdate:
        """Return an update; its times are of the kind of the batches, after a restart of that of the ``watermark``."""
        kind = self._kind
        if kind is None and is_moment(watermark):
            kind = timestamps([watermark]).original.dtype.kind
        outputs = taken.outputs
        released = (
            Released(
                np.concatenate([each.keys for each in outputs]),
                _as_given(np.concatenate([each.at for each in outputs]), kind),
                np.concatenate([each.found for each in outputs]),
                np.repeat(np.arange(len(outputs)), [len(each.at) for each in outputs]),
            )
            if any(len(each.at) for each in outputs)
            else _no_release(outputs[0].keys.dtype)
        )
        if not self._requirements:
            (one,) = outputs
            times = _as_given(one.times, kind)
            return FleetUpdate(one.values, one.known, times, one.warming, taken.late, released)
        values = np.stack([each.values for each in outputs], axis=1)
        known = np.stack([each.known for each in outputs], axis=1)
        times = _as_given(np.stack([each.times for each in outputs], axis=1), kind)
        warming = np.stack([each.warming for each in outputs], axis=1)
        return FleetUpdate(values, known, times, warming, taken.late, released, self._requirements)

    def monitor(self, key: NDArray[Any], requirement: str | None) -> OnlineMonitor | None:  # noqa: ARG002 - no key has one
        """Raise :class:`UsageError`: keys have records."""
        raise UsageError(
            "a fleet of delayed verdicts in discrete time has a record for each key, and no monitor; read update_many()"
        )

    def update(self, keys: NDArray[Any], times: FloatArray, columns: Mapping[str, FloatArray]) -> Taken:
        """Take a batch. Raises for wrong data, and nothing has changed."""
        self.records.check(keys, times, columns, dated=self._dated)
        return _all_in_order(keys, self.records.update(keys, times, columns, dated=self._dated))

    def release(self, time: float, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> Taken:  # noqa: ARG002 - nothing waits
        """Release what waits up to a time in seconds."""
        raise _nothing_waits()

    @property
    def late(self) -> int:
        """The number of late samples."""
        return 0

    @property
    def waiting(self) -> int:
        """The number of samples that wait for earlier ones."""
        return 0

    @property
    def capacity(self) -> int:
        """The largest number of keys."""
        return int(self.records.capacity)

    @property
    def memory(self) -> int:
        """Bytes of state."""
        return int(self.records.memory)

    def __len__(self) -> int:
        return len(self.records)

    def contains(self, key: NDArray[Any]) -> bool:
        """Return whether the key in an array of one element exists."""
        return bool(self.records.contains(key))

    def keys(self) -> list[Any]:
        """Return all keys, in no particular order."""
        return list(self.records.keys())

    def drop(self, keys: NDArray[Any]) -> int | None:
        """Forget keys; return the index of the first that is not there, and forget none then."""
        missing: int | None = self.records.drop(keys)
        return missing

    def expire(self, before: float, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> int:  # noqa: ARG002 - of Reordered
        """Forget the keys whose last sample is before a time; return how many."""
        return int(self.records.expire(before))

    def program(self) -> bytes:
        """Return the program of the records, for the C API."""
        from rtamt.fleet.compiled import records_program  # with the compiler

        session, formulas = self.records.compiled
        return records_program(session, formulas, self._requirements)

    def snapshot(self, gaps: Gaps) -> bytes:
        """Return the state; that of rejected gaps is that of the monitors alone."""
        records = bytes(self.records.snapshot())
        return records if gaps.code == 0 else packed(FleetState(gaps, None, None, records))


class Reordered(InOrder):
    """Samples that a reorder buffer for each key puts in order."""

    def __init__(
        self,
        records: Any,
        requirements: tuple[str, ...],
        lateness: float | None,
        gaps: Gaps,
        state: bytes | None,
    ) -> None:
        super().__init__(records, requirements)
        self._lateness = lateness
        self._buffer = records.reordering(lateness, gaps.filled, state)

    def take(self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]) -> FleetUpdate:
        """See :class:`InOrder`."""
        return self._take_carefully(keys, times, columns)

    def update(self, keys: NDArray[Any], times: FloatArray, columns: Mapping[str, FloatArray]) -> Taken:
        """See :class:`InOrder`."""
        self.records.check(keys, times, columns, dated=self._dated)
        late, ready = self._buffer.offer(keys, times, columns, dated=self._dated)
        return self._taken(late, keys[ready.places], ready)

    def release(self, time: float, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> Taken:
        """See :class:`InOrder`."""
        if self._lateness is None:
            return super().release(time, arrays)
        keys, ready = self._buffer.advance(time, dated=self._dated)
        return self._taken(np.empty(0, np.bool_), arrays(keys), ready)

    def release_keys(
        self, keys: NDArray[Any], arrays: Callable[[Sequence[Any]], NDArray[Any]]
    ) -> FleetUpdate:
        """See :class:`InOrder`."""
        if self._lateness is None:
            return super().release_keys(keys, arrays)
        for index in range(len(keys)):
            if not self.contains(keys[index : index + 1]):
                raise UsageError(
                    f"the fleet has no key {keys[index].item()!r} (index {index}); nothing was released"
                )
        found, ready = self._buffer.release(keys, dated=self._dated)
        return self._updated(self._taken(np.empty(0, np.bool_), arrays(found), ready))

    def _taken(self, late: NDArray[np.bool_], keys: NDArray[Any], ready: Any) -> Taken:
        """Monitor the released samples; ``keys``: of each of these samples."""
        try:
            known = self.records.update(
                np.ascontiguousarray(keys), ready.times, ready.columns, ready, dated=self._dated
            )
        except BaseException:
            self._buffer.withdraw()
            raise
        self._buffer.accept()
        return Taken(late, [_split_known(len(late), keys, ready, each) for each in known])

    @property
    def late(self) -> int:
        """See :class:`InOrder`."""
        return int(self._buffer.late)

    @property
    def waiting(self) -> int:
        """See :class:`InOrder`."""
        return int(self._buffer.waiting)

    @property
    def memory(self) -> int:
        """See :class:`InOrder`."""
        return super().memory + int(self._buffer.memory)

    def __len__(self) -> int:
        return len(self._buffer)

    def contains(self, key: NDArray[Any]) -> bool:
        """See :class:`InOrder`."""
        return bool(self._buffer.contains(key))

    def keys(self) -> list[Any]:
        """See :class:`InOrder`."""
        return list(self._buffer.keys())

    def drop(self, keys: NDArray[Any]) -> int | None:
        """See :class:`InOrder`."""
        left = self._buffer.left(keys)
        missing: int | None = self._buffer.drop(keys)
        if missing is None:
            absent = self.records.drop(np.ascontiguousarray(keys[left]))
            assert absent is None, "what has left the buffer is monitored"
        return missing

    def discard(self, key: NDArray[Any], time: float) -> bool:
        """Forget the sample of a time that waits, of the key of an array of one; return whether there was one."""
        return bool(self._buffer.discard(key, time))

    def expire(self, before: float, arrays: Callable[[Sequence[Any]], NDArray[Any]]) -> int:
        """See :class:`InOrder`."""
        stale = self._buffer.stale(before)
        self.drop(arrays(stale))
        return len(stale)

    def snapshot(self, gaps: Gaps) -> bytes:
        """See :class:`InOrder`."""
        waiting = self._buffer.snapshot()
        return packed(FleetState(gaps, self._lateness, waiting, bytes(self.records.snapshot())))


def _as_given(seconds: FloatArray, kind: str | None) -> NDArray[Any]:
    """Return times of samples as a dtype of this kind; dates to the microsecond, which is what a double holds."""
    if kind not in ("M", "m"):
        return seconds
    known = ~np.isnan(seconds)
    times = np.full(seconds.shape, np.iinfo(np.int64).min)  # NaT
    times[known] = np.rint(seconds[known] * 1e6).astype(np.int64) * 1000
    return times.view(f"{kind}8[ns]")


def _all_in_order(keys: NDArray[Any], known: Iterable[Sequence[NDArray[Any]]]) -> Taken:
    """Return what a batch has done of which no sample waits or is late; ``known``: arrays of each output."""
    nothing = np.empty(0)
    outputs = [
        Output(values, final, times, warming, keys[:0], nothing, nothing)
        for values, final, times, warming in known
    ]
    return Taken(np.zeros(len(keys), np.bool_), outputs)


@lru_cache(16)
def _no_release(keys: np.dtype[Any]) -> Released:
    return Released(np.empty(0, keys), np.empty(0), np.empty(0), np.empty(0, np.int64))


def _split_known(size: int, keys: NDArray[Any], ready: Any, known: Any) -> Output:
    """Return what samples of the batch made known, in its order, and the rest."""
    values, final, times, warming = (
        np.zeros(size),
        np.zeros(size, np.bool_),
        np.full(size, nan),
        np.zeros(size, np.bool_),
    )
    own, at = ready.own, ready.places[ready.own]
    for out, found in zip((values, final, times, warming), known, strict=True):
        out[at] = found[own]
    others = ~own & known.known
    return Output(values, final, times, warming, keys[others], known.times[others], known.values[others])


def _nothing_waits() -> UsageError:
    return UsageError(
        "the fleet was made without lateness=, so that no sample waits; make it with Fleet(..., lateness=...)"
    )


def _seconds(time: Any) -> float:
    """Return a watermark in seconds."""
    number = None if is_truth(time) else number_of(time)
    seconds = float(timestamps([time]).seconds[0]) if number is None else number
    if isnan(seconds):
        raise TraceError("the watermark is NaN: give a number of seconds")
    return seconds


def moment_of(time: Any, what: str) -> float:
    """Return a time in seconds; raise :class:`UsageError` for what is neither a number nor a date."""
    try:
        return _seconds(time)
    except TraceError:
        raise UsageError(f"{what} is {shown(time)}; give a number of seconds, or a date") from None
