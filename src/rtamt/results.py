"""The result of an evaluation: robustness and verdict at the first instant, and signals on demand."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError, UsageError, did_you_mean
from rtamt.language.contents import variables
from rtamt.language.parsing.grammar import is_number
from rtamt.language.printing.printer import excerpt
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.modules import np
from rtamt.signals.listing import show_time
from rtamt.signals.outcomes import BoundedSignal, Interval
from rtamt.verdicts import offline as verdicts
from rtamt.verdicts.offline import Findings, findings_of
from rtamt.violations import episodes_in_steps, first_violation, signals_of

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from rtamt.engine.direct import Reading
    from rtamt.explain.explanation import Explanation
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.episodes import Episode
    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace
    from rtamt.specification import Specification


class _Slots:
    """The attributes that every result has; with them alone, a result needs no dict."""

    __slots__ = ("_found", "semantics", "specification")


@dataclass(frozen=True, eq=False, repr=False, init=False)
class Result(_Slots):
    """The result of an evaluation: robustness and verdict at the first instant, and the whole signal.

    >>> import rtamt
    >>> rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 2]})
    <result of always(x >= 3): robustness -1.0 at 0.0>
    """

    specification: Specification
    #: The semantics of predicates: a name, or the given function.
    semantics: str | PredicateSemantics
    #: What is known already: of a requirement what its program has found, of several with different starts each.
    known: Findings | Mapping[str, Result] | None = None
    #: Of a direct evaluation what it has found, from which the trace and the signal are created on first use.
    _found: tuple[Reading, Any] | None = field(init=False)

    def __init__(
        self,
        specification: Specification,
        trace: DomainTrace,
        signal: Signal,
        semantics: str | PredicateSemantics = "standard",
        known: Findings | Mapping[str, Result] | None = None,
    ) -> None:
        # The __init__ of a frozen dataclass takes as long as the evaluation of a short trace.
        _set_specification(self, specification)
        _set_semantics(self, semantics)
        _set_found(self, None)
        fields = self.__dict__
        fields["_trace"] = trace
        fields["_signal"] = signal
        fields["known"] = known

    # No cached_property: its lock takes longer than the rest.
    @property
    def trace(self) -> DomainTrace:
        """The recording."""
        fields = self.__dict__
        if "_trace" not in fields:
            assert self._found is not None
            reading, found = self._found
            fields["_trace"] = self.specification._with_units(reading.trace(found))
        trace: DomainTrace = fields["_trace"]
        return trace

    @property
    def signal(self) -> Signal:
        """ρ at every sample; in dense time at every change and at the end: ``.times`` and ``.values``."""
        if self._found is None:
            signal: Signal = self.__dict__["_signal"]
            return signal
        reading, found = self._found
        return reading.signal(found)

    @property
    def _size(self) -> int:
        """The number of evaluated samples, without making a signal of them."""
        if self._found is not None:
            reading, found = self._found
            return int(reading.samples(found))
        return len(self.signal)

    def __repr__(self) -> str:
        of = self.specification.name or self.specification.formula
        start = self.signal.times[0]
        at = show_time(start) if isinstance(start, np.timedelta64) else start
        return f"<result of {of}: robustness {_format_robustness(self.interval)} at {at}>"

    def _repr_html_(self) -> str:
        from html import escape

        rows = []
        for name, part in self.requirements.items():
            formula = escape(excerpt(part.specification.formula))
            rows.append(
                f"<tr><td>{escape(name)}</td><td><code>{formula}</code></td>"
                f"<td>{_format_robustness(part.interval, '.6g')}</td>"
                f"<td>{escape(part._verdict)}</td></tr>"
            )
        head = "<tr><th>requirement</th><th>formula</th><th>robustness</th><th>verdict</th></tr>"
        return f"<table>{head}{''.join(rows)}</table>"

    @property
    def _verdict(self) -> str:
        if self.trace.bounds:
            decided = self._decided
            return "open" if decided is None else "satisfied" if decided else "violated"
        violated = first_violation(self)
        if violated is None:
            return "satisfied"
        return f"violated, first at {show_time(violated, self.signal.times[0])}"

    @cached_property
    def requirements(self) -> Mapping[str, Result]:
        """The results of the requirements by name, in the order of the text.

        The robustness of this result is their minimum, and it is satisfied if all of them are. In dense
        time each requirement has its own trace, which starts when all of its variables have started.

        >>> import rtamt
        >>> spec = rtamt.parse("require low: always(x <= 3); require high: always(x >= 1)")
        >>> result = spec.evaluate({"x": [1, 2, 5]})
        >>> {name: part.robustness for name, part in result.requirements.items()}
        {'low': -2.0, 'high': 0.0}
        >>> result.robustness, result.requirements["high"].satisfied
        (-2.0, True)
        """
        specs = self.specification.requirements
        if len(specs) == 1:
            return MappingProxyType(dict.fromkeys(specs, self))
        if isinstance(self.known, Mapping):
            return self.known
        spec = self.specification
        outputs = [one._outputs(self.semantics) for one in specs.values()]
        return requirements_of(spec, findings_of(outputs, self.trace, spec._signals_of), self.semantics)

    @property
    def robustness(self) -> float:
        """ρ at the first instant: how far the recording is from violating (or satisfying)."""
        if self.known is not None and isinstance(
            self.known, Mapping
        ):  # the check takes longer than all the rest
            return min(part.robustness for part in self.known.values())
        if isinstance(self.signal, BoundedSignal):
            return self.signal.value(0) + 0.0
        return float(self.signal.values[0]) + 0.0  # no minus before a zero

    @property
    def interval(self) -> Interval:
        """Bounds of the robustness at the first instant, over all traces that agree with the samples.

        If all samples are known exactly, both bounds are the robustness.

        >>> import rtamt
        >>> spec = rtamt.parse("eventually[0:2](x >= 3)")
        >>> spec.evaluate({"x": [1, None, 2]}, ranges={"x": (0, 10)}).interval
        Interval(lower=-1.0, upper=7.0)
        >>> spec.evaluate({"x": [1, 4, 2]}).interval
        Interval(lower=1.0, upper=1.0)
        """
        if isinstance(self.signal, BoundedSignal):
            return self.signal.at(0)
        return Interval(self.robustness, self.robustness)

    @property
    def intervals(self) -> BoundedSignal:
        """The bounds at every instant of :attr:`signal`: ``.times``, ``.lower`` and ``.upper``.

        >>> import rtamt
        >>> intervals = rtamt.parse("x >= 3").evaluate({"x": [1, 4]}, uncertainty={"x": 0.5}).intervals
        >>> intervals.lower, intervals.upper
        (array([-2.5,  0.5]), array([-1.5,  1.5]))
        """
        if isinstance(self.signal, BoundedSignal):
            return self.signal
        return BoundedSignal(self.signal.times, self.signal.values, self.signal.values)

    @property
    def satisfied(self) -> bool:
        """Whether the formula holds at the first instant: Boolean semantics, evaluated on its own.

        It is the same under every semantics, and defined even if the robustness is 0.

        >>> import rtamt
        >>> [rtamt.parse(text).evaluate({"x": [3]}).satisfied for text in ("x >= 3", "x > 3")]
        [True, False]
        """
        fields = self.__dict__
        if "_satisfied" not in fields:
            fields["_satisfied"] = self._verdict_at_start()
        satisfied: bool = fields["_satisfied"]
        return satisfied

    def _verdict_at_start(self) -> bool:
        trace = self.trace
        if trace.bounds:
            decided = self._decided
            if decided is None:
                raise EvaluationError(
                    "the samples do not decide whether the formula holds, because some are missing or uncertain; "
                    "read result.interval"
                )
            return decided
        holds = self.specification._holds(trace) if self.known is None else None
        return self._first_violation is None if holds is None else holds

    @property
    def _decided(self) -> bool | None:
        """The verdict at the first instant from partly known samples; None if they do not decide it."""
        _, truth = signals_of(self)
        assert isinstance(truth, BoundedSignal)
        holds, fails = truth.lower[0] > 0, truth.upper[0] < 0
        return bool(holds) if holds or fails else None

    @cached_property
    def _first_violation(self) -> Any:
        spec = self.specification
        if len(spec.document.requirements) > 1:
            violations = [part._first_violation for part in self.requirements.values()]
            return min((each for each in violations if each is not None), default=None)
        if isinstance(self.known, Findings) and self.known.violations:
            return self.known.violations[0]
        if self.trace.bounds:
            if self._verdict_at_start():
                return None
            if verdicts.is_violated_at_start(spec._outputs().truth, self.trace):
                return self.trace.time(0)
        return verdicts.first_violation(spec._outputs().truth, self.trace, spec._signals_of)

    def episodes(self) -> list[Episode]:
        """Return the maximal runs of violation, with begin, end, and the worst robustness and its instant.

        For ``always φ``, these are the runs in which φ is violated, within its window from the first instant on; for
        any other formula, the runs of instants at which its robustness is below 0. With several requirements, call it
        for each: ``result.requirements["R1"].episodes()``. Online: ``monitor(episodes=True)``.

        >>> import rtamt
        >>> result = rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2, 3, 4], "x": [5, 2, 1, 3, 0]})
        >>> for episode in result.episodes():
        ...     print(episode)
        Episode(begin=1.0, end=2.0, worst=-2.0, at=2.0)
        Episode(begin=4.0, end=4.0, worst=-3.0, at=4.0)
        """
        if len(self.specification.requirements) > 1:
            first = next(iter(self.specification.requirements))
            raise UsageError(
                f"the specification has several requirements; ask one of them for its episodes, such as "
                f"result.requirements['{first}']"
            )
        return [episode.with_times(self.trace.time) for episode in episodes_in_steps(self)]

    def explain(self, at: Any = None) -> Explanation:
        """Explain why the formula is satisfied or violated: which signals are responsible, and when.

        ``at``: a time of the trace, in the form in which times were given; by default the first instant. The
        explanation covers the robustness under the semantics of the evaluation, and the verdict, which is the
        same under every semantics. Raises :class:`UsageError` if the trace has no such time.

        >>> import rtamt
        >>> spec = rtamt.parse("always(req >= 3 -> eventually[0:2](gnt >= 3))")
        >>> explanation = spec.evaluate({"req": [0, 6, 0, 0, 0], "gnt": [0, 0, 0, 1, 7]}).explain()
        >>> print(explanation)
        violated, robustness -2: always(req >= 3 -> eventually[0:2](gnt >= 3))
        first violation at 1 s
        critical point at 3 s: 'gnt >= 3' is -2; the robustness follows it from -3 to 3
        sufficient cause, independent of all other samples:
          'req >= 3' holds at 1 s (3)
          'gnt >= 3' fails from 1 s to 3 s (-3 to -2)
        >>> explanation.critical.predicate, explanation.critical.time, explanation.critical.value
        ('gnt >= 3', 3.0, -2.0)
        """
        from rtamt.explain.explain import explain

        self._require_exact("explain")
        spec = self.specification
        return explain(
            spec.formula,
            self.trace,
            backend=spec.backend,
            at=at,
            text=spec.text,
            semantics=lambda predicate: spec._apply_semantics(predicate, self.semantics),
            signal=self.signal,
        )

    def plot(
        self,
        at: Any = None,
        *,
        rows: int = 6,
        start: Any = None,
        end: Any = None,
        zoom: str | None = None,
        bounds: bool = False,
        figure: Figure | None = None,
    ) -> Figure:
        """Plot the signals, the robustness over time and the explanation; needs ``pip install 'rtamt[plot]'``.

        Signals that a predicate compares share a panel. Below them are the robustness of the formula and of at
        most ``rows - 1`` sub-formulas: violated requirements, other named ones, those that the explanation
        mentions, and those next to the top. Intervals in which a formula does not hold are shaded (Boolean
        semantics), the sufficient cause is yellow, and a diamond marks the critical point; infinities are drawn at
        the edge. ``at``: the instant to explain, as in :meth:`explain`. ``start`` and ``end``: the visible time range;
        ``zoom="violation"``: the range around the first violation. ``bounds``: also draw the bounds of the
        robustness at the start, as known after each sample, a band that narrows to it, and the sample that decided
        the verdict. ``figure``: the matplotlib figure to draw into, by default a new one of pyplot.

        Where samples are missing or uncertain, signals and robustness are bands between their bounds, and the instants
        whose verdict the samples do not decide are grey. There is no explanation, and ``zoom`` and ``bounds`` are
        rejected.

        >>> import rtamt
        >>> from matplotlib.figure import Figure
        >>> result = rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 2, 6]})
        >>> figure = result.plot(figure=Figure())
        >>> [axis.get_title(loc="left") for axis in figure.axes]
        ['', 'always(x >= 3)', 'x >= 3']
        """
        from rtamt.plot.figure import draw, figure_for
        from rtamt.plot.scene import scene

        self._require_one_start("plot")
        if self.trace.bounds:
            from rtamt.plot.uncertain import draw_uncertain

            return draw_uncertain(
                self, figure, at=at, rows=rows, start=start, end=end, zoom=zoom, bounds=bounds
            )
        seen = scene(self, at, bounds=bounds)
        window = seen.window(start, end, zoom)
        canvas: Figure = figure_for(figure)
        draw(seen, rows, canvas, window)
        return canvas

    def plot_tree(self, at: Any = None, *, figure: Figure | None = None) -> Figure:
        """Plot the formula as a tree, each sub-formula with its robustness and verdict at an instant.

        ``at`` and ``figure`` as for :meth:`plot`. The predicate of the critical point has a thick frame.

        >>> import rtamt
        >>> from matplotlib.figure import Figure
        >>> result = rtamt.parse("x >= 3 and y >= 0").evaluate({"x": [5], "y": [-1]})
        >>> [text.get_text() for text in result.plot_tree(figure=Figure()).axes[0].texts][2:4]
        ['φ and ψ', '✗ −1']
        """
        from rtamt.plot.figure import figure_for
        from rtamt.plot.scene import scene
        from rtamt.plot.tree import draw_tree

        self._require_exact("draw the tree of")
        canvas: Figure = figure_for(figure)
        draw_tree(scene(self, at), canvas)
        return canvas

    def __getitem__(self, name: str) -> Signal:
        """Return the signal of a named sub-specification, or of any formula over the same variables.

        The semantics is that of the evaluation; numbers (``x + 1``) are the same under every semantics.

        >>> import rtamt
        >>> result = rtamt.parse("low = x <= 3; always(low)").evaluate({"time": [0, 1], "x": [1, 2]})
        >>> result["low"]
        Signal(times=array([0., 1.]), values=array([2., 1.]))
        >>> result["x + 1"].values
        array([2., 3.])
        """
        if len(self.specification.requirements) > 1 and name in self.specification.requirements:
            return self.requirements[name].signal
        formula = self.specification._named(name)
        names = tuple(self.trace.columns)
        for variable in variables(formula):
            if variable not in self.trace.columns:
                raise UsageError(
                    f"'{name}' reads '{variable}', which the formula does not{did_you_mean(variable, names)}; "
                    f"the recording was read for {', '.join(names)} only"
                )
        self.trace.check(formula, name)
        if not is_number(formula):
            formula = self.specification._apply_semantics(formula, self.semantics)
        return self.specification._signals_of((formula,), self.trace)[0]

    #: A result is no sequence of its signals.
    __iter__ = __contains__ = None

    def __bool__(self) -> bool:
        """Raise :class:`UsageError`: by default every object is true, also the result of a violation."""
        raise UsageError(
            "a result is neither true nor false; read result.satisfied, result.robustness or result.interval"
        )

    def _require_exact(self, what: str) -> None:
        """Raise :class:`UsageError` if the samples give only bounds, or requirements start at different times."""
        if self.trace.bounds:
            raise UsageError(
                f"cannot {what} a result of missing or uncertain samples; read result.interval, or evaluate samples "
                f"that are known exactly"
            )
        self._require_one_start(what)

    def _require_one_start(self, what: str) -> None:
        """Raise :class:`UsageError` if requirements have traces that start at different times."""
        if isinstance(self.known, Mapping):
            starts = {name: part.signal.times[0] for name, part in self.known.items()}
            first = min(starts, key=lambda name: starts[name])
            last = max(starts, key=lambda name: starts[name])
            raise UsageError(
                f"the requirements start at different times, '{first}' at {show_time(starts[first])} and '{last}' at "
                f"{show_time(starts[last])}; {what} one of them, such as result.requirements['{first}']"
            )


#: Of the result of a direct evaluation these attributes alone are set; the others are created on first use.
DIRECT_SLOTS = ("specification", "semantics", "_found")
_set_specification, _set_semantics, _set_found = (getattr(_Slots, name).__set__ for name in DIRECT_SLOTS)


def requirements_of(
    spec: Specification, findings: Sequence[Findings], semantics: str | PredicateSemantics
) -> Mapping[str, Result]:
    """Return the results of the requirements of a specification, by name."""
    return MappingProxyType(
        {
            name: Result(one, each.trace, each.signal, semantics, each)
            for (name, one), each in zip(spec.requirements.items(), findings, strict=True)
        }
    )


def _format_robustness(bounds: Interval, form: str = "") -> str:
    """Return the robustness, or its bounds where samples are missing or uncertain."""
    lower, upper = format(bounds.lower, form), format(bounds.upper, form)
    return lower if bounds.lower == bounds.upper else f"from {lower} to {upper}"
