"""Whether intervals of predicates force a verdict: where it is lost if the predicates are known there only.

A set of intervals forces the verdict if the formula has it when each predicate has its truth on its
intervals and, everywhere else, the truth that contradicts the verdict, at each of its places.
Operators being monotone, no other values there can be worse. The engine decides this on the formula
with two variables for a predicate (``Structure.polar``) that are +inf or -inf; for a share of a predicate,
cells are counted instead.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from rtamt.explain.intervals import Groups
from rtamt.explain.signals import truths
from rtamt.explain.spare import ShareWindows
from rtamt.language.formula import Apply, Var
from rtamt.language.records import Rank
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import NEVER, literal, reaches
from rtamt.signals.instants import NONE, Cells, StepFunction, two_valued

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from rtamt.engine import TimeAxis
    from rtamt.explain.intervals import Intervals
    from rtamt.explain.propagate import Demands
    from rtamt.language.formula import Formula
    from rtamt.rewrite.structure import Place, Structure
    from rtamt.signals.instants import Ints

    #: Choices with their demands, and what evaluates them.
    Runner = tuple[list[tuple[Place, Cells]], Callable[[Mapping[str, StepFunction]], list[StepFunction]]]


class Forcing:
    """Finds where the verdict is lost if the predicates are known only on some intervals."""

    def __init__(
        self, structure: Structure, demands: Demands, axis: TimeAxis, fixed: Mapping[str, StepFunction]
    ) -> None:
        self._structure = structure
        self._demands = demands
        self._axis = axis
        self._end = axis.end
        self._fixed = fixed
        self._literals = [
            (leaf.name, sign) for leaf in structure.leaves.values() if not leaf.fixed for sign in (1, -1)
        ]
        choices = [(place, surely) for place, surely in demands.choices if len(surely)]
        self._choices = [each for each in choices if not self._is_share(each[0][0])]
        self._shares = [
            _Share(place, surely, demands) for place, surely in choices if self._is_share(place[0])
        ]
        found = reaches(structure.order, axis.period)
        bounded = {node for node, reach in found.items() if max(reach) < NEVER}
        #: How many cells behind and ahead a choice can look, of those that do not look at the whole recording.
        reaching = [found[node] for (node, _), _ in choices if node in bounded]
        self.behind = max((behind for behind, _ in reaching), default=0)
        self.ahead = max((ahead for _, ahead in reaching), default=0)
        self._near = self._runner([each for each in self._choices if each[0][0] in bounded])
        self._far = self._runner([each for each in self._choices if each[0][0] not in bounded])

    def _runner(self, choices: list[tuple[Place, Cells]]) -> Runner | None:
        formulas = [self._structure.polar[place] for place, _ in choices]
        return (choices, self._axis.runner(formulas)) if formulas else None

    def _signals(self, intervals: Intervals) -> dict[str, StepFunction]:
        """Return replacements for the predicates: unchanged on the intervals, worst case elsewhere."""
        signals = dict(self._fixed)
        for name, sign in self._literals:
            good = inf if self._demands.truth(sign) else -inf
            cells = intervals.cells((name, sign))
            signals[literal(name, sign)] = two_valued(cells, good, -good, self._end)
        return signals

    def support(self, intervals: Intervals) -> Callable[[Place], Cells]:
        """Return where a place has its required truth, by the intervals alone."""
        known: dict[Formula, Cells] = {}

        def supported(place: Place) -> Cells:
            node, sign = place
            if isinstance(node, Var) and node.name not in self._fixed:
                return intervals.cells((node.name, sign))
            if not known:
                order = tuple(dict.fromkeys(self._structure.polar.values()))
                known.update(truths(order, self._axis, self._signals(intervals)))
            holds = known[self._structure.polar[place]]
            return holds if self._demands.truth(sign) else Cells.of([(0, self._end)]) - holds

        return supported

    def _is_share(self, node: Formula) -> bool:
        """Return whether a choice is one of a share of a predicate: cells of its intervals need only be counted."""
        assert isinstance(node, Apply)
        return (
            isinstance(node.op.kernel, Rank)
            and isinstance(operand := node.args[0], Var)
            and operand.name not in self._fixed
        )

    def begin(self, intervals: Intervals) -> None:
        """Begin trials without some of these intervals, which force the verdict."""
        for share in self._shares:
            share.begin(intervals)

    def stuck(self, intervals: Intervals, groups: Groups) -> NDArray[np.bool_]:
        """Return of each group of ``intervals``, sorted by their starts, whether it clearly cannot be taken away.

        Of those that :meth:`begin` was called with.
        """
        found = np.zeros(len(groups), bool)
        for share in self._shares:
            found |= share.stuck(intervals, groups)
        return found

    def failures(self, intervals: Intervals, begins: Ints, ends: Ints) -> Cells:
        """Return cells at which something falls that the verdict cannot do without: in each [begin, end) with any.

        These are sorted and apart. Choices that look at the whole recording are left to :meth:`fails`.
        """
        failed = self._failed(self._near, intervals)
        for share in self._shares:
            failed = failed | share.failures(intervals, begins, ends)
        return failed

    def fails(self, intervals: Intervals) -> bool:
        """Return whether a choice that looks at the whole recording loses what the verdict cannot do without."""
        return len(self._failed(self._far, intervals)) > 0

    def _failed(self, runner: Runner | None, intervals: Intervals) -> Cells:
        failed = NONE
        if runner is not None:
            choices, run = runner
            for ((_, sign), surely), steps in zip(choices, run(self._signals(intervals)), strict=True):
                holds = Cells.where(steps.changes, (steps.values > 0) == self._demands.truth(sign), self._end)
                failed = failed | (surely - holds)
        return failed


class _Share:
    """A choice of a share of a predicate."""

    def __init__(self, place: Place, surely: Cells, demands: Demands) -> None:
        node, self._sign = place
        assert isinstance(node, Apply)
        operand = node.args[0]
        assert isinstance(operand, Var)
        self._node = node
        self._literal = operand.name, self._sign
        self._demands = demands
        need, _ = demands.share_of(node, self._sign, NONE)
        self._windows = ShareWindows(surely, *demands.offsets(node), need, demands.both(self._sign))

    def begin(self, intervals: Intervals) -> None:
        found = self._found(intervals)
        self._points = self._windows.lows(found)
        self._counts = self._windows.counts(found, self._points)

    def stuck(self, intervals: Intervals, groups: Groups) -> NDArray[np.bool_]:
        mine = intervals.mask(self._literal)
        before = np.concatenate(([0], np.cumsum((intervals.ends - intervals.starts) * mine)))
        return self._windows.cannot_spare(
            self._points,
            self._counts,
            intervals.starts[groups.first],
            groups.largest(intervals.ends),
            before[groups.stop] - before[groups.first],
        )

    def failures(self, intervals: Intervals, begins: Ints, ends: Ints) -> Cells:
        first = np.searchsorted(self._points, begins, side="left")
        stop = np.searchsorted(self._points, ends, side="right")
        return self._windows.failing(self._found(intervals), self._points[Groups(first, stop).members()])

    def _found(self, intervals: Intervals) -> Cells:
        cells = self._demands.lasting(intervals.cells(self._literal))
        return self._demands.share_of(self._node, self._sign, cells)[1]
