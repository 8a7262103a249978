"""Robustness, verdict and explanation of a request, as data for the page."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

from rtamt.errors import BoundError, EvaluationError, SpecificationError, StlError, UsageError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, postorder
from rtamt.language.operators import STL
from rtamt.language.printing.printer import excerpt, to_text
from rtamt.language.units.durations import format_duration
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.modules import np
from rtamt.play.downsampling import line, number
from rtamt.play.drawn_signals import sample_signals, signal_points
from rtamt.play.recent import Recent
from rtamt.plot.panels import groups
from rtamt.plot.x_axis import XAxis
from rtamt.rewrite.truth import is_predicate
from rtamt.signals.outcomes import BoundedSignal
from rtamt.specification_loader import parse
from rtamt.violations import first_violation, signals_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.explain.explanation import Explanation, Stretch
    from rtamt.play.downsampling import View
    from rtamt.play.messages import Request
    from rtamt.play.online import Replay
    from rtamt.play.recordings import File, Recordings
    from rtamt.results import Result
    from rtamt.signals.time_domain_interface import DomainTrace
    from rtamt.specification import Specification

#: Limits: listed causes, drawn intervals of signals, drawn intervals of violation.
_CAUSES, _STRETCHES, _RUNS = 6, 400, 2000


@dataclass(frozen=True, slots=True)
class Sources:
    """The recordings and the folder of imported files (None: no folder) that requests refer to.

    ``results``: the last evaluation. ``replays``: the last replay.
    """

    recordings: Recordings
    file: File | None = None
    folder: str | None = None
    results: Recent[Result] = field(default_factory=Recent)
    replays: Recent[Replay] = field(default_factory=Recent)


def parse_request(request: Request, sources: Sources) -> Specification:
    """Return the specification of a request; raises :class:`SpecificationError`.

    A sampling period declared in the text takes precedence over that of the request.
    """
    if not request.text.strip():
        raise SpecificationError("write a formula, such as always(x >= 3)")
    spec = parse(request.text, time=request.time, folder=sources.folder)
    if request.dense or request.period is None or spec.document.sampling is not None:
        return spec
    return parse(request.text, time=request.time, period=request.period, folder=sources.folder)


def data_of(request: Request, spec: Specification, sources: Sources) -> Any:
    """Return the data that a request names, as ``evaluate`` takes it."""
    if request.recording is None:
        period = spec.period or request.period or Fraction(1)
        make = signal_points if request.dense else sample_signals
        return make(request.signals, period, request.duration)
    if sources.file is None:
        raise UsageError("the recording is no longer here: load it again")
    trace = sources.recordings.trace(sources.file, spec)
    if not request.resample:
        return trace
    step = spec.period or request.period
    if step is None:
        raise UsageError("to put the signals on one time base, give a period")
    return trace.resample(step, request.resample)


def result_of(request: Request, spec: Specification, sources: Sources) -> Result:
    """Evaluate a request."""
    data = data_of(request, spec, sources)
    if request.recording is None and not request.dense:
        return spec.evaluate(data, period=spec.period or request.period)
    return spec.evaluate(data)


def inner(spec: Specification) -> Specification:
    """Return the formula shown at each instant: ``φ`` for an unbounded ``always φ``, else the formula itself.

    >>> import rtamt
    >>> print(inner(rtamt.parse("always(x >= 3 -> eventually[0:2](y >= 1))")).formula)
    x >= 3 -> eventually[0:2](y >= 1)
    """
    formula = spec.formula
    if isinstance(formula, Apply) and formula.op is STL["always"] and formula.interval is None:
        return spec.with_formula(formula.args[0])
    return spec


def select_requirement(request: Request, result: Result) -> tuple[str, Result]:
    """Return the requirement to explain and monitor: the requested one, else the first violated one."""
    parts = result.requirements
    if request.focus is not None and request.focus in parts:
        return request.focus, parts[request.focus]
    names = [*(name for name, part in parts.items() if verdict_of(part) == "violated"), *parts]
    return names[0], parts[names[0]]


def evaluate_request(request: Request, sources: Sources) -> dict[str, Any]:
    """Evaluate a request; errors in the text or the data are reported in ``error``."""
    answer: dict[str, Any] = {"error": None}
    try:
        spec = parse_request(request, sources)
        answer |= _facts(spec, request, sources)
        if answer["missing"] and request.recording is None:
            return answer
        result = sources.results.keep(request, result_of(request, spec, sources))
        name, part = select_requirement(request, result)
        answer |= _requirement_facts(name, part) | _requirement_lines(result, part, request, None)
        answer["near"] = (
            None if request.view is None else _requirement_lines(result, part, request, request.view)
        )
        answer["requirements"] = [_row(each, one) for each, one in result.requirements.items()]
    except StlError as error:
        answer["error"] = error_as_data(error, sources)
    return answer


def redraw(request: Request, sources: Sources) -> dict[str, Any]:
    """Return the visible part of the last evaluation, as ``near`` of :func:`evaluate_request`."""
    try:
        result = sources.results.of(
            request, lambda: result_of(request, parse_request(request, sources), sources)
        )
        near = _requirement_lines(result, select_requirement(request, result)[1], request, request.view)
    except StlError as error:
        return {"error": error_as_data(error, sources)}
    return {"error": None, "near": near}


def error_as_data(error: StlError, sources: Sources) -> dict[str, Any]:
    """Return an error as data: its message and its position in the text."""
    message = error.message if isinstance(error, SpecificationError) else str(error)
    span = error.span if isinstance(error, SpecificationError) else None
    for path, name in _private_paths(sources):
        message = message.replace(path, name)
    return {
        "message": message,
        "start": None if span is None else span.start,
        "end": None if span is None else span.end,
    }


def _private_paths(sources: Sources) -> list[tuple[str, str]]:
    """Return the paths to hide in messages, with their replacements."""
    found = [] if sources.file is None else [(sources.file.path, sources.file.name)]
    return found if sources.folder is None else [*found, (sources.folder, ".")]


def horizon_over(spec: Specification, trace: DomainTrace) -> float:
    """Return the horizon on a recording, whose period bounds must fit where nothing else gives one."""
    return spec._horizon_in(trace.domain, trace.domain.step if trace.domain.sampled else None)


def _facts(spec: Specification, request: Request, sources: Sources) -> dict[str, Any]:
    """Return the facts that need no data: variables, horizon, warnings."""
    try:
        horizon = spec.horizon
    except BoundError:  # the bounds do not fit the default period
        if request.recording is None:
            raise
        horizon = horizon_over(spec, result_of(request, spec, sources).trace)
    return {
        "variables": list(spec.input_names),
        "missing": [name for name in spec.input_names if name not in request.signals],
        "period": float(spec.period or request.period or 1),
        "declared": spec.document.sampling is not None,
        "horizon": number(horizon) if horizon == float("inf") else format_duration(Fraction(str(horizon))),
        "warnings": [_warning(each) for each in spec.warnings],
    }


def _warning(found: Any) -> dict[str, Any]:
    span = found.span
    return {
        "code": found.code,
        "message": found.message,
        "start": None if span is None else span.start,
        "end": None if span is None else span.end,
    }


def verdict_of(result: Result) -> str:
    """Return the verdict as a word; "open" if missing samples leave it undecided."""
    try:
        return "satisfied" if result.satisfied else "violated"
    except EvaluationError:
        if not isinstance(result.signal, BoundedSignal):
            raise
        return "open"


def _row(name: str, result: Result) -> dict[str, Any]:
    return {"name": name, "verdict": verdict_of(result), "interval": _interval(result)}


def _interval(result: Result) -> list[Any]:
    return [number(result.interval.lower), number(result.interval.upper)]


def _requirement_facts(name: str, result: Result) -> dict[str, Any]:
    """Return the verdict, robustness and explanation of one requirement."""
    x_axis, spec = XAxis.of(result.trace), result.specification
    period = result.trace.domain.period
    answer: dict[str, Any] = {
        "focus": name,
        "formula": to_text(spec.formula, limit=2000),
        "verdict": verdict_of(result),
        "interval": _interval(result),
        "dense": result.trace.domain.continuous,
        "clock": {
            "start": x_axis.start,
            "end": x_axis.end,
            "label": x_axis.label,
            "origin": str(x_axis.origin),
        },
        "samples": result.trace.samples,
        "step": None if period is None else float(period),
        "thresholds": _thresholds(spec),
    }
    if isinstance(result.signal, BoundedSignal):
        return answer | {"explanation": None}
    violation = first_violation(result)
    return answer | {
        "first": None if violation is None else x_axis.position(violation),
        "explanation": _explanation(result.explain(), x_axis),
    }


def _requirement_lines(result: Result, part: Result, request: Request, view: View | None) -> dict[str, Any]:
    """Return the visible lines of one requirement: robustness, signals and violations."""
    signal = part.signal
    positions = XAxis.of(part.trace).positions(signal.times)
    first, *rest = (signal.lower, signal.upper) if isinstance(signal, BoundedSignal) else (signal.values,)
    return {
        "view": view,
        "robustness": line(positions, first, request.width, view),
        "upper": line(positions, rest[0], request.width, view) if rest else None,
        "lines": _lines(result, part, request.width, view),
        "fails": _violation_runs(part, view),
    }


def _violation_runs(part: Result, view: View | None) -> list[list[float]]:
    """Return the intervals in which the monitored formula is violated, each up to the next instant."""
    if part.trace.bounds:
        return []
    _, truth = signals_of(part, inner(part.specification).formula)
    x_axis = XAxis.of(part.trace)
    begins = x_axis.positions(truth.times)
    last = x_axis.end + float(part.trace.domain.period or 0)
    edges = np.diff((truth.values < 0).astype(np.int8), prepend=0, append=0)
    starts, ends = np.flatnonzero(edges > 0), np.flatnonzero(edges < 0)
    until = np.append(begins, last)
    runs = np.column_stack([begins[starts], until[ends]])
    if view is not None:
        runs = runs[(runs[:, 1] >= view[0]) & (runs[:, 0] <= view[1])]
    found: list[list[float]] = runs[:_RUNS].tolist()
    return found


def _lines(result: Result, part: Result, width: int, view: View | None) -> list[dict[str, Any]]:
    """Return the signals of all requirements, on the time axis of the selected one."""
    known = {}
    for name in result.specification.input_names:
        trace = part.trace if name in part.specification.input_names else result.trace
        positions, values = XAxis.of(trace).recorded(name)
        # In dense time requirements may start at different instants, from which dates are counted.
        positions = positions + _shift(trace, part.trace)
        seen = positions >= XAxis.of(part.trace).start
        known[name] = positions[seen], values[seen]
    units = result.specification.units
    return [
        {"name": name, "unit": units.get(name, ""), **line(*both, width, view)}
        for name, both in known.items()
    ]


def _shift(trace: DomainTrace, shown: DomainTrace) -> float:
    """Return the offset between the time axes of two traces."""
    ours, theirs = XAxis.of(trace).origin, XAxis.of(shown).origin
    if isinstance(ours, np.datetime64) and isinstance(theirs, np.datetime64):
        return float((ours - theirs) / np.timedelta64(1, "ns")) / 1e9
    assert not isinstance(ours, np.datetime64)
    assert not isinstance(theirs, np.datetime64)
    return ours - theirs


def _thresholds(spec: Specification) -> dict[str, list[float]]:
    """Return the thresholds of each variable."""
    predicates = [each for each in postorder(spec.formula) if is_predicate(each)]
    found: dict[str, list[float]] = {}
    for name in spec.input_names:
        alone = [each for each in predicates if variables(each) == (name,)]
        found[name] = sorted(limit for group in groups([name], alone) for limit in group.thresholds)
    return found


def _explanation(explanation: Explanation, x_axis: XAxis) -> dict[str, Any]:
    shown, point = explanation.shown(_CAUSES), explanation.critical
    ranking = explanation.ranking[:_STRETCHES]
    return {
        "headline": explanation.headline,
        # The headline and the first violation are shown as numbers.
        "summary": list(explanation.summary[1 if explanation.first_violation is None else 2 :]),
        "causes": [
            {"text": explanation.causes[k], **_place(explanation.implicant[k], x_axis)} for k in shown
        ],
        "more": len(explanation.causes) - len(shown),
        "critical": None if point.predicate is None else x_axis.position(point.time),
        "because": _cause_intervals([explanation.implicant[k] for k in ranking], x_axis),
    }


def _place(stretch: Stretch, x_axis: XAxis) -> dict[str, float]:
    start = x_axis.start if stretch.start is None else x_axis.position(stretch.start)
    return {"start": start, "end": x_axis.end if stretch.end is None else x_axis.position(stretch.end)}


def _cause_intervals(stretches: Sequence[Stretch], x_axis: XAxis) -> Mapping[str, list[list[float]]]:
    """Return the intervals of each signal in the sufficient cause."""
    found: dict[str, list[list[float]]] = {}
    for stretch in stretches:
        for reading in stretch.reads[:_STRETCHES]:
            end = x_axis.end if reading.end is None else x_axis.position(reading.end)
            found.setdefault(reading.signal, []).append([x_axis.position(reading.start), end])
    return found


def name_of(spec: Specification) -> str:
    """Return a formula short enough for a label."""
    return excerpt(spec.formula)


__all__ = [
    "Sources",
    "data_of",
    "error_as_data",
    "evaluate_request",
    "name_of",
    "parse_request",
    "redraw",
    "result_of",
    "select_requirement",
]
