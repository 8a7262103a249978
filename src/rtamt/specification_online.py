"""The online face of a specification: monitors, and programs that run without Python."""

from __future__ import annotations

from fractions import Fraction
from functools import partial

from rtamt.engine import OnlineMonitor, Watched, engine_of
from rtamt.errors import UsageError
from rtamt.language.contents import variables
from rtamt.language.quantifiers import quantifiers
from rtamt.language.records import Sort
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING, Any, Literal, cast, overload
from rtamt.rewrite.semantics import apply_semantics
from rtamt.settings import require_samples, watched_of
from rtamt.signals.arrays import is_mapping
from rtamt.specification_groups import QuantifiedText
from rtamt.verdicts.modes import DELAYED, mode_of, monitor_of, semantics_in

if TYPE_CHECKING:
    from collections.abc import Mapping

    from typing_extensions import Unpack

    from rtamt.compiler.program import Program
    from rtamt.engine.dense.monitor import DenseMonitor
    from rtamt.engine.discrete.monitor import Monitor
    from rtamt.language.formula import Formula
    from rtamt.language.units.durations import Duration
    from rtamt.settings import DenseSettings, DiscreteSettings, IntervalSettings, Semantics, Watch
    from rtamt.signals.dense import Dense
    from rtamt.signals.discrete import Discrete
    from rtamt.signals.time_domain_interface import TimeDomain
    from rtamt.verdicts.early.dense_causation import DenseCausationMonitor
    from rtamt.verdicts.early.dense_eager import DenseEagerMonitor
    from rtamt.verdicts.early.discrete_causation import DiscreteCausationMonitor
    from rtamt.verdicts.early.discrete_eager import EagerMonitor
    from rtamt.verdicts.early.interval import IntervalMonitor


class OnlineSpecification(QuantifiedText):
    """One requirement or several, which can be monitored and compiled."""

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
    ) -> DiscreteCausationMonitor: ...

    @overload
    def monitor(
        self,
        *,
        time: Literal["dense"] | Dense,
        verdict: Literal["causation"],
        **settings: Unpack[DenseSettings],
    ) -> DenseCausationMonitor: ...

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
        worst_case: bool = False,
    ) -> OnlineMonitor:
        """Return an online monitor; for dense time if selected here or in :func:`parse`.

        ``period`` as in :meth:`evaluate`, by default 1 s. ``tolerance``: the allowed deviation of a gap between
        samples, as a fraction of the period. ``semantics``: as for :func:`parse`; under
        ``"boolean"`` the monitor reports verdicts, +inf where the formula holds and -inf where it does
        not, even if the robustness is 0. ``watch``: names of sub-specifications, or formulas over
        the same variables (text, or formulas such as ``spec.formula``), whose values ``monitor[...]`` reports in
        addition to the result; each is known at its own horizon. ``time_unit``: the unit of numeric times, as in
        :meth:`evaluate`, also of reported times. ``time`` and ``resolution`` as in :meth:`evaluate`.

        In dense time each of several requirements starts when all variables that it reads have started; the
        result is the minimum of those that have, known once all variables have started. Raises
        :class:`BoundError` for unbounded future.

        ``verdict``: what the monitor reports for each sample: ``"delayed"``, the robustness one horizon later;
        ``"eager"``, whether the formula holds, as soon as no later sample can change it; ``"interval"``, bounds
        of the robustness from the samples so far; ``"causation"``, by how much the sample alone violates or
        satisfies the formula. The last three also accept unbounded future; in dense time they report runs of
        instants. ``at``: the instants that ``"interval"`` reports: the ``"start"`` of the trace (the default
        for unbounded future), or ``"every"`` one. ``ranges``: from a variable to its lowest and highest value, by
        default its declared range (``"eager"``, ``"interval"``); a sample outside is an error. ``lateness``: how late a
        sample may arrive (``"interval"``); without it, the samples of each variable must arrive in order in dense
        time. ``on_correction``: whether to ``"reject"`` or ``"replay"`` a sample that contradicts an earlier one
        (``"interval"``). ``episodes``: whether the monitor
        records runs of violation, which ``monitor.episodes()`` returns (``"delayed"``). ``worst_case``: for real-time
        use, whether no update may take longer than others, whatever the bounds (``"delayed"``, discrete time); the
        results are the same, and sums over windows are rejected. ``explain``: whether it
        keeps samples, so that ``monitor.explain(verdict)`` can return those that decided a verdict (``"eager"``).

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
        given |= {"episodes": episodes or None, "explain": explain or None, "worst_case": worst_case or None}
        settings: dict[str, Any] = {name: setting for name, setting in given.items() if setting is not None}
        mode = mode_of(verdict, settings)
        asked, semantics = semantics, semantics_in(mode, self._semantics(semantics))
        if self.groups:
            self.refuse_recorded_fields()
            return self._member_monitor(
                verdict, settings, time, period, tolerance, resolution, asked, watched_of(watch), time_unit
            )
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
        if "ranges" in mode.settings:
            settings["ranges"] = (
                ranges if ranges and not is_mapping(ranges) else {**self.ranges, **(ranges or {})}
            )
        domain = self._domain_for(time, period, tolerance, resolution).online
        require_samples(domain, worst_case=worst_case)
        requirements = [self._watched(name, semantics).formula for name in self.requirements]
        if self.document.origin is not None and self.input_names and not variables(self.formula):
            from rtamt.verdicts.robustness_and_truth import align_inputs

            formula = align_inputs(formula, self.input_names, self.types)
            requirements = [formula]
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

    def _member_monitor(
        self,
        verdict: str,
        settings: Mapping[str, Any],
        time: str | TimeDomain | None,
        period: Duration | None,
        tolerance: float | None,
        resolution: Duration | None,
        semantics: Semantics | None,
        watch: tuple[str | Formula, ...],
        time_unit: str | None,
    ) -> OnlineMonitor:
        """Return a monitor of quantifiers over dynamic groups."""
        from rtamt.rewrite.presence import channel_of
        from rtamt.rewrite.quantifier_streams import Splitting  # other monitors do not wait for it

        domain = self._domain_for(time, period, tolerance, resolution).online
        early = verdict != DELAYED
        make = domain.part(f"members_{verdict}" if early else "members")
        unfit = [f"{name}=" for name in settings if name != "at"]
        unfit += [f"verdict='{verdict}' in {domain.name} time"] if early and make is None else []
        unfit += ["time_unit="] if time_unit is not None and domain.sampled else []
        unfit += [f"time='{domain.name}'"] if make is None and not early else []
        for what in unfit:
            named = ", ".join(f"'{group}': [...]" for group in sorted(self.groups))
            raise UsageError(
                f"a monitor of quantifiers has no {what}; name the members, which must be present throughout: "
                f"spec.over({{{named}}}).monitor(...)"
            )
        domain.check(self.formula, self.text)
        roles = dict(self.roles)
        for each in quantifiers(*self._all_formulas):
            assert each.op.binder is not None
            group = each.op.binder.group
            role = roles.get(group.name, group.role)
            if role is not None:
                roles[each.op.binder.variable] = roles[channel_of(each.op.binder.variable)] = role
        chosen = self._semantics(semantics)
        numbers = any(each.op.result is Sort.NUMBER for each in quantifiers(*self._all_formulas))
        if numbers and chosen not in ("standard", "boolean"):
            raise UsageError(
                "a monitor of 'count' has standard or boolean semantics, for what it counts may have several roles; "
                "evaluate recordings"
            )
        splitting = Splitting(
            domain.period or Fraction(1),
            lambda formula: apply_semantics(formula, chosen, roles),
            self.text,
            held_at_end=domain.held_at_end,
            late=not early,
        )
        found = [Watched(self.text, self.formula, self.text)]
        found += [replace(self._watched(each, "standard")) for each in watch]
        (formula, *others), quantified = splitting.outer(domain.ground(*(each.formula for each in found)))
        monitor = make(
            formula,
            domain,
            quantified,
            self.groups,
            names=self.input_names,
            text=self.text,
            backend=self.backend,
            declared=self._declared,
            watch=[replace(each, formula=other) for each, other in zip(found[1:], others, strict=True)],
            factory=partial(
                _monitor,
                self,
                time=domain,
                tolerance=tolerance,
                semantics=semantics,
                watch=watch,
                time_unit=time_unit,
                verdict=verdict,
                **settings,
            ),
            types=self.types,
            **settings,
            **({} if time_unit is None else {"unit": time_unit}),
        )
        monitor.bind(self.binding)
        return cast("OnlineMonitor", monitor)  # not a subclass: it has several

    def compile(
        self,
        *,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        resolution: Duration | None = None,
        semantics: Semantics | None = None,
        verdict: str = DELAYED,
        worst_case: bool = False,
    ) -> Program:
        """Compile the requirement to a standalone program, which the core runs without Python.

        Its outputs are ``robustness`` (ρ, or that of ``semantics``) and ``verdict`` (+inf where the
        formula holds, -inf where it does not); for several requirements these refer to their conjunction, and each has
        its own, ``robustness.R1`` and ``verdict.R1``. The parameters and named constants of the specification are
        parameters of the program, except those that bound an interval. Settings, errors and
        ``worst_case`` as for :meth:`monitor`.

        With ``verdict="interval"`` its outputs are bounds at the start of the trace, valid for every continuation:
        ``lower``, ``upper``, ``verdict``, and ``decided_since``, the seconds from the first sample to the one that
        decided the verdict. The future may then be unbounded; time is discrete. Declared ranges bound later samples,
        and the program refuses a sample outside.

        >>> import rtamt
        >>> program = rtamt.parse("always[0:200ms](x >= 3)").compile(period="100ms")
        >>> program.lags, len(program.to_bytes())
        ((2, 2), 463)
        """
        from rtamt.verdicts.standalone import bounds_program, carried_program  # parsing does not wait for it

        self.require_no_groups("a compiled program")
        domain = self._domain_for(time, period, None, resolution).online
        chosen = self._semantics(semantics)
        require_samples(domain, worst_case=worst_case)
        if mode_of(verdict, {"worst_case": True} if worst_case else {}).name != DELAYED:
            if verdict != "interval":
                raise UsageError(f"verdict='{verdict}' cannot be compiled; choose from {DELAYED}, interval")
            applied = self._apply_semantics(self.formula, chosen)
            return bounds_program(
                self.formula, domain, applied=applied, text=self.text, name=self.name, ranges=self.ranges
            )
        several = self.requirements if len(self.requirements) > 1 else {}
        parts = {name: one._outputs(chosen) for name, one in several.items()}
        program = carried_program(
            self.formula,
            applied=self._apply_semantics(self.formula, chosen),
            parts=parts,
            domain=domain,
            text=self.text,
            name=self.name,
        )
        return program.for_worst_case() if worst_case else program


def _monitor(
    spec: OnlineSpecification, parameters: Mapping[str, Any] | None = None, **settings: Any
) -> OnlineMonitor:
    """Return a monitor of a specification with values of parameters; ``settings``: those of ``monitor()``."""
    monitor: OnlineMonitor = spec.with_parameters(**(parameters or {})).monitor(**settings)
    return monitor
