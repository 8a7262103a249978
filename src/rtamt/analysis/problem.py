"""The search for a trace of bounded length that reaches several goals."""

from __future__ import annotations

import sys
from fractions import Fraction
from math import floor, inf, isfinite, log10
from time import monotonic
from typing import TYPE_CHECKING

from rtamt.analysis.encoder import Encoder, Limits
from rtamt.analysis.solver import Solver
from rtamt.analysis.witness import Goal, Witness
from rtamt.language.contents import variables
from rtamt.language.formula import Const, Formula, postorder
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.analysis.solver import Asking, Real, Truth

#: Traces up to this length are shown in full: the end of a trace satisfies or violates much by itself.
_SHORT = 8
#: Longer traces: the search for a margin is limited to a multiple of the time of the answer, plus some seconds:
#: the second number if the engine does not confirm the answer, as without a margin it may not.
_PATIENCE, _AT_LEAST, _UNCONFIRMED = 1.0, 0.05, 1.0

#: The number of margins: powers of ten, the first of the magnitude of the greatest constant of the formulas.
_MARGINS = 10

#: The greatest finite double: signals have no greater numbers, which the solver has.
_GREATEST = Fraction(sys.float_info.max)


@dataclass(frozen=True)
class Answer:
    """The result of the solver: a trace, none (``exists`` is False), or a timeout (``exists`` is None)."""

    exists: bool | None
    witness: Witness | None = None


class Problem:
    """The traces of 1 to ``samples`` samples (``whole``: of exactly so many) within the limits of variables.

    ``coarse``: only those whose variables change at a few instants. These answer most queries in a fraction of the
    time; where there is none, nothing is known of the other traces.
    """

    def __init__(
        self,
        samples: int,
        period: Fraction,
        limits: Mapping[str, Limits],
        limit: float,
        *,
        whole: bool = False,
        coarse: bool = False,
    ) -> None:
        self.period = period
        self._solver = Solver(limit)
        self._encoder = Encoder(self._solver, samples, period, limits, whole=whole, coarse=coarse)
        self._whole = whole
        self._exact: dict[tuple[Formula, bool], Truth] = {}
        self._distant: dict[tuple[Formula, bool], Truth] = {}

    def find(self, goals: Sequence[Goal], limit: float) -> Answer:
        """Look for a trace that reaches all goals, with a margin if possible, within a time limit."""
        end = monotonic() + limit
        if not self._whole:
            return self._find(goals, end)
        # Goals without common variables do not affect each other if the length is given.
        columns: dict[str, NDArray[np.float64]] = {}
        for group in group_related(goals):
            answer = self._find(group, end)
            if answer.witness is None:
                return answer
            columns |= answer.witness.columns
        return Answer(True, Witness(columns, self.period, tuple(goals), len(self._encoder.inside)))

    def _find(self, goals: Sequence[Goal], end: float) -> Answer:
        begin = monotonic()
        asking = self._solver.asking([self._truth(goal) for goal in goals])
        if not (found := asking(limit=end - monotonic())):
            return Answer(found)
        taken = monotonic() - begin
        witness = self._witness(goals)
        if len(self._encoder.inside) > _SHORT:
            least = _AT_LEAST if witness.confirmed else _UNCONFIRMED
            patience = _PATIENCE * taken + least
        else:
            patience = inf
            # A short trace that is not cut off early, if there is one.
            last = self._encoder.inside[-1]
            if asking(last, end - monotonic()):
                asking.add([last])
                witness = self._witness(goals)
        clear = self._clear(goals, asking, min(patience, end - monotonic()))
        return Answer(True, witness if clear is None or not clear.confirmed else clear)

    def conflict(self, goals: Sequence[Goal]) -> list[int] | None:
        """Return the indices of some goals that cannot be reached together; None where none are known."""
        return self._solver.conflict([self._truth(goal) for goal in goals])

    def has_values(self, goals: Sequence[Goal], limit: float) -> bool | None:
        """Return whether formulas are all defined on some trace; None on a timeout."""
        for goal in goals:
            self._truth(goal)
        defined = [self._encoder.defined(goal.formula) for goal in goals]
        return all(each is True for each in defined) or self._solver.ask(defined, limit)

    def covers(self, goal: Goal) -> None:
        """Raise :class:`NotCoveredError` if a part of the formula is not covered."""
        self._truth(goal)

    def _clear(self, goals: Sequence[Goal], asking: Asking, patience: float) -> Witness | None:
        """Return a trace with the greatest of a few margins; None on a timeout."""
        asking.add([self._distance(goal) for goal in goals])
        largest = _magnitude([goal.formula for goal in goals])
        end = monotonic() + patience
        found: Witness | None = None
        # Where there is a margin there is every smaller one.
        low, high = 0, _MARGINS
        while low < high and (left := end - monotonic()) > 0:
            # First the greatest margin, then the smallest one.
            middle = low if low == 0 else (low + high) // 2 if found else high - 1
            margin = Fraction(10) ** (largest - middle)
            if asking(self._solver.at_most(margin, self._encoder.margin), left):
                found, high = self._witness(goals), middle
            else:
                low = middle + 1
        return found

    def _truth(self, goal: Goal) -> Truth:
        """Return whether a goal is fulfilled."""
        key = (goal.formula, goal.holds)
        if key not in self._exact:
            truth = self._encoder.holds(goal.formula, goal.spec.text)[0]
            fulfilled = truth if goal.holds else self._solver.no(truth)
            self._exact[key] = self._solver.every((fulfilled, self._encoder.defined(goal.formula)))
        return self._exact[key]

    def _distance(self, goal: Goal) -> Truth:
        """Return whether a goal is fulfilled with the margin."""
        key = (goal.formula, goal.holds)
        if key not in self._distant:
            verdict = self._encoder.robust(goal.formula, goal.spec.text)[0]
            self._distant[key] = verdict.yes if goal.holds else verdict.no
        return self._distant[key]

    def _witness(self, goals: Sequence[Goal]) -> Witness:
        """Return the trace of the last answer."""
        solver = self._solver
        n = sum(map(solver.is_true, self._encoder.inside))
        columns = {
            name: np.array(_numbers(solver, [value.real for value in self._encoder.columns[name][:n]]))
            for name in variables(*(goal.formula for goal in goals))
        }
        return Witness(columns, self.period, tuple(goals), n)


def _numbers(solver: Solver, terms: Sequence[Real]) -> list[float]:
    """Return numbers in the last answer; a coarse trace has the same term many times in a row."""
    found: list[float] = []
    for index, term in enumerate(terms):
        same = index > 0 and term is terms[index - 1]
        found.append(found[-1] if same else _nearest(solver.value(term)))
    return found


def _nearest(number: Fraction) -> float:
    """Return the nearest finite double."""
    return float(min(max(number, -_GREATEST), _GREATEST))


def group_related(goals: Sequence[Goal]) -> list[list[Goal]]:
    """Return groups of goals, of which each shares no variables with the others."""
    groups: list[tuple[set[str], list[Goal]]] = []
    for goal in goals:
        names, members = set(variables(goal.formula)), [goal]
        for group in [group for group in groups if group[0] & names]:
            names |= group[0]
            members = [*group[1], *members]
            groups.remove(group)
        groups.append((names, members))
    return [members for _, members in groups]


def _magnitude(formulas: Sequence[Formula]) -> int:
    """Return the decimal exponent of the greatest constant of formulas."""
    constants = [abs(node.value) for node in postorder(*formulas) if isinstance(node, Const)]
    return max((floor(log10(each)) for each in constants if each and isfinite(each)), default=0)
