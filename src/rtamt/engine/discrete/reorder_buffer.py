"""Samples of many keys that arrive in any order, put in the order of their times."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.engine.fleet_keys import full, place_of, rows_of, sentence
from rtamt.engine.native import core
from rtamt.errors import TraceError, UsageError
from rtamt.language.units.moments import time_text
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals.data_errors import NAN_MEND

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.signals.arrays import FloatArray


class Ready(NamedTuple):
    """Samples that have waited long enough, those of each key in the order of their times.

    ``places``: of each sample in the batch where it is ``own``, and else of a sample of the same key; without a batch,
    the place of the key. ``fills``: whether it fills the gap before the next one that does not.
    """

    places: NDArray[np.int64]
    own: NDArray[np.bool_]
    fills: NDArray[np.bool_]
    times: FloatArray
    columns: dict[str, FloatArray]

    def place(self, index: int) -> int | None:
        """Return where a sample is in the batch, None if it is not."""
        return int(self.places[index]) if self.own[index] else None

    def sample(self, index: int) -> int:
        """Return the index of a sample that came: this one, or the one after the gap that this one fills."""
        while self.fills[index]:
            index += 1
        return index


class ReorderBuffer:
    """A reorder buffer for each key, in the core.

    ``names``: what stands for the variables in a state. ``lateness``: in seconds; None if samples have to arrive in
    order. ``regular``: the sampling period and its tolerance. ``filled``: how many values are held in a gap.
    """

    def __init__(
        self,
        names: Sequence[str],
        inputs: Sequence[str],
        lateness: float | None,
        capacity: int,
        regular: tuple[float, float],
        filled: int,
        state: bytes | None,
    ) -> None:
        self._inputs, self._filled, self._capacity = tuple(inputs), filled, capacity
        self._made_of = list(names), lateness, capacity, *regular, filled
        try:
            self._core = core().ReorderBuffer(*self._made_of, state)
            if state is not None:
                self._core.keys()  # decodes texts
        except UnicodeDecodeError:
            raise UsageError("this is not the state of a fleet: a key is no UTF-8") from None
        except ValueError as error:
            raise UsageError(sentence(error)) from None

    def follow(self, keys: list[Any], times: FloatArray, *, new: bool) -> None:
        """Go on after the last samples of keys; raise :class:`UsageError` for a state with other keys.

        ``new``: whether the buffer knows of no key yet.
        """
        if new and keys:
            names, _, *others, _ = self._made_of
            start = core().ReorderBuffer(names, 0.0, *others, 0)
            nothing = [np.zeros(len(keys)) for _ in names]
            rejected = start.offer(rows_of(np.asarray(keys)), times, nothing, np.zeros(len(keys), np.uint8))
            assert rejected is None, "a fleet has room for its keys"
            start.accept()
            self._core = core().ReorderBuffer(*self._made_of, start.snapshot())
        own = self._core.keys()
        left = self._core.left(rows_of(np.asarray(own))) if own else []
        if sorted(key for key, gone in zip(own, left, strict=True) if gone) != sorted(keys):
            raise UsageError("this is not the state of a fleet: what waits is of other keys")

    def offer(
        self, keys: NDArray[Any], times: FloatArray, columns: Mapping[str, FloatArray], *, dated: bool
    ) -> tuple[NDArray[np.bool_], Ready]:
        """Take a batch; return which samples are late, and what has waited long enough.

        ``dated``: whether the caller's times are dates. Raises for wrong data, and nothing has changed. Otherwise call
        :meth:`accept` or :meth:`withdraw` next.
        """
        late = np.zeros(len(times), np.bool_)
        given = [columns[name] for name in self._inputs]
        try:
            rejected = self._core.offer(rows_of(keys), times, given, late.view(np.uint8))
        except ValueError as error:
            raise UsageError(sentence(error)) from None
        if rejected is not None:
            raise self._error(keys[rejected[0]].item(), times, rejected, dated=dated)
        return late, self._ready()

    def advance(self, watermark: float, *, dated: bool) -> tuple[list[Any], Ready]:
        """Set the watermark of all keys; return what has waited long enough, and its keys. Then as :meth:`offer`."""
        return self._without_samples(self._core.advance(watermark), dated=dated)

    def release(self, keys: NDArray[Any], *, dated: bool) -> tuple[list[Any], Ready]:
        """Let all leave that waits of some keys, as if their watermarks had reached it. Then as :meth:`offer`."""
        return self._without_samples(self._core.release(rows_of(keys)), dated=dated)

    def _without_samples(self, rejected: Any, *, dated: bool) -> tuple[list[Any], Ready]:
        if rejected is not None:
            (key,) = self._core.keys_at(np.array([rejected[0]]))
            raise TraceError(f"{place_of(key, None)}: {self._long_gap(rejected, dated=dated)}")
        ready = self._ready()
        return self._core.keys_at(ready.places), ready

    def _ready(self) -> Ready:
        places, own, fills, times, columns = self._core.ready()
        given = dict(zip(self._inputs, columns, strict=True))
        return Ready(places, own.view(np.bool_), fills.view(np.bool_), times, given)

    def accept(self) -> None:
        """Keep the batch that was offered."""
        self._core.accept()

    def withdraw(self) -> None:
        """Forget the batch that was offered."""
        self._core.withdraw()

    def _error(self, key: Any, times: FloatArray, rejected: Any, *, dated: bool) -> Exception:
        index, reason, _, last, number, _ = rejected
        where, time = place_of(key, index), float(times[index])
        if reason == "full":
            return full(where, self._capacity)
        if reason == "value":
            name = self._inputs[number]
            text = f"'{name}' is NaN at {time_text(time, dated=dated)}: {NAN_MEND}"
            return TraceError(f"{where}: {text}", variable=name, index=index, time=time)
        if reason == "gap":
            text = self._long_gap(rejected, dated=dated)
        elif last is None:
            text = f"time is {time:.15g}: give a finite number of seconds"
        else:
            now, then = time_text(time, dated=dated), time_text(last, dated=dated)
            text = (
                f"time does not increase: {now} comes after {then}; sort the samples and drop repeated "
                f"timestamps, or allow for lateness"
            )
        return TraceError(f"{where}: {text}", variable="time", index=index, time=time)

    def _long_gap(self, rejected: Any, *, dated: bool) -> str:
        last, time = (time_text(seconds, dated=dated) for seconds in (rejected[3], rejected[5]))
        return (
            f"the gap from {last} to {time} is longer than the {self._filled} samples for which a value "
            f"is held; drop the key, or choose gaps='restart'"
        )

    # ---- keys and state --------------------------------------------------------------------------

    def __len__(self) -> int:
        return int(self._core.size)

    @property
    def waiting(self) -> int:
        """The number of waiting samples."""
        return int(self._core.waiting)

    @property
    def late(self) -> int:
        """The number of late samples."""
        return int(self._core.late)

    @property
    def memory(self) -> int:
        """Bytes by now."""
        return int(self._core.state_bytes)

    def contains(self, key: NDArray[Any]) -> bool:
        """Return whether the key in an array of one element exists."""
        return bool(self._core.contains(rows_of(key)))

    def keys(self) -> list[Any]:
        """Return all keys, in no particular order."""
        return list(self._core.keys())

    def left(self, keys: NDArray[Any]) -> NDArray[np.bool_]:
        """Return the keys with samples that have waited long enough."""
        found: NDArray[np.bool_] = self._core.left(rows_of(keys)).view(np.bool_)
        return found

    def drop(self, keys: NDArray[Any]) -> int | None:
        """Forget keys; return the index of the first that is not there, and forget none then."""
        missing: int | None = self._core.drop(rows_of(keys))
        return missing

    def discard(self, key: NDArray[Any], time: float) -> bool:
        """Forget the sample of a time that waits, of the key of an array of one; return whether there was one."""
        return bool(self._core.discard(rows_of(key), time))

    def stale(self, before: float) -> list[Any]:
        """Return the keys whose newest sample is before a time."""
        return list(self._core.stale(before))

    def snapshot(self) -> bytes:
        """Return the waiting samples as bytes."""
        return bytes(self._core.snapshot())
