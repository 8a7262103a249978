"""The critical point: the predicate and the instant whose value is, up to sign, the robustness.

From the root down: through minimum and maximum to the operand that attains the value, through a window or
a share of it to an instant at which the operand attains it, through until and since to the t' that attains the
supremum, and there to ψ or to an instant of φ. Signals are step functions and windows closed, so that
every supremum is attained. Of equal ones the earliest is taken (of since: the latest t'); ``explain.py`` prefers
one that overturns the verdict alone.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Protocol

from rtamt.language.formula import Apply, Const, Formula, Var
from rtamt.language.records import Rank, Shift, Since, Tense, Until, Window
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import CHOOSING, NEGATION, opcode, window_of

if TYPE_CHECKING:
    from fractions import Fraction

    from rtamt.signals.instants import StepFunction

#: What decides a value that no predicate does.
START, END, CONSTANT = "start", "end", "constant"


@dataclass(frozen=True, slots=True)
class Point:
    """The end of the walk: at leaf ``name`` (read ``sign`` times its value), or at another decisive node."""

    cell: int
    sign: int
    name: str = ""
    decided_by: str = ""


class Values(Protocol):
    """The values of sub-formulas."""

    def of(self, node: Formula, value: float | None = None, /) -> StepFunction:
        """Return the values of a sub-formula that reads other instants, or that one reads; see ``Signals.of``."""

    def largest(self, node: Formula, sign: int, begin: int, end: int, /) -> int:
        """Return the first cell in [begin, end) at which such a value is, times a sign, the largest."""

    def at(self, node: Formula, cell: int, /) -> float:
        """Return the value of a sub-formula at a cell."""


class Walk:
    """A way down one formula."""

    def __init__(self, signals: Values, period: Fraction, end: int) -> None:
        self._signals = signals
        self._period = period
        self._end = end

    def down(self, formula: Formula, cell: int) -> Point:
        """Return the critical point of a formula's value at a cell."""
        node, sign = formula, 1
        while isinstance(node, Apply):
            code = opcode(node)
            if code == NEGATION:
                node, sign = node.args[0], -sign
            elif code in CHOOSING:
                value = self._signals.at(node, cell)
                same = [arg for arg in node.args if self._signals.at(arg, cell) == value]
                node = next((arg for arg in same if not isinstance(arg, Const)), same[0])
            else:
                step = self.elsewhere(node, cell)
                if step is None:
                    return Point(cell, sign, decided_by=END if node.op.tense is Tense.FUTURE else START)
                node, cell = step
        if isinstance(node, Var):
            return Point(cell, sign, node.name)
        return Point(cell, sign, decided_by=CONSTANT)

    def extreme(self, node: Formula, reduce: str, begin: int, end: int) -> int:
        """Return the first cell in [begin, end) at which a sub-formula is largest (or smallest)."""
        return self._signals.largest(node, 1 if reduce == CHOOSING[1] else -1, begin, end)

    def _equal(self, node: Apply, cell: int, begin: int, end: int) -> int | None:
        """Return the first cell in [begin, end) at which the operand has the value of ``node`` at ``cell``."""
        value = self._signals.at(node, cell)
        changes, values = self._signals.of(node.args[0], value).between(begin, end)
        found = changes[values == value]
        return int(found[0]) if len(found) else None

    def elsewhere(self, node: Apply, cell: int) -> tuple[Formula, int] | None:
        """Return the operand and the cell from which the value comes; None if there is none to come from."""
        kernel, past = node.op.kernel, node.op.tense is Tense.PAST
        if isinstance(kernel, Shift):
            there = cell - 1 if past else cell + 1
            return (node.args[0], there) if 0 <= there < self._end else None
        first, last = window_of(node, self._period)
        if isinstance(kernel, Rank):
            begin, end = around(cell, first, last, past=past, end=self._end)
            same = None if begin >= end else self._equal(node, cell, begin, end)
            return None if same is None else (node.args[0], same)
        if isinstance(kernel, Window):
            begin, end = around(cell, first, last, past=past, end=self._end)
            return (
                (node.args[0], self.extreme(node.args[0], kernel.reduce, begin, end)) if begin < end else None
            )
        value = self._signals.at(node, cell)
        hold, goal = (self._signals.of(arg, value) for arg in node.args)
        base = cell
        if isinstance(kernel, Since):
            oldest = max(cell - last, 0)
            if cell - first < oldest:
                return None
            # Backwards, since is until.
            hold, goal = hold.mirrored(oldest, cell + 1), goal.mirrored(oldest, cell + 1)
            base, begin, end = -cell, first - cell, min(last - cell, -oldest) + 1
        else:
            assert isinstance(kernel, Until)
            if past:
                base = max(cell - last, 0)
                begin, end = max(cell - last + first, 0), cell + 1
            else:
                begin, end = around(cell, first, last, past=False, end=self._end)
        if begin >= end:
            return None
        which, there = reached(hold, goal, base, begin, end)
        return node.args[which], -there if isinstance(kernel, Since) else there


def around(cell: int, first: int, last: int, *, past: bool, end: int) -> tuple[int, int]:
    """Return the window [first, last] behind or ahead of a cell as [begin, end), cut to [0, end)."""
    if past:
        return max(cell - last, 0), cell - first + 1
    return cell + first, min(cell + last + 1, end)


def reached(hold: StepFunction, goal: StepFunction, base: int, begin: int, end: int) -> tuple[int, int]:
    """Return which operand (0: φ, 1: ψ) and which cell attains φ until ψ from ``base`` on, t' in [begin, end)."""
    reached_at, goals = goal.between(begin, end)
    if end > base + 1:
        changes, values = hold.between(base, end - 1)
        lowest = np.concatenate(([inf], np.minimum.accumulate(values)))
    else:
        changes, values, lowest = np.empty(0, np.int64), np.empty(0), np.array([inf])
    # For each t': how many stretches of φ begin before it, and the smallest value of φ by then.
    before = np.searchsorted(changes, reached_at, side="left")
    held = lowest[before]
    best = int(np.minimum(goals, held).argmax())
    if goals[best] <= held[best]:
        return 1, int(reached_at[best])
    return 0, int(changes[values[: before[best]].argmin()])
