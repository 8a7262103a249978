"""Online: samples in, robustness out as soon as it is known; nothing is lost when an update fails."""

from __future__ import annotations

from fractions import Fraction
from math import isfinite, isnan
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.compiler.plan import compile_program
from rtamt.engine import python_backend
from rtamt.engine.gate import alone, in_use
from rtamt.engine.native import compiled, core, core_monitor, culprit
from rtamt.engine.online import OnlineMonitor, Watched, depth_of
from rtamt.errors import TraceError, UsageError, shown
from rtamt.language.undefined_value import at_sample, undefined
from rtamt.language.units import UNITS, check_unit
from rtamt.rewrite.check import check_online
from rtamt.rewrite.desugar import desugar
from rtamt.signals import arrays
from rtamt.signals.arrays import Stamps, plain
from rtamt.signals.counting import implausible, is_implausible
from rtamt.signals.discrete import DISCRETE, Discrete
from rtamt.signals.regular import (
    check_increasing,
    check_regular,
    irregular,
    not_increasing,
)
from rtamt.signals.signal import Signal

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.language.formula import Formula


#: How messages call what stamps are told in, by the kind of their dtype.
_KINDS = {"f": "seconds", "M": "datetimes", "m": "timedeltas"}
_NUMBERS = {"f": np.float64, "i": np.int64, "M": np.int64, "m": np.int64}


class Monitor(OnlineMonitor):
    """Watches one formula over a stream of samples in discrete time.

    Built by ``Specification.monitor``. Feed it with one of :meth:`update` (a sample by name),
    :meth:`step` (a sample by position, fastest) and :meth:`update_many` (a chunk), then
    :meth:`finish`. Values come in order, each exactly once: ρ at t as soon as the input has
    reached t + horizon.

    >>> import rtamt
    >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor(period=1)
    >>> [monitor.update(t, x=x) for t, x in enumerate([5.0, 4.0, 6.0])]
    [None, 1.0, 1.0]
    >>> monitor.finish()
    Signal(times=array([2.]), values=array([3.]))

    ``copy.copy`` branches a monitor: the copy has the same state and goes its own way. So does pickling.
    Give each thread a monitor of its own: one that threads share takes every sample whole, in some order, or
    raises :class:`UsageError`.
    """

    _remembered = ("_finished", "_news", "_told")

    def __init__(
        self,
        formula: Formula,
        domain: Discrete = DISCRETE,
        *,
        text: str | None = None,
        backend: str = "cpp",
        declared: Collection[str] = (),
        watch: Sequence[Watched] = (),
        factory: Callable[[], OnlineMonitor] | None = None,
        unit: str | None = None,
        requirements: Sequence[Formula] = (),  # noqa: ARG002 - in discrete time they start together
    ) -> None:
        domain = domain.online
        period = domain.period
        assert period is not None
        for watched in (Watched("", formula, text), *watch):
            domain.check(watched.formula, watched.text)
            check_online(watched.formula, watched.text)
        super().__init__(formula, watch, declared, factory)
        self._period = period
        self._tolerance = domain.tolerance
        self._depths = [depth_of(formula, period) for formula in self._formulas]
        self._lags = [int(depth / period) for depth in self._depths]
        self._oldest = max(self._lags)  # samples that may still have a value to come
        # What the last chunk made known, and how many samples there were then: after any other update
        # there are more.
        self._news: tuple[int, list[Signal]] = (0, [])
        self._unit = None if unit is None else check_unit(unit)
        # The stamps of the samples that may still have a value to come, and of the last one, where they are not
        # told in seconds; those in seconds the back end has.
        self._told: NDArray[Any] | None = None
        self._program = None
        if backend != "python":
            outputs = [desugar(formula) for formula in self._formulas]
            self._program = compile_program(outputs, period, self.input_names)
        self._connect(self._open())

    def _open(self) -> Any:
        if self._program is None:
            return python_backend.PythonMonitor(
                self._formulas, self.input_names, self._period, self._tolerance
            )
        return core_monitor(self._program, float(self._period), self._tolerance)

    def _connect(self, backend: Any) -> None:
        plain = self._unit is None and self._told is None
        self._backend = backend if plain else _Apart(backend)
        self._update = backend.update
        self._step = backend.step
        self._refused: Any = python_backend.Refused if self._program is None else core().Refused
        self._undefined: Any = () if self._program is None else core().Undefined

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known."""
        return float(self._depths[0])

    @property
    def period(self) -> Fraction:
        """Seconds from one sample to the next."""
        return self._period

    @property
    def samples(self) -> int:
        """How many samples the monitor has taken since the start or the last reset."""
        return int(self._backend.samples)

    @compiled("update")
    def update(self, time: float, /, **values: float) -> float | None:
        """Take one sample: ``time`` in seconds, or in ``time_unit=``, and a number for every variable.

        Returns ρ at ``time - horizon``; None until the horizon has passed. Raises
        :class:`TraceError` for wrong data and :class:`EvaluationError` where an operation has no
        value; the monitor is then as it was. A formula that reads ``req.value`` takes an object
        with that field as ``req=``, or the number as ``**{"req.value": 3}``.

        >>> import rtamt
        >>> monitor = rtamt.parse("(req >= 3) -> eventually[0:1](gnt >= 3)").monitor()
        >>> print(monitor.update(0.0, req=5, gnt=0), monitor.update(1.0, req=0, gnt=4))
        None 1.0
        """
        if self._unit is None and self._told is None:
            return self._take(time, values)
        return self._take_told(time, values)

    @alone
    def _take_told(self, time: Any, values: dict[str, Any]) -> float | None:
        """Take a sample whose time is not told in seconds."""
        stamp = self._stamps([time])
        robustness = self._take(float(stamp.seconds[0]), values)
        self._remember(stamp.told)
        return robustness

    def _take(self, time: Any, values: dict[str, Any]) -> float | None:
        try:
            return self._update(time, values)  # type: ignore[no-any-return]
        except self._refused:
            pass  # the long way takes it, or finds out what is wrong and says it
        except self._undefined as error:
            raise self._no_value(error) from None
        flat = self._read_by_formula(values)
        if self._finished:
            raise self._is_finished()
        stamp = read_time(time, self.samples, self._last_time)
        numbers = read_values(flat, self.input_names, self.samples, stamp)
        try:
            return self._update(stamp, numbers)  # type: ignore[no-any-return]
        except self._refused:
            raise self._refusal(stamp) from None
        except self._undefined as error:
            raise self._no_value(error) from None

    @compiled("step")
    def step(self, *values: float) -> float | None:
        """Take one sample by position, in the order of ``input_names``, one period after the last.

        Returns and raises as :meth:`update` does; for loops in which a microsecond counts.

        >>> import rtamt
        >>> monitor = rtamt.parse("once[0:1](x >= y)").monitor(period=0.1)
        >>> monitor.input_names
        ('x', 'y')
        >>> [monitor.step(5, 4), monitor.step(1, 4)]
        [1.0, 1.0]
        """
        if self._unit is None and self._told is None:
            return self._take_row(values)
        return self._take_row_told(values)

    @alone
    def _take_row_told(self, values: tuple[float, ...]) -> float | None:
        """Take a sample after those whose times are not told in seconds."""
        later = self._later(1)
        robustness = self._take_row(values)
        self._remember(later)
        return robustness

    def _take_row(self, values: tuple[float, ...]) -> float | None:
        try:
            return self._step(*values)  # type: ignore[no-any-return]
        except self._refused:
            pass
        except self._undefined as error:
            raise self._no_value(error) from None
        if len(values) != len(self.input_names):
            raise TraceError(
                f"sample {self.samples} has the wrong number of values: expected {len(self.input_names)} "
                f"({', '.join(self.input_names) or 'the formula reads no variable'}), got {len(values)}"
            )
        if self._finished:
            raise self._is_finished()
        named = dict(zip(self.input_names, values, strict=True))
        numbers = read_values(named, self.input_names, self.samples, self._next_time())
        try:
            return self._step(*numbers.values())  # type: ignore[no-any-return]
        except self._refused:
            raise self._refusal(self._next_time()) from None
        except self._undefined as error:
            raise self._no_value(error) from None

    @alone
    def update_many(self, data: Any) -> Signal:
        """Take a chunk of samples: a mapping (or frame) from variable to values, with ``"time"``.

        Returns what became known, a Signal of as many values. ``"time"`` may be left out; samples
        then follow one period after another. Raises as :meth:`update` does.

        >>> import rtamt
        >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor()
        >>> monitor.update_many({"time": [0, 1, 2], "x": [5, 4, 6]})
        Signal(times=array([0., 1.]), values=array([1., 1.]))
        """
        if self._finished:
            raise self._is_finished()
        return self.push(*arrays.columns_of(data, self.input_names, self._unit))

    def push(self, stamps: Stamps | None, given: Mapping[str, arrays.FloatArray], n: int) -> Signal:
        """Take a chunk of ``n`` samples as ``arrays.columns_of`` returns it; not for several threads."""
        samples = self.samples
        (times, told), columns = self._chunk(stamps, given, n)
        before = self._recent(min(self._oldest, samples))
        try:
            known = self._backend.push(times, columns, samples)
        except self._undefined as error:
            raise self._no_value(error) from None
        if self._unit is not None or self._told is not None or (len(told) and told is not times):
            self._remember(told)
        every = np.concatenate((before, told)) if len(before) else told
        news = []
        for lag, values in zip(self._lags, known, strict=True):
            first = len(before) - min(lag, samples)
            news.append(Signal(every[first : first + len(values)], values))
        self._news = samples + len(times), news
        return news[0]

    @alone
    def finish(self) -> Signal:
        """Say that no more samples will come; returns the values that were still unknown.

        >>> import rtamt
        >>> monitor = rtamt.parse("always[0:1](x >= 3)").monitor()
        >>> _ = monitor.update_many({"time": [0, 1, 2], "x": [5, 4, 6]})
        >>> monitor.finish()
        Signal(times=array([2.]), values=array([3.]))
        """
        if self._finished:
            return Signal(self._recent(0), np.empty(0))
        try:
            known = self._backend.finish()
        except self._undefined as error:
            raise self._no_value(error) from None
        self._finished = True
        news = [Signal(self._recent(len(values)), values) for values in known]
        self._news = self.samples, news
        return news[0]

    def __getitem__(self, name: str) -> float | Signal | None:
        """Return what the last update made known of a formula that is watched (see ``Specification.monitor``).

        ``name``: as given to ``watch=``. After :meth:`update` and :meth:`step` the value at the time of
        the sample less the formula's own horizon, None before that; after :meth:`update_many` and
        :meth:`finish` a Signal. Raises :class:`UsageError` for what is not watched.

        >>> import rtamt
        >>> monitor = rtamt.parse("eventually[0:1](x >= 3)").monitor(watch=["x >= 3"])
        >>> print(monitor.update(0.0, x=1), monitor["x >= 3"])
        None -2.0
        """
        output = self._output(name)
        samples, news = self._news
        if news and samples == self.samples:
            return news[output]
        return self._backend.latest(output)  # type: ignore[no-any-return]

    @alone
    def reset(self) -> None:
        """Forget the trace; the next sample is the first.

        >>> import rtamt
        >>> monitor = rtamt.parse("once(x >= 3)").monitor()
        >>> monitor.update(0.0, x=9)
        6.0
        >>> monitor.reset()
        >>> monitor.update(0.0, x=1)
        -2.0
        """
        self._backend.reset()
        self._finished = False
        self._news = (0, [])
        if self._told is not None:
            self._told = None
            self._connect(self._backend.inner)

    @property
    def _last_time(self) -> float | None:
        return self._backend.last_time  # type: ignore[no-any-return]

    def _next_time(self) -> float:
        last = self._last_time
        return 0.0 if last is None else last + float(self._period)

    # ---- stamps that are not told in seconds -----------------------------------------------------

    def _stamps(self, times: Any) -> Stamps:
        """Return times that the caller gave; raise :class:`TraceError` where they are not of the kind of the first."""
        stamps = arrays.stamps(times, self._unit)
        self._require_alike(stamps)
        return stamps

    def _require_alike(self, stamps: Stamps) -> None:
        if self._unit is None and self.samples:
            before = "f" if self._told is None else self._told.dtype.kind
            if stamps.told.dtype.kind != before:
                raise TraceError(
                    f"'{arrays.TIME}' is told in {_KINDS[stamps.told.dtype.kind]} at sample {self.samples}, but before "
                    f"in {_KINDS[before]}: use one of them for all",
                    variable=arrays.TIME,
                    index=self.samples,
                )

    def _remember(self, told: NDArray[Any]) -> None:
        first = self._told is None
        whole = told if self._told is None else np.concatenate((self._told, told))
        self._told = whole[-self._oldest - 1 :].copy()
        if first:
            self._connect(getattr(self._backend, "inner", self._backend))

    def _recent(self, count: int) -> NDArray[Any]:
        """Return the stamps of the last samples, as the caller tells time."""
        if self._told is not None:
            return self._told[len(self._told) - count :]
        return np.array(self._backend.recent(count)) if count or self._unit is None else np.empty(0, np.int64)

    def _later(self, count: int) -> NDArray[Any]:
        """Return the stamps of samples that come one period after another, as the caller tells time."""
        if self._told is None or not len(self._told):
            start, dtype = Fraction(0), np.dtype(np.int64)
        else:
            start, dtype = (
                Fraction(plain(self._told[-1:].view(_NUMBERS[self._told.dtype.kind])[0])),
                self._told.dtype,
            )
            start += self._step_in_unit(dtype)
        stamps = [start + i * self._step_in_unit(dtype) for i in range(count)]
        if dtype.kind in "mM":
            return np.array([round(stamp) for stamp in stamps], np.int64).view(dtype)
        if dtype.kind == "i" and all(stamp.denominator == 1 for stamp in stamps):
            return np.array([int(stamp) for stamp in stamps], np.int64)
        return np.array([float(stamp) for stamp in stamps])

    def _step_in_unit(self, dtype: np.dtype[Any]) -> Fraction:
        return self._period / UNITS["ns" if dtype.kind in "mM" else self._unit or "s"]

    # ---- what goes wrong -------------------------------------------------------------------------

    def _chunk(
        self, stamps: Stamps | None, columns: Mapping[str, arrays.FloatArray], n: int
    ) -> tuple[Stamps, list[arrays.FloatArray]]:
        last = self._last_time
        if stamps is None:
            times = np.array(self._next_time() + float(self._period) * np.arange(n), dtype=np.float64)
            stamps = Stamps(times, times if self._unit is None and self._told is None else self._later(n))
        elif n:
            self._require_alike(stamps)
        else:
            stamps = Stamps(stamps.seconds, self._recent(0))
        times = stamps.seconds
        check_increasing(times, last, self.samples)
        check_regular(times, self._period, self._tolerance, last, self.samples)
        for name, column in columns.items():
            arrays.check_numbers(name, column, times, self.samples)
        return stamps, [columns[name] for name in self.input_names]

    def _is_finished(self) -> UsageError:
        return UsageError("the monitor has finished its trace; call reset() before the next sample")

    def _refusal(self, time: float) -> Exception:
        """Find out why the back end took no sample of numbers at this time, and say it."""
        if self._finished:
            return self._is_finished()
        index, last = self.samples, self._last_time
        read_time(time, index, last)
        period = float(self._period)
        if last is None or abs(time - last - period) <= self._tolerance * period:
            return in_use()  # what was wrong is so no more
        return irregular(index, time, last, self._period, self._tolerance)

    def _no_value(self, error: Any) -> Exception:
        """Name the sub-formula and the instant of a value that does not exist."""
        assert self._program is not None
        formula = culprit(error, self._program, self._formulas)
        return undefined(formula, at_sample(error.args[1], error.time))


class _Apart:
    """A back end that the quick way in does not see: the times of its samples have to be read first."""

    def __init__(self, inner: Any) -> None:
        self.inner = inner

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)


def read_time(time: Any, index: int, last: float | None, *, again: bool = False) -> float:
    """Return a sample's time stamp; raise :class:`TraceError` for one that no sample can have.

    ``again``: whether it may be the same as the ``last`` one.
    """
    stamp = arrays.number_of(time)
    if stamp is None:
        raise TraceError(
            f"time is {shown(time)} at sample {index}, expected a number of seconds", variable="time"
        )
    if is_implausible(stamp):
        raise implausible("time", index, time if is_implausible(time) else stamp)
    if not isfinite(stamp):
        raise TraceError(f"time is {stamp} at sample {index}: give a finite number of seconds")
    if last is not None and (stamp < last or (stamp == last and not again)):
        raise not_increasing(index, stamp, last)
    return stamp


def read_values(
    values: Mapping[str, Any], names: tuple[str, ...], index: int, time: float
) -> dict[str, float]:
    """Return a sample's values in the order of the names, each read once; raise :class:`TraceError`."""
    for name in values:
        if name not in names:
            raise arrays.unknown_variable(name, names)
    numbers = {}
    for name in names:
        if name not in values:
            raise arrays.missing_variable(name, tuple(values))
        number = arrays.number_of(values[name])
        if number is None:
            raise TraceError(
                f"'{name}' is {shown(values[name])} at sample {index}, expected a number",
                variable=name,
                index=index,
            )
        if isnan(number):
            raise arrays.nan_error(name, index, time)
        numbers[name] = number
    return numbers
