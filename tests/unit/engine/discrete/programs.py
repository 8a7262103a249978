"""Small programs, and the monitor of one."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

from rtamt.compiler.program import Instruction, Program, records_of
from rtamt.engine.native import core

CORE = core()


def program(*instructions: Instruction, outputs: tuple[int, ...], inputs: tuple[str, ...]) -> bytes:
    return Program(
        records=records_of(instructions),
        inputs=inputs,
        outputs=outputs,
        period=Fraction(1),
        value_of={},
        origins=(),
    ).to_bytes()


A = Instruction("input", n=0)
B = Instruction("input", n=1)
DIFFERENCE = program(A, B, Instruction("sub", a=0, b=1), outputs=(2,), inputs=("a", "b"))


def monitor(**options: Any) -> Any:
    return CORE.Monitor(DIFFERENCE, ["a", "b"], **options)


def state(m: Any) -> tuple[Any, ...]:
    return (m.samples, m.violations, m.last_time, m.last(2))
