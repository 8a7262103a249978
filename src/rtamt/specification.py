"""The modern face: requirements that can be evaluated, monitored, printed and rewritten."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any, Literal, overload

from rtamt.engine.engine import engine_of
from rtamt.engine.offline import Evaluators, Query
from rtamt.engine.online import OnlineMonitor
from rtamt.errors import TraceError, UsageError
from rtamt.language.imports import again
from rtamt.language.printer import to_text
from rtamt.language.specfile import parse_document
from rtamt.language.units import check_unit
from rtamt.results import Result, requirements_of
from rtamt.settings import watched_of
from rtamt.signals.inexact import Uncertainty, fill_gaps
from rtamt.signals.sampling import sampled
from rtamt.specification_text import SpecificationText
from rtamt.verdicts.modes import DELAYED, mode_of, monitor_of, semantics_in
from rtamt.verdicts.offline import by_start, findings_apart
from rtamt.verdicts.standalone import bounds_program, carried_program

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import Unpack

    from rtamt.compiler.program import Program
    from rtamt.engine.dense.monitor import DenseMonitor
    from rtamt.engine.discrete.monitor import Monitor
    from rtamt.language.formula import Formula
    from rtamt.language.imports import Library
    from rtamt.language.units import Duration
    from rtamt.settings import DenseSettings, DiscreteSettings, IntervalSettings, Semantics, Watch
    from rtamt.signals.dense import Dense
    from rtamt.signals.discrete import Discrete
    from rtamt.signals.domain_interface import DomainTrace, TimeDomain
    from rtamt.signals.signal import Signal
    from rtamt.verdicts.causation import CausationMonitor
    from rtamt.verdicts.dense_early import DenseEagerMonitor
    from rtamt.verdicts.eager import EagerMonitor
    from rtamt.verdicts.interval import IntervalMonitor


@dataclass(frozen=True, eq=False, repr=False)
class Specification(SpecificationText):
    """One requirement or several, with the names, types and sub-formulas of their document.

    Created by :func:`parse` and :func:`load`; immutable, so that it can be shared and reused.

    >>> import rtamt
    >>> rtamt.parse("specification slow always(speed <= 30)")
    <specification slow: always(speed <= 30)>
    """

    def evaluate(
        self,
        data: Any,
        *,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
        time_unit: str | None = None,
        uncertainty: Mapping[str, float] | None = None,
        ranges: Mapping[str, tuple[float, float]] | None = None,
    ) -> Result:
        """Compute the robustness of a complete trace at every sample.

        ``data``: a mapping (or frame) from variable to n numbers; ``"time"``: n timestamps,
        optional: numbers, datetimes or timedeltas. Times are returned in the same form:
        seconds as floats, integers of a unit as integers, datetimes and timedeltas as those of numpy (in
        UTC if they have a time zone). ``time_unit``: the unit of numeric times: ``"s"`` (the default), ``"ms"``,
        ``"us"`` or ``"ns"``. ``period``: seconds, or text such as ``"100ms"``; by default
        that of the specification, else the median gap of the timestamps, else 1 s. ``tolerance``: the
        allowed deviation of a gap between samples, as a fraction of the period.

        ``time``: ``"discrete"``, ``"dense"``, or a time domain with its settings: ``rtamt.Discrete(period=...)``,
        ``rtamt.Dense(resolution=...)``. In dense time signals change at any instant, each on its own time base:
        ``data`` maps a variable to (times, values), or to a list of [time, value] pairs. ``resolution``: the length
        of a tick, in which time is counted (default 1 ns); bounds must be multiples of it.

        ``semantics``: as for :func:`parse`, by default that of the specification.

        A sample may be missing: ``None``, a null of Arrow or polars, ``pandas.NA`` or a masked value (NaN is an
        error). Then, and with ``uncertainty``, the result has bounds: ``result.interval`` at the first instant,
        ``result.intervals`` at each. Where both are equal, the robustness is that number. ``uncertainty``: for some
        variables how far a sample may be off the value, in either direction. ``ranges``: for some
        variables the lowest and the highest possible value, which bound missing samples.

        Raises :class:`TraceError` if the data is invalid, :class:`BoundError` if an interval is
        not a multiple of the period, :class:`EvaluationError` if an operation has no value.

        >>> import rtamt
        >>> result = rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2], "x": [5, 4, 6]})
        >>> result.robustness, result.satisfied, result.signal.values
        (1.0, True, array([1., 1., 3.]))
        >>> spec = rtamt.parse("always(x >= 3)")
        >>> spec.evaluate({"x": [5, None, 4]}, uncertainty={"x": 0.5}, ranges={"x": (0, 120)}).interval
        Interval(lower=-3.0, upper=1.5)
        """
        query = self._query(time, period, tolerance, resolution, semantics, time_unit)
        data = self._sampled(query, self.binding.applied(data))
        recording = self._with_units(self._recorded(query, data, uncertainty, ranges))
        self._check(query, recording)
        return self._result(query, recording)

    def _sampled(self, query: Query, data: Any) -> Any:
        """Return data with the samples that the sampling rule takes of it."""
        rule = self.sampling
        if rule is None or not rule.hold or query.domain.continuous:
            return data
        return sampled(data, self.input_names, rule, query.domain.period or rule.period, query.unit)

    def _result(self, query: Query, recording: DomainTrace) -> Result:
        """Return the result on a normalised recording; the formula must have been checked."""
        if len(self.requirements) > 1 and recording.domain.continuous:
            outputs = [one._outputs(query.semantics) for one in self.requirements.values()]
            if len(by_start(outputs, recording)) > 1:
                if recording.bounds:
                    raise UsageError(
                        "the requirements start at different times, and samples are missing or uncertain; "
                        "evaluate each of spec.requirements alone"
                    )
                signal, findings = findings_apart(outputs, recording, self._signals_of)
                parts = requirements_of(self, findings, query.semantics)
                return Result(self, recording, signal, query.semantics, parts)
        return Result(self, recording, self._signals_of((query.formula,), recording)[0], query.semantics)

    def _recorded(self, query: Query, data: Any, uncertainty: Any, ranges: Any) -> DomainTrace:
        """Return a recording that may have missing and uncertain samples."""
        declared = Uncertainty.of(uncertainty, ranges, self.input_names)
        missing: dict[str, Any] = {}
        try:
            recording = query.record(data, self.input_names, self.types)
        except TraceError as error:
            if error.variable not in self.input_names:
                raise
            own_clocks = query.domain.continuous
            filled, missing = fill_gaps(data, self.input_names, own_clocks=own_clocks)
            if not missing:
                raise
            recording = query.record(filled, self.input_names, self.types)
        return declared.applied(recording, missing)

    def _with_units(self, recording: DomainTrace) -> DomainTrace:
        """Return a recording with the declared units of the variables whose source names none."""
        return recording.with_units({**self.units, **recording.units}) if self.units else recording

    def _query(
        self,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
        time_unit: str | None = None,
    ) -> Query:
        """Return what :meth:`evaluate` asks of a recording; arguments and errors are those of it."""
        if time is period is tolerance is resolution is semantics is time_unit is None:
            return self._own_query
        return self._query_of(self._domain_for(time, period, tolerance, resolution), semantics, time_unit)

    @cached_property
    def _own_query(self) -> Query:
        return self._query_of(self.domain, None, None)

    def _query_of(self, domain: TimeDomain, semantics: Semantics | None, time_unit: str | None) -> Query:
        unit = None if time_unit is None else check_unit(time_unit)
        chosen = self._semantics(semantics)
        formula = self._apply_semantics(self.formula, chosen)
        domain.check(formula, self.text)
        return Query(formula, self.text, domain, chosen, unit)

    @overload
    def monitor(
        self,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        verdict: Literal["delayed"] = "delayed",
        **settings: Unpack[DiscreteSettings],
    ) -> Monitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["dense"] | Dense,
        verdict: Literal["delayed"] = "delayed",
        **settings: Unpack[DenseSettings],
    ) -> DenseMonitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        verdict: Literal["eager"],
        ranges: Mapping[str, Any] | None = None,
        explain: bool = False,
        **settings: Unpack[DiscreteSettings],
    ) -> EagerMonitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["dense"] | Dense,
        verdict: Literal["eager"],
        ranges: Mapping[str, Any] | None = None,
        explain: bool = False,
        **settings: Unpack[DenseSettings],
    ) -> DenseEagerMonitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["discrete", "dense"] | TimeDomain | None = None,
        verdict: Literal["interval"],
        **settings: Unpack[IntervalSettings],
    ) -> IntervalMonitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        verdict: Literal["causation"],
        **settings: Unpack[DiscreteSettings],
    ) -> CausationMonitor: ...

    def monitor(
        self,
        *,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
        watch: Watch = (),
        time_unit: str | None = None,
        verdict: str = DELAYED,
        at: str | None = None,
        ranges: Mapping[str, Any] | None = None,
        lateness: Duration | None = None,
        on_correction: str | None = None,
        episodes: bool = False,
        explain: bool = False,
    ) -> OnlineMonitor:
        """Return an online monitor; for dense time if selected here or in :func:`parse`.

        ``period`` as in :meth:`evaluate`, by default 1 s. ``tolerance``: the fraction of the period
        by which a gap between samples may miss it. ``semantics``: as for :func:`parse`; under
        ``"boolean"`` the monitor gives verdicts, +inf where the formula holds and -inf where it does
        not, also where the robustness is 0. ``watch``: names of sub-specifications, or formulas over
        the same variables (text, or such as ``spec.formula``), whose values ``monitor[...]`` reports beside the
        result; each is known at its own horizon. ``time_unit``: of times that are numbers, as in :meth:`evaluate`,
        also of those that are reported. ``time`` as in :meth:`evaluate`. ``resolution`` as in :meth:`evaluate`.

        In dense time each of several requirements starts when all variables that it reads have started; the
        result is the minimum of those that have, known once all variables have started. Raises
        :class:`BoundError` for unbounded future.

        ``verdict``: what the monitor reports of each sample: ``"delayed"``, the robustness one horizon later;
        ``"eager"``, whether the formula holds, as soon as no later sample can change it; ``"interval"``, bounds
        of the robustness from what is known by now; ``"causation"``, by how much the sample alone violates or
        satisfies the formula. In dense time ``"eager"`` and ``"interval"`` report runs of instants, with unbounded
        future too. ``at``: of which instants ``"interval"`` reports: the ``"start"`` of the trace, as by default
        for unbounded future, or ``"every"`` one. ``ranges``: from a variable to its least and greatest value
        (``"eager"``, ``"interval"``). ``lateness``: by how much a sample may come late (``"interval"``); without it,
        each variable of dense time has its samples in order. ``on_correction``: whether to ``"reject"`` or
        ``"replay"`` a sample that contradicts an earlier one (``"interval"``). ``episodes``: whether the monitor
        remembers runs of violation, which ``monitor.episodes()`` returns (``"delayed"``). ``explain``: whether it
        remembers samples, so that ``monitor.explain(verdict)`` returns those that decided a verdict (``"eager"``).

        >>> import rtamt
        >>> monitor = rtamt.parse("always[0:200ms](x >= 3)").monitor(period="100ms")
        >>> [monitor.update(t, x=5) for t in (0.0, 0.1, 0.2)]
        [None, None, 2.0]
        >>> verdict = rtamt.parse("x > 3").monitor(semantics="boolean")
        >>> [verdict.update(t, x=x) > 0 for t, x in enumerate([4, 3])]
        [True, False]
        >>> spec = rtamt.parse("asked = req >= 3; always[0:1](asked -> gnt >= 3)")
        >>> monitor = spec.monitor(watch=["asked", "gnt - req"])
        >>> print(monitor.update(0.0, req=5, gnt=2), monitor["asked"], monitor["gnt - req"])
        None 2.0 -3.0
        """
        given = {"at": at, "ranges": ranges, "lateness": lateness, "on_correction": on_correction}
        given |= {"episodes": episodes or None, "explain": explain or None}
        settings: dict[str, Any] = {name: setting for name, setting in given.items() if setting is not None}
        mode = mode_of(verdict, settings)
        asked, semantics = semantics, semantics_in(mode, self._semantics(semantics))
        formula = self._apply_semantics(self.formula, semantics)
        given_watch = watched_of(watch)
        watched = [self._watched(each, semantics) for each in given_watch]
        factory = partial(
            _monitor,
            self,
            time=time,
            period=period,
            tolerance=tolerance,
            resolution=resolution,
            semantics=asked,
            watch=given_watch,
            time_unit=time_unit,
            verdict=verdict,
            **settings,
        )
        domain = self._domain_for(time, period, tolerance, resolution).online
        requirements = [self._watched(name, semantics).formula for name in self.requirements]
        make = engine_of(domain).monitor if mode.name == DELAYED else monitor_of(mode, domain)
        monitor = make(
            formula,
            domain,
            text=self.text,
            backend=self.backend,
            declared=self._declared,
            watch=watched,
            factory=factory,
            unit=time_unit,
            requirements=requirements,
            **settings,
        )
        if isinstance(monitor, OnlineMonitor):
            monitor.bind(self.binding)
        return monitor

    def compile(
        self,
        *,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
        verdict: str = DELAYED,
    ) -> Program:
        """Compile the requirement to a standalone program, which the core runs without Python.

        Its outputs are ``robustness`` (ρ, or that of ``semantics``) and ``verdict`` (+inf where the
        formula holds, -inf where it does not); of several requirements these are of all together, and each has
        its own, ``robustness.R1`` and ``verdict.R1``. The parameters and named constants of the specification are
        parameters of the program, except those that bound an interval. Settings and errors as for :meth:`monitor`.

        With ``verdict="interval"`` its outputs are bounds at the start of the trace, whatever is still to come:
        ``lower``, ``upper``, ``verdict``, and ``decided_since``, the seconds from the first sample to the one that
        decided the verdict. The future may then be unbounded; time is discrete.

        >>> import rtamt
        >>> program = rtamt.parse("always[0:200ms](x >= 3)").compile(period="100ms")
        >>> program.lags, len(program.to_bytes())
        ((2, 2), 463)
        """
        domain = self._domain_for(time, period, None, resolution).online
        chosen = self._semantics(semantics)
        if mode_of(verdict, {}).name != DELAYED:
            if verdict != "interval":
                raise UsageError(f"verdict='{verdict}' cannot be compiled; choose from {DELAYED}, interval")
            applied = self._apply_semantics(self.formula, chosen)
            return bounds_program(self.formula, domain, applied=applied, text=self.text, name=self.name)
        several = self.requirements if len(self.requirements) > 1 else {}
        parts = {name: one._outputs(chosen) for name, one in several.items()}
        return carried_program(
            self.formula,
            applied=self._apply_semantics(self.formula, chosen),
            parts=parts,
            domain=domain,
            text=self.text,
            name=self.name,
        )

    def _signals_of(self, formulas: tuple[Formula, ...], trace: DomainTrace) -> list[Signal]:
        """Return the robustness signals of formulas over a normalised recording, all from one program."""
        return self._evaluators(formulas, trace)

    def _check(self, query: Query, recording: DomainTrace) -> None:
        if query.domain.step is None:  # else checked without a recording; many recordings have the same step
            key = (query.formula, recording.step.as_integer_ratio())  # hashing fractions is slow
            if key not in self._checked:
                recording.check(query.formula, self.text)
                self._checked.add(key)

    @cached_property
    def _checked(self) -> set[tuple[Formula, tuple[int, int]]]:
        return set()

    @cached_property
    def _evaluators(self) -> Evaluators:
        return Evaluators(self.backend)

    def __reduce__(self) -> tuple[Any, ...]:
        # The text is sufficient, and is parsed without recursion at any length.
        names = ("domain", "period", "resolution", "unit", "backend", "language", "semantics", "sampling")
        settings = {name: getattr(self, name) for name in names}
        replaced = self.document.replaced
        formula = to_text(self.formula, self.language, parameters=True) if replaced else None
        values = self._given, dict(self.parameters), again(self.document)
        return _factory, (
            self.text,
            values,
            {**settings, "roles": dict(self.roles), "columns": dict(self.columns)},
            self.document.selected,
            formula,
        )


def result_of(spec: Specification, recording: DomainTrace) -> Result:
    """Return the result of a specification on a normalised recording."""
    return spec._result(spec._query(), recording)


def _monitor(
    spec: Specification, parameters: Mapping[str, float] | None = None, **settings: Any
) -> OnlineMonitor:
    """Return a monitor of a specification with values of parameters; ``settings``: those of ``monitor()``."""
    monitor: OnlineMonitor = spec.with_parameters(**(parameters or {})).monitor(**settings)
    return monitor


def _factory(
    text: str,
    values: tuple[Mapping[str, float], Mapping[str, float], Library],
    settings: dict[str, Any],
    selected: str | None,
    formula: str | None,
) -> Specification:
    constants, parameters, library = values
    document = parse_document(
        text,
        language=settings["language"],
        unit=settings["unit"],
        constants=constants,
        parameters=parameters,
        library=library,
    )
    spec = Specification(document if selected is None else document.select(selected), **settings)
    return spec if formula is None else spec.with_formula(spec._named(formula))
