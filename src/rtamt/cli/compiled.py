"""``rtamt info`` for programs that ``rtamt compile`` wrote."""

from __future__ import annotations

import os
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError
from rtamt.compiler.passes import passes_of
from rtamt.compiler.program import MAGIC, Program
from rtamt.errors import UsageError
from rtamt.language.units.durations import format_duration
from rtamt.verdicts.standalone import check_code, layout

if TYPE_CHECKING:
    from collections.abc import Iterator


def load_compiled(path: str) -> Program | None:
    """Return the program in a file, if it is one."""
    if not os.path.isfile(path):
        return None
    try:
        with Path(path).open("rb") as file:
            code = file.read(len(MAGIC))
            if code != MAGIC:
                return None
            code += file.read()
    except OSError as error:
        raise CommandError(f"cannot read '{path}': {error.strerror}") from error
    try:
        program = Program.from_bytes(code)
        check_code(program, code)
    except UsageError as error:
        raise CommandError(f"{path}: {error}") from error
    return program


def listing(program: Program) -> Iterator[str]:
    """Return the metadata and the instructions of a program, line by line."""
    metadata = program.metadata
    assert metadata is not None
    if metadata.name:
        yield f"name       {metadata.name}"
    yield f"formula    {metadata.formula}"
    yield f"variables  {', '.join(program.inputs) or 'none'}"
    values = (
        f"{name} = {program.instructions[places[0]].x:g}" for name, places in metadata.parameters.items()
    )
    yield f"parameters {', '.join(values) or 'none'}"
    yield f"outputs    {', '.join(metadata.outputs)}"
    yield f"{program.domain.unit.step:<10} {format_duration(program.period)}, {program.domain.name} time"
    yield f"horizon    {format_duration(max(program.lags) * program.period)}"
    yield "program"
    for line in program.disassemble().splitlines():
        yield f"  {line}"


def after_passes(program: Program) -> Iterator[str]:
    """Return the passes that a program goes through, and what they make of its instructions, line by line."""
    yield f"passes     {', '.join(passes_of(program)) or 'none'}"
    yield "program"
    lines = program.disassemble().splitlines()
    width = max(len(line) for line in lines)
    for line, note in zip_longest(lines, _places(program), fillvalue=""):
        yield f"  {line:{width}}  {note}".rstrip()


def _places(program: Program) -> list[str]:
    """Return where the core computes and keeps the value of each instruction."""
    places = []
    for root, register in layout(program):
        if register is not None:
            places.append(f"register {register}")
        else:
            places.append("in place" if root is None else f"fused into %{root}")
    return places
