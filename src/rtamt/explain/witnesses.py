"""The choice of instants of an operand that support a verdict if one of several would be sufficient.

Each function is given the cells ``asked`` at which an operator has the truth that is to be explained, and
where its operands have the truth that brings it about; it returns cells of the operands, within
those, that bring it about at all of ``asked``. Few long intervals are preferred to many short ones.
In discrete time no more is taken than is needed; in dense time, where one tick of a segment means
nothing, the whole segment within the window.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right

from rtamt.rewrite.structure import NEVER
from rtamt.signals.instants import NONE, Cells


def witnesses(asked: Cells, found: Cells, before: int, after: int, *, whole: bool) -> Cells:
    """Return cells of ``found`` such that each k of ``asked`` has one in [k + before, k + after].

    From left to right, each time the interval of ``found`` that reaches furthest: so every one is needed.
    ``whole``: take all of it that lies in the windows.
    """
    starts, ends = found.starts.tolist(), found.ends.tolist()
    begins, stops = asked.starts.tolist(), asked.ends.tolist()
    taken: list[tuple[int, int]] = []
    i, cell = 0, begins[0] if begins else 0
    while i < len(begins):
        cell = max(cell, begins[i])
        run = bisect_right(starts, cell + after) - 1
        covered = ends[run] - 1 - before  # the last k whose window this interval still meets
        last_asked = bisect_right(begins, covered) - 1
        last = min(stops[last_asked] - 1, covered)
        if whole:
            taken.append((max(starts[run], cell + before), min(ends[run], last + after + 1)))
        else:
            begin = min(ends[run] - 1, cell + after)
            taken.append((begin, max(begin, last + before) + 1))
        cell = covered + 1
        i = bisect_right(stops, cell)
    return Cells.of(taken)


def reaching(
    asked: Cells, holds: Cells, goals: Cells, first: int, last: int, *, whole: bool
) -> tuple[Cells, Cells]:
    """Return the cells of φ and of ψ for φ until[first, last] ψ to hold at ``asked``, where it does.

    ``holds`` and ``goals`` are where they hold. For a single cell t' is the earliest at which ψ holds,
    which asks the least of φ; for many it is from left to right the latest, which serves most of them.
    """
    starts, ends = goals.starts.tolist(), goals.ends.tolist()
    lone = asked.lone
    if lone is not None:
        run = bisect_right(ends, lone + first)
        at = max(starts[run], lone + first)
        return Cells.of([(lone, at)]), Cells.of([(at, min(ends[run], lone + last + 1) if whole else at + 1)])
    # Cells at which ψ holds and φ does not can rest on themselves alone.
    alone = NONE if first else (asked & goals) - holds
    taken, held = list(alone), list[tuple[int, int]]()
    rest = asked - alone
    begins, stops = rest.starts.tolist(), rest.ends.tolist()
    hold_starts, hold_ends = holds.starts.tolist(), holds.ends.tolist()
    i, cell = 0, begins[0] if begins else 0
    while i < len(begins):
        cell = max(cell, begins[i])
        run = bisect_right(hold_ends, cell)
        # φ holds from this cell up to here.
        gap = hold_ends[run] if run < len(hold_ends) and hold_starts[run] <= cell else cell
        run = bisect_right(starts, min(cell + last, gap)) - 1
        at = min(ends[run] - 1, cell + last, gap)
        # Later cells are served by the rest of this stretch of ψ, as long as φ holds up to it.
        covered = min(ends[run] - 1, gap) - first
        final = min(stops[bisect_right(begins, covered) - 1] - 1, covered)
        held.append((cell, max(at, final + first) if first else at))
        if whole:
            taken.append((max(starts[run], cell + first), min(ends[run], final + last + 1)))
        else:
            taken.append((at, max(at, final + first) + 1))
        cell = covered + 1
        i = bisect_right(stops, cell)
    return Cells.of(held), Cells.of(taken)


def blocking(
    asked: Cells, gaps: Cells, goals: Cells, first: int, last: int, *, whole: bool
) -> tuple[Cells, Cells]:
    """Return the cells at which φ and ψ fail for φ until[first, last] ψ to fail at ``asked``, where it does.

    ``gaps`` is where φ fails, ``goals`` where ψ holds. Where φ fails, whatever comes later is spared; up to
    there, or to the window's end, ψ must fail. For a single cell it is the earliest such gap, for many
    it is from left to right the latest, and none where ψ fails in the whole window.
    """
    starts, ends = gaps.starts.tolist(), gaps.ends.tolist()
    lone = asked.lone
    if lone is not None:
        run = bisect_right(ends, lone)
        gap = max(starts[run], lone) if run < len(starts) else lone + last
        if gap >= lone + last:
            return NONE, Cells.of([(lone + first, lone + last + 1)])
        blocked = gap, min(ends[run], lone + last) if whole else gap + 1
        return Cells.of([blocked]), Cells.of([(lone + first, gap + 1)])
    goal_starts, goal_ends = goals.starts.tolist(), goals.ends.tolist()
    begins, stops = asked.starts.tolist(), asked.ends.tolist()
    blocks: list[tuple[int, int]] = []
    fails: list[tuple[int, int]] = []
    i, cell = 0, begins[0] if begins else 0
    while i < len(begins):
        cell = max(cell, begins[i])
        run = bisect_right(goal_ends, cell + first)
        goal = max(goal_starts[run], cell + first) if run < len(goal_starts) else 8 * NEVER
        if goal > cell + last:
            covered = goal - last - 1
            final = min(stops[bisect_right(begins, covered) - 1] - 1, covered)
            fails.append((cell + first, final + last + 1))
        else:
            run = bisect_left(starts, goal) - 1
            gap = min(ends[run], goal) - 1
            covered = ends[run] - 1 if first else gap
            final = min(stops[bisect_right(begins, covered) - 1] - 1, covered)
            segment = max(starts[run], cell), max(min(ends[run], final + last), gap + 1)
            blocks.append(segment if whole else (gap, max(gap, final) + 1))
            fails.append((cell + first, gap + 1))
        cell = covered + 1
        i = bisect_right(stops, cell)
    return Cells.of(blocks), Cells.of(fails)


def up_to_gaps(asked: Cells, gaps: Cells, first: int, last: int) -> Cells:
    """Return where ψ must fail for φ until[first, last] ψ to fail at ``asked``, if φ fails only in ``gaps``.

    From the beginning of the window up to the first gap: φ need only hold before ψ does.
    """
    starts = gaps.starts.tolist()
    found = [] if first else list(asked & gaps)
    for begin, end in asked - gaps:
        gap = bisect_left(starts, end)
        stop = min(end + last, starts[gap] + 1 if gap < len(starts) else 4 * NEVER)
        if begin + first < stop:
            found.append((begin + first, stop))
    return Cells.of(found)
