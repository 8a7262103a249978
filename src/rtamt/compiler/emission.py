"""The instructions of a program so far: value numbering, lags, and the delays that align operands."""

from __future__ import annotations

from rtamt.compiler.program import CODES, NO_OPERAND
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.compiler.program import Record
    from rtamt.language.formula import Formula

_CONST, _SHIFT = CODES["const"], CODES["shift"]


class Emission:
    """The instructions so far; emitting an existing instruction returns its index."""

    def __init__(self) -> None:
        self.records: list[Record] = []
        #: The lag of each instruction in steps.
        self.lags: list[int] = []
        #: The formula that each instruction was emitted for.
        self.origins: list[Formula | None] = []
        self.index_of: dict[Record, int] = {}

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

    def constant(self, value: float, origin: Formula) -> int:
        """Return the index of a constant."""
        return self.emit((_CONST, NO_OPERAND, NO_OPERAND, 0, 0, value, 0), origin)

    def parameter(self, value: float, origin: Formula) -> int:
        """Add a constant that is never merged with another one, since its value may be changed; return its index."""
        self.records.append((_CONST, NO_OPERAND, NO_OPERAND, 0, 0, value, 0))
        self.lags.append(0)
        self.origins.append(origin)
        return len(self.origins) - 1

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
