"""One shard of a stream: a fleet that takes any samples, and rejects those that are wrong one by one.

What a sample leads to depends on the earlier samples of the shard alone, not on how they come in batches: a stream
that is read again from a snapshot has the same results.
"""

from __future__ import annotations

import json
from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError, StlError, TraceError, UsageError, WaitedError
from rtamt.fleet.fleet import Fleet
from rtamt.lazy_dataclasses import dataclass, field
from rtamt.lazy_numpy import np
from rtamt.lazy_tuples import NamedTuple
from rtamt.signals.counting import is_implausible

if TYPE_CHECKING:
    from collections.abc import Sequence

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
    """A sample of one key; ``values``: in the order of :attr:`Shard.names`."""

    key: str
    time: float
    values: tuple[float, ...]


class Result(NamedTuple):
    """A robustness that has become known; ``time``: the time that it is for."""

    key: str
    time: float
    robustness: float

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
    """What a batch has led to: results and rejected samples, each in the order of the batch, and discarded ones."""

    results: list[Result] = field(default_factory=list)
    rejected: list[Rejected] = field(default_factory=list)
    discarded: list[Discarded] = field(default_factory=list)


class Shard:
    """The monitors of all keys of a shard.

    ``state``: what :meth:`snapshot` returned, perhaps for another specification. A gap between two samples of a key
    restarts its trace. ``lateness``: how late a sample may arrive (:class:`rtamt.Fleet`); by default those of a key
    come in the order of their times. A sample that has waited and turns out to have no value is discarded, as if it had
    not come.
    ``settings``: those of ``Specification.monitor``.

    >>> import rtamt
    >>> shard = Shard(rtamt.parse("x >= 3"))
    >>> taken = shard.take([Sample("car-1", 0.0, (5.0,)), Sample("car-1", -1.0, (5.0,)), Sample("car-2", 7.0, (1.0,))])
    >>> taken.results
    [Result(key='car-1', time=0.0, robustness=2.0), Result(key='car-2', time=7.0, robustness=-2.0)]
    >>> [(each.position, each.late) for each in taken.rejected]
    [(1, True)]
    """

    def __init__(
        self,
        spec: Specification,
        *,
        capacity: int = CAPACITY,
        state: bytes | None = None,
        lateness: Duration | None = None,
        **settings: Any,
    ) -> None:
        self._waits = lateness is not None
        self.names = tuple(spec.input_names)
        #: The recorded names of the variables.
        self.columns = tuple(dict(spec.binding.columns).get(name, name) for name in self.names)
        if state is None:
            self._fleet = Fleet(spec, capacity, lateness=lateness, gaps="restart", **settings)
        else:
            self._fleet = Fleet.restore(
                spec, state, capacity=capacity, lateness=lateness, gaps="restart", **settings
            )

    def __len__(self) -> int:
        return len(self._fleet)

    def snapshot(self) -> bytes:
        """Return the state of all keys."""
        return self._fleet.snapshot()

    def take(self, samples: Sequence[Sample]) -> Taken:
        """Take samples of any keys; those of one key in the order in which they came."""
        taken = Taken()
        if not samples:
            return taken
        batch = _Batch(samples, self.columns)
        if self._update(batch, 0, len(samples), taken) is None:
            return taken
        waiting = [(first, min(first + _CHUNK, len(samples))) for first in range(0, len(samples), _CHUNK)]
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
                if isinstance(error, WaitedError) and self._fleet.discard(error.key, error.time):
                    taken.discarded.append(Discarded(error.key, error.time, error.reason))
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
        return taken

    def _update(self, batch: _Batch, first: int, end: int, taken: Taken) -> StlError | None:
        """Take a part of a batch; return why it was rejected as a whole, if it was."""
        columns = {name: column[first:end] for name, column in batch.columns.items()}
        try:
            update = self._fleet.update_many(batch.keys[first:end], batch.times[first:end], columns)
        except (TraceError, EvaluationError, UsageError) as error:
            return error
        known = np.flatnonzero(update.known)
        for i, time, value in zip(
            known.tolist(), update.times[known].tolist(), update.values[known].tolist(), strict=True
        ):
            taken.results.append(Result(batch.samples[first + i].key, time, value))
        if self._waits:
            self._released(batch, first, update, taken)
        return None

    def _released(self, batch: _Batch, first: int, update: FleetUpdate, taken: Taken) -> None:
        """Note what samples have made known that waited, in the order of their times, and which came too late."""
        out = update.released
        for key, time, value in zip(out.keys.tolist(), out.times.tolist(), out.values.tolist(), strict=True):
            taken.results.append(Result(key, time, value))
        taken.results.sort(key=lambda result: result.time)
        for i in np.flatnonzero(update.late).tolist():
            sample = batch.samples[first + i]
            text = (
                f"key {sample.key!r}: the sample at {sample.time:.15g} s is late: one that is newer by the lateness "
                f"has come, or one of the same time"
            )
            taken.rejected.append(Rejected(first + i, text, True))


class _Batch:
    """Samples as arrays."""

    def __init__(self, samples: Sequence[Sample], columns: Sequence[str]) -> None:
        self.samples = samples
        self.keys = np.array([sample.key for sample in samples])
        self.times = np.array([sample.time for sample in samples], np.float64)
        values = np.array([sample.values for sample in samples], np.float64).reshape(len(samples), -1)
        self.columns = {name: np.ascontiguousarray(values[:, i]) for i, name in enumerate(columns)}
