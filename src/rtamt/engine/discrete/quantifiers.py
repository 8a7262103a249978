"""The discrete-time monitor of formulas with quantifiers, over members that come and go.

The outer formula is monitored as any other: what the members of a quantifier give together is a column of it.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import TYPE_CHECKING, Any

from rtamt.engine.discrete.member_executors import Executor, Moment, QuantifierExecutor
from rtamt.engine.discrete.monitor import Monitor
from rtamt.engine.quantifiers import Plan, QuantifierMonitor
from rtamt.lazy.modules import np
from rtamt.rewrite.quantifier_streams import RUNNING
from rtamt.signals import arrays
from rtamt.signals.arrays import Timestamps
from rtamt.signals.data_errors import missing_field, missing_variable, nan_of_members
from rtamt.signals.member_chunks import chunk
from rtamt.signals.samples import read_values
from rtamt.signals.signal import Signal
from rtamt.usage_guard import exclusive

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.engine.discrete.member_executors import Sample
    from rtamt.engine.online import Watched
    from rtamt.language.formula import Formula
    from rtamt.rewrite.quantifier_streams import Quantified
    from rtamt.signals.discrete import Discrete
    from rtamt.signals.members import Fields


class _NewValues:
    """The new values of each formula after several samples: of the result (None), and of the watched ones."""

    def __init__(self, names: Sequence[Any]) -> None:
        self._points: dict[Any, list[tuple[Any, float]]] = {name: [] for name in (None, *names)}

    def note(self, robustness: float | None, outer: Monitor) -> None:
        """Note what a sample made known."""
        for (name, points), lag in zip(self._points.items(), outer._lags, strict=True):
            value = robustness if name is None else outer[name]
            if value is not None:
                assert not isinstance(value, Signal)
                points.append((outer._recent(lag + 1)[0], value))

    def end(self, rest: Signal, outer: Monitor) -> None:
        """Note what the end of the trace made known."""
        for name, points in self._points.items():
            signal = rest if name is None else outer[name]
            assert isinstance(signal, Signal)
            points.extend(signal.points())

    def signals(self, last: Any = None) -> dict[Any, Signal]:
        """Return a signal of each formula, as far as the ``last`` sample."""
        found = {}
        for name, points in self._points.items():
            kept = points if last is None else [point for point in points if point[0] <= last]
            found[name] = Signal(np.array([time for time, _ in kept]), np.array([value for _, value in kept]))
        return found


class SampledMembers(QuantifierMonitor):
    """A monitor of quantifiers in discrete time: what an update gives."""

    @abstractmethod
    def _next_time(self) -> float:
        """Return the time of the next sample if it has none."""

    def _read(self, values: Mapping[str, Any], time: Any) -> tuple[Sample, dict[str, dict[str, Sample]]]:
        """Return the numbers of an update, and the members that are present."""
        own, given = self._partition(values)
        for name in self.input_names:
            if name not in own:
                raise missing_variable(name, tuple(values))
        moment = self._moment(time)
        numbers = read_values(
            own, self.input_names, self.samples, moment.seconds, self._types, dated=moment.dated
        )
        present = {}
        for name, (group, fields) in self._fields.items():
            present[name] = {
                member: self._sample(member, sample, group, fields, moment)
                for member, sample in given.items()
                if group.matches(member) and all(sample.get(field, 0.0) is not None for field in fields)
            }
        return numbers, present

    def _moment(self, time: Any) -> Moment:
        """Return where an update is in the trace, for errors; of an invalid time, as if it were the next one."""
        seconds, dated = arrays.number_of(time), False
        if arrays.is_moment(time):
            stamps = arrays.timestamps([time])
            seconds, dated = float(stamps.seconds[0]), arrays.are_dates(stamps.original)
        return Moment(self.samples, self._next_time() if seconds is None else seconds, dated)

    def _sample(
        self, member: str, sample: Mapping[str, Any], group: Any, fields: Sequence[str], moment: Moment
    ) -> Sample:
        """Return the fields of a member as numbers."""
        for field in fields:
            if field not in sample:
                raise missing_field(member, field, self.samples)
        names = {field: f"{member}.{field}" for field in fields}
        types = {names[field]: group.values(field) for field in fields if group.values(field) is not None}
        numbers = read_values(
            {name: sample[field] for field, name in names.items()},
            tuple(names.values()),
            moment.sample,
            moment.seconds,
            types,
            dated=moment.dated,
        )
        return {field: numbers[name] for field, name in names.items()}


class MemberMonitor(SampledMembers):
    """Monitors a formula with quantifiers on a stream of samples in discrete time.

    Built by ``Specification.monitor``. :meth:`update` takes the fields of each member by name,
    ``**{"car_3.x": 5.0}``, or as an object with those fields, ``car_3=car``. A member that an update leaves out, or
    whose value is None, is absent there; any other variable must be given.

    >>> import rtamt
    >>> monitor = rtamt.parse('group cars = "car_*"; forall v in cars: v.x > 3').monitor()
    >>> [monitor.update(0.0, **{"car_1.x": 5.0}), monitor.update(1.0), monitor.update(2.0, **{"car_2.x": 1.0})]
    [2.0, inf, -2.0]
    """

    def __init__(
        self,
        formula: Formula,
        domain: Discrete,
        quantified: Sequence[Quantified],
        fields: Fields,
        *,
        text: str | None = None,
        backend: str = "cpp",
        watch: Sequence[Watched] = (),
        **settings: Any,
    ) -> None:
        # ``settings``: ``names``, ``declared``, ``factory`` and ``types`` of :class:`QuantifierMonitor`.
        domain = domain.online
        assert domain.period is not None

        def template(of: Quantified) -> Monitor:
            return Executor(of.formula, domain, text=text, backend=backend)

        plans = [Plan(each, domain.period, template, fields) for each in quantified]
        self._late = max((plan.lag for plan in plans), default=0)
        super().__init__(
            Monitor(formula, domain, text=text, backend=backend, watch=watch),
            plans,
            fields,
            watch=watch,
            **settings,
        )

    def _begin(self) -> None:
        """See :class:`QuantifierMonitor`."""
        #: What the last chunk made known of each formula; of a sample, the outer monitor has it.
        self._news: dict[Any, Signal] = {}
        super()._begin()

    def _executors(self) -> list[QuantifierExecutor]:
        """See :class:`QuantifierMonitor`."""
        return [QuantifierExecutor(plan, {}) for plan in self._plans]

    @property
    def period(self) -> Fraction:
        """The sampling period in seconds."""
        period: Fraction = self._outer.period
        return period

    @property
    def samples(self) -> int:
        """The number of samples since the start or the last reset."""
        return int(self._outer.samples)

    # ---- samples ---------------------------------------------------------------------------------

    @exclusive
    def update(self, time: float, /, **values: Any) -> float | None:
        """Take one sample: ``time`` in seconds, a number for every variable, and the members that are present.

        Returns ρ at ``time - horizon``; None until the horizon has passed. Raises :class:`TraceError` for wrong
        data and :class:`EvaluationError` where an operation has no value; the monitor is then unchanged.
        """
        numbers, present = self._read(values, time)
        robustness: float | None = self._try_update(time, numbers, present)
        self._news = {}
        return robustness

    @exclusive
    def update_many(self, data: Any) -> Signal:
        """Take a chunk of samples: a mapping (or frame) from variable to values, with ``"time"`` if it has timestamps.

        Returns the new values as a Signal. Raises the errors of :meth:`update`.
        """
        data = self._binding.applied(data)
        regular = self._outer.is_period_known(data)
        made = chunk(data, self._fields, self.input_names, regular=regular)
        names = [*self.input_names, *made.columns]
        timestamps, columns, n = arrays.columns_of(
            made.data, names, None, {**self._types, **made.types}, first=self.samples
        )
        if n == 0:
            return Signal(np.empty(0), np.empty(0))
        seconds, given = self._next_times(n) if timestamps is None else timestamps
        dated = arrays.are_dates(given)
        with nan_of_members(self._fields):
            for name, column in columns.items():
                arrays.check_numbers(name, column, seconds, self.samples, self._types.get(name), dated=dated)
        before = self._state()
        known = _NewValues(self._watched)
        try:
            for i in range(n):
                numbers = {name: float(columns[name][i]) for name in self.input_names}
                present = made.present(columns, i)
                known.note(self._try_update(arrays.plain(given[i]), numbers, present), self._outer)
        except Exception:
            self._restore(before)
            raise
        self._news = known.signals()
        return self._news[None]

    @exclusive
    def finish(self) -> Signal:
        """End the trace and return the values that were still unknown."""
        if self._finished:
            return Signal(np.empty(0), np.empty(0))
        samples = self.samples
        numbers = dict.fromkeys(self.input_names, 1.0)
        known = _NewValues(self._watched)
        absent: dict[str, dict[str, Sample]] = {name: {} for name in self._fields}
        for _ in range(self._late if samples else 0):
            (time,) = self._next_times(1).original
            known.note(self._advance(arrays.plain(time), numbers, absent, running=0.0), self._outer)
        last = self._outer._recent(self._late + 1)[0] if samples else None
        known.end(self._outer.finish(), self._outer)
        self._finished = True
        self._news = known.signals(last)
        return self._news[None]

    def _advance(
        self, time: Any, numbers: Sample, present: dict[str, dict[str, Sample]], running: float = 1.0
    ) -> float | None:
        values = {**numbers, RUNNING: running}
        at = self._moment(time)
        for each in self._quantifiers:
            values[each.plan.column] = each.step(present, numbers, at)
        outer = self._outer
        robustness: float | None = outer.update(time, **{name: values[name] for name in outer.input_names})
        return robustness

    def _next_time(self) -> float:
        return float(self._outer._next_time())

    def _next_times(self, n: int) -> Timestamps:
        """Return the times of the next samples, one period apart, in seconds and in the caller's format."""
        seconds = self._outer._next_times(n)
        times = self._outer._times
        return Timestamps(seconds, seconds if times.plain else times.later(n))

    def __getitem__(self, name: str | Formula) -> float | Signal | None:
        """Return the new values of a watched formula after the last update; see ``Monitor``."""
        return self._news[name] if name in self._news else self._outer[name]
