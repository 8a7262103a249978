"""Online before the horizon: what the monitors of verdicts and of bounds share in all time domains and back ends.

The back end of a specification answers one query of the monitor, see :class:`rtamt.engine.early.EarlyQuery`.
"""

from __future__ import annotations

from abc import abstractmethod
from functools import partial
from math import inf, isnan
from typing import TYPE_CHECKING, Any

from rtamt.engine import OnlineMonitor, SlowPath, Watched, engine_of, grounded, inner_of
from rtamt.engine.early import EarlyQuery
from rtamt.engine.native import EarlyMonitorBase
from rtamt.errors import TraceError, UsageError, did_you_mean, shown
from rtamt.language.value_types import BOOLEAN
from rtamt.rewrite.presence import channel_of, presences, tracked
from rtamt.signals import arrays
from rtamt.signals.coding import encoded_value, no_truth
from rtamt.signals.outcomes import Interval
from rtamt.usage_guard import exclusive
from rtamt.verdicts.early.evidence import Evidence, span_of

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from rtamt.engine.early import EarlySession
    from rtamt.language.formula import Formula
    from rtamt.signals.outcomes import Cause, Verdict, VerdictRun
    from rtamt.signals.time_domain_interface import TimeDomain


class EarlyMonitor(OnlineMonitor):
    """The base of the monitors of verdicts and of bounds. Not instantiated by users."""

    _base = EarlyMonitorBase
    _session: EarlySession

    #: Whether verdicts are reported; else bounds.
    _reports_verdicts = False
    #: Whether causation is reported.
    _reports_causes = False
    #: The conjuncts of the formula, where each has its own trace.
    _requirements: tuple[Formula, ...] = ()
    #: The greatest lateness of a sample in steps; None if all arrive in order.
    _late: int | None = None
    #: Whether samples may correct earlier ones.
    _replays = False
    #: The samples that may decide a verdict; None if they are not needed.
    _evidence: Evidence | None = None

    def __init__(
        self,
        formula: Formula,
        domain: TimeDomain,
        *,
        text: str | None = None,
        backend: str = "cpp",
        declared: Collection[str] = (),
        watch: Sequence[Watched] = (),
        factory: Callable[..., OnlineMonitor] | None = None,
        ranges: Mapping[str, Any] | None = None,
        start: bool = False,
        every: bool = True,
        explain: bool = False,
    ) -> None:
        formula, watch = grounded(domain, formula, text, watch)
        step = domain.step
        assert step is not None
        OnlineMonitor.__init__(self, formula, watch, declared, factory)
        self._chosen = engine_of(domain).backends[backend]
        self._domain, self._step = domain, step
        self._explained, self._continuous = explain, domain.continuous
        self._ranges = self._read_ranges(ranges or {})
        asked = presences(*self._formulas)
        self._channels = {name: channel_of(name) for name in asked}
        self._ranges |= dict.fromkeys(self._channels.values(), (0.0, 1.0))
        self._formulas = tuple(map(tracked, self._formulas))
        #: The variables and the channels of their presence, which is what the back end reads.
        self._inputs = (*self.input_names, *self._channels.values())
        # A formula that is requested only at the start is not an output.
        self._hidden, self._at_start = 0 if every else 1, start

    def _prepare(self) -> None:
        """Ask the back end for a session, and open its first monitor."""
        self._session = self._chosen.early_session(self._query(), self._domain)
        self._connect(self._session.open())

    def _query(self) -> EarlyQuery:
        return EarlyQuery(
            self._formulas,
            self._requirements,
            self._inputs,
            self._known_ranges(),
            self._types,
            self._unread,
            verdicts=self._reports_verdicts,
            causes=self._reports_causes,
            start=self._at_start,
            hidden=self._hidden,
            late=self._late,
            replays=self._replays,
        )

    @property
    def _outputs(self) -> range:
        """The indices of the formula, unless it is requested only at the start, and of the watched formulas."""
        return range(len(self._formulas) - self._hidden)

    def _read_ranges(self, ranges: Mapping[str, Any]) -> dict[str, tuple[float, float]]:
        read = {}
        if not arrays.is_mapping(ranges):
            raise UsageError(
                f"ranges={shown(ranges)} is no mapping from variables; give for example {{'x': (0, 120)}}"
            )
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
        return [self._ranges.get(name, (-inf, inf)) for name in self._inputs]

    @property
    def samples(self) -> int:
        """The number of samples since the start or the last reset."""
        return int(self._backend.samples)

    def _explain(self, verdict: Verdict | VerdictRun) -> list[Cause]:
        """Return the samples that decide a verdict."""
        if self._evidence is None:
            raise UsageError(
                "the monitor does not remember its samples; make it with monitor(verdict='eager', explain=True)"
            )
        assert self._factory is not None
        monitor = partial(self._factory, explain=False)
        decided = self._steps(verdict.decided_at)
        return self._evidence.causes(verdict, decided, monitor, ended=self._finished)

    @abstractmethod
    def _steps(self, time: Any) -> float:
        """Return a time in steps."""

    def _resume(self, state: tuple[Any, ...]) -> None:
        super()._resume(state)
        if self._evidence is not None:
            self._evidence = self._evidence.copied()

    def _connect(self, backend: Any) -> None:
        self._backend = SlowPath(inner_of(backend)) if self._channels or self._explained else backend
        self._refused = self._session.refused
        self._undefined: Any = self._session.undefined

    def _forget(self) -> None:
        """Reset everything except the state of the back end."""
        self._finished = False
        if self._explained:
            span = span_of(self._formulas[0], self._step)
            self._evidence = Evidence(span, continuous=self._continuous)

    @exclusive
    def reset(self, /, **parameters: Any) -> None:
        """Forget the trace; the next sample is the first.

        ``parameters``: their values from now on, as ``Specification.with_parameters`` takes them.
        """
        self._assign(parameters)
        self._forget()
        self._connect(self._session.open())

    # ---- samples ---------------------------------------------------------------------------------

    def _read_by_formula(self, values: Mapping[str, Any]) -> dict[str, Any]:
        flat = super()._read_by_formula(values)
        for name, channel in self._channels.items():
            if name in flat and (flat[name] is not None or self._settled):
                flat[channel] = float(flat[name] is not None)
        return flat

    @property
    def _settled(self) -> bool:
        """Whether a sample that is missing now cannot arrive later."""
        return self._late is None

    def _known_of(self, name: str, given: Any, index: int, moment: str) -> tuple[float, float] | None:
        """Return the bounds of a value, None where it is missing; raise :class:`TraceError` for wrong data."""
        if given is None:
            return None
        where = f"sample {index}, {moment}"
        type_ = self._types.get(name)
        given = encoded_value(given, name, type_, where, index)
        bounds = bounds_of(given)
        if bounds is None:
            raise TraceError(
                f"'{name}' is {shown(given)} at {where}; expected a number, bounds (lower, upper), or None "
                f"if it is missing",
                variable=name,
                index=index,
            )
        if isnan(bounds[0]) or isnan(bounds[1]):
            raise TraceError(
                f"'{name}' is NaN at {where}: fill the gap or leave the sample out",
                variable=name,
                index=index,
            )
        if bounds[0] > bounds[1]:
            raise TraceError(
                f"'{name}' is {shown(given)} at {where}, reversed: give the lower bound first",
                variable=name,
                index=index,
            )
        if type_ is BOOLEAN:
            for end in bounds:
                if end not in (0.0, 1.0):
                    raise no_truth(name, end, where, index)
        low, high = self._ranges.get(name, (-inf, inf))
        if not (low <= bounds[0] and bounds[1] <= high):
            raise TraceError(
                f"'{name}' is {shown(given)} at {where}, outside its declared range [{low:g}, {high:g}]: "
                f"correct the value, or declare a wider range",
                variable=name,
                index=index,
            )
        return bounds

    @abstractmethod
    def _no_value(self, error: Any) -> Exception:
        """Name the sub-formula and the instant of a value that does not exist."""

    def _is_finished(self) -> UsageError:
        return UsageError("the monitor has finished its trace; call reset() before the next sample")


def bounds_of(value: Any) -> tuple[float, float] | None:
    """Return the bounds given by a number, an :class:`Interval` or a pair of numbers; None for anything else."""
    if isinstance(value, Interval):
        value = (value.lower, value.upper)
    if isinstance(value, tuple | list):
        if len(value) != 2:
            return None
        low, high = (arrays.number_of(end) for end in value)
        return None if low is None or high is None else (low, high)
    number = arrays.number_of(value)
    return None if number is None else (number, number)
