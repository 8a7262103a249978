"""Queries about requirements, answered by sentences with traces."""

from __future__ import annotations

from fractions import Fraction
from time import monotonic
from typing import TYPE_CHECKING

from rtamt.analysis.declared import common_limits, last_limits, require_covered, require_same_signals
from rtamt.analysis.problem import Answer, Problem, group_related
from rtamt.analysis.witness import Goal, Witness
from rtamt.errors import UsageError, shown
from rtamt.language.formula import Apply, Formula, postorder
from rtamt.language.operators import STL, Bounds, Tense
from rtamt.language.printing.printer import excerpt
from rtamt.language.units.durations import format_duration
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.desugar import spelled_out
from rtamt.rewrite.ground import ground
from rtamt.rewrite.horizon import horizon
from rtamt.signals.arrays import is_number
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.specification import Specification

#: Most queries are answered by a trace this short, which takes less time to find.
_SHORT = 8

#: The default length of traces in samples, and the time limit of a query in seconds.
SAMPLES, LIMIT = 200, 10.0


class Part(NamedTuple):
    """One requirement, under its name."""

    name: str
    spec: Specification

    def goal(self, holds: bool = True) -> Goal:
        """Return the goal of a trace on which it holds, or does not hold."""
        return Goal(self.spec, self.spec.formula, holds)


@dataclass(frozen=True, eq=False)
class Conclusion:
    """The answer to one query about requirements.

    ``question``: such as ``"satisfiable"``. ``names``: of the requirements. ``holds``: None if there is no answer.
    ``finding``: whether something is wrong with the requirements. ``sentence``: the answer. ``witness``: the trace that
    shows it, None where the answer is that there is none.
    """

    question: str
    names: tuple[str, ...]
    holds: bool | None
    sentence: str
    finding: bool = False
    witness: Witness | None = None

    def __str__(self) -> str:
        names = ", ".join(name for name in self.names if name)
        return f"{names}: {self.sentence}" if names else self.sentence


class BoundedChecker:
    """Requirements over the same variables, and the traces of 1 to ``samples`` samples.

    ``limit``: seconds that one query may take. ``versions``: whether the specifications are versions of one, of
    which the last one declares the limits of variables. Raises :class:`NotCoveredError` for dense time, and for groups
    of signals.
    """

    def __init__(
        self,
        specs: Sequence[Specification],
        samples: int = SAMPLES,
        limit: float = LIMIT,
        *,
        versions: bool = False,
    ) -> None:
        if not is_number(samples) or samples != int(samples) or samples < 1:
            raise UsageError(f"samples is {shown(samples)}; give a number of samples, 1 or more")
        if not is_number(limit) or not limit > 0:
            raise UsageError(f"limit is {shown(limit)}; give a number of seconds above 0")
        for spec in specs:
            require_covered(spec)
        periods = {spec.period or Fraction(1) for spec in specs}
        if len(periods) > 1:
            listed = " and ".join(format_duration(each) for each in sorted(periods))
            raise UsageError(
                f"the sampling periods differ, {listed}: give both specifications the same period"
            )
        (self.period,) = periods
        self.samples = int(samples)
        self.limit = limit
        self.limits = last_limits(specs) if versions else common_limits(specs)
        require_same_signals(specs)
        for spec in specs:
            Discrete(self.period).check(spec.formula, spec.text)
        self._problems: dict[tuple[int, bool, bool], Problem] = {}

    def problem(self, samples: int, *, whole: bool = False, coarse: bool = False) -> Problem:
        """Return the problem of traces with at most, or exactly, ``samples`` samples; ``coarse``: of coarse ones."""
        key = (samples, whole, coarse)
        if key not in self._problems:
            self._problems[key] = Problem(
                samples, self.period, self.limits, self.limit, whole=whole, coarse=coarse
            )
        return self._problems[key]

    def find(self, goals: Sequence[Goal]) -> Answer:
        """Look for a trace of any length that reaches all goals; short and coarse ones first."""
        if self.samples <= _SHORT:
            return self._first(goals, self.problem(self.samples))
        return self._first(
            goals,
            self.problem(_SHORT),
            self.problem(self.samples, whole=True, coarse=True),
            self.problem(self.samples),
        )

    def find_whole(self, goals: Sequence[Goal]) -> Answer:
        """Look for a trace of the full length that reaches all goals; coarse ones first."""
        coarse = self.problem(self.samples, whole=True, coarse=True)
        return self._first(goals, coarse, self.problem(self.samples, whole=True))

    def _first(self, goals: Sequence[Goal], *problems: Problem) -> Answer:
        """Return the first trace that the engine confirms, without one the answer to the last problem.

        Each problem may take half of the time that is left, the last one all of it.
        """
        end, doubtful = monotonic() + self.limit, None
        for problem in problems:
            left = end - monotonic()
            answer = problem.find(goals, left if problem is problems[-1] else left / 2)
            if answer.witness is not None:
                if answer.witness.confirmed:
                    return answer
                doubtful = doubtful or answer
        return answer if answer.exists is not None or doubtful is None else doubtful

    def require_covered(self, formula: Formula, spec: Specification) -> None:
        """Raise :class:`NotCoveredError` if a part of a formula is not covered."""
        self.problem(min(_SHORT, self.samples)).covers(Goal(spec, formula, True))

    def without_value(self, *parts: Part) -> str | None:
        """Return the sentence that there is no trace on which the parts have values; None if there may be one."""
        goals = [part.goal() for part in parts]
        problems = [self.problem(min(_SHORT, self.samples)), self.problem(self.samples)]
        if any(problem.has_values(goals, self.limit) is not False for problem in problems):
            return None
        verb = "it has" if len(parts) == 1 else "they have"
        return f"{verb} no value on any trace up to {self._length}: evaluations report an error"

    # ---- one requirement -------------------------------------------------------------------------

    def satisfiable(self, *parts: Part) -> Conclusion:
        """Answer whether a trace of the full length satisfies all parts."""
        one, names = len(parts) == 1, tuple(part.name for part in parts)
        question = "satisfiable" if one else "consistent"
        goals = [part.goal() for part in parts]
        answer = self.find_whole(goals)
        satisfies = "satisfies it" if one else "satisfies all of them together"
        if answer.exists is False:
            if nothing := self.without_value(*parts):
                return Conclusion(question, names, False, nothing, True)
            if not one:
                problem = self.problem(self.samples, whole=True)
                names = tuple(parts[k].name for k in _smallest(problem, goals))
            sentence = (
                f"no trace of {self._length} satisfies it"
                if len(names) == 1
                else f"they contradict each other: no trace of {self._length} satisfies them together"
            )
            shorter = self.find(goals)
            if shorter.exists and shorter.witness is not None:
                sentence += f"; a trace of {_samples(shorter.witness.samples)} does"
            return Conclusion(question, names, False, sentence, True, shorter.witness)
        return self._open(question, names, answer) or Conclusion(
            question, names, True, f"{trace_text(answer.witness)} {satisfies}", witness=answer.witness
        )

    def valid(self, part: Part) -> Conclusion:
        """Answer whether a requirement holds on every trace."""
        answer = self.find([part.goal(False)])
        if answer.exists is False:
            if nothing := self.without_value(part):
                return Conclusion("valid", (part.name,), False, nothing, True)
            sentence = f"it always holds: {self._none([part.spec.formula])}"
            return Conclusion("valid", (part.name,), True, sentence, True)
        return self._open("valid", (part.name,), answer) or Conclusion(
            "valid", (part.name,), False, f"{trace_text(answer.witness)} violates it", witness=answer.witness
        )

    # ---- two requirements ------------------------------------------------------------------------

    def implies(self, first: Part, second: Part) -> Conclusion:
        """Answer whether every trace that satisfies the first satisfies the second."""
        names = (first.name, second.name)
        answer = self.find([first.goal(), second.goal(False)])
        if answer.exists is False:
            if nothing := self.without_value(first, second):
                return Conclusion("implies", names, None, nothing)
            none = self._none([first.spec.formula, second.spec.formula])
            return Conclusion("implies", names, True, f"the first implies the second: {none}")
        return self._open("implies", names, answer) or Conclusion(
            "implies",
            names,
            False,
            f"{trace_text(answer.witness)} satisfies the first and violates the second",
            witness=answer.witness,
        )

    def equivalent(self, first: Part, second: Part) -> Conclusion:
        """Answer whether two requirements have the same verdict on every trace."""
        there, back = self.implies(first, second), self.implies(second, first)
        names = (first.name, second.name)
        for one, sentence in (
            (there, "satisfies the first and violates the second"),
            (back, "satisfies the second and violates the first"),
        ):
            if one.holds is False:
                return Conclusion(
                    "equivalent", names, False, f"{trace_text(one.witness)} {sentence}", witness=one.witness
                )
        for one in (there, back):
            if one.holds is None:
                return Conclusion("equivalent", names, None, one.sentence, witness=one.witness)
        none = self._none([first.spec.formula, second.spec.formula])
        return Conclusion("equivalent", names, True, f"they agree: {none}")

    # ---- several requirements --------------------------------------------------------------------

    def redundant(self, parts: Sequence[Part]) -> Iterator[Conclusion]:
        """Answer for each part whether the others imply it; the parts must be consistent."""
        dropped: set[str] = set()
        for part in parts:
            others = [other for other in parts if other is not part and other.name not in dropped]
            violated = part.goal(False)
            # Those that share no signals with it, directly or through others, do not imply it.
            near = next(
                group
                for group in group_related([violated, *(other.goal() for other in others)])
                if violated in group
            )
            others = [other for other in others if other.goal() in near]
            goals = [violated, *(other.goal() for other in others)]
            answer = self.find(goals)
            if answer.exists is False:
                needed = [k for k in _smallest(self.problem(self.samples), goals) if k > 0]
                if not needed:  # it always holds, which is another finding
                    continue
                dropped.add(part.name)
                listed = " and ".join(others[k - 1].name for k in needed)
                none = self._none([goal.formula for goal in goals])
                sentence = f"it is redundant, because {listed} {'imply' if len(needed) > 1 else 'implies'} it: {none}"
                yield Conclusion("redundant", (part.name,), True, sentence, True)
            else:
                yield self._open("redundant", (part.name,), answer) or Conclusion(
                    "redundant",
                    (part.name,),
                    False,
                    f"{trace_text(answer.witness)} violates it and no other that shares signals with it",
                    witness=answer.witness,
                )

    def vacuous(self, part: Part) -> Iterator[Conclusion]:
        """Answer for each implication of a requirement whether it is never triggered where the requirement holds."""
        for condition in implications(part.spec.formula):
            happens = Goal(part.spec, STL["eventually"](condition), True)
            shown, names = f"'{excerpt(condition)}'", (part.name,)
            answer = self.find([part.goal(), happens])
            if answer.exists is False:
                alone = self.find([happens])
                none = f"no trace up to {self._length}"
                if alone.exists:
                    sentence = (
                        f"it holds only where {shown} is never true: {none} satisfies it with that true"
                    )
                elif alone.exists is False:
                    sentence = f"it is vacuous, because {shown} is never true: {none} makes it true"
                else:
                    sentence = f"{none} satisfies it with {shown} true at some instant"
                yield Conclusion("vacuous", names, True, sentence, True, alone.witness)
            else:
                yield self._open("vacuous", names, answer) or Conclusion(
                    "vacuous",
                    names,
                    False,
                    f"{trace_text(answer.witness)} satisfies it with {shown} true at some instant",
                    witness=answer.witness,
                )

    # ---- sentences -------------------------------------------------------------------------------

    @property
    def _length(self) -> str:
        return _samples(self.samples)

    def _none(self, formulas: Sequence[Formula]) -> str:
        """Return the meaning of a missing counterexample: for which lengths of traces it holds."""
        depths = [horizon(ground(formula, self.period), self.period) for formula in formulas]
        if all(depth is not None and depth / self.period < self.samples for depth in depths):
            return "no counterexample of any length"
        return f"no counterexample up to {self._length}"

    def _open(self, question: str, names: tuple[str, ...], answer: Answer) -> Conclusion | None:
        """Return the conclusion that there is no answer, or that the engine does not confirm it."""
        if answer.exists is None:
            sentence = (
                f"'{question}' has no answer within {self.limit:g} s; use fewer samples or a longer limit"
            )
            return Conclusion(question, names, None, sentence)
        if answer.witness is not None and not answer.witness.confirmed:
            sentence = (
                f"'{question}' is open: over the reals there is {trace_text(answer.witness)}, on which doubles lead to "
                f"another verdict"
            )
            return Conclusion(question, names, None, sentence, witness=answer.witness)
        return None


def _smallest(problem: Problem, goals: Sequence[Goal]) -> list[int]:
    """Return indices of goals that cannot be reached together, none of which can be left out."""
    needed = problem.conflict(goals) or list(range(len(goals)))
    for index in tuple(needed):
        rest = [k for k in needed if k != index]
        fewer = problem.conflict([goals[k] for k in rest]) if index in needed else None
        if fewer is not None:
            needed = [rest[k] for k in fewer]
    return needed


def implications(formula: Formula) -> list[Formula]:
    """Return the conditions of the implications in a formula, each once, that are not constant."""
    found = [
        node.args[0] for node in postorder(formula) if isinstance(node, Apply) and node.op is STL["implies"]
    ]
    return list(dict.fromkeys(found))


def unbounded(formula: Formula) -> list[Formula]:
    """Return the parts of a formula whose operator reads the future without a bound."""
    return [
        node
        for node in postorder(spelled_out(formula))
        if isinstance(node, Apply)
        and node.op.tense is Tense.FUTURE
        and node.op.bounds is Bounds.OPTIONAL
        and (node.interval is None or node.interval.end is None)
    ]


def _samples(count: int) -> str:
    return f"{count} sample{'s' * (count != 1)}"


def trace_text(witness: Witness | None) -> str:
    """Return a trace for a sentence, with its margin."""
    assert witness is not None
    if not witness.confirmed:
        return f"a trace of {_samples(witness.samples)}"
    return f"a trace of {_samples(witness.samples)} (margin {witness.margin:.6g})"
