"""The modern face: requirements that can be evaluated, monitored, printed and rewritten."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property, partial
from html import escape
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, overload

from rtamt.engine.domains import engine_of
from rtamt.engine.offline import Evaluators, Query
from rtamt.engine.online import Watched
from rtamt.errors import TraceError, UsageError
from rtamt.language.formula import Formula, variables
from rtamt.language.grammar import is_number
from rtamt.language.lint import LintWarning, warnings_of
from rtamt.language.operators import STL, Language
from rtamt.language.parser import parse_formula
from rtamt.language.printer import excerpt, to_text
from rtamt.language.specfile import parse_document
from rtamt.language.units import check_unit, positive_period
from rtamt.results import Result, requirements_of
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.pastify import pastify
from rtamt.rewrite.semantics import apply_semantics, semantics_of
from rtamt.settings import names_of
from rtamt.signals.discrete import DISCRETE
from rtamt.signals.domains import Defaults, time_domain
from rtamt.signals.inexact import Uncertainty, fill_gaps
from rtamt.signals.ticks import NANOSECOND
from rtamt.verdicts.modes import DELAYED, clock_of, mode_of, semantics_in
from rtamt.verdicts.offline import by_start, judge, judge_apart
from rtamt.verdicts.outputs import Outputs, outputs_of
from rtamt.verdicts.standalone import carried_program

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rtamt.compiler.program import Program
    from rtamt.engine.dense.monitor import DenseMonitor
    from rtamt.engine.discrete.monitor import Monitor
    from rtamt.engine.online import OnlineMonitor
    from rtamt.language.document import Document
    from rtamt.language.units import Duration
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.settings import Semantics
    from rtamt.signals.dense import Dense
    from rtamt.signals.discrete import Discrete
    from rtamt.signals.domain import DomainTrace, TimeDomain
    from rtamt.signals.signal import Signal
    from rtamt.verdicts.bounds import IntervalMonitor
    from rtamt.verdicts.early import EagerMonitor


@dataclass(frozen=True, eq=False, repr=False)
class Specification:
    """One requirement or several, with the names, types and sub-formulas of their document.

    Made by :func:`parse` and :func:`load`; immutable, so that it can be shared and reused.

    >>> import rtamt
    >>> rtamt.parse("specification slow always(speed <= 30)")
    <specification slow: always(speed <= 30)>
    """

    document: Document
    domain: TimeDomain = DISCRETE
    #: The settings of evaluations and monitors in another time domain than ``domain``.
    period: Fraction | None = None
    resolution: Fraction = NANOSECOND
    unit: str = "s"
    backend: str = "cpp"
    language: Language = STL
    semantics: str | PredicateSemantics = "standard"
    #: From a variable to ``"input"`` or ``"output"``: what the text declares, and what was given.
    roles: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<specification {f'{self.name}: ' if self.name else ''}{self.formula}>"

    def _repr_html_(self) -> str:
        name = f"<b>{escape(self.name)}</b>" if self.name else ""
        rows = [
            f"<tr><td>{escape(known.name)}</td><td><code>{escape(excerpt(known.formula))}</code></td>"
            f"<td>{escape(known.description)}</td></tr>"
            for known in self.document.requirements
        ]
        return (
            f"{name}<table><tr><th>requirement</th><th>formula</th><th>text</th></tr>{''.join(rows)}</table>"
        )

    @property
    def time(self) -> str:
        """The name of the time domain: ``"discrete"`` or ``"dense"``."""
        return self.domain.name

    @property
    def formula(self) -> Formula:
        """The formula of the requirement; of several their conjunction, whose robustness is the minimum."""
        return self.document.formula

    @cached_property
    def requirements(self) -> Mapping[str, Specification]:
        """Every requirement by name, in the order of the text, each as a specification of its own.

        The requirements are the formulas after ``require``; in a text without any, the formulas (not
        numbers) that no other one uses. One that has no name is ``requirement_2``, if it is the second.

        >>> import rtamt
        >>> spec = rtamt.parse('''
        ...     near = distance <= 30
        ...     require REQ-7 "brakes in time" severity warning: always(near -> eventually[0:1](brake >= 1))
        ...     require REQ-8: always(distance >= 2)''')
        >>> spec.requirements["REQ-8"]
        <specification REQ-8: always(distance >= 2)>
        >>> [(requirement.name, requirement.severity) for requirement in spec.document.requirements]
        [('REQ-7', 'warning'), ('REQ-8', 'error')]
        """
        known = self.document.requirements
        if len(known) == 1:
            return MappingProxyType({known[0].name: self})
        return MappingProxyType({requirement.name: self.select(requirement.name) for requirement in known})

    @cached_property
    def warnings(self) -> tuple[LintWarning, ...]:
        """What is legal in the text and seldom meant; each with a code, a message and its place.

        >>> import rtamt
        >>> print(*rtamt.parse("prev(x) - x <= 3").warnings)
        RT105: 'prev' applies to all of '(x) - x <= 3'; write prev((x) - x <= 3) if that is meant
          line 1, column 1:
            prev(x) - x <= 3
            ^^^^^^^^^^^^^^^^
        """
        return warnings_of(self.document)

    def select(self, name: str) -> Specification:
        """Return the specification of one requirement or named sub-specification alone.

        Raises :class:`UsageError` where there is none of this name.
        """
        return replace(self, document=self.document.select(name))

    @property
    def text(self) -> str:
        """The text as it was given."""
        return self.document.text

    @property
    def name(self) -> str | None:
        """The name of a requirement of several; else the one after ``specification``, if there is one."""
        return self.document.selected or self.document.name

    @cached_property
    def input_names(self) -> tuple[str, ...]:
        """The variables that the formula reads, of several requirements those of all, in order of appearance."""
        return variables(self.formula)

    @property
    def horizon(self) -> float:
        """Seconds after t at which ρ at t is known online; inf if never. The paper's Definition 3."""
        depth = horizon(self.apply_semantics(self.formula), self.period or Fraction(1))
        return float("inf") if depth is None else float(depth)

    def pastified(self, period: Duration | None = None) -> Formula:
        """Return Π(φ): past operators only, the same value one horizon later (Definition 4).

        That holds under every semantics, since predicates stay what they are.

        >>> import rtamt
        >>> print(rtamt.parse("x >= 3 -> eventually[0:5](y >= 3)").pastified())
        once[5:5](x >= 3) -> once[0:5](y >= 3)
        """
        step = self.period if period is None else positive_period(period)
        return pastify(self.formula, step or Fraction(1), self.text, self.unit)

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
        """Compute the robustness of a finished recording at every sample.

        ``data``: a mapping (or frame) from variable to n numbers; ``"time"``: n stamps, may be left
        out. Numbers are seconds, whatever holds them, or of the unit that ``time_unit`` names: ``"s"``, ``"ms"``,
        ``"us"``, ``"ns"``; datetimes and timedeltas are what they are. Times come back as they were given:
        seconds as floats, integers of a unit as integers, datetimes and timedeltas as those of numpy (in
        UTC if they have a time zone). ``period``: seconds, or text such as ``"100ms"``; by default
        that of the specification, else the median gap of the stamps, else 1 s. ``tolerance``: the
        fraction of the period by which a gap between samples may miss it.

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

        Raises :class:`TraceError` where the data is wrong, :class:`BoundError` where an interval is
        no multiple of the period, :class:`EvaluationError` where an operation has no value.

        >>> import rtamt
        >>> result = rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2], "x": [5, 4, 6]})
        >>> result.robustness, result.satisfied, result.signal.values
        (1.0, True, array([1., 1., 3.]))
        >>> spec = rtamt.parse("always(x >= 3)")
        >>> spec.evaluate({"x": [5, None, 4]}, uncertainty={"x": 0.5}, ranges={"x": (0, 120)}).interval
        Interval(lower=-3.0, upper=1.5)
        """
        query = self.query(time, period, tolerance, resolution, semantics, time_unit)
        recording = self.with_units(self._recorded(query, data, uncertainty, ranges))
        self._check(query, recording)
        return self.result(query, recording)

    def result(self, query: Query, recording: DomainTrace) -> Result:
        """Return the result over a normalised recording, for which the formula was checked."""
        if len(self.requirements) > 1 and recording.domain.continuous:
            outputs = [one.outputs(query.semantics) for one in self.requirements.values()]
            if len(by_start(outputs, recording)) > 1:
                if recording.bounds:
                    raise UsageError(
                        "the requirements start at different times, and samples are missing or uncertain; "
                        "evaluate each of spec.requirements alone"
                    )
                signal, judged = judge_apart(outputs, recording, self.signals_of)
                parts = requirements_of(self, judged, query.semantics)
                return Result(self, recording, signal, query.semantics, parts)
        return Result(self, recording, self.signal_of(query.formula, recording), query.semantics)

    def _recorded(self, query: Query, data: Any, uncertainty: Any, ranges: Any) -> DomainTrace:
        """Return a recording that may have missing and uncertain samples."""
        declared = Uncertainty.of(uncertainty, ranges, self.input_names)
        missing: dict[str, Any] = {}
        try:
            recording = query.record(data, self.input_names)
        except TraceError as error:
            if error.variable not in self.input_names:
                raise
            own_clocks = query.domain.continuous
            filled, missing = fill_gaps(data, self.input_names, own_clocks=own_clocks)
            if not missing:
                raise
            recording = query.record(filled, self.input_names)
        return declared.applied(recording, missing)

    def judge(self, data: Any) -> Mapping[str, Result]:
        """Evaluate each requirement over a finished recording: robustness and verdicts of all from one program.

        ``data`` and errors as for :meth:`evaluate`, which computes verdicts when they are asked for.
        """
        query = self.query()
        recording = self.with_units(query.record(data, self.input_names))
        self._check(query, recording)
        outputs = [one.outputs() for one in self.requirements.values()]
        return requirements_of(self, judge(outputs, recording, self.signals_of), query.semantics)

    def with_units(self, recording: DomainTrace) -> DomainTrace:
        """Return a recording with the declared units of the variables whose source names none."""
        units = {d.name: d.unit for d in self.document.declarations if d.unit and d.name in self.input_names}
        return recording.with_units({**units, **recording.units}) if units else recording

    def query(
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
        return self._query_of(self.domain_for(time, period, tolerance, resolution), semantics, time_unit)

    @cached_property
    def _own_query(self) -> Query:
        return self._query_of(self.domain, None, None)

    def _query_of(self, domain: TimeDomain, semantics: Semantics | None, time_unit: str | None) -> Query:
        unit = None if time_unit is None else check_unit(time_unit)
        chosen = self._semantics(semantics)
        formula = self.apply_semantics(self.formula, chosen)
        domain.check(formula, self.text)
        return Query(formula, self.text, domain, chosen, unit)

    @overload
    def monitor(
        self,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        semantics: Semantics | None = None,
        watch: str | Iterable[str] = (),
        time_unit: str | None = None,
        verdict: Literal["delayed"] = "delayed",
    ) -> Monitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["dense"] | Dense,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
        watch: str | Iterable[str] = (),
        time_unit: str | None = None,
        verdict: Literal["delayed"] = "delayed",
    ) -> DenseMonitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        semantics: Semantics | None = None,
        watch: str | Iterable[str] = (),
        time_unit: str | None = None,
        verdict: Literal["eager"],
    ) -> EagerMonitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["discrete"] | Discrete | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        semantics: Semantics | None = None,
        watch: str | Iterable[str] = (),
        time_unit: str | None = None,
        verdict: Literal["interval"],
        at: str | None = None,
        ranges: Mapping[str, Any] | None = None,
        lateness: Duration | None = None,
        on_correction: str | None = None,
    ) -> IntervalMonitor: ...

    def monitor(
        self,
        *,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
        watch: str | Iterable[str] = (),
        time_unit: str | None = None,
        verdict: str = DELAYED,
        at: str | None = None,
        ranges: Mapping[str, Any] | None = None,
        lateness: Duration | None = None,
        on_correction: str | None = None,
    ) -> OnlineMonitor:
        """Return an online monitor; of dense time where that is asked for here or in :func:`parse`.

        ``period`` as in :meth:`evaluate`, by default 1 s. ``tolerance``: the fraction of the period
        by which a gap between samples may miss it. ``semantics``: as for :func:`parse`; under
        ``"boolean"`` the monitor gives verdicts, +inf where the formula holds and -inf where it does
        not, also where the robustness is 0. ``watch``: names of sub-specifications, or formulas over
        the same variables, whose values ``monitor[name]`` is to tell beside the result; each is known
        at its own horizon. ``time_unit``: of times that are numbers, as in :meth:`evaluate`; what is
        told comes in it too. Raises :class:`BoundError` for unbounded future.

        ``verdict``: what the monitor reports of each sample: ``"delayed"``, the robustness one horizon later;
        ``"eager"``, whether the formula holds, as soon as no later sample can change it; ``"interval"``, bounds
        of the robustness from what is known by now. Of intervals: ``at``, the ``"start"`` of the trace, as by
        default for unbounded future, or ``"every"`` sample; ``ranges``, from a variable to its least and
        greatest value; ``lateness``, by how much a sample may come late; ``on_correction``, whether to
        ``"reject"`` or ``"replay"`` a sample that contradicts an earlier one.

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
        settings: dict[str, Any] = {name: setting for name, setting in given.items() if setting is not None}
        mode = mode_of(verdict, settings)
        asked, semantics = semantics, semantics_in(mode, self._semantics(semantics))
        formula = self.apply_semantics(self.formula, semantics)
        names = names_of(watch)
        watched = [self._watched(name, semantics) for name in names]
        factory = partial(
            self.monitor,
            time=time,
            period=period,
            tolerance=tolerance,
            resolution=resolution,
            semantics=asked,
            watch=names,
            time_unit=time_unit,
            verdict=verdict,
            **settings,
        )
        domain = self.domain_for(time, period, tolerance, resolution).online
        if mode.monitor is not None:
            return mode.monitor(
                formula,
                clock_of(mode, domain, time_unit),
                text=self.text,
                backend=self.backend,
                declared=self.declared,
                watch=watched,
                factory=factory,
                **settings,
            )
        return engine_of(domain).monitor(
            formula,
            domain,
            text=self.text,
            backend=self.backend,
            declared=self.declared,
            watch=watched,
            factory=factory,
            unit=time_unit,
            requirements=[self._watched(name, semantics).formula for name in self.requirements],
        )

    def compile(
        self,
        *,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
    ) -> Program:
        """Return the requirement as a program, whose bytes run wherever the core does, without Python.

        Its outputs are ``robustness`` (ρ, or what ``semantics`` says) and ``verdict`` (+inf where the
        formula holds, -inf where it does not); of several requirements these are of all together, and each has
        its own, ``robustness.R1`` and ``verdict.R1``. The named constants of the specification are parameters
        of the program, except those that bound an interval. Settings and errors as for :meth:`monitor`.

        >>> import rtamt
        >>> program = rtamt.parse("always[0:200ms](x >= 3)").compile(period="100ms")
        >>> program.lags, len(program.to_bytes())
        ((2, 2), 459)
        """
        domain = self.domain_for(time, period, None, resolution).online
        chosen = self._semantics(semantics)
        several = self.requirements if len(self.requirements) > 1 else {}
        parts = {name: one.outputs(chosen) for name, one in several.items()}
        return carried_program(
            self.formula,
            applied=self.apply_semantics(self.formula, chosen),
            parts=parts,
            domain=domain,
            text=self.text,
            name=self.name,
        )

    def apply_semantics(self, formula: Formula, semantics: str | PredicateSemantics | None = None) -> Formula:
        """Return the formula whose robustness is the value of ``formula`` under a semantics.

        ``semantics``: by default that of the specification; see :func:`rtamt.rewrite.semantics.lower`.
        """
        chosen = self._semantics(semantics)
        if not isinstance(chosen, str):
            return apply_semantics(formula, chosen, self.roles)
        applied = self._lowered.get((formula, chosen))
        if applied is None:
            applied = self._lowered[formula, chosen] = apply_semantics(formula, chosen, self.roles)
        return applied

    def outputs(
        self, semantics: str | PredicateSemantics | None = None, formula: Formula | None = None
    ) -> Outputs:
        """Return what is computed to judge the requirement: robustness under a semantics, and truth.

        ``formula``: one that replaces that of the specification, such as its pastified form.
        """
        judged = self.formula if formula is None else formula
        return outputs_of(judged, self.apply_semantics(judged, semantics))

    def signal_of(self, formula: Formula, trace: DomainTrace) -> Signal:
        """Return the robustness signal of any formula over a normalised recording."""
        return self.signals_of((formula,), trace)[0]

    def signals_of(self, formulas: tuple[Formula, ...], trace: DomainTrace) -> list[Signal]:
        """Return the robustness signals of formulas over a normalised recording, all from one program."""
        return self._evaluators(formulas, trace)

    def named(self, name: str) -> Formula:
        """Return a named sub-specification or requirement, or the formula of any other text, read in its place.

        >>> import rtamt
        >>> spec = rtamt.parse("asked = req >= 3; always(asked -> gnt >= 3)")
        >>> print(spec.named("asked"), "|", spec.named("once asked"))
        req >= 3 | once(req >= 3)
        """
        known = self._known(name)
        if known is not None:
            return known
        return parse_formula(
            name,
            language=self.language,
            constants=self.document.constants,
            definitions=self.document.definitions,
            variables=self.document.variables or None,
            unit=self.unit,
        )

    def _watched(self, name: str, semantics: Semantics | None) -> Watched:
        formula = self.named(name)
        if not is_number(formula):
            formula = self.apply_semantics(formula, self._semantics(semantics))
        return Watched(name, formula, name if self._known(name) is None else self.text)

    def _known(self, name: str) -> Formula | None:
        """Return a named sub-specification or requirement, if there is one."""
        definition = self.document.definitions.get(name)
        if definition is not None:
            return definition
        return next((known.formula for known in self.document.requirements if known.name == name), None)

    @cached_property
    def _lowered(self) -> dict[tuple[Formula, str], Formula]:
        return {}

    def _check(self, query: Query, recording: DomainTrace) -> None:
        if query.domain.step is None:  # else checked without a recording; many recordings have the same step
            key = (query.formula, recording.step.as_integer_ratio())  # fractions are slow to hash
            if key not in self._checked:
                recording.check(query.formula, self.text)
                self._checked.add(key)

    @cached_property
    def _checked(self) -> set[tuple[Formula, tuple[int, int]]]:
        return set()

    @cached_property
    def _evaluators(self) -> Evaluators:
        return Evaluators(self.backend)

    @cached_property
    def declared(self) -> tuple[str, ...]:
        """The names that the text declares: data may have them, also where the formula reads none of them."""
        return tuple(declaration.name for declaration in self.document.declarations)

    def domain_for(
        self,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        resolution: Duration | None = None,
    ) -> TimeDomain:
        """Return the time domain that is asked for; what is left out is that of the specification."""
        if time is period is tolerance is resolution is None:
            return self.domain
        defaults = Defaults(self.period, self.domain.tolerance, self.resolution)
        named = self.domain.name if time is None else time
        return time_domain(named, period, tolerance, resolution, defaults)

    def _semantics(self, semantics: Semantics | None) -> str | PredicateSemantics:
        return self.semantics if semantics is None else semantics_of(semantics)

    def __reduce__(self) -> tuple[Any, ...]:
        # The text says it all, and is read without recursion however long it is.
        declared = {declaration.name for declaration in self.document.declarations}
        given = {name: v for name, v in self.document.constants.items() if name not in declared}
        names = ("domain", "period", "resolution", "unit", "backend", "language", "semantics")
        settings = {name: getattr(self, name) for name in names}
        return _factory, (self.text, given, {**settings, "roles": dict(self.roles)}, self.document.selected)

    def __str__(self) -> str:
        return to_text(self.formula, self.language)


def _factory(
    text: str, constants: Mapping[str, float], settings: dict[str, Any], selected: str | None
) -> Specification:
    document = parse_document(text, language=settings["language"], unit=settings["unit"], constants=constants)
    return Specification(document if selected is None else document.select(selected), **settings)
