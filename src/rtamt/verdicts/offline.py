"""Robustness and verdicts of requirements over a finished trace: all outputs of all of them from one program."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError
from rtamt.language.contents import own_variables
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.horizon import reach
from rtamt.rewrite.semantics import no_verdict
from rtamt.signals.dense_arrays import changes, minimum
from rtamt.signals.signal import Signal
from rtamt.verdicts.decompose import anchor
from rtamt.verdicts.trackers import Trackers

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.signals.time_domain_interface import DomainTrace
    from rtamt.verdicts.decompose import Leaf
    from rtamt.verdicts.robustness_and_truth import Evaluate, Outputs
    from rtamt.verdicts.trackers import Tracker

#: Values of all outputs of one program: what many requirements read of a long trace must fit into memory.
ROOM = 2**24


class Findings(NamedTuple):
    """The results of one requirement over its trace.

    ``violations``: when it is first violated (see :func:`first_violation`), in the times of the trace; empty
    where it was not requested, or where an operation of the truth has no value.
    """

    trace: DomainTrace
    signal: Signal
    violations: tuple[Any, ...]


def findings_of(outputs: Sequence[Outputs], trace: DomainTrace, evaluate: Evaluate) -> list[Findings]:
    """Return robustness and verdict of each requirement, each over the trace of its own variables.

    Raises :class:`EvaluationError` if a robustness has no value.
    """
    found: dict[int, Findings] = {}
    for numbers in by_start(outputs, trace):
        whole = trace_of([outputs[i].truth for i in numbers], trace)
        size = max(1, ROOM // max(1, whole.size))
        for first in range(0, len(numbers), size):
            some = numbers[first : first + size]
            findings = _findings_of([outputs[i] for i in some], whole, trace, evaluate)
            found.update(zip(some, findings, strict=True))
    return [found[i] for i in range(len(outputs))]


def findings_apart(
    outputs: Sequence[Outputs], trace: DomainTrace, evaluate: Evaluate
) -> tuple[Signal, list[Findings]]:
    """Return the same of requirements whose traces start at different instants, and their common signal.

    That begins with the first requirement: at each instant it is the minimum over those that have started.
    """
    # In steps, since instants that differ by a tick may be equal in the caller's times.
    found = findings_of(outputs, trace.in_steps(), evaluate)
    every = [(each.signal.times, each.signal.values) for each in found]
    ticks, values = changes(*minimum(every, [np.inf] * len(every)))
    findings = [
        Findings(
            trace_of([output.truth], trace),
            trace.in_caller_times(each.signal),
            tuple(None if step is None else trace.time(step - trace.start) for step in each.violations),
        )
        for output, each in zip(outputs, found, strict=True)
    ]
    return trace.in_caller_times(Signal(ticks, values)), findings


def first_violation(truth: Formula, trace: DomainTrace, evaluate: Evaluate) -> Any:
    """Return when a formula is first violated, in the times of the trace; None where it holds.

    For ``always φ`` that is the earliest instant of its window at which φ does not hold, for a conjunction the
    earliest of its parts, for any other formula the first instant of the trace. Raises
    :class:`EvaluationError` where an operation of the truth has no value.
    """
    try:
        _, violations = _outputs((), [truth], trace, evaluate)
    except EvaluationError as error:
        if trace.bounds:
            raise EvaluationError(
                "the samples do not decide when the formula is first violated, because some are missing or uncertain; "
                "read result.intervals"
            ) from error
        raise no_verdict(error) from error
    return violations[0]


def is_violated_at_start(truth: Formula, trace: DomainTrace) -> bool:
    """Return whether the first violation of a formula that does not hold can only be the first instant."""
    (grounded,) = trace.domain.ground(truth)
    anchored = anchor(grounded)
    leaves = (anchored.leaf(part) for part in anchored.conjuncts())
    return all(leaf is None or leaf.reduce != "min" for leaf in leaves)


# ---- traces ----------------------------------------------------------------------------------------


def trace_of(formulas: Sequence[Formula], trace: DomainTrace) -> DomainTrace:
    """Return the trace of formulas: it starts when all variables that they read have started."""
    return trace.started({name for f in formulas for name in own_variables(f, tuple(trace.columns))})


def by_start(outputs: Sequence[Outputs], trace: DomainTrace) -> list[list[int]]:
    """Return the numbers of the requirements whose traces start at the same instant."""
    groups: dict[int, list[int]] = {}
    for i, each in enumerate(outputs):
        groups.setdefault(trace_of([each.truth], trace).start, []).append(i)
    return list(groups.values())


# ---- outputs ---------------------------------------------------------------------------------------


def _findings_of(
    outputs: Sequence[Outputs],
    trace: DomainTrace,
    whole: DomainTrace,
    evaluate: Evaluate,
) -> Iterator[Findings]:
    """Yield the results of requirements over their common trace, with robustness to the end of the ``whole``."""
    trace = trace.held_until(whole.end)
    robustness = tuple(each.robustness for each in outputs)
    try:
        signals, found = _outputs(robustness, [each.truth for each in outputs], trace, evaluate)
    except EvaluationError:  # of one of the truths, or indeed of a robustness
        signals, found = evaluate(robustness, trace), []
    for i, (each, signal) in enumerate(zip(outputs, signals, strict=True)):
        yield Findings(trace_of([each.truth], whole), signal, tuple(found[i : i + 1]))


def _outputs(
    formulas: tuple[Formula, ...],
    truths: Sequence[Formula],
    trace: DomainTrace,
    evaluate: Evaluate,
) -> tuple[list[Signal], list[Any]]:
    """Return the signals of formulas, and when truths are first violated."""
    grounded = trace.domain.ground(*truths)
    found = [Trackers(anchor(truth), trace.step, trace.domain.continuous) for truth in grounded]
    trackers = [tracker for each in found for tracker in each.leaves]
    signals, leaves = _evaluate_settled(formulas, trackers, trace, evaluate)
    for tracker in trackers:
        signal = leaves[tracker.leaf]
        tracker.take(trace.positions(signal), signal.values)
    for each in found:
        each.finish()
    violations = [each.violation(evaluate) for each in found]
    return signals, [None if position is None else trace.time(position) for position in violations]


def _signals(
    formulas: tuple[Formula, ...],
    trackers: Sequence[Tracker],
    trace: DomainTrace,
    evaluate: Evaluate,
) -> tuple[list[Signal], dict[Leaf, Signal]]:
    """Return the signals of formulas and of leaves, all from one program."""
    asked = tuple(dict.fromkeys((*formulas, *(tracker.leaf.formula for tracker in trackers))))
    known = dict(zip(asked, evaluate(asked, trace), strict=True)) if asked else {}
    return [known[f] for f in formulas], {tracker.leaf: known[tracker.leaf.formula] for tracker in trackers}


def _evaluate_settled(
    formulas: tuple[Formula, ...], trackers: Sequence[Tracker], trace: DomainTrace, evaluate: Evaluate
) -> tuple[list[Signal], dict[Leaf, Signal]]:
    """Return the same, of leaves in steps and as far as each is read after the last sample."""
    in_steps = trace.in_steps()
    start, end, latest = trace.start, trace.end, trace.latest
    ends: dict[int, list[Tracker]] = {end: []}
    if trace.domain.held_at_end:
        for tracker in trackers:
            ends.setdefault(end_of(tracker.leaf, start, latest, trace.step), []).append(tracker)
    try:
        signals, leaves = _signals(formulas, trackers, in_steps.held_until(max(ends)), evaluate)
    except EvaluationError:
        if len(ends) == 1:
            raise
        # What has no value perhaps lies after all that its formula reads.
        signals, leaves = _signals(formulas, (), in_steps, evaluate)
        for end, some in ends.items():
            leaves |= _signals((), some, in_steps.held_until(end), evaluate)[1]
    return list(map(trace.in_caller_times, signals)), leaves


def end_of(leaf: Leaf, start: int, end: int, tick: Fraction) -> int:
    """Return the last tick at which the formula of a leaf is read, from a trace of these ticks.

    A window without an end is read until the formula has settled over the last values.
    """
    if leaf.end is None:
        return end + reach(desugar(leaf.formula), tick) + 1
    return max(end, start + int(leaf.end / tick))
