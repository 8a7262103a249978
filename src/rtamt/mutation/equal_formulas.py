"""A key of a formula that is the same for formulas that are trivially equal.

Predicates are true or false there, derived operators are expanded, negations are moved inwards and vanish in pairs,
and the operands of ``and`` and ``or`` have no order. Formulas with different keys may still be equal.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.language.formula import Apply, Const, Formula, Var, fold, postorder
from rtamt.language.operators import STL, Pointwise, Shift, Window
from rtamt.rewrite.desugar import desugar
from rtamt.rewrite.ground import ground
from rtamt.rewrite.truth import rebuilt, replaced, truth

if TYPE_CHECKING:
    from fractions import Fraction

_SMALLER, _GREATER, _MINUS = "min", "max", "neg"
_FLIPPED = {_SMALLER: _GREATER, _GREATER: _SMALLER}
#: Of windows and shifts, by name, the operator of the negation.
_DUALS = {op.name: op.dual for op in STL if op.dual and isinstance(op.kernel, Window | Shift)}


class Keys:
    """Keys of formulas: equal numbers mean that formulas are trivially equal.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> keys = Keys(Fraction(1))
    >>> one, other = "x > 3 and not always(y > 2)", "eventually(y <= 2) and not (x <= 3)"
    >>> keys.of(parse_formula(one)) == keys.of(parse_formula(other))
    True
    """

    def __init__(self, step: Fraction, *, continuous: bool = False) -> None:
        self._step = step
        self._continuous = continuous
        self._numbers: dict[Any, int] = {}
        #: The quantified formula of each number.
        self._parts: list[Any] = []

    def of(self, formula: Formula) -> int:
        """Return the key of a formula."""
        grounded = ground(fold(formula, self._replace_quantifier), self._step, continuous=self._continuous)
        core = desugar(replaced(grounded, truth))
        known: dict[int, int] = {}
        for node in postorder(core):
            known[id(node)] = self._key(node, known)
        return known[id(core)]

    def _replace_quantifier(self, node: Formula, args: tuple[Formula, ...]) -> Formula:
        """Return a quantified formula as a variable, which the quantifier and the key of what it ranges over name."""
        if not isinstance(node, Apply):
            return node
        if node.op.binder is not None:
            return Var(f"{node.op.name} {node.op.binder}: {self.of(args[0])}")
        return rebuilt(node, args)

    def _key(self, node: Formula, known: dict[int, int]) -> int:
        if isinstance(node, Const):
            return self._number(("const", node.value + 0.0))
        if isinstance(node, Var):
            return self._number(("var", node.name))
        assert isinstance(node, Apply)
        operands = tuple(known[id(arg)] for arg in node.args)
        kernel = node.op.kernel
        if isinstance(kernel, Pointwise):
            if kernel.opcode == _MINUS:
                return self._minus(operands[0])
            if kernel.opcode in _FLIPPED:
                return self._junction(kernel.opcode, operands)
        interval = node.interval
        if isinstance(kernel, Window) and interval is not None and interval.end == 0:
            return operands[0]  # a window of one instant
        bounds = None if interval is None else (interval.begin, interval.end, interval.share)
        return self._number((node.op.name, bounds, operands))

    def _minus(self, operand: int) -> int:
        """Return the negation: of windows and junctions the dual over the negations of the operands."""
        part = self._parts[operand]
        head = part[0]
        if head == _MINUS:
            return int(part[2][0])
        if head == "const":
            return self._number(("const", 0.0 - part[1]))
        if head in _FLIPPED:
            return self._junction(_FLIPPED[head], tuple(map(self._minus, part[2])))
        if head in _DUALS:
            return self._number((_DUALS[head], part[1], tuple(map(self._minus, part[2]))))
        return self._number((_MINUS, None, (operand,)))

    def _junction(self, opcode: str, operands: tuple[int, ...]) -> int:
        neutral = inf if opcode == _SMALLER else -inf
        flat: set[int] = set()
        for operand in operands:
            part = self._parts[operand]
            flat.update(part[2] if part[0] == opcode else (operand,))
        if self._number(("const", -neutral)) in flat:
            return self._number(("const", -neutral))
        flat.discard(self._number(("const", neutral)))
        if not flat:
            return self._number(("const", neutral))
        if len(flat) == 1:
            return flat.pop()
        return self._number((opcode, None, tuple(sorted(flat))))

    def _number(self, part: Any) -> int:
        number = self._numbers.setdefault(part, len(self._parts))
        if number == len(self._parts):
            self._parts.append(part)
        return number
