"""The instructions of a program so far: value numbering, lags, and the delays that align operands."""

from __future__ import annotations

from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.language.formula import Formula

    #: The fields of an instruction, of which instructions are made in the end.
    Row = tuple[str, int | None, int | None, int, float, int]


class Emission:
    """The instructions so far; emitting an existing instruction returns its index."""

    def __init__(self) -> None:
        self.instructions: list[Row] = []
        #: The formula that each instruction was emitted for.
        self.origins: list[Formula | None] = []
        self.index_of: dict[Row, int] = {}

    def emit(self, instruction: Row, origin: Formula) -> int:
        """Return the index of an instruction, adding it if necessary."""
        instructions = self.instructions
        new = len(instructions)
        index = self.index_of.setdefault(instruction, new)
        if index == new:
            instructions.append(instruction)
            self.origins.append(origin)
        return index

    def append(self, instruction: Row, origin: Formula) -> int:
        """Add an instruction and return its index."""
        self.instructions.append(instruction)
        self.origins.append(origin)
        return len(self.origins) - 1

    def lag(self, index: int) -> int:
        """Return the lag of an instruction in steps."""
        return self.instructions[index][5]

    def is_const(self, index: int) -> bool:
        """Return whether an instruction is a constant, which needs no delay."""
        return self.instructions[index][0] == "const"

    def align(self, indices: list[int]) -> list[int]:
        """Delay operands until all have the largest lag; constants have no lag."""
        if len(indices) < 2:
            return indices
        lags = [self.instructions[index][5] for index in indices]
        lag = max(lags)
        return [i if own == lag else self.delayed(i, lag) for i, own in zip(indices, lags, strict=True)]

    def delayed(self, index: int, lag: int) -> int:
        """Return the same value known later: slots move, time does not."""
        return index if self.instructions[index][0] == "const" else self.late(index, lag)

    def late(self, index: int, lag: int) -> int:
        """Return the same value known at ``lag``, also for a constant."""
        behind = lag - self.instructions[index][5]
        if behind == 0:
            return index
        origin = self.origins[index]
        assert origin is not None
        return self.emit(("shift", index, None, behind, 0.0, lag), origin)

    def moved(self, index: int, distance: int, fill: float, lag: int, origin: Formula) -> int:
        """Return the operand ``distance`` samples ago, ``fill`` where that sample does not exist."""
        return self.emit(("shift", index, None, distance, fill, lag), origin)
