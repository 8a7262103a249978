"""Violations of a result: the first one, the episodes, and the signals that they follow from."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.language.formula import Apply
from rtamt.language.operators import STL
from rtamt.signals.episodes import WindowTracker
from rtamt.signals.outcomes import BoundedSignal

if TYPE_CHECKING:
    from rtamt.language.formula import Formula
    from rtamt.results import Result
    from rtamt.signals.episodes import Episode
    from rtamt.signals.signal import Signal


def signals_of(result: Result, formula: Formula | None = None) -> tuple[Signal, Signal]:
    """Return the robustness and the truth of a formula over the recording of a result, by default that of the result.

    The robustness is that under the semantics of the result; the truth is +inf where the formula holds, else -inf.
    """
    spec = result.specification
    robustness, truth = spec._signals_of(spec._outputs(result.semantics, formula), result.trace)
    return robustness, truth


def episodes_in_steps(result: Result, *, certain: bool = False) -> list[Episode]:
    """Return the episodes of violation of one requirement; their times are positions of the trace.

    ``certain``: of partly known samples the episodes that any values have, with upper bounds of their worst robustness.
    """
    spec, trace = result.specification, result.trace
    (formula,) = trace.domain.ground(spec.formula)
    begin, end = 0, None
    if isinstance(formula, Apply) and formula.op is STL["always"]:
        if formula.interval is not None:
            begin = int(formula.interval.begin / trace.step)
            end = None if formula.interval.end is None else int(formula.interval.end / trace.step)
        formula = formula.args[0]
    applied = spec._apply_semantics(formula, result.semantics)
    (signal,) = spec._signals_of((applied,), trace.in_steps().held_until(trace.latest))
    values = signal.upper if certain and isinstance(signal, BoundedSignal) else signal.values
    positions = trace.positions(signal)
    tracker = WindowTracker(begin, end, continuous=trace.domain.continuous)
    tracker.take(positions, values)
    tracker.finish(int(positions[-1]))
    return tracker.episodes()


def first_violation(result: Result) -> Any:
    """Return the time at which a requirement is first violated, in the times of the trace; None if it holds.

    For ``always φ`` it is the earliest instant of its window at which φ does not hold, for a conjunction the
    earliest of its parts, and for any other formula the first instant of the trace (Boolean semantics).

    >>> import rtamt
    >>> rtamt.first_violation(rtamt.parse("always(x >= 3)").evaluate({"time": [0, 1, 2], "x": [5, 1, 0]}))
    1.0
    """
    if not hasattr(type(result), "_first_violation"):
        raise UsageError(f"expected a result, got {shown(result)}; write spec.evaluate(data)")
    return result._first_violation
