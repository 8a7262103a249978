"""The intervals that are obviously necessary for a verdict, so that fewer remain to be tried.

Down the formula once more, as ``Demands`` goes, but over what the predicates are known to be on some
intervals, and asking only for what nothing else can stand in for: the operand that alone has its truth,
the only stretch in a window. Fewer intervals never offer more to choose from, so what is needed
now is needed whatever else is taken away.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from typing import TYPE_CHECKING

from rtamt.explain.propagate import Asked, Demands
from rtamt.explain.spare import ShareWindows
from rtamt.explain.witnesses import up_to_gaps
from rtamt.language.formula import Var
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import NEVER
from rtamt.signals.instants import Cells

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from rtamt.language.formula import Apply, Formula
    from rtamt.rewrite.structure import Place


class Needs(Demands):
    """The demands of a verdict on every place. ``leaves``: cells of intervals that cannot be left out."""

    def given(self, support: Callable[[Place], Cells]) -> Needs:
        """Set where a place is known to have the required truth."""
        self._known = support
        return self

    def _support(self, node: Formula, sign: int) -> Cells:
        return self._known((node, sign))

    def _choose_operands(self, node: Apply, sign: int, cells: Cells) -> None:
        shares = [self._having(arg, sign) for arg in node.args]
        for arg, other in zip(node.args, reversed(shares), strict=True):
            self._add(arg, sign, Asked(cells - other))

    def _witnesses(self, node: Apply, reduce: str, sign: int, cells: Cells) -> Cells:
        del reduce  # whichever it is
        having = self._having(node.args[0], sign)
        return _needed_cells(node.args[0], only_stretches(cells, having, *self.offsets(node)), having)

    def _deciding(self, node: Apply, sign: int, cells: Cells) -> Cells:
        need, found = self._share(node, sign)
        before, after = self.offsets(node)
        tight = ShareWindows(cells, before, after, need, self.both(sign)).tight(found)
        needed = only_share(tight, found, before, after, need, ends=self._ends(sign))
        window = self._ticks(sign, cells, before, after, need)
        if window is None or not isinstance(node.args[0], Var):
            return needed
        return needed | window.needed(found & cells.widened(before, after)).within(0, self._end)

    def _ends(self, sign: int) -> Callable[..., NDArray[np.int64]] | None:
        both = self.both(sign)
        return None if both is None else np.minimum if both else np.maximum

    def _until(
        self, node: Apply, sign: int, cells: Cells, having: tuple[Cells, Cells], window: tuple[int, int]
    ) -> tuple[Cells, Cells]:
        hold, goal = having
        first, last = window
        if not self.truth(sign):
            gaps = _needed_cells(node.args[0], only_gaps(cells, hold, goal, first, last), hold)
            return gaps, up_to_gaps(cells, hold, first, last)
        # Where φ need not hold, t' is at once or not at all.
        goals = _needed_cells(node.args[1], only_goals(cells, hold, goal, first, last), goal)
        return (cells, goals) if first else (cells - goal, goals | (cells - hold))


def _needed_cells(operand: Formula, found: Cells, having: Cells) -> Cells:
    """Return the cells that are needed of an operand, given one cell of each stretch that is needed.

    Of a predicate, the stretch is an interval, needed as a whole; else which of its cells are needed is
    known only where it has but one.
    """
    if isinstance(operand, Var):
        return found
    single = having.ends - having.starts == 1
    return found & Cells(having.starts[single], having.ends[single])


def only_stretches(asked: Cells, having: Cells, before: int, after: int) -> Cells:
    """Return a cell of each interval of ``having`` that some k of ``asked`` finds alone in [k + before, k + after]."""
    far = np.array([4 * NEVER])
    # From the first k that the interval before no longer serves to the last that the next does not yet.
    first = np.maximum(having.starts - after, np.concatenate((-far, having.ends[:-1])) - before)
    end = np.minimum(having.ends - before, np.concatenate((having.starts[1:], far)) - after)
    k = np.searchsorted(asked.ends, first, side="right")
    met = k < len(asked)
    met[met] = asked.starts[k[met]] < end[met]
    met &= first < end
    return Cells(having.starts[met], having.starts[met] + 1)


def only_share(
    asked: Cells,
    having: Cells,
    before: int,
    after: int,
    need: int,
    *,
    ends: Callable[..., NDArray[np.int64]] | None,
) -> Cells:
    """Return cells of ``having`` without which some k of ``asked`` has fewer than ``need`` in [k + before, k + after].

    Looked for where such a window begins or ends with an interval, and at the ends of ``asked``. ``ends``: how the
    numbers without the last and without the first cell are combined, where both of them make up one cell.
    """
    edges = np.concatenate((having.starts, having.ends))
    shifted = [edges - by for end in (before, after) for by in (end - 1, end, end + 1)]
    points = np.concatenate((asked.starts, asked.ends - 1, *shifted))
    among = np.searchsorted(asked.ends, points, side="right")
    points, among = points[among < len(asked)], among[among < len(asked)]
    points = points[asked.starts[among] <= points]

    def count(first: int, last: int) -> NDArray[np.int64]:
        return having.before(points + last + 1) - having.before(points + first)

    if ends is None:
        tight = points[count(before, after) <= need]
        return having & Cells.union(tight + before, tight + after + 1)
    # Every cell but the two at the ends is in both numbers.
    tight = points[ends(count(before, after - 1), count(before + 1, after)) <= need]
    return having & Cells.union(tight + before + 1, tight + after)


def only_goals(asked: Cells, holds: Cells, goals: Cells, first: int, last: int) -> Cells:
    """Return a cell of each interval of ψ that alone makes φ until[first, last] ψ hold at some of ``asked``.

    Looked for from the ends of each stretch of ``asked`` on which φ holds: there the choice is smallest.
    """
    starts, ends, gaps = goals.starts.tolist(), goals.ends.tolist(), holds.ends.tolist()
    found = []
    for begin, end in asked & holds:
        gap = gaps[bisect_right(gaps, begin)]
        for cell in {begin, end - 1}:
            run = bisect_right(ends, cell + first)
            if run == bisect_right(starts, min(cell + last, gap)) - 1:
                found.append((starts[run], starts[run] + 1))
    return Cells.of(found)


def only_gaps(asked: Cells, gaps: Cells, goals: Cells, first: int, last: int) -> Cells:
    """Return a cell of each interval in which φ fails that alone makes φ until[first, last] ψ fail, likewise."""
    starts, ends = gaps.starts.tolist(), gaps.ends.tolist()
    goal_starts, goal_ends = goals.starts.tolist(), goals.ends.tolist()
    found = []
    for begin, end in asked:
        for cell in {begin, end - 1}:
            goal = bisect_right(goal_ends, cell + first)
            at = max(goal_starts[goal], cell + first) if goal < len(goal_ends) else 4 * NEVER
            run = bisect_right(ends, cell)
            if at <= cell + last and run == bisect_left(starts, at) - 1:
                found.append((starts[run], starts[run] + 1))
    return Cells.of(found)
