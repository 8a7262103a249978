"""A compiled formula: a flat list of instructions that every carrier of the engine runs.

Slots and lags. At slot s (the s-th sample) an instruction with lag L gives its value at sample
s - L; a future window [a, b] adds b to the lag, and operands are delayed until their lags agree.
What lies outside the trace is *absent*: kernels skip it, which cuts windows at both ends. So one
program serves offline and online alike, and nothing needs pastification.

The bytes are those of core/program.hpp (documented there and in ``to_bytes``): header, records of
40 bytes, outputs, metadata as JSON, CRC-32.
"""

from __future__ import annotations

import json
import struct
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtamt.errors import UsageError

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from rtamt.language.formula import Apply, Formula
    from rtamt.language.operators import Operator

#: In the order of the core's enumeration; a test compares the two.
OPCODES = (
    "input", "const",
    "neg", "abs", "sqrt", "exp", "ln",
    "add", "sub", "mul", "div", "pow", "log", "min", "max", "holds_gt", "holds_ge", "holds_eq",
    "shift", "slide_max", "slide_min", "run_max", "run_min", "since", "until", "call",
)  # fmt: skip

#: Time domains, in the order of their codes.
DOMAINS = ("discrete", "dense")

NO_OPERAND = 0xFFFFFFFF
_HEADER = struct.Struct("<8sHBBIIIII")
_RECORD = struct.Struct("<B3xIIIqdq")


@dataclass(frozen=True, slots=True)
class Instruction:
    """One instruction: ``a`` and ``b`` are operands (indices of earlier instructions, or None).

    ``n`` is a width or distance in samples (of ``input``: which input; of ``call``: which call), ``x`` a
    constant or fill.
    """

    opcode: str
    a: int | None = None
    b: int | None = None
    n: int = 0
    x: float = 0.0
    lag: int = 0

    def describe(self, inputs: tuple[str, ...], calls: tuple[CallSite, ...] = ()) -> str:
        """Return the instruction as one line of a listing."""
        parts = [self.opcode]
        if self.opcode == "call":
            return calls[self.n].describe()
        if self.opcode == "input":
            parts.append(inputs[self.n])
        elif self.opcode == "const":
            parts.append(repr(self.x))
        parts += [f"%{i}" for i in (self.a, self.b) if i is not None]
        if self.opcode not in ("input", "const") and self.n:
            parts.append(f"n={self.n}")
        if self.opcode == "shift":
            parts.append(f"fill={self.x!r}")
        return " ".join(parts)


@dataclass(frozen=True, slots=True)
class CallSite:
    """An operator that the core does not know, and the instructions that it reads.

    It runs a kernel of the user's, or the definition where there is none. ``begin`` and ``end`` are its
    interval in steps (samples or ticks), ``end=None`` where there is no upper bound; ``ahead`` is how
    many steps ahead of the present one it reads.
    """

    node: Apply
    operands: tuple[int, ...]
    begin: int
    end: int | None
    ahead: int

    @property
    def op(self) -> Operator:
        """The operator."""
        return self.node.op

    def describe(self) -> str:
        """Return the call as one line of a listing."""
        interval = ""
        if self.node.interval is not None:
            interval = f"[{self.begin}:{'inf' if self.end is None else self.end}]"
        return " ".join([f"call {self.op.name}{interval}", *(f"%{i}" for i in self.operands)])


@dataclass(frozen=True, slots=True)
class Program:
    """Instructions in SSA form, equal ones merged.

    ``period`` is the sampling period, in dense time the length of a tick (seconds). ``outputs`` are
    indices of instructions; ``lags`` tells after how many samples or ticks each output is known.
    ``value_of`` maps each core sub-formula to its instruction, ``origins`` the other way.
    """

    instructions: tuple[Instruction, ...]
    inputs: tuple[str, ...]
    outputs: tuple[int, ...]
    period: Fraction
    value_of: Mapping[Formula, int]
    origins: tuple[Formula | None, ...]
    domain: str = "discrete"
    calls: tuple[CallSite, ...] = ()

    @property
    def lags(self) -> tuple[int, ...]:
        """Samples (or ticks) after which each output's value at a sample is known."""
        return tuple(self.instructions[i].lag for i in self.outputs)

    def to_bytes(self) -> bytes:
        """Serialise: what every carrier of the core runs.

        Raises :class:`UsageError` where the program calls an operator that the core does not know.
        """
        if self.calls:
            raise UsageError(
                f"the program calls '{self.calls[0].op.name}', which the core does not know: bytes cannot carry "
                f"an operator's own code; expand it into the operators of STL, or run the program in Python"
            )
        return self.code()

    def code(self) -> bytes:
        """Return what the core runs in this process, together with the calls."""
        meta = json.dumps({"inputs": self.inputs, "period": str(self.period)}, separators=(",", ":")).encode()
        parts = [
            _HEADER.pack(
                b"RTAMTPRG",
                1,
                DOMAINS.index(self.domain),
                0,
                len(self.instructions),
                len(self.inputs),
                len(self.outputs),
                len(meta),
                0,
            )
        ]
        for ins in self.instructions:
            a = NO_OPERAND if ins.a is None else ins.a
            b = NO_OPERAND if ins.b is None else ins.b
            parts.append(_RECORD.pack(OPCODES.index(ins.opcode), a, b, 0, ins.n, ins.x, ins.lag))
        parts.append(struct.pack(f"<{len(self.outputs)}I", *self.outputs))
        parts.append(meta)
        body = b"".join(parts)
        return body + struct.pack("<I", zlib.crc32(body))

    def disassemble(self) -> str:
        """Return a listing: index, lag in samples, instruction.

        >>> from fractions import Fraction
        >>> from rtamt.engine.compile import compile_program
        >>> from rtamt.language.parser import parse_formula
        >>> print(compile_program([parse_formula("always[0:2](x - 3)")], Fraction(1)).disassemble())
        %0   lag 0    input x
        %1   lag 0    const 3.0
        %2   lag 0    sub %0 %1
        %3   lag 2    slide_min %2 n=3  -> output
        """
        lines = []
        for i, ins in enumerate(self.instructions):
            mark = "  -> output" if i in self.outputs else ""
            lines.append(f"%{i:<3} lag {ins.lag:<4} {ins.describe(self.inputs, self.calls)}{mark}")
        return "\n".join(lines)
