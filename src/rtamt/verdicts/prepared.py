"""Many requirements compiled once: robustness, truth and first violation from programs without formulas.

The truth of a requirement is that of its *leaves* (``decompose.py``): a first program computes the signals of all of
them, each is reduced over its window, and a second program joins the results, one value each.
"""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.engine.backend import compiled_backend
from rtamt.errors import EvaluationError
from rtamt.language.formula import Var
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.semantics import no_verdict
from rtamt.signals.discrete import DISCRETE, DiscreteTrace
from rtamt.verdicts.decompose import Leaf
from rtamt.verdicts.offline import ROOM
from rtamt.verdicts.trackers import Tracker

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.compiler.stored import StoredPlan
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.time_domain_interface import DomainTrace, TimeDomain

    #: A reduced leaf: its value, and the position at which a minimum is first below 0.
    Reduced = tuple[float, int | None]

_ONE = Fraction(1)


class Asked(NamedTuple):
    """The formulas of a requirement: its robustness under a semantics, and its truth; None where not selected."""

    robustness: Formula | None
    truth: Formula | None


class Window(NamedTuple):
    """A leaf without its formula: the ``reduce`` of an output of a program over the steps [begin, end].

    ``settled``: steps after the last sample for which a window without an end is read.
    """

    output: int
    reduce: str | None
    begin: int
    end: int | None
    settled: int


class Joined(NamedTuple):
    """The outputs for the truth of a requirement: ``value``: its output of the joining program.

    ``windows``: those of its leaves. ``parts``: of each part that must hold, its window if that is a minimum, and else
    its output.
    """

    value: int
    windows: tuple[int, ...]
    parts: tuple[tuple[int | None, int | None], ...]

    def with_outputs(self, moved: Callable[[int], int]) -> Joined:
        """Return the same of a program whose outputs are elsewhere."""
        parts = [(window, None if output is None else moved(output)) for window, output in self.parts]
        return Joined(moved(self.value), self.windows, tuple(parts))


class Found(NamedTuple):
    """The results of one requirement: None where it was not selected, or where there is an ``error``.

    ``violation``: the position at which it is first violated, None where it holds.
    """

    robustness: float | None = None
    satisfied: bool | None = None
    violation: int | None = None
    error: EvaluationError | None = None


@dataclass(frozen=True)
class Prepared:
    """Requirements over the same ``inputs``, ready to be evaluated.

    ``robustness`` and ``leaves``: the plans of these signals; in discrete time they are one. ``outputs``: where the
    robustness of each requirement is, ``joined``: where its truth is; empty where not selected.
    """

    domain: TimeDomain
    inputs: tuple[str, ...]
    robustness: StoredPlan | None
    leaves: StoredPlan | None
    joining: StoredPlan | None
    windows: Mapping[int, Window]
    outputs: tuple[int, ...]
    joined: tuple[Joined, ...]

    @property
    def is_joint(self) -> bool:
        """Whether one plan has the robustness and the leaves."""
        return self.robustness is self.leaves and self.robustness is not None

    def __len__(self) -> int:
        return max(len(self.outputs), len(self.joined))

    def evaluate(self, trace: DomainTrace) -> list[Found]:
        """Return the results of each requirement over a normalised recording of the inputs."""
        width = max([plan.outputs for plan in (self.robustness, self.leaves) if plan is not None], default=1)
        size = max(
            1, ROOM // max(1, trace.size * -(-width // len(self)))
        )  # requirements whose signals fit memory
        if size < len(self):
            starts = range(0, len(self), size)
            parts = [self.part(range(start, min(start + size, len(self)))) for start in starts]
            return [found for part in parts for found in part.evaluate(trace)]
        try:
            return self._together(trace)
        except EvaluationError:
            if len(self) == 1:
                return [self._evaluate_alone(trace)]
            return [self.part([i])._evaluate_alone(trace) for i in range(len(self))]

    def signals(self, trace: DomainTrace) -> list[Any]:
        """Return the robustness signal of each requirement; raise :class:`EvaluationError` if one is undefined."""
        assert self.robustness is not None
        found = trace.signals(self._run[0](trace))
        return [found[output] for output in self.outputs]

    # ---- evaluation ------------------------------------------------------------------------------

    def _together(self, trace: DomainTrace) -> list[Found]:
        if self.is_joint:
            assert self.robustness is not None
            signals = self._run[0](trace)
            robustness = [_first(signals[output]) for output in self.outputs]
            reduced = {i: _reduce(window, signals[window.output]) for i, window in self.windows.items()}
        else:
            robustness = self._robustness(trace)
            reduced = self._evaluate_settled(trace) if self.joined else {}
        truths = self._truths(reduced) if self.joined else [Found()] * len(robustness)
        if not self.outputs:
            return truths
        return [truth._replace(robustness=value) for value, truth in zip(robustness, truths, strict=True)]

    def _evaluate_alone(self, trace: DomainTrace) -> Found:
        """Return the results of the only requirement, of which one part is undefined."""
        robustness = None
        try:
            if self.outputs:
                robustness = self._robustness(trace)[0]
        except EvaluationError as error:
            return Found(error=error)
        if not self.joined:
            return Found(robustness)
        try:
            return self._truths(self._verdict_windows(trace))[0]._replace(robustness=robustness)
        except EvaluationError as error:
            # Without a robustness, the error is that of Boolean semantics.
            return Found(robustness, error=no_verdict(error) if self.outputs else self._error(trace, error))

    def _error(self, trace: DomainTrace, error: EvaluationError) -> EvaluationError:
        """Return the error of the leaves over a trace, whose times are the caller's and not steps, if there is one."""
        assert self.leaves is not None
        try:
            self._evaluator(self.leaves)(trace)
        except EvaluationError as same:
            return same
        return error

    def _robustness(self, trace: DomainTrace) -> list[float]:
        if not self.outputs:
            return []
        assert self.robustness is not None
        plan, outputs = self.robustness, self.outputs
        if plan is self.leaves:
            plan, outputs = plan.part(outputs), tuple(range(len(outputs)))
        values = self._evaluator(plan)(trace)
        return [_first(values[output]) for output in outputs]

    def _verdict_windows(self, trace: DomainTrace) -> Mapping[int, Reduced]:
        """Return the reduced leaves, each from as few samples as it needs."""
        if self.leaves is None or not self.windows:
            return {}
        if not trace.domain.held_at_end:
            needed = [window.output for window in self.windows.values()]
            signals = self._evaluator(self.leaves.part(needed))(trace)
            return {
                i: _reduce(window, signal)
                for (i, window), signal in zip(self.windows.items(), signals, strict=True)
            }
        try:
            return self._evaluate_settled(trace)
        except EvaluationError:
            ends = {_end_of(window, trace) for window in self.windows.values()} | {trace.end}
            if len(ends) == 1:
                raise
            # What has no value perhaps lies after all that its formula reads.
            found: dict[int, Reduced] = {}
            for end in ends:
                some = {i: window for i, window in self.windows.items() if _end_of(window, trace) == end}
                if some:
                    part = self.leaves.part([window.output for window in some.values()], self.inputs)
                    moved = {i: some[i]._replace(output=k) for k, i in enumerate(some)}
                    found.update(self._held(trace, end, self._evaluator(part), moved))
            return found

    def _evaluate_settled(self, trace: DomainTrace) -> dict[int, Reduced]:
        """Return the reduced leaves over a recording in dense time, which all hold until the last is read."""
        ends = [_end_of(window, trace) for window in self.windows.values()]
        return self._held(trace, max([*ends, trace.end]), self._run[1], self.windows) if ends else {}

    def _held(
        self,
        trace: DomainTrace,
        end: int,
        evaluate: Callable[[Any], Sequence[Any]],
        windows: Mapping[int, Window],
    ) -> dict[int, Reduced]:
        steps = trace.in_steps()
        held = steps.held_until(end)
        signals = held.signals(evaluate(held))
        found = {}
        for i, window in windows.items():
            signal = signals[window.output]
            ends = None if window.end is None else Fraction(window.end)
            tracker = Tracker(Leaf(Var("#"), window.reduce, Fraction(window.begin), ends), _ONE, dense=True)
            tracker.take(steps.positions(signal), signal.values)
            tracker.finish()
            found[i] = tracker.value, tracker.violated
        return found

    def _truths(self, reduced: Mapping[int, Reduced]) -> list[Found]:
        assert self.joining is not None
        columns = {f"#{i}": np.array([value]) for i, (value, _) in reduced.items()}
        values = [float(value[0]) for value in self._run[2](DiscreteTrace(np.zeros(1), columns, _ONE))]
        found = []
        for joined in self.joined:
            if values[joined.value] > 0:
                found.append(Found(satisfied=True))
                continue
            violated = []
            for window, output in joined.parts:
                if window is not None:
                    violated += [at for at in (reduced[window][1],) if at is not None]
                elif output is not None and not values[output] > 0:
                    violated.append(0)
            # A forged program may be false although none of its parts is.
            found.append(Found(satisfied=False, violation=min(violated, default=None)))
        return found

    # ---- programs --------------------------------------------------------------------------------

    @cached_property
    def _run(self) -> list[Any]:
        """The evaluators of the three plans."""
        first = None if self.robustness is None else self._evaluator(self.robustness)
        second = first if self.leaves is self.robustness else None
        if second is None and self.leaves is not None:
            second = self._evaluator(self.leaves)
        third = None if self.joining is None else compiled_backend(DISCRETE).stored_evaluator(self.joining)
        return [first or second, second, third]

    def _evaluator(self, plan: StoredPlan) -> Callable[[Any], Sequence[Any]]:
        return compiled_backend(self.domain).stored_evaluator(plan)

    @cached_property
    def _parts(self) -> dict[tuple[int, ...], Prepared]:
        return {}

    def part(self, numbers: Sequence[int]) -> Prepared:
        """Return these requirements alone."""
        key = tuple(numbers)
        if key not in self._parts:
            self._parts[key] = self._make_part(key)
        return self._parts[key]

    def _make_part(self, numbers: tuple[int, ...]) -> Prepared:
        joined = [self.joined[i] for i in numbers] if self.joined else []
        outputs = [self.outputs[i] for i in numbers] if self.outputs else []
        windows = {i: self.windows[i] for each in joined for i in each.windows}
        needed = [window.output for window in windows.values()]
        inputs = self.inputs if self.domain.own_time_bases else ()
        robustness, leaves, joining = self.robustness, self.leaves, self.joining
        if robustness is not None and robustness is leaves:
            places = list(dict.fromkeys([*outputs, *needed]))
            robustness = leaves = robustness.part(places) if places else None
            outputs, needed = list(map(places.index, outputs)), list(map(places.index, needed))
        else:
            if robustness is not None:
                robustness, outputs = robustness.part(outputs, inputs), list(range(len(outputs)))
            if leaves is not None:
                leaves = leaves.part(needed, inputs) if needed else None
                needed = list(range(len(needed)))
        if joining is not None:
            values = [each.value for each in joined]
            values += [output for each in joined for _, output in each.parts if output is not None]
            values = list(dict.fromkeys(values))
            joining = joining.part(values)
            joined = [each.with_outputs(values.index) for each in joined]
        moved = {
            i: window._replace(output=place)
            for (i, window), place in zip(windows.items(), needed, strict=True)
        }
        return Prepared(
            self.domain, self.inputs, robustness, leaves, joining, moved, tuple(outputs), tuple(joined)
        )


def _first(signal: Any) -> float:
    """Return the first value of an output: an array, or ticks and values."""
    values = signal[1] if isinstance(signal, tuple) else signal
    return float(values[0]) + 0.0  # no minus before a zero


def _end_of(window: Window, trace: DomainTrace) -> int:
    """Return the last tick at which a leaf is read."""
    if window.end is None:
        return trace.latest + window.settled
    return max(trace.latest, trace.start + window.end)


def _reduce(window: Window, values: FloatArray) -> Reduced:
    """Return a leaf in discrete time, see :class:`Tracker`."""
    inside = values[window.begin : None if window.end is None else window.end + 1]
    if not len(inside):
        return (-inf if window.reduce == "max" else inf), None
    if window.reduce is None:
        return float(inside[0]), None
    if window.reduce == "max":
        return float(inside.max()), None
    lowest = float(inside.min())
    return lowest, window.begin + int((inside < 0).argmax()) if lowest < 0 else None
