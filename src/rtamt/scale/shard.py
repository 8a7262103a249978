"""One shard of a stream: a fleet that takes any samples, and rejects those that are wrong one by one.

What a sample leads to depends on the earlier samples of the shard alone, not on their batches: a stream
that is read again from a snapshot has the same results.
"""

from __future__ import annotations

import json
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError, StlError, TraceError, UsageError, WaitedError
from rtamt.fleet.fleet import Fleet
from rtamt.fleet.reports import FleetPoints, SuiteUpdate
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.scale.arrivals import Arrivals
from rtamt.scale.inputs import inputs_of, is_dense
from rtamt.signals.counting import is_implausible

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from rtamt.fleet.suite import Suite
    from rtamt.fleet.updates import FleetUpdate
    from rtamt.language.units.durations import Duration
    from rtamt.specification import Specification

#: The largest number of keys of a shard, by default; memory is used only for those that have come.
CAPACITY = 1_000_000
#: The longest key: a batch is an array whose rows have the length of the longest one.
LONGEST_KEY = 256
#: Samples that are taken together where a batch has wrong ones: each wrong one takes another call.
_CHUNK = 256


def key_problem(key: str) -> str:
    """Return why a text cannot be a key, as the end of a sentence; empty if it can.

    >>> key_problem("car-1"), key_problem("")
    ('', 'is "", expected 1 to 256 printable characters')
    """
    if key and len(key) <= LONGEST_KEY and key.isprintable():  # the character 0 is not printable
        return ""
    text = json.dumps(key[:100])
    return f"is {text if len(text) <= 40 else f'{text[:40]}...'}, expected 1 to {LONGEST_KEY} printable characters"


class Sample(NamedTuple):
    """A sample of one key; ``values``: in the order of :attr:`Shard.columns`; NaN: without one, in dense time."""

    key: str
    time: float
    values: tuple[float, ...]


class Result(NamedTuple):
    """A robustness that has become known; ``time``: the time that it is for, in dense time from which on it holds.

    ``requirement``: its name, of a suite.
    """

    key: str
    time: float
    robustness: float
    requirement: str | None = None

    @property
    def satisfied(self) -> bool | None:
        """The verdict; None at robustness 0, whose sign does not decide it: ``x > 3`` and ``x >= 3`` differ there."""
        return None if self.robustness == 0 else self.robustness > 0


class Rejected(NamedTuple):
    """A sample that changes nothing; ``position``: in the batch; ``late``: it came too late."""

    position: int
    error: str
    late: bool


class Discarded(NamedTuple):
    """A sample of an earlier batch that waited, has no value, and changes nothing."""

    key: str
    time: float
    error: str


@dataclass(frozen=True, slots=True)
class Taken:
    """The outcome of a batch: results and rejected samples, each in the order of the batch, and discarded ones."""

    results: list[Result] = field(default_factory=list)
    rejected: list[Rejected] = field(default_factory=list)
    discarded: list[Discarded] = field(default_factory=list)
    #: The keys that have expired.
    expired: list[str] = field(default_factory=list)


class Shard:
    """The monitors of all keys of a shard.

    ``spec``: a specification, or a suite, each of whose requirements has its results. ``state``: what :meth:`snapshot`
    returned; in discrete time perhaps for another specification. In discrete time a gap between two samples of a key
    restarts its trace. ``lateness``: how late a sample may arrive (:class:`rtamt.Fleet`); by default those of a key
    come in the order of their times. A sample that has waited and turns out to have no value is discarded, as if it had
    not come. ``expire_after``: for how many seconds a key may have no message until it is forgotten, by the times that
    :meth:`take` is given; what waits of it is released. ``settings``: those of ``Specification.monitor``.

    >>> import rtamt
    >>> shard = Shard(rtamt.parse("x >= 3"))
    >>> taken = shard.take([Sample("car-1", 0.0, (5.0,)), Sample("car-1", -1.0, (5.0,)), Sample("car-2", 7.0, (1.0,))])
    >>> [(each.key, each.time, each.robustness) for each in taken.results]
    [('car-1', 0.0, 2.0), ('car-2', 7.0, -2.0)]
    >>> [(each.position, each.late) for each in taken.rejected]
    [(1, True)]
    """

    def __init__(
        self,
        spec: Specification | Suite,
        *,
        capacity: int = CAPACITY,
        state: bytes | None = None,
        lateness: Duration | None = None,
        expire_after: float | None = None,
        **settings: Any,
    ) -> None:
        self._waits = lateness is not None
        #: What a message has, in the order of the values of a sample.
        self.inputs = inputs_of(spec)
        #: The recorded names of the variables.
        self.columns = tuple(each.columns[0] for each in self.inputs)
        self._partial = is_dense(spec, settings)
        if self._partial and self._waits:
            raise UsageError(
                "lateness needs discrete time, and this is dense time: send the samples of a key in the order of their "
                "times"
            )
        self._arrivals = None if expire_after is None else Arrivals(expire_after)
        if not self._partial:
            settings["gaps"] = "restart"
        if state is None:
            self._fleet: Fleet[Any] = Fleet(spec, capacity, lateness=lateness, **settings)
        else:
            inner = (self._arrivals or Arrivals(inf)).unpack_state(state)
            self._fleet = Fleet.restore(spec, inner, capacity=capacity, lateness=lateness, **settings)
        if self._arrivals is not None:
            self._arrivals.begin(self._fleet.keys())

    def __len__(self) -> int:
        return len(self._fleet)

    def snapshot(self) -> bytes:
        """Return the state of all keys."""
        state = self._fleet.snapshot()
        return state if self._arrivals is None else self._arrivals.pack_state(state)

    def take(self, samples: Sequence[Sample], arrivals: Sequence[float] = ()) -> Taken:
        """Take samples of any keys; those of one key in the order in which they came.

        ``arrivals``: the time of the message of each sample in seconds, for ``expire_after``.
        """
        taken = Taken()
        if not samples:
            return taken
        batch = _Batch(samples, self.columns, masked=self._partial)
        first = 0
        if self._arrivals is not None:
            # In a full shard, an expired key may take the place of a new one.
            full = len(self._fleet) + len(samples) > self._fleet.capacity
            for place, (sample, time) in enumerate(zip(samples, arrivals, strict=True)):
                expired = [sample.key] if self._arrivals.note(sample.key, time) else []
                if full:
                    expired += self._arrivals.pop_expired()
                if expired:
                    self._take(batch, first, place, taken)
                    self._forget(expired, taken)
                    first = place
        self._take(batch, first, len(samples), taken)
        if self._arrivals is not None:
            self._forget(self._arrivals.pop_expired(), taken)
        return taken

    def _forget(self, expired: Sequence[str], taken: Taken) -> None:
        """Forget keys, after what waits of them."""
        keys = [key for key in expired if key in self._fleet]
        if not keys:
            return
        taken.expired.extend(keys)
        while self._waits:
            try:
                update = self._fleet.release(keys)
            except WaitedError as error:
                self._discard(error, taken)
                continue
            taken.results.extend(self._results(update))
            break
        self._fleet.drop(keys)

    def _discard(self, error: WaitedError, taken: Taken) -> None:
        self._fleet.discard(error.key, error.time)
        taken.discarded.append(Discarded(error.key, error.time, error.reason))

    def _take(self, batch: _Batch, start: int, stop: int, taken: Taken) -> None:
        """Take a part of a batch."""
        samples = batch.samples
        if start == stop or self._update(batch, start, stop, taken) is None:
            return
        waiting = [(first, min(first + _CHUNK, stop)) for first in range(start, stop, _CHUNK)]
        waiting.reverse()
        while waiting:
            first, end = waiting.pop()
            if first == end:
                continue
            error = self._update(batch, first, end, taken)
            if error is None:
                continue
            if end - first == 1:
                time = samples[first].time
                plausible = isfinite(time) and not is_implausible(time)
                if isinstance(error, WaitedError):
                    self._discard(error, taken)
                    waiting.append((first, end))  # what has released it may be right
                    continue
                late = isinstance(error, TraceError) and error.variable == "time" and plausible
                text = str(error).replace(" at index 0 of the batch", "", 1)
                taken.rejected.append(Rejected(first, text, late))
                continue
            index = getattr(error, "index", None)
            if index is None:
                middle = (first + end) // 2
                waiting += [(middle, end), (first, middle)]
            else:
                wrong = first + index
                waiting += [(wrong + 1, end), (wrong, wrong + 1), (first, wrong)]

    def _update(self, batch: _Batch, first: int, end: int, taken: Taken) -> StlError | None:
        """Take a part of a batch; return why it was rejected as a whole, if it was."""
        columns = {name: column[first:end] for name, column in batch.columns.items()}
        try:
            update = self._fleet.update_many(batch.keys[first:end], batch.times[first:end], columns)
        except (TraceError, EvaluationError, UsageError) as error:
            return error
        taken.results.extend(self._results(update, batch.keys[first:end]))
        if self._waits:
            self._note_late(batch, first, update, taken)
        return None

    def _results(self, update: Any, keys: Any = ()) -> list[Result]:
        """Return the results of a batch; with lateness in the order of times."""
        if isinstance(update, SuiteUpdate):
            return [
                result._replace(requirement=name)
                for name, one in update.updates.items()
                for result in self._results(one, keys)
            ]
        if isinstance(update, FleetPoints):
            points = zip(update.keys.tolist(), update.times.tolist(), update.values.tolist(), strict=True)
            return [Result(*point) for point in points]
        known = np.nonzero(update.known)
        names: Any = update.requirements or (None,)
        numbers = known[1].tolist() if len(known) > 1 else [0] * len(known[0])
        rows = zip(
            known[0].tolist(),
            update.times[known].tolist(),
            update.values[known].tolist(),
            numbers,
            strict=True,
        )
        found = [Result(str(keys[i]), time, value, names[number]) for i, time, value, number in rows]
        out = update.released
        columns = (out.keys, out.times, out.values, out.requirements)
        for key, time, value, number in zip(*(column.tolist() for column in columns), strict=True):
            found.append(Result(key, time, value, names[number]))
        if self._waits:
            found.sort(key=lambda result: result.time)
        return found

    def _note_late(self, batch: _Batch, first: int, update: FleetUpdate, taken: Taken) -> None:
        """Note which samples arrived too late."""
        for i in np.flatnonzero(update.late).tolist():
            sample = batch.samples[first + i]
            text = (
                f"key {sample.key!r}: the sample at {sample.time:.15g} s is late: one that is newer by the lateness "
                f"has come, or one of the same time"
            )
            taken.rejected.append(Rejected(first + i, text, True))


class _Batch:
    """Samples as arrays."""

    def __init__(self, samples: Sequence[Sample], columns: Sequence[str], *, masked: bool) -> None:
        self.samples = samples
        self.keys = np.array([sample.key for sample in samples])
        self.times = np.array([sample.time for sample in samples], np.float64)
        values = np.array([sample.values for sample in samples], np.float64).reshape(len(samples), -1)
        self.columns = {name: np.ascontiguousarray(values[:, i]) for i, name in enumerate(columns)}
        if masked:
            self.columns = {name: _without_nan(each) for name, each in self.columns.items()}


def _without_nan(values: NDArray[np.float64]) -> Any:
    """Return values of which those that are not there are masked."""
    absent = np.isnan(values)
    return np.ma.array(values, mask=absent) if absent.any() else values
