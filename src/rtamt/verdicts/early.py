"""Online in discrete time: what the monitors of verdicts (``eager.py``) and of bounds (``interval.py``) share.

Both run the same graph (``compiler/early.py``) in the core.
"""

from __future__ import annotations

from math import inf, isfinite, isnan
from typing import TYPE_CHECKING, Any, ClassVar

from rtamt.compiler.early import compile_graph
from rtamt.engine.backend import Session
from rtamt.engine.discrete.apart import Apart
from rtamt.engine.discrete.early_python_backend import PythonEarlyMonitor
from rtamt.engine.gate import alone
from rtamt.engine.native import EarlyMonitorBase, core
from rtamt.engine.online import OnlineMonitor, Watched
from rtamt.errors import TraceError, UsageError, did_you_mean, shown
from rtamt.language.undefined_value import at_sample, undefined
from rtamt.language.units import check_unit
from rtamt.rewrite.desugar import desugar, written
from rtamt.signals import arrays
from rtamt.signals.outcomes import Interval
from rtamt.signals.regular import irregular, not_increasing
from rtamt.verdicts.caller_clock import CallerClock, Stamp

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.early import Graph
    from rtamt.language.formula import Formula
    from rtamt.signals.domain_interface import TimeDomain


class GraphSession(Session):
    """A graph that monitors of the core run; see ``_core.EarlyMonitor`` for the other arguments."""

    def __init__(self, graph: Graph, *settings: Any) -> None:
        self._graph = graph
        self._settings = settings
        self.refused = core().Refused
        self.undefined = (core().Undefined,)

    def open(self) -> Any:
        """See :class:`Session`."""
        return core().EarlyMonitor(*self._settings)

    @property
    def fingerprint(self) -> bytes:
        """See :class:`Session`."""
        return self._graph.fingerprint()


class GraphDefinition(Session):
    """Formulas that are evaluated by definition; see ``PythonEarlyMonitor`` for the other arguments."""

    def __init__(self, graph: Graph, *settings: Any) -> None:
        self._graph = graph
        self._settings = settings

    def open(self) -> PythonEarlyMonitor:
        """See :class:`Session`."""
        return PythonEarlyMonitor(*self._settings)

    @property
    def fingerprint(self) -> bytes:
        """See :class:`Session`."""
        return self._graph.fingerprint()


class EarlyMonitor(EarlyMonitorBase, OnlineMonitor):
    """What both monitors of discrete time share. Not instantiated by users."""

    _remembered: ClassVar[tuple[str, ...]] = ("_finished", "_clock")
    _base = EarlyMonitorBase
    #: The class of what update() returns, None for bounds.
    _verdict: type | None

    def __init__(
        self,
        formula: Formula,
        domain: TimeDomain,
        *,
        text: str | None = None,
        backend: str = "cpp",
        declared: Collection[str] = (),
        watch: Sequence[Watched] = (),
        factory: Callable[[], OnlineMonitor] | None = None,
        ranges: Mapping[str, Any] | None = None,
        start: bool = False,
        every: bool = True,
        unit: str | None = None,
    ) -> None:
        for watched in (Watched("", formula, text), *watch):
            domain.check(watched.formula, watched.text)
        period = domain.period
        assert period is not None
        OnlineMonitor.__init__(self, formula, watch, declared, factory)
        self._backend_name = backend
        self._period = period
        self._tolerance = domain.tolerance
        self._ranges = self._read_ranges(ranges or {})
        cores = [desugar(each) for each in self._formulas]
        self._graph = compile_graph(cores, period, self.input_names, start=start)
        # A formula that is asked for at the start alone is no output.
        self._hidden = 0 if every else 1
        self._outputs = self._graph.outputs[self._hidden :]
        self._clock = CallerClock(None if unit is None else check_unit(unit), period)

    def _prepare(self) -> None:
        """Open the first monitor of the back end."""
        if self._backend_name == "python":
            self._session = GraphDefinition(
                self._graph,
                self._formulas,
                self._hidden,
                self._known_ranges(),
                self.input_names,
                self._period,
                self._tolerance,
                self._late,
                self._verdict,
            )
        else:
            self._session = self._compiled()
        self._connect(self._session.open())

    def _compiled(self) -> GraphSession:
        return GraphSession(
            self._graph,
            self._graph.nodes,
            self._outputs,
            self._graph.items,
            self._known_ranges(),
            list(self.input_names),
            self._unread,
            float(self._period),
            self._tolerance,
            self._late,
            self._verdict,
            self._replays,
        )

    def _connect(self, backend: Any) -> None:
        self._backend = backend if self._clock.plain else Apart(backend)
        self._refused = self._session.refused
        self._undefined: Any = self._session.undefined

    def _resume(self, state: tuple[Any, ...]) -> None:
        super()._resume(state)
        self._clock = self._clock.copied()

    #: By how many samples at most a sample may be late; None where all come in order.
    _late: int | None = None
    #: Whether samples may correct earlier ones.
    _replays = False

    def _read_ranges(self, ranges: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
        read = {}
        for name, given in ranges.items():
            if name not in self.input_names and name not in self._declared:
                raise UsageError(
                    f"ranges has '{name}', which the formula does not read{did_you_mean(name, self.input_names)}"
                )
            bounds = bounds_of(given)
            if bounds is None or isnan(bounds[0]) or isnan(bounds[1]):
                raise UsageError(f"the range of '{name}' is {shown(given)}; give (lower, upper), two numbers")
            if bounds[0] > bounds[1]:
                raise UsageError(f"the range of '{name}' is {shown(given)}, reversed; give (lower, upper)")
            read[name] = bounds
        return read

    def _known_ranges(self) -> list[tuple[float, float]]:
        return [self._ranges.get(name, (-inf, inf)) for name in self.input_names]

    @property
    def period(self) -> Fraction:
        """Seconds from one sample to the next."""
        return self._period

    @property
    def samples(self) -> int:
        """How many samples the monitor has taken since the start or the last reset."""
        return int(self._backend.samples)

    @alone
    def reset(self) -> None:
        """Forget the trace; the next sample is the first."""
        self._finished = False
        self._clock = self._clock.cleared()
        self._connect(self._session.open())

    # ---- samples ---------------------------------------------------------------------------------

    @property
    def _count(self) -> int:
        """How many samples came, also if they are not in the back end yet."""
        return self.samples

    def _stamp(self, time: Any) -> Stamp:
        """Return a time in seconds and as it was given; raise :class:`TraceError` for what is none."""
        stamp = self._clock.read(time, self._count)
        if stamp is None:
            return Stamp(self._number(time))
        return Stamp(self._number(stamp.seconds), stamp.original)

    def _seconds(self, time: Any) -> float:
        return self._stamp(time).seconds

    def _remember(self, stamp: Stamp, *, begun: bool = True) -> None:
        """Remember the time of a sample that the back end has taken, if it was not given in seconds."""
        if stamp.original is None:
            return
        plain = self._clock.plain
        self._clock.take(stamp, begun=begun)
        if plain != self._clock.plain:
            self._connect(self._backend)
        if self._clock.full and begun:
            self._clock.forget(self._backend.earliest)

    def _number(self, time: Any) -> float:
        number = arrays.number_of(time)
        if number is None:
            raise TraceError(
                f"time is {shown(time)} at sample {self.samples}, expected a number of seconds",
                variable=arrays.TIME,
            )
        if not isfinite(number):
            raise TraceError(f"time is {number} at sample {self.samples}: give a finite number of seconds")
        return number

    def _bounds_of(
        self, values: Mapping[str, Any], index: int, time: float
    ) -> dict[str, tuple[float, float] | None]:
        """Return what a sample makes known, None where it is missing; raise :class:`TraceError` for wrong data."""
        read: dict[str, tuple[float, float] | None] = {}
        for name in values:
            if name not in self.input_names:
                raise arrays.unknown_variable(name, self.input_names)
        for name in self.input_names:
            if name not in values:
                if self._late is None:
                    raise arrays.missing_variable(name, tuple(values))
                continue
            given = values[name]
            where = f"sample {index}, time {time:.15g} s"
            if given is None:
                read[name] = None
                continue
            bounds = bounds_of(given)
            if bounds is None:
                raise TraceError(
                    f"'{name}' is {shown(given)} at {where}; expected a number, bounds (lower, upper), or None "
                    f"if it is missing",
                    variable=name,
                    index=index,
                )
            if isnan(bounds[0]) or isnan(bounds[1]):
                raise arrays.nan_error(name, index, time)
            if bounds[0] > bounds[1]:
                raise TraceError(
                    f"'{name}' is {shown(given)} at {where}, reversed: give the lower bound first",
                    variable=name,
                    index=index,
                )
            low, high = self._ranges.get(name, (-inf, inf))
            if not (low <= bounds[0] and bounds[1] <= high):
                raise TraceError(
                    f"'{name}' is {shown(given)} at {where}, outside its declared range [{low:g}, {high:g}]: "
                    f"correct the value, or declare a wider range",
                    variable=name,
                    index=index,
                )
            read[name] = bounds
        return read

    def _row(self, known: Mapping[str, tuple[float, float] | None]) -> tuple[list[float], list[float]]:
        """Return the lower and the upper bounds of every variable at a sample."""
        ranges = zip(self.input_names, self._known_ranges(), strict=True)
        row = [known.get(name) or bounds for name, bounds in ranges]
        return [low for low, _ in row], [high for _, high in row]

    def _check_order(self, time: float) -> None:
        """Raise the error for a time at which no sample of an ordered trace can come."""
        backend = self._backend
        if backend.newest < 0:
            return
        last = backend.time(backend.newest)
        if time <= last:
            raise not_increasing(self.samples, time, last)
        place = backend.place(time)
        if place is None or (place != backend.newest + 1 and place - 1 > backend.closed):
            raise irregular(self.samples, time, last, self._period, self._tolerance)

    def _is_finished(self) -> UsageError:
        return UsageError("the monitor has finished its trace; call reset() before the next sample")

    def _no_value(self, error: Any) -> Exception:
        """Name the sub-formula and the instant of a value that does not exist."""
        formula = written(self._graph.origins[error.args[0]], self._formulas)
        return undefined(formula, at_sample(error.args[1], error.time))


def bounds_of(value: Any) -> tuple[float, float] | None:
    """Return what a number, an :class:`Interval` or a pair of numbers says; None for anything else."""
    if isinstance(value, Interval):
        value = (value.lower, value.upper)
    if isinstance(value, tuple | list):
        if len(value) != 2:
            return None
        low, high = (arrays.number_of(end) for end in value)
        return None if low is None or high is None else (low, high)
    number = arrays.number_of(value)
    return None if number is None else (number, number)
