"""The instructions of a program so far: value numbering, inputs and constants, lags, and the delays that align."""

from __future__ import annotations

from rtamt.compiler.program import CODES, NO_OPERAND
from rtamt.language.formula import Const, Parameter, Var
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.compiler.program import Record
    from rtamt.language.formula import Formula

_INPUT, _CONST, _SHIFT = (CODES[opcode] for opcode in ("input", "const", "shift"))


class Emission:
    """The instructions so far; emitting an existing instruction returns its index."""

    def __init__(self, inputs: tuple[str, ...]) -> None:
        self.inputs = inputs
        self.records: list[Record] = []
        #: The lag of each instruction in steps.
        self.lags: list[int] = []
        #: The formula that each instruction was emitted for.
        self.origins: list[Formula | None] = []
        self.index_of: dict[Record, int] = {}
        #: The indices of constants, other than parameters, by value.
        self.constants: dict[float, int] = {}
        self.parameters: dict[Parameter, int] = {}
        self.variables: dict[str, int] = {}
        self._places = {name: place for place, name in enumerate(inputs)}

    def emit(self, record: Record, origin: Formula) -> int:
        """Return the index of an instruction, adding it if necessary."""
        records = self.records
        new = len(records)
        index = self.index_of.setdefault(record, new)
        if index == new:
            records.append(record)
            self.lags.append(record[6])
            self.origins.append(origin)
        return index

    def add(
        self,
        opcode: str,
        origin: Formula,
        a: int = NO_OPERAND,
        b: int = NO_OPERAND,
        *,
        n: int = 0,
        x: float = 0.0,
        lag: int = 0,
    ) -> int:
        """Return the index of an instruction from its fields, adding it if necessary."""
        return self.emit((CODES[opcode], a, b, 0, n, x, lag), origin)

    def leaf(self, node: Formula) -> int:
        """Return the index of a variable or a constant, adding it if necessary."""
        if node.__class__ is Const:  # no parameter
            value = node.value
            place = self.constants.get(value)
            if place is None:
                place = self.constants[value] = self.new_constant(value, node)
            return place
        if isinstance(node, Var):
            place = self.variables.get(node.name)  # most occur several times
            if place is None:
                assert not node.bound, "quantifiers are resolved before"
                record = (_INPUT, NO_OPERAND, NO_OPERAND, 0, self._places[node.name], 0.0, 0)
                place = self.variables[node.name] = self.emit(record, node)
            return place
        assert isinstance(node, Parameter)
        known = self.parameters.get(node)
        if known is None:
            known = self.parameters[node] = self.new_constant(node.value, node)
        return known

    def constant(self, value: float, origin: Formula) -> int:
        """Return the index of a constant, adding it if necessary."""
        known = self.constants.get(value)
        if known is None:
            known = self.constants[value] = self.new_constant(value, origin)
        return known

    def new_constant(self, value: float, origin: Formula) -> int:
        """Add a constant even if there is an equal one, since parameters may change; return its index."""
        self.records.append((_CONST, NO_OPERAND, NO_OPERAND, 0, 0, value, 0))
        self.lags.append(0)
        self.origins.append(origin)
        return len(self.origins) - 1

    def pointwise(self, code: int, origin: Formula, a: int, b: int = NO_OPERAND) -> int:
        """Lower an operator on values at one instant, over operands that need not be aligned."""
        lags = self.lags
        lag = lags[a]
        if b != NO_OPERAND and (other := lags[b]) != lag:  # as align() does
            if other < lag:
                b = self.delayed(b, lag)
            else:
                a, lag = self.delayed(a, other), other
        record = (code, a, b, 0, 0, 0.0, lag)
        new = len(lags)
        index = self.index_of.setdefault(record, new)
        if index == new:  # as emit() does
            self.records.append(record)
            lags.append(lag)
            self.origins.append(origin)
        return index

    def is_const(self, index: int) -> bool:
        """Return whether an instruction is a constant, which needs no delay."""
        return self.records[index][0] == _CONST

    def align(self, indices: list[int]) -> list[int]:
        """Delay operands until all have the largest lag; constants have no lag."""
        if len(indices) < 2:
            return indices
        lags = [self.lags[index] for index in indices]
        lag = max(lags)
        return [i if own == lag else self.delayed(i, lag) for i, own in zip(indices, lags, strict=True)]

    def delayed(self, index: int, lag: int) -> int:
        """Return the same value known later: slots move, time does not."""
        return index if self.records[index][0] == _CONST else self.late(index, lag)

    def late(self, index: int, lag: int) -> int:
        """Return the same value known at ``lag``, also for a constant."""
        behind = lag - self.lags[index]
        if behind == 0:
            return index
        origin = self.origins[index]
        assert origin is not None
        return self.emit((_SHIFT, index, NO_OPERAND, 0, behind, 0.0, lag), origin)

    def moved(self, index: int, distance: int, fill: float, lag: int, origin: Formula) -> int:
        """Return the operand ``distance`` samples ago, ``fill`` where that sample does not exist."""
        return self.emit((_SHIFT, index, NO_OPERAND, 0, distance, fill, lag), origin)
