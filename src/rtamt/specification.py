"""``Specification``: requirements that can be evaluated, monitored, printed and rewritten.

Results, and what few recordings need, are imported on use: monitors do not wait for them.
"""

from __future__ import annotations

from functools import cached_property, wraps

from rtamt.engine import engine_of
from rtamt.errors import EvaluationError, UsageError, shown
from rtamt.language.parsing.imports import library_of
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.units.durations import check_unit
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.typing import TYPE_CHECKING, Any, ClassVar, TypeVar, cast
from rtamt.specification_online import OnlineSpecification

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.batch_results import BatchResult
    from rtamt.engine import Evaluators, Query
    from rtamt.language.formula import Formula
    from rtamt.language.parsing.imports import Library
    from rtamt.language.units.durations import Duration
    from rtamt.results import Result
    from rtamt.rewrite.quantifiers import Members
    from rtamt.settings import Semantics
    from rtamt.signals.signal import Signal
    from rtamt.signals.time_domain_interface import DomainTrace, TimeDomain

    _Evaluate = TypeVar("_Evaluate", bound=Callable[..., Result])


def _plain_first(evaluate: _Evaluate) -> _Evaluate:
    """Let ``evaluate`` of data alone skip the defaults of its settings.

    Python looks each of them up by its name: all of them take a fifth of the time of a short trace.
    """

    @wraps(evaluate)
    def plain_first(self: Specification, data: Any, **settings: Any) -> Result:
        return evaluate(self, data, **settings) if settings else self._evaluate_plain(data)

    return cast("_Evaluate", plain_first)


@dataclass(frozen=True, eq=False, repr=False)
class Specification(OnlineSpecification):
    """One requirement or several, with the names, types and sub-formulas of their document.

    Created by :func:`parse` and :func:`load`; immutable, so that it can be shared and reused.

    >>> import rtamt
    >>> rtamt.parse("specification slow always(speed <= 30)")
    <specification slow: always(speed <= 30)>
    """

    #: What evaluates data like those of an earlier evaluation directly, and makes its results; see :class:`Direct`.
    _direct: ClassVar[tuple[Any, ...] | None] = None

    def __post_init__(self) -> None:
        if not hasattr(self.document, "declarations"):
            raise UsageError(
                f"a specification is made by rtamt.parse(text) or rtamt.load(path), got {shown(self.document)}"
            )

    @_plain_first
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
        error), or, in discrete time, a gap in a signal of a trace (in dense time, its last value holds). Then, and
        with ``uncertainty``, the result has bounds: ``result.interval`` at the first instant,
        ``result.intervals`` at each. Where both are equal, the robustness is that number. ``uncertainty``: from
        a variable to the largest error of its samples, in either direction. ``ranges``: from a
        variable to its lowest and highest possible value, by default its declared range. They bound missing and
        uncertain samples; if there are any, a sample outside is an error.

        Raises :class:`TraceError` if the data is invalid, :class:`BoundError` if an interval is
        not a multiple of the period, :class:`EvaluationError` if an operation is undefined.

        >>> import rtamt
        >>> result = rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2], "x": [5, 4, 6]})
        >>> result.robustness, result.satisfied, result.signal.values
        (1.0, True, array([1., 1., 3.]))
        >>> spec = rtamt.parse("always(x >= 3)")
        >>> spec.evaluate({"x": [5, None, 4]}, uncertainty={"x": 0.5}, ranges={"x": (0, 120)}).interval
        Interval(lower=-3.0, upper=1.5)
        """
        plain = time is period is tolerance is resolution is semantics is time_unit is None
        if plain and uncertainty is None and ranges is None:
            return self._evaluate_plain(data)
        query = self._query(time, period, tolerance, resolution, semantics, time_unit)
        return self._evaluate(data, query, semantics, time_unit, uncertainty, ranges)

    def _evaluate_plain(self, data: Any) -> Result:
        """Return the result of data alone, directly where an earlier evaluation has prepared that."""
        if (direct := self._direct) is not None:
            # A short trace is evaluated in a microsecond: each call from here on takes a tenth of one.
            run, columns, reading, semantics, result_of = direct
            found = run(data if data.__class__ is dict else columns(data, self.input_names))
            if found is not None:
                made: Result = result_of(self, semantics, (reading, found))
                return made
        return self._evaluate(data, self._own_query, plain=True)

    def _evaluate(
        self,
        data: Any,
        query: Query,
        semantics: Semantics | None = None,
        time_unit: str | None = None,
        uncertainty: Mapping[str, float] | None = None,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        *,
        plain: bool = False,
    ) -> Result:
        """Return the result of any data; ``plain``: without settings."""
        if self.groups:
            from rtamt.signals.data_errors import nan_of_members
            from rtamt.specification_data import over_data

            spec, data = over_data(self, query, data)
            with nan_of_members(self.groups):
                return spec.evaluate(
                    data,
                    time=query.domain,
                    semantics=semantics,
                    time_unit=time_unit,
                    uncertainty=uncertainty,
                    ranges=ranges,
                )
        if not self._reads_as_given:
            from rtamt.specification_data import sample

            data = sample(self, query, self.binding.applied(data))
            plain = False
        recording = None
        if uncertainty is None and ranges is None:
            recording = query.read(data, self.input_names, self.types)
        if recording is None:
            from rtamt.specification_data import record_inexact

            recording = record_inexact(self, query, data, uncertainty, ranges)
            # Signals with separate time bases need conversion even if they are plain; this is detected once.
            plain = plain and query.domain.own_time_bases and "_direct" not in self.__dict__
            plain = plain and self._has_one_start and not recording.bounds
        if len(self.requirements) > 1:  # a single one has been read with all that it needs
            from rtamt.specification_data import require_times

            require_times(self, query, data)
        if self.units:
            recording = self._with_units(recording)
        self._check(query, recording)
        result = self._result(query, recording)
        if plain:
            self._prepare_directly(query, recording)
        return result

    def evaluate_batch(
        self,
        data: Any,
        *,
        lengths: Any = None,
        time: str | TimeDomain | None = None,
        period: Duration | None = None,
        tolerance: float | None = None,
        semantics: Semantics | None = None,
        time_unit: str | None = None,
    ) -> BatchResult:
        """Evaluate many short traces in discrete time: an array for each variable, a trace in each row.

        ``data``: a mapping from variable to an array of shape (traces, samples); ``"time"`` is optional, one row of
        timestamps for all traces or a row for each. ``lengths``: the number of samples of each trace; what follows
        in its row is ignored. The other arguments are those of :meth:`evaluate`, and so are the results. For
        traces in dense time, of members that come and go, or with missing samples, see :func:`rtamt.evaluate_batch`.

        Raises the error of :meth:`evaluate` for the first invalid trace, prefixed with its index (from 0).

        >>> import numpy as np, rtamt
        >>> spec = rtamt.parse("eventually[0:1](x >= 3)")
        >>> batch = spec.evaluate_batch({"x": np.array([[1, 5, 0], [0, 2, 9]])})
        >>> batch.robustness, batch.satisfied, batch[1].signal.values
        (array([ 2., -1.]), array([ True, False]), array([-1.,  6.,  6.]))
        """
        from rtamt.batch_results import evaluate_rows
        from rtamt.signals.rows import Rows

        query = self._query(time, period, tolerance, None, semantics, time_unit)
        rule = query.domain.sampling(self.sampling)
        for what, unfit in (
            (f"{query.domain.name} time", query.domain.own_time_bases),
            ("groups", bool(self.groups)),
            (f"'{rule}'", rule is not None and rule.hold),
        ):
            if unfit:
                raise UsageError(
                    f"arrays of traces cannot be evaluated with {what}: use rtamt.evaluate_batch(spec, traces)"
                )
        rows = Rows.of(self.binding.applied(data), self.input_names, lengths, self._evaluators.new_rows)

        def evaluate(row: Any) -> Result:
            return self.evaluate(row, time=query.domain, semantics=semantics, time_unit=time_unit)

        return evaluate_rows(self, query, rows, evaluate)

    def _result(self, query: Query, recording: DomainTrace) -> Result:
        """Return the result on a normalised recording; the formula must have been checked."""
        from rtamt.results import Result, requirements_of

        if self.groups:
            self.require_no_groups("this check")
        if len(self.requirements) > 1 and recording.domain.own_time_bases:
            from rtamt.verdicts.offline import by_start, findings_apart

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
        return Result(
            self, recording, self._evaluators.signals(query.formulas, recording)[0], query.semantics
        )

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
        """Return the query of :meth:`evaluate`, with the same arguments and errors."""
        if time is period is tolerance is resolution is semantics is time_unit is None:
            return self._own_query
        return self._query_of(self._domain_for(time, period, tolerance, resolution), semantics, time_unit)

    def _prepare_directly(self, query: Query, recording: DomainTrace) -> None:
        """Evaluate data like this recording directly from now on, where that is possible."""
        from rtamt.results import DIRECT_SLOTS, Result

        direct = self._evaluators.direct(query, recording)
        self.__dict__["_direct"] = direct and (
            *(direct.run, direct.columns, direct.reading),
            *(query.semantics, direct.maker_of(Result, DIRECT_SLOTS)),
        )

    @cached_property
    def _reads_as_given(self) -> bool:
        """Whether data need neither other names and units nor a choice of samples."""
        binding = self.binding
        return self.sampling is None and not (binding.columns or binding.units or binding.unread)

    @cached_property
    def _has_one_start(self) -> bool:
        """Whether all numbers are samples as they are, and the variables alone decide when the trace starts."""
        return not self.types and self.resolved is None and len(self.requirements) == 1

    @cached_property
    def _own_query(self) -> Query:
        return self._query_of(self.domain, None, None)

    def _query_of(self, domain: TimeDomain, semantics: Semantics | None, time_unit: str | None) -> Query:
        from rtamt.engine import Query  # monitors do not wait for it

        unit = None if time_unit is None else check_unit(time_unit)
        chosen = self._semantics(semantics)
        formula = self._apply_semantics(self.formula, chosen)
        domain.check(formula, self.text)
        return Query(formula, self.text, domain, chosen, unit, engine_of(domain))

    def _signals_of(self, formulas: tuple[Formula, ...], trace: DomainTrace) -> list[Signal]:
        """Return the robustness signals of formulas over a normalised recording, all from one program."""
        return self._evaluators(formulas, trace)

    def _holds(self, trace: DomainTrace) -> bool | None:
        """Return whether the formula holds at the first instant; None where that takes more than one evaluation."""
        if not self._has_one_start and trace.domain.own_time_bases:
            return None
        try:
            (truth,) = self._signals_of(self._truth, trace)
        except EvaluationError:  # which need not concern the first instant
            return None
        return bool(truth.values[0] > 0)

    @cached_property
    def _truth(self) -> tuple[Formula]:
        return (self._outputs().truth,)

    def _check(self, query: Query, recording: DomainTrace) -> None:
        if query.domain.step is None:  # else checked without a recording; many recordings have the same step
            key = (query.formula, recording.step.as_integer_ratio())  # hashing fractions is slow
            if key not in self._checked:
                recording.check(query.formula, self.text, given=False)
                self._checked.add(key)

    @cached_property
    def _checked(self) -> set[tuple[Formula, tuple[int, int]]]:
        return set()

    @cached_property
    def _evaluators(self) -> Evaluators:
        from rtamt.engine import Evaluators

        return Evaluators(self.backend)

    def __reduce__(self) -> tuple[Any, ...]:
        from rtamt.language.printing.printer import to_text
        from rtamt.specification_parameters import given_constants

        if self.resolved is not None:
            other = self.formula if self.document.replaced else None
            return _over, (*self.resolved, dict(self.parameters), self.document.selected, other)
        # The text is sufficient, and is parsed without recursion at any length.
        names = ("domain", "period", "resolution", "unit", "backend", "language", "semantics", "sampling")
        settings = {name: getattr(self, name) for name in names}
        replaced = self.document.replaced
        formula = to_text(self.formula, self.language, parameters=True) if replaced else None
        values = given_constants(self), dict(self.parameters), library_of(self.document)
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


def _over(
    spec: Specification,
    members: Members,
    parameters: Mapping[str, float],
    selected: str | None,
    replaced: Formula | None,
) -> Specification:
    made = spec.with_parameters(**parameters).over(members)
    chosen = made if selected is None else made.select(selected)
    return chosen if replaced is None else chosen.with_formula(replaced)


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
