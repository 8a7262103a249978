"""Propagation of a verdict to the predicates: the truth that each sub-formula must have at each instant.

Where both operands (or all instants of a window) are needed, all are requested; where one would do, one
is chosen (see ``choices``). What is requested at the predicates is enough for the verdict by construction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.explain.critical import around
from rtamt.explain.shares import TickWindow, sharing
from rtamt.explain.witnesses import blocking, reaching, up_to_gaps, witnesses
from rtamt.language.formula import Apply, Formula, Var
from rtamt.language.records import Rank, Shift, Since, Tense, Window
from rtamt.language.shares import rank_of
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import CHOOSING, NEGATION, NEVER, Place, opcode, window_of
from rtamt.signals.instants import NONE, Cells

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from rtamt.explain.critical import Walk
    from rtamt.explain.signals import Signals
    from rtamt.rewrite.structure import Structure


@dataclass(frozen=True, slots=True, eq=False)
class Asked:
    """Cells at which a place must have its truth; ``surely``: of these, those without which there is no verdict."""

    cells: Cells = NONE
    surely: Cells = NONE

    def __or__(self, other: Asked) -> Asked:
        return Asked(self.cells | other.cells, self.surely | other.surely)


class Demands:
    """The truth values that a verdict requires at every place of a formula.

    ``leaves``: of each predicate and sign. ``choices``: the places below which something was chosen,
    with the cells at which each of them must have its truth for there to be the verdict.
    """

    def __init__(
        self,
        structure: Structure,
        holds: Mapping[Formula, Cells],
        signals: Signals,
        walk: Walk,
        period: Fraction,
        end: int,
        *,
        dense: bool,
    ) -> None:
        self._structure = structure
        self._holds = holds
        self._signals = signals
        self._walk = walk
        self._period = period
        self._end = end
        self._dense = dense
        # In dense time the last values hold for ever: also where windows of the last cells look.
        self._all = Cells.of([(0, 4 * NEVER if dense else end)])
        self._asked: dict[Place, Asked] = {}
        self.leaves: dict[tuple[str, int], Asked] = {}
        self.choices: list[tuple[Place, Cells]] = []

    def ask(self, cells: Cells, *, satisfied: bool) -> None:
        """Ask for the verdict at some cells."""
        self._satisfied = satisfied
        self._add(self._structure.core, 1, Asked(cells, cells))
        for node in reversed(self._structure.order):
            for sign in (1, -1):
                asked = self._asked.pop((node, sign), None)
                if asked is None or not len(asked.cells):
                    continue
                if isinstance(node, Apply):
                    self._pass_on(node, sign, asked)
                elif isinstance(node, Var) and not self._structure.leaves[node.name].fixed:
                    self.leaves[node.name, sign] = asked

    def truth(self, sign: int) -> bool:
        """Return the required truth at places of a sign."""
        return self._satisfied == (sign > 0)

    def both(self, sign: int) -> bool | None:
        """Return whether the cell at both ends of a window counts where both do, or where one does.

        In dense time they are one; in discrete time None.
        """
        return self.truth(sign) if self._dense else None

    def _add(self, node: Formula, sign: int, asked: Asked) -> None:
        asked = Asked(self._within(asked.cells), self._within(asked.surely))
        place = node, sign
        self._asked[place] = self._asked[place] | asked if place in self._asked else asked

    def _within(self, cells: Cells) -> Cells:
        """Return the part that there is. Long after a recording all has settled: what lasts so long lasts for ever."""
        cells = cells.within(0, self._end)
        if self._dense and len(cells) and cells.ends[-1] > NEVER // 2:
            cells = cells | Cells.of([(int(cells.ends[-1]), self._end)])
        return cells

    def _having(self, node: Formula, sign: int) -> Cells:
        """Return where a sub-formula has the truth required of places of a sign."""
        return self.lasting(self._support(node, sign))

    def lasting(self, having: Cells) -> Cells:
        """Return cells with those after the recording: in dense time what is so at its end remains so."""
        if self._dense and len(having) and having.ends[-1] >= self._end:
            having = having | Cells.of([(int(having.starts[-1]), 4 * NEVER)])
        elif self._dense:
            having = having.within(0, self._end)
        return having

    def _support(self, node: Formula, sign: int) -> Cells:
        # What holds is known up to the end: later instants are not part of the explanation.
        holds = self._holds[node]
        return holds if self.truth(sign) else (self._all - holds).within(0, self._end)

    def _pass_on(self, node: Apply, sign: int, asked: Asked) -> None:
        """Ask the operands for what makes ``node`` have its truth."""
        kernel, code = node.op.kernel, opcode(node)
        if code == NEGATION:
            self._add(node.args[0], -sign, asked)
        elif isinstance(kernel, Shift):
            by = 1 if node.op.tense is Tense.FUTURE else -1
            moved = Asked(asked.cells.widened(by, by), asked.surely.widened(by, by))
            self._add(node.args[0], sign, moved)
        elif code is not None and self.truth(sign) == (code == CHOOSING[0]):
            for arg in node.args:
                self._add(arg, sign, asked)
        elif isinstance(kernel, Window) and self.truth(sign) == (kernel.reduce == CHOOSING[0]):
            before, after = self.offsets(node)
            self._add(
                node.args[0],
                sign,
                Asked(asked.cells.widened(before, after), asked.surely.widened(before, after)),
            )
        else:
            self.choices.append(((node, sign), asked.surely))
            self._choose(node, sign, asked)

    def _choose(self, node: Apply, sign: int, asked: Asked) -> None:
        kernel, cells = node.op.kernel, asked.cells
        if opcode(node) is not None:
            self._choose_operands(node, sign, cells)
        elif isinstance(kernel, Window):
            self._add(node.args[0], sign, Asked(self._witnesses(node, kernel.reduce, sign, cells)))
        elif isinstance(kernel, Rank):
            self._add(node.args[0], sign, Asked(self._deciding(node, sign, cells)))
        else:
            self._choose_in_time(node, sign, asked)

    def _choose_in_time(self, node: Apply, sign: int, asked: Asked) -> None:
        """Choose cells of both operands of until, and of since and precedes, which are until in disguise."""
        window = window_of(node, self._period)
        hold, goal = (self._having(arg, sign) for arg in node.args)
        if not self.truth(sign):  # then it matters where ψ may hold
            goal = self._all - goal
        cells, surely = asked.cells, asked.surely
        turned = isinstance(node.op.kernel, Since)
        if turned:  # since is until, backwards
            cells, surely, hold, goal = (each.mirrored() for each in (cells, surely, hold, goal))
        elif node.op.tense is Tense.PAST:  # precedes is until, read from where the window begins
            cells, surely = (each.widened(-window[1], -window[1]) for each in (cells, surely))
            if self.truth(sign):  # and requires nothing of φ before the start
                hold = hold | Cells.of([(-2 * NEVER, 0)])
        holds, goals = self._until(node, sign, cells, (hold, goal), window)
        sure = NONE if self.truth(sign) else up_to_gaps(surely, hold, *window)
        for arg, found in zip(node.args, (Asked(holds), Asked(goals | sure, sure)), strict=True):
            self._add(arg, sign, Asked(found.cells.mirrored(), found.surely.mirrored()) if turned else found)

    def _until(
        self, node: Apply, sign: int, cells: Cells, having: tuple[Cells, Cells], window: tuple[int, int]
    ) -> tuple[Cells, Cells]:
        """Return the cells of φ and ψ on which it is to rest that φ until ψ holds, or fails, at ``cells``.

        ``having``: where φ has the required truth, and where ψ holds.
        """
        del node  # whatever its operands are
        choose = reaching if self.truth(sign) else blocking
        return choose(cells, *having, *window, whole=self._dense)

    def _choose_operands(self, node: Apply, sign: int, cells: Cells) -> None:
        """Rest on the operand that does for most cells, and on the other one for the rest.

        At a single cell, on the one whose robustness is the larger.
        """
        shares = [self._having(arg, sign) & cells for arg in node.args]
        cell = cells.lone
        toward = 1 if self.truth(sign) else -1

        def weight(k: int) -> tuple[int, float]:
            robustness = 0.0 if cell is None else toward * self._signals.at(node.args[k], cell)
            return shares[k].count, robustness

        first = max(range(len(shares)), key=weight)
        for k in sorted(range(len(shares)), key=lambda k: k != first):
            mine = shares[k] & cells
            self._add(node.args[k], sign, Asked(mine))
            cells = cells - mine

    def _witnesses(self, node: Apply, reduce: str, sign: int, cells: Cells) -> Cells:
        """Choose instants of a window's operand; for a single cell, where its robustness is largest."""
        found = self._having(node.args[0], sign)
        before, after = self.offsets(node)
        cell = cells.lone
        if cell is not None:
            begin, end = around(
                cell, *window_of(node, self._period), past=node.op.tense is Tense.PAST, end=self._end
            )
            best = self._walk.extreme(node.args[0], reduce, begin, end)
            if best in found:
                here = Cells.of([(best, best + 1)])
                # In dense time the interval around it, and it alone.
                found = next_to(found, best) if self._dense else here
        return witnesses(cells, found, before, after, whole=self._dense)

    def _share(self, node: Apply, sign: int) -> tuple[int, Cells]:
        """Return how many cells of a window must have the required truth, and which cells have it.

        Those outside the trace are among them if they count.
        """
        return self.share_of(node, sign, self._having(node.args[0], sign))

    def share_of(self, node: Apply, sign: int, found: Cells) -> tuple[int, Cells]:
        """Return the same where these cells have it."""
        k, outside = rank_of(node.interval, self._period, continuous=self._dense)
        first, last = window_of(node, self._period)
        if (outside > 0) == self.truth(sign):
            found = found | Cells.of([(-2 * NEVER, 0)])
            if not self._dense:
                found = found | Cells.of([(self._end, 4 * NEVER)])
        nominal = last - first + (0 if self._dense else 1)
        return k if self.truth(sign) else nominal - k + 1, found

    def _deciding(self, node: Apply, sign: int, cells: Cells) -> Cells:
        """Choose instants of the operand for a share of a window: in discrete time as few as possible."""
        need, found = self._share(node, sign)
        before, after = self.offsets(node)
        found = found & cells.widened(before, after)
        window = self._ticks(sign, cells, before, after, need)
        if window is not None:
            return window.fewest(found, self._end)
        if self._dense:
            return found
        if cells.lone is None:
            return sharing(cells, found, before, after, need)
        # Those that decide the value: the largest, or the smallest.
        inside = found.within(0, self._end)
        samples = np.concatenate([np.arange(*each) for each in inside] or [np.empty(0, np.int64)])
        values = self._signals.of(node.args[0]).each(samples)
        best = np.argsort(-values if self.truth(sign) else values, kind="stable")
        chosen = samples[best[: max(need - (found.count - inside.count), 0)]]
        return Cells.union(chosen, chosen + 1)

    def _ticks(self, sign: int, cells: Cells, before: int, after: int, need: int) -> TickWindow | None:
        """Return the window of a share in dense time, for a single required cell."""
        cell = cells.lone
        if not self._dense or cell is None:
            return None
        return TickWindow(cell + before, cell + after, need, both=self.truth(sign))

    def offsets(self, node: Apply) -> tuple[int, int]:
        """Return the ends of a window, counted from the present cell on."""
        first, last = window_of(node, self._period)
        return (-last, -first) if node.op.tense is Tense.PAST else (first, last)


def next_to(cells: Cells, cell: int) -> Cells:
    """Return the interval that contains a cell."""
    return Cells.of([next((begin, end) for begin, end in cells if begin <= cell < end)])
