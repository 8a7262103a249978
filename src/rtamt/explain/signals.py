"""The values of the sub-formulas that an explanation looks at, and where they hold."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, Const, Formula, Var, children
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import CHOOSING, NEGATION, opcode
from rtamt.signals.instants import Cells, StepFunction, two_valued

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.engine import TimeAxis
    from rtamt.rewrite.structure import Structure


class Signals:
    """The sub-formulas of a structure over given signals of its leaves.

    One run of the engine gives those that read other instants and what they read; the others are a
    minimum, maximum or negation at one instant, found where they are requested.
    """

    def __init__(self, structure: Structure, axis: TimeAxis, leaves: Mapping[str, StepFunction]) -> None:
        self._end = axis.end
        self._steps: dict[Formula, StepFunction] = {}
        self._at: tuple[int, dict[Formula, float]] = (-1, {})
        wanted: dict[Formula, None] = {}
        for node in structure.order:
            if isinstance(node, Apply) and opcode(node) is None:
                wanted.update(dict.fromkeys((*node.args, node)))
        asked = [node for node in wanted if isinstance(node, Apply)]
        for node in structure.order:
            if isinstance(node, Var):
                self._steps[node] = leaves[node.name]
            elif isinstance(node, Const):
                self._steps[node] = StepFunction(np.zeros(1, np.int64), np.array([node.value]), self._end)
        if asked:
            self._steps.update(zip(asked, axis.runner(asked)(leaves), strict=True))

    def of(self, node: Formula) -> StepFunction:
        """Return the values of a leaf, of a sub-formula that reads other instants, or of what one reads."""
        return self._steps[node]

    def at(self, node: Formula, cell: int) -> float:
        """Return the value of any sub-formula at a cell."""
        if self._at[0] != cell:
            self._at = (cell, {})
        known = self._at[1]
        stack = [node]
        while stack:
            top = stack[-1]
            if top in known:
                stack.pop()
            elif top in self._steps:
                known[top] = self._steps[top].at(cell)
            else:
                missing = [arg for arg in children(top) if arg not in known]
                stack.extend(missing)
                if not missing:
                    known[top] = _choose(opcode(top), [known[arg] for arg in children(top)])
        return known[node]


def _choose(code: str | None, values: list[float]) -> float:
    if code == NEGATION:
        return -values[0]
    return min(values) if code == CHOOSING[0] else max(values)


def truths(
    order: Sequence[Formula], axis: TimeAxis, leaves: Mapping[str, StepFunction]
) -> dict[Formula, Cells]:
    """Return where each sub-formula holds, given signals of its leaves that are above 0 where they hold.

    ``order``: the distinct sub-formulas, operands first.
    """
    whole = Cells.of([(0, axis.end)])
    bold = {name: two_valued(steps.positive(), inf, -inf, steps.end) for name, steps in leaves.items()}
    asked = [node for node in order if isinstance(node, Apply) and opcode(node) is None]
    found: dict[Formula, StepFunction] = {}
    if asked:
        found.update(zip(asked, axis.runner(asked)(bold), strict=True))
    holds: dict[Formula, Cells] = {}
    for node in order:
        code = opcode(node)
        if isinstance(node, Var):
            holds[node] = leaves[node.name].positive()
        elif isinstance(node, Const):
            holds[node] = whole if node.value > 0 else Cells.of([])
        elif code is None:
            holds[node] = found[node].positive()
        else:
            below = [holds[arg] for arg in children(node)]
            if code == NEGATION:
                holds[node] = whole - below[0]
            else:
                holds[node] = below[0] & below[1] if code == CHOOSING[0] else below[0] | below[1]
    return holds
