"""The samples that determine the value of a predicate.

From a predicate down to its variables: the cells at which each part must not become smaller (*lower*) or larger
(*upper*) than it is, for the predicate to stay at least, or at most, what it is. Where one of several parts does (the
largest of a window, the branch that is taken), only that is requested; a condition is requested as any formula is
(``propagate.py``). Where no rule is known (an operator with a definition only), all that can be read is.

The *source* of a single value is the sample that determines it: of a minimum the one that attains it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.explain.attained import attained
from rtamt.explain.critical import Walk
from rtamt.explain.propagate import Demands
from rtamt.explain.signals import Signals, truths
from rtamt.language.formula import Apply, Const, Formula, Var, children
from rtamt.language.records import Ahead, Pointwise, Shift, Sort, Source, Sum, Tense, Window
from rtamt.lazy.modules import np
from rtamt.rewrite.desugar import spelled_out
from rtamt.rewrite.structure import CHOOSING, NEGATION, NEVER, Structure, own_reach, window_of
from rtamt.rewrite.truth import rebuilt
from rtamt.signals.instants import NONE, Cells

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.engine import TimeAxis
    from rtamt.signals.instants import StepFunction

#: The demands on a number: cells at which it must not fall, and cells at which it must not rise.
Need = tuple[Cells, Cells]


class Readings:
    """The samples that predicates read over a recording."""

    def __init__(self, axis: TimeAxis, *, dense: bool) -> None:
        self._axis = axis
        self._dense = dense
        self._parts: dict[Formula, _Parts] = {}
        self._conditions: dict[Formula, _Condition] = {}

    def of(self, predicate: Formula, lower: Cells, upper: Cells) -> dict[str, Cells]:
        """Return the cells of variables that keep a predicate from falling at ``lower``, and rising at ``upper``."""
        found: dict[str, Cells] = {}
        waiting = [(predicate, (lower, upper))]
        while waiting:
            formula, need = waiting.pop()
            parts = self._parts_of(formula)
            for node, asked in self._passed(parts, need):
                if isinstance(node, Var):
                    found[node.name] = found.get(node.name, NONE) | asked[0] | asked[1]
                else:
                    waiting += self._condition(node, asked)
        return found

    def source(self, predicate: Formula, cell: int) -> dict[str, Cells]:
        """Return the cells of variables that determine the value of a predicate at a cell."""
        found: dict[str, Cells] = {}
        parts = self._parts_of(predicate)
        walk = Walk(parts, self._axis.period, self._axis.end)
        waiting, met = [(parts.top, cell)], set()
        while waiting:
            place = waiting.pop()
            if place in met:
                continue
            met.add(place)
            node, cell = place
            if isinstance(node, Var):
                found[node.name] = found.get(node.name, NONE) | Cells.of([(cell, cell + 1)])
            elif isinstance(node, Apply):
                further = self._from(parts, walk, node, cell)
                if further is None:
                    here = Cells.of([(cell, cell + 1)])
                    for name, cells in self.of(node, here, here).items():
                        found[name] = found.get(name, NONE) | cells
                else:
                    waiting += further
        return found

    def _parts_of(self, formula: Formula) -> _Parts:
        if formula not in self._parts:
            self._parts[formula] = _Parts(formula, self._axis)
        return self._parts[formula]

    # ---- from a part to its operands ---------------------------------------------------------------

    def _passed(self, parts: _Parts, need: Need) -> Iterator[tuple[Formula, Need]]:
        """Yield the demands on variables and conditions that follow from demands on a formula."""
        asked: dict[Formula, Need] = {parts.top: need}
        for node in reversed(parts.order):
            need = asked.pop(node, (NONE, NONE))
            lower, upper = (self._within(cells) for cells in need)
            if not len(lower) and not len(upper):
                continue
            if isinstance(node, Var):
                yield node, (lower, upper)
            elif isinstance(node, Apply):
                conditions = _conditions(node)
                for arg, (below, above) in self._operands(parts, node, lower, upper):
                    if arg in conditions:
                        yield arg, (self._within(below), self._within(above))
                    else:
                        known = asked.get(arg, (NONE, NONE))
                        asked[arg] = known[0] | below, known[1] | above

    def _within(self, cells: Cells) -> Cells:
        cells = cells.within(0, self._axis.end)
        if self._dense and len(cells) and cells.ends[-1] > NEVER // 2:
            cells = cells | Cells.of([(int(cells.ends[-1]), self._axis.end)])
        return cells

    def _operands(self, parts: _Parts, node: Apply, lower: Cells, upper: Cells) -> list[tuple[Formula, Need]]:
        kernel, args = node.op.kernel, node.args
        if node.op.source is Source.BRANCH:
            truth = self._truth(args[0])
            return [
                (args[0], (both := (lower | upper) & truth, (lower | upper) - both)),
                (args[1], (lower & truth, upper & truth)),
                (args[2], (lower - truth, upper - truth)),
            ]
        if node.op.source is Source.HELD:
            return self._held(parts, node, lower, upper)
        if node.op.source is Source.DELAYED:
            back = -self._steps(node)
            first = Cells.of([(0, -back)])
            moved = tuple((cells - first).widened(back, back) for cells in (lower, upper))
            return [(args[0], (moved[0], moved[1])), self._initial(node, 1, lower & first, upper & first)]
        if isinstance(kernel, Ahead):
            steps, last = self._steps(node), Cells.of([(self._axis.end - 1, self._axis.end)])
            late = Cells.of([(self._axis.end - 1, 4 * NEVER)])
            ahead = [cells.widened(steps, steps) for cells in (lower, upper)]
            capped = [(cells - late) | (last if len(cells & late) else NONE) for cells in ahead]
            return [(args[0], (capped[0], capped[1]))]
        if isinstance(kernel, Shift):
            by = 1 if node.op.tense is Tense.FUTURE else -1
            return [(args[0], (lower.widened(by, by), upper.widened(by, by)))]
        if isinstance(kernel, Sum | Window):
            return self._window(parts, node, lower, upper)
        if isinstance(kernel, Pointwise):
            return self._pointwise(parts, node, lower, upper)
        behind, ahead_ = own_reach(node, self._axis.period)
        whole = (lower | upper).widened(-behind, ahead_)
        return [(arg, (whole, whole)) for arg in args]

    def _steps(self, node: Apply) -> int:
        """Return how many cells away an operator of a duration reads: a sample where none is given."""
        return 1 if node.interval is None else window_of(node, self._axis.period)[0]

    def _initial(self, node: Apply, k: int, lower: Cells, upper: Cells) -> tuple[Formula, Need]:
        """Return the demands on the substitute for values before the trace: operand k, or the first value."""
        if len(node.args) > k:
            return node.args[k], (lower, upper)
        start = Cells.of([(0, 1)])
        return node.args[0], (start if len(lower) else NONE, start if len(upper) else NONE)

    def _held(self, parts: _Parts, node: Apply, lower: Cells, upper: Cells) -> list[tuple[Formula, Need]]:
        truth = self._truth(node.args[1])
        holding, failing = [], []
        passed, initial = [], []
        for cells in (lower, upper):
            now = cells & truth
            later = cells - truth
            run = np.searchsorted(truth.starts, later.starts, side="right") - 1
            known = run >= 0
            ends = truth.ends[run[known]]
            begins = ends - 1
            if self._dense:  # not a tick, but the segment that it ends
                begins = np.maximum(truth.starts[run[known]], parts.of(node.args[0]).begins(begins))
            before = Cells.union(begins, ends)
            holding.append(now | before)
            failing += [Cells.union(ends, later.ends[known])]
            passed.append(now | before)
            never = Cells.union(later.starts[~known], later.ends[~known])
            initial.append(never)
            failing.append(Cells.of([(0, int(never.ends[-1]))] if len(never) else []))
        true, false = holding[0] | holding[1], failing[0] | failing[1] | failing[2] | failing[3]
        return [
            (node.args[0], (passed[0], passed[1])),
            (node.args[1], (true, false)),
            self._initial(node, 2, initial[0], initial[1]),
        ]

    def _window(self, parts: _Parts, node: Apply, lower: Cells, upper: Cells) -> list[tuple[Formula, Need]]:
        first, last = window_of(node, self._axis.period)
        before, after = (-last, -first) if node.op.tense is Tense.PAST else (first, last)
        arg, kernel = node.args[0], node.op.kernel
        below, above = lower.widened(before, after), upper.widened(before, after)
        if isinstance(kernel, Window):
            largest = kernel.reduce == CHOOSING[1]
            one = attained(
                lower if largest else upper,
                parts.of(node),
                parts.of(arg),
                before,
                after,
                largest=largest,
                whole=self._dense,
            )
            below, above = (one, above) if largest else (below, one)
        return [(arg, (below, above))]

    def _pointwise(
        self, parts: _Parts, node: Apply, lower: Cells, upper: Cells
    ) -> list[tuple[Formula, Need]]:
        kernel, args = node.op.kernel, node.args
        assert isinstance(kernel, Pointwise)
        if kernel.opcode in CHOOSING:
            largest = kernel.opcode == CHOOSING[1]
            value, rest = parts.of(node), lower if largest else upper
            found = []
            # A constant does, wherever it is the value.
            for k in sorted(range(len(args)), key=lambda k: not isinstance(args[k], Const)):
                mine = rest & parts.of(args[k]).equal(value)
                rest = rest - mine
                found.append((args[k], (mine, upper) if largest else (lower, mine)))
            return found
        if kernel.opcode == NEGATION:
            return [(args[0], (upper, lower))]
        constants = (arg.value if isinstance(arg, Const) else None for arg in args)
        slopes = (None,) * len(args) if node.op.slopes is None else node.op.slopes(*constants)
        both = lower | upper
        needs = {1: (lower, upper), -1: (upper, lower)}
        return [(arg, needs.get(slope or 0, (both, both))) for arg, slope in zip(args, slopes, strict=True)]

    # ---- conditions --------------------------------------------------------------------------------

    def _condition_of(self, condition: Formula) -> _Condition:
        if condition not in self._conditions:
            self._conditions[condition] = _Condition(condition, self._axis, dense=self._dense)
        return self._conditions[condition]

    def _truth(self, condition: Formula) -> Cells:
        return self._condition_of(condition).holds

    def _condition(self, condition: Formula, need: Need) -> list[tuple[Formula, Need]]:
        return self._condition_of(condition).asked(*need)

    # ---- from a value to its source ----------------------------------------------------------------

    def _from(self, parts: _Parts, walk: Walk, node: Apply, cell: int) -> list[tuple[Formula, int]] | None:
        """Return the parts that determine the value of a part; None for all that it reads."""
        kernel, args = node.op.kernel, node.args
        if isinstance(kernel, Pointwise):
            if kernel.opcode not in CHOOSING:
                return [(arg, cell) for arg in args]
            value = parts.at(node, cell)
            same = [arg for arg in args if parts.at(arg, cell) == value]
            return [(next((arg for arg in same if not isinstance(arg, Const)), same[0]), cell)]
        if isinstance(kernel, Shift | Window):
            there = walk.elsewhere(node, cell)
            return [] if there is None else [there]
        if isinstance(kernel, Ahead):
            return [(args[0], min(cell + self._steps(node), self._axis.end - 1))]
        if node.op.source is Source.BRANCH:
            branch = args[1] if cell in self._truth(args[0]) else args[2]
            # Of a constant the value comes from the condition.
            return None if isinstance(branch, Const) else [(branch, cell)]
        if node.op.source is Source.DELAYED:
            back = cell - self._steps(node)
            return [(args[0], back) if back >= 0 else (args[1], cell) if len(args) > 1 else (args[0], 0)]
        if node.op.source is Source.HELD:
            earlier = self._truth(args[1]).within(0, cell + 1)
            if len(earlier):
                return [(args[0], int(earlier.ends[-1]) - 1)]
            return [(args[2], cell) if len(args) > 2 else (args[0], 0)]
        return None


class _Parts:
    """The parts of a predicate, down to variables and conditions, and their values."""

    def __init__(self, formula: Formula, axis: TimeAxis) -> None:
        self._axis = axis
        self.top = _expand(spelled_out(formula))
        self.order: list[Formula] = []
        self._steps: dict[Formula, StepFunction] = {}
        stack: list[tuple[Formula, bool]] = [(self.top, False)]
        met: set[Formula] = set()
        while stack:
            node, ready = stack.pop()
            if ready:
                self.order.append(node)
            elif node not in met:
                met.add(node)
                stack.append((node, True))
                if isinstance(node, Apply):
                    conditions = _conditions(node)
                    stack.extend((arg, False) for arg in node.args if arg not in conditions)

    def of(self, node: Formula, value: float | None = None) -> StepFunction:
        """Return the values of a part: all of them."""
        del value
        if node not in self._steps:
            self._steps[node] = self._axis.measured([node])[0]
        return self._steps[node]

    def largest(self, node: Formula, sign: int, begin: int, end: int) -> int:
        """Return the first cell in [begin, end) at which the value of a part is, times a sign, the largest."""
        changes, values = self.of(node).between(begin, end)
        return int(changes[(sign * values).argmax()])

    def at(self, node: Formula, cell: int) -> float:
        """Return the value of a part at a cell."""
        return self.of(node).at(cell)


class _Condition:
    """A condition, and the samples that its truth requires."""

    def __init__(self, condition: Formula, axis: TimeAxis, *, dense: bool) -> None:
        self._structure = Structure.of(condition, axis.period if dense else None)
        leaves = [leaf.formula for leaf in self._structure.leaves.values()]
        steps = axis.measured(leaves) if leaves else []
        values = dict(zip(self._structure.leaves, steps, strict=True))
        self._holds = truths(self._structure.order, axis, values)
        signals = Signals(self._structure, axis, values)
        walk = Walk(signals, axis.period, axis.end)
        self._given = (self._structure, self._holds, signals, walk, axis.period, axis.end)
        self._dense = dense

    @property
    def holds(self) -> Cells:
        """Where the condition holds."""
        return self._holds[self._structure.core]

    def asked(self, true: Cells, false: Cells) -> list[tuple[Formula, Need]]:
        """Return the demands on predicates for the condition to stay true at some cells, and false at others."""
        found = []
        for satisfied, cells in ((True, true), (False, false)):
            if not len(cells):
                continue
            demands = Demands(*self._given, dense=self._dense)
            demands.ask(cells, satisfied=satisfied)
            for (name, sign), asked in demands.leaves.items():
                predicate = self._structure.leaves[name].formula
                truth = demands.truth(sign)
                found.append((predicate, (asked.cells, NONE) if truth else (NONE, asked.cells)))
        return found


def _conditions(node: Apply) -> list[Formula]:
    return [arg for sort, arg in zip(node.op.operands, node.args, strict=False) if sort is Sort.CONDITION]


def _expand(formula: Formula) -> Formula:
    """Return a formula with its operators expanded, from the top down to those with a rule; conditions stay."""
    expanded: dict[int, Formula] = {}
    done: dict[int, tuple[Formula, Formula]] = {}
    stack = [formula]
    while stack:
        node = stack[-1]
        if (
            isinstance(node, Apply)
            and node.op.expansion is not None
            and not (node.op.kernel or node.op.source)
        ):
            if id(node) not in expanded:
                expanded[id(node)] = node.op.expansion(*node.args, node.interval)
            below = [expanded[id(node)]]
        else:
            conditions = _conditions(node) if isinstance(node, Apply) else []
            below = [arg for arg in children(node) if arg not in conditions]
        missing = [part for part in below if id(part) not in done]
        if missing:
            stack.extend(missing)
            continue
        stack.pop()
        result = node
        if id(node) in expanded:
            result = done[id(below[0])][1]
        elif isinstance(node, Apply):
            args = tuple(done[id(arg)][1] if id(arg) in done else arg for arg in node.args)
            result = rebuilt(node, args)
        done[id(node)] = node, result  # the node, too: identities are those of living objects
    return done[id(formula)][1]
