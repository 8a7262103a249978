"""Parts of a program: the instructions that some of its outputs need."""

from __future__ import annotations

from types import MappingProxyType

from rtamt.compiler.places import Deferred
from rtamt.compiler.program import records_of
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from rtamt.compiler.program import Program


def sliced(program: Program, outputs: Sequence[int], kept_inputs: Collection[str] = ()) -> Program:
    """Return the program of some outputs alone (numbers of ``program.outputs``), whose values stay the same.

    ``kept_inputs``: inputs that are read even if these outputs do not need them: in dense time they determine where
    signals start and end.

    >>> from fractions import Fraction
    >>> from rtamt.compiler.plan import compile_program
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> both = compile_program([parse_formula("x - 3"), parse_formula("y - 3")], Fraction(1))
    >>> print(sliced(both, [1]).disassemble())
    %0   lag 0    const 3.0
    %1   lag 0    input y
    %2   lag 0    sub %1 %0  -> output
    """
    instructions = program.instructions
    roots = [program.outputs[i] for i in outputs]
    needed = set(roots)
    needed.update(
        i
        for i, instruction in enumerate(instructions)
        if instruction.opcode == "input" and program.inputs[instruction.n] in kept_inputs
    )
    for i in range(len(instructions) - 1, -1, -1):
        if i in needed:
            needed.update(j for j in (instructions[i].a, instructions[i].b) if j is not None)
    kept = sorted(needed)
    place = {old: new for new, old in enumerate(kept)}
    read = {program.inputs[instructions[i].n] for i in kept if instructions[i].opcode == "input"}
    names = [name for name in program.inputs if name in read or name in kept_inputs]
    made = []
    for i in kept:
        old = instructions[i]
        a, b = (None if j is None else place[j] for j in (old.a, old.b))
        n = names.index(program.inputs[old.n]) if old.opcode == "input" else old.n
        made.append(old._replace(a=a, b=b, n=n))
    metadata = program.metadata
    if metadata is not None:
        meanings = metadata.meanings
        metadata = replace(
            metadata,
            outputs=tuple([metadata.outputs[i] for i in outputs]),
            meanings=Deferred(lambda: [(place[i], text) for i, text in meanings.items() if i in place]),
            parameters=MappingProxyType({}),
        )
    return replace(
        program,
        records=records_of(made),
        inputs=tuple(names),
        outputs=tuple([place[i] for i in roots]),
        value_of=MappingProxyType(
            {formula: place[i] for formula, i in program.value_of.items() if i in place}
        ),
        origins=tuple([program.origins[i] for i in kept]) if program.origins else (),
        parametric=MappingProxyType({place[i]: name for i, name in program.parametric.items() if i in place}),
        metadata=metadata,
    )
