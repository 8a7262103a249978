"""Many monitors of one formula in discrete time: a record for each key in the compiled core.

The results are those of one :class:`Monitor` for each key, bit for bit.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.compiler.metadata import encoded
from rtamt.engine.discrete.backends import BACKENDS, SampleProgram
from rtamt.engine.discrete.reorder_buffer import ReorderBuffer
from rtamt.engine.fleet_keys import full, place_of, rows_of, sentence
from rtamt.engine.native import core
from rtamt.errors import EvaluationError, TraceError, UsageError, WaitedError, shown
from rtamt.language.undefined_value import at_sample, undefined
from rtamt.language.units.moments import time_text
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.signals import coding
from rtamt.signals.arrays import TIME, Timestamps, array, columns_of, number_expected, number_of
from rtamt.signals.coding import require_truths
from rtamt.signals.counting import refuse_implausible
from rtamt.signals.data_errors import nan_error, unknown_variable
from rtamt.signals.discrete import Discrete
from rtamt.signals.gaps import elements_of
from rtamt.signals.samples import read_time
from rtamt.signals.sampling_period import irregular

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.engine.discrete.monitor import Monitor
    from rtamt.engine.discrete.reorder_buffer import Ready
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray


class Known(NamedTuple):
    """The results of a batch, in its order; ``times``: of each value, NaN where none is known."""

    values: FloatArray
    known: NDArray[np.bool_]
    times: FloatArray
    warming: NDArray[np.bool_]


class DiscreteFleet:
    """Runs the program of a monitor for many keys.

    ``monitor``: of the core, without custom operators (see :func:`has_records`). ``restart``: whether a gap between
    samples begins a new trace of the key. ``identities``: what stands for the names of variables in the state, where
    their declarations decide what a number means. ``watched``: whether the outputs are the watched formulas alone.
    """

    def __init__(
        self,
        monitor: Monitor,
        capacity: int,
        *,
        identities: Mapping[str, str] = MappingProxyType({}),
        restart: bool = False,
        state: bytes | None = None,
        watched: bool = False,
    ) -> None:
        session = monitor._session
        if watched:
            domain = Discrete(monitor.period, monitor._tolerance)
            session = BACKENDS["cpp"].session(monitor._formulas[1:], monitor.input_names, domain)
        assert isinstance(session, SampleProgram)
        self._monitor, self._session = monitor, session
        program = session.program
        made_of = float(monitor.period), monitor._tolerance, restart, capacity
        try:
            self._names = [identities.get(name, name) for name in program.inputs]
            for name in self._names:
                encoded(name)  # the core takes UTF-8
            self._core = core().Fleet(program.code(), self._names, *made_of, state)
            if state is not None:
                self._core.keys()  # decodes texts
        except MemoryError:
            raise UsageError(
                f"a fleet for {capacity} keys needs more memory than this machine gives; lower the capacity"
            ) from None
        except UnicodeDecodeError:
            raise UsageError("this is not the state of a fleet: a key is no UTF-8") from None
        except ValueError as error:
            raise UsageError(sentence(error)) from None

    def take(
        self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]
    ) -> Sequence[Sequence[NDArray[Any]]] | None:
        """Take a batch that needs no conversion, in one call of the core; None for any other, which is not taken.

        Return the arrays of :class:`Known` of each output.
        """
        names = self._monitor.input_names
        if self._monitor._types or len(columns) != len(names):
            return None
        try:
            taken: Sequence[Any] | None = self._core.take(
                rows_of(keys), times, [columns.get(name) for name in names]
            )
        except ValueError as error:
            raise UsageError(sentence(error)) from None
        return taken

    def columns(
        self, keys: NDArray[Any], times: Any, columns: Mapping[str, Any]
    ) -> tuple[Timestamps, dict[str, FloatArray]]:
        """Return a batch as arrays; raise :class:`TraceError` for data that is not one."""
        monitor = self._monitor
        given = [times, *(columns.get(name) for name in monitor.input_names)]
        if not monitor._types and len(given) == len(columns) + 1 and all(map(_is_column, given)):
            refuse_implausible(times, TIME)
            if all(len(column) == len(times) for column in given):
                return Timestamps(times, times), dict(columns)
        for name in columns:
            if name not in monitor.input_names and name not in monitor._declared:
                raise unknown_variable(name, monitor.input_names)
        try:
            timestamps, found, _ = columns_of(
                {**columns, TIME: times}, monitor.input_names, None, monitor._types
            )
            if TIME in found and TIME in columns:  # a variable of this name
                found[TIME] = self._variable_called_time(columns[TIME], len(times))
        except TraceError as error:
            raise self._of_key(error, keys, {**columns, TIME: times}) from None
        assert timestamps is not None
        return timestamps, found

    def _variable_called_time(self, column: Any, samples: int) -> FloatArray:
        values = array(coding.encoded(column, TIME, self._monitor._types.get(TIME)), TIME)
        if len(values) != samples:
            raise TraceError(
                f"there are {samples} times and '{TIME}' has {len(values)} samples: give one value of each at every "
                f"sample",
                variable=TIME,
            )
        return values

    def _of_key(self, error: TraceError, keys: NDArray[Any], columns: Mapping[str, Any]) -> TraceError:
        """Return the error for a value of a batch with its key and index; the core has counted no sample yet."""
        index, name = error.index, error.variable or ""
        if index is None or index >= len(keys) or name not in columns or name in self._monitor._types:
            return error
        value = list(elements_of(columns[name]))[index]
        text = str(error)
        if number_of(value) is None:
            text = f"'{name}' is {shown(value)}, {number_expected(value)}"
        return TraceError(f"{place_of(keys[index].item(), index)}: {text}", variable=name, index=index)

    def check(
        self, keys: NDArray[Any], times: FloatArray, columns: Mapping[str, FloatArray], *, dated: bool = False
    ) -> None:
        """Raise :class:`TraceError` for a value that does not have its type; ``dated``: whether times are dates."""
        for name, type_ in self._monitor._types.items():
            require_truths(
                name,
                type_,
                np.where(np.isnan(columns[name]), 0.0, columns[name]),
                lambda i: (
                    f"index {i} of the batch, key {keys[i].item()!r}, time {time_text(times[i], dated=dated)}"
                ),
            )

    def update(
        self,
        keys: NDArray[Any],
        times: FloatArray,
        columns: Mapping[str, FloatArray],
        ready: Ready | None = None,
        *,
        dated: bool = False,
    ) -> list[Known]:
        """Take samples that :meth:`check` accepts; return what became known of each output.

        ``ready``: where they come from, if not from a batch of the caller. ``dated``: whether the caller's times are
        dates. Raises for wrong data, and nothing has changed.
        """
        n = len(times)
        made = [
            Known(np.empty(n), np.empty(n, np.bool_), np.empty(n), np.empty(n, np.bool_))
            for _ in self._session.program.outputs
        ]
        outputs = [(k.values, k.known.view(np.uint8), k.times, k.warming.view(np.uint8)) for k in made]
        given = [columns[name] for name in self._monitor.input_names]
        try:
            rejected = self._core.update(rows_of(keys), times, given, outputs)
        except ValueError as error:
            raise UsageError(sentence(error)) from None
        if rejected is not None:
            raise self._error(keys, times, rejected, ready, dated=dated)
        return made

    def _error(
        self, keys: NDArray[Any], times: FloatArray, rejected: Any, ready: Ready | None, *, dated: bool
    ) -> Exception:
        """Return the error for a batch that the core rejected: that of a monitor, with key and index."""
        index, reason, sample, last, instruction, moment = rejected
        came = index if ready is None else ready.sample(index)
        place = index if ready is None else ready.place(came)
        where = place_of(keys[index].item(), place)
        time = float(times[index])
        if reason == "full":
            return full(where, self.capacity)
        if reason == "undefined":
            failure = core().Undefined(instruction, sample)
            culprit = undefined(self._session.culprit(failure), at_sample(sample, moment, dated=dated))
            text = f"{where}: {culprit}"
            if place is not None:
                return EvaluationError(text)
            return WaitedError(text, keys[index].item(), float(times[came]))
        monitor = self._monitor
        error: Exception
        if reason == "value":
            error = nan_error(monitor.input_names[instruction], sample, time, dated=dated)
        elif reason == "gap":
            error = irregular(sample, time, time - last, monitor.period, monitor._tolerance, dated=dated)
            if place is None:
                error = TraceError(f"{error}; or drop the key")
        else:
            try:
                read_time(time, sample, last, dated=dated)
            except TraceError as wrong:
                error = wrong
        variable = monitor.input_names[instruction] if reason == "value" else "time"
        return TraceError(f"{where}: {error}", variable=variable, index=place, time=time)

    def reordering(self, lateness: float | None, filled: int, state: bytes | None) -> ReorderBuffer:
        """Return the buffer that orders samples by time; ``filled``: how many samples fill a gap."""
        monitor = self._monitor
        buffer = ReorderBuffer(
            self._names,
            monitor.input_names,
            lateness,
            self.capacity,
            (float(monitor.period), monitor._tolerance),
            filled,
            state,
        )
        buffer.follow(self._core.keys(), np.asarray(self._core.last_times()), new=state is None)
        return buffer

    @property
    def compiled(self) -> tuple[SampleProgram, Sequence[Formula]]:
        """The session of all records, and its formulas."""
        return self._session, self._session._formulas

    @property
    def capacity(self) -> int:
        """The largest number of keys."""
        return int(self._core.capacity)

    @property
    def memory(self) -> int:
        """Bytes of state by now."""
        return int(self._core.state_bytes)

    def __len__(self) -> int:
        return int(self._core.size)

    def contains(self, key: NDArray[Any]) -> bool:
        """Return whether the key in an array of one element exists."""
        return bool(self._core.contains(rows_of(key)))

    def keys(self) -> list[Any]:
        """Return all keys, in no particular order."""
        return list(self._core.keys())

    def drop(self, keys: NDArray[Any]) -> int | None:
        """Forget keys; return the index of the first that is not there, and forget none then."""
        missing: int | None = self._core.drop(rows_of(keys))
        return missing

    def expire(self, before: float) -> int:
        """Forget the keys whose last sample is before a time; return how many."""
        return int(self._core.expire(before))

    def snapshot(self) -> bytes:
        """Return the state of all keys."""
        return bytes(self._core.snapshot())


def _is_column(values: Any) -> bool:
    """Return whether the core can read values as they are."""
    return (
        values.__class__ is np.ndarray
        and values.ndim == 1
        and values.dtype == np.float64
        and values.flags.c_contiguous
        and values.flags.aligned
    )


def has_records(monitor: Any, *, watched: bool = False) -> bool:
    """Return whether a monitor, or its watched formulas, can run as a :class:`DiscreteFleet`."""
    session = getattr(monitor, "_session", None)
    return (
        isinstance(session, SampleProgram)
        and not session.calls
        and not session.program.worst_case
        and monitor._times.plain
        and monitor._episodes is None
        and (len(monitor._formulas) > 1) == watched
    )
