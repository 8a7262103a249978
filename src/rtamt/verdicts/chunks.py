"""Requirements over the chunks of a recording: the formulas that a monitor computes, and their results."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.engine import Evaluators
from rtamt.language.formula import Apply, Const
from rtamt.language.operators import STL
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.rewrite.horizon import horizon
from rtamt.signals.episodes import WindowTracker, place_in
from rtamt.verdicts.decompose import Anchored, Leaf, anchor, check_in_chunks
from rtamt.verdicts.robustness_and_truth import align_inputs, outputs_under
from rtamt.verdicts.trackers import Tracker, Trackers

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.rewrite.semantics import PredicateSemantics
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.episodes import Episodes, Positions
    from rtamt.signals.time_domain_interface import TimeDomain
    from rtamt.specification import Specification


@dataclass(frozen=True, slots=True)
class StreamResult:
    """The result of a check in chunks.

    ``robustness``: ρ at the first instant, ``start``. ``satisfied``: whether the formula holds there (Boolean
    semantics). ``first_violation``: when it is first violated, see :func:`rtamt.first_violation`; None
    where it holds. ``minimum``: the smallest ρ at any instant; None where the future is unbounded and
    chunks do not have it. ``samples``: the number of instants at which a variable has a sample. ``period``: seconds
    from one sample to the next; None in dense time. ``episodes``: how many episodes of violation there are, the worst
    and the first ones, see ``Result.episodes``; None of several requirements, and as for ``minimum``.
    ``steady``: False if the period was inferred from the first chunk, and another chunk has another one.
    ``requirements``: the same for each requirement, by name.

    >>> import rtamt
    >>> chunks = [{"time": [0, 1], "x": [5, 4]}, {"time": [2, 3], "x": [1, 6]}]
    >>> result = rtamt.check_stream(rtamt.parse("always(x >= 3)"), chunks)
    >>> result.robustness, result.satisfied, result.first_violation, result.samples
    (-2.0, False, 2.0, 4)
    """

    robustness: float
    satisfied: bool
    first_violation: Any
    minimum: float | None
    samples: int
    period: Fraction | None
    start: Any = 0.0
    episodes: Episodes | None = None
    steady: bool = True
    requirements: Mapping[str, StreamResult] = field(default_factory=lambda: MappingProxyType({}))


class Requirement:
    """One requirement over chunks: its robustness, its truth and its minimum, from the leaves of each."""

    def __init__(self, spec: Specification, semantics: str | PredicateSemantics | None) -> None:
        self.spec = spec
        self._outputs = outputs_under(spec.formula, semantics or spec.semantics, spec.roles)
        check_in_chunks(anchor(self._outputs.robustness), spec.text)
        self._robust: Anchored
        self._truth: Anchored
        self._whole: Leaf | None
        self._violated: Leaf | None
        self._robustness: Trackers
        self._verdict: Trackers
        self._minimum: Tracker | None = None
        self._episodes: WindowTracker | None = None

    @property
    def leaves(self) -> Iterator[Leaf]:
        """The leaves of robustness and truth."""
        yield from self._robust.leaves
        yield from self._truth.leaves

    @property
    def formulas(self) -> Iterator[Formula]:
        """The formulas whose signals this requirement reads."""
        yield from (leaf.formula for leaf in self.leaves)
        if self._whole is not None:
            yield self._whole.formula

    def ground(self, domain: TimeDomain) -> None:
        """Find the leaves, once the length of a period or tick is known."""
        robustness, truth = domain.ground(*self._outputs)
        self._robust, self._truth = anchor(robustness), anchor(truth)
        # The whole formula, for its minimum, where it can be known online.
        bounded = horizon(robustness) is not None
        self._whole = Leaf(robustness, "min", end=None) if bounded else None
        # Episodes are those of φ in its window if the formula is always φ, else of the whole formula.
        (first, *_) = (*self._robust.leaves, None)
        top = self.spec.formula
        always = isinstance(top, Apply) and top.op is STL["always"]
        self._violated = first if always else self._whole

    def begin(self, unit: Fraction, dense: bool, outputs: Mapping[Formula, Output]) -> None:
        """Make the trackers; ``unit``: seconds of a period or tick."""
        self._dense = dense
        self._robustness, self._verdict = (
            Trackers(each, unit, dense) for each in (self._robust, self._truth)
        )
        for tracker in (*self._robustness.leaves, *self._verdict.leaves):
            outputs[tracker.leaf.formula].trackers.append(tracker)
        if self._whole is not None:
            self._minimum = Tracker(self._whole, unit, dense)
            outputs[self._whole.formula].minima.append(self._minimum)
        if self._violated is not None:
            begin, end = self._violated.begin / unit, self._violated.end
            self._episodes = WindowTracker(
                int(begin), None if end is None else int(end / unit), continuous=dense, few=True
            )
            outputs[self._violated.formula].episodes.append(self._episodes)

    def result(
        self, time: Callable[[int], Any], last: int, samples: int, period: Fraction | None
    ) -> StreamResult:
        """Return the results over all chunks.

        ``time``: from a position to a time in the caller's form; ``last``: the position of the end of the trace.
        """
        evaluate = Evaluators(self.spec.backend)
        self._robustness.finish()
        self._verdict.finish()
        violated = self._verdict.violation(evaluate)
        if self._minimum is not None:
            self._minimum.finish()
        return StreamResult(
            self._robustness.value(evaluate) + 0.0,  # as of an evaluation
            violated is None,
            None if violated is None else time(violated),
            None if self._minimum is None else self._minimum.value,
            samples,
            period,
            time(0),
            None if self._episodes is None else self._summary(self._episodes, time, last),
        )

    def _summary(self, tracker: WindowTracker, time: Callable[[int], Any], last: int) -> Episodes:
        tracker.finish(last)
        found = tracker.summary()
        return (
            found.with_times(time) if self._dense else found
        )  # in discrete time it has the timestamps of samples


class Output:
    """One output of a monitor: the trackers that read it, and how far it was known."""

    def __init__(self) -> None:
        self.trackers: list[Tracker] = []
        #: Of minima and episodes, which end with the last sample.
        self.minima: list[Tracker] = []
        self.episodes: list[WindowTracker] = []
        self.known = 0
        self.last: Any = None  # the last timestamp at which it was known

    def take(
        self, positions: Positions, values: FloatArray, last: int | None = None, times: Any = None
    ) -> None:
        """Take what became known.

        ``last``: the last position that minima and episodes are about; ``times``: the timestamps of samples, if
        a position alone does not give them.
        """
        for tracker in self.trackers:
            tracker.take(positions, values)
        if last is not None:
            end = place_in(positions, last, "right")
            positions, values = positions[:end], values[:end]
        for tracker in self.minima:
            tracker.take(positions, values)
        for each in self.episodes:
            each.take(positions, values, times)


class Group:
    """Requirements with a common trace: one program computes all leaves of all of them."""

    def __init__(self, requirements: Mapping[str, Requirement], names: Sequence[str]) -> None:
        self.requirements = requirements
        self.names = tuple(names)
        self.formulas: tuple[Formula, ...]
        self.outputs: dict[Formula, Output]
        self.start: int | None = None

    def begin(self, domain: TimeDomain, spec: Specification) -> Specification:
        """Make the trackers; return the specification of the first formula, whose monitor watches the others."""
        step = domain.step
        assert step is not None, "known before"
        for each in self.requirements.values():
            each.ground(domain)
        formulas = dict.fromkeys(f for each in self.requirements.values() for f in each.formulas)
        self.formulas = tuple(formulas) or (Const(float("inf")),)  # a constant has no leaves
        self.outputs = {formula: Output() for formula in self.formulas}
        for each in self.requirements.values():
            each.begin(step, domain.continuous, self.outputs)
        return spec.with_formula(align_inputs(self.formulas[0], self.names, spec.types))
