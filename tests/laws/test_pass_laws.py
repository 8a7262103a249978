"""Passes change no bit: values, failures and states are the same whichever are left out."""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING, Any

import numpy as np
from hypothesis import assume, given
from hypothesis import strategies as st

from rtamt.compiler.passes import PASSES
from rtamt.compiler.plan import compile_program
from rtamt.engine.native import calls_of, core
from rtamt.errors import StlError
from rtamt.language.contents import variables
from rtamt.rewrite.desugar import desugar
from tests.support.strategies import chunkings, formulas, traces

if TYPE_CHECKING:
    from rtamt.compiler.program import Program
    from rtamt.language.formula import Formula

SUBSETS = [names for size in range(1, len(PASSES) + 1) for names in combinations(PASSES, size)]


def compiled(asked: tuple[Formula, ...], without: tuple[str, ...]) -> Program:
    cores = tuple(desugar(formula) for formula in asked)
    return compile_program(cores, Fraction(1), variables(*cores), without=without)


def columns_of(
    program: Program, columns: dict[str, Any], begin: int = 0, end: int | None = None
) -> list[Any]:
    return [np.asarray(columns[name], float)[begin:end] for name in program.inputs]


def bits(values: list[Any]) -> list[bytes]:
    return [np.asarray(each).tobytes() for each in values]


def failure(program: Program, error: Exception) -> Any:
    """Return what failed and when; passes may number instructions anew."""
    return program.origin_of(error.args[0]), error.args[1]


def offline(program: Program, columns: dict[str, Any]) -> Any:
    inputs = columns_of(program, columns)
    n = len(next(iter(columns.values())))
    try:
        return bits(core().evaluate(program.code(), inputs, n, calls_of(program)))
    except core().Undefined as error:
        return failure(program, error)


def monitor_of(program: Program) -> Any:
    return core().Monitor(program.code(), list(program.inputs), calls=calls_of(program))


def online(program: Program, columns: dict[str, Any], sizes: list[int]) -> Any:
    """Return what each chunk makes known, or how it fails, and the values of the outputs after it."""
    monitor, at, known = monitor_of(program), 0, []
    for size in sizes:
        try:
            known.append(bits(monitor.push(None, columns_of(program, columns, at, at + size))))
        except core().Undefined as error:
            known.append(failure(program, error))
        at += size
        known.append([monitor.latest(output) for output in range(len(program.outputs))])
    try:
        known.append(bits(monitor.finish()))
    except core().Undefined as error:
        known.append(failure(program, error))
    return known


@given(st.data(), st.booleans())
def test_no_pass_changes_a_bit(data: st.DataObject, long: bool) -> None:
    asked = tuple(data.draw(st.lists(formulas(), min_size=1, max_size=3)))
    assume(variables(*asked))
    columns = data.draw(traces(infinite=True))
    n = len(columns["x"])
    if long:  # whole strips and blocks, and ends of them
        n = data.draw(st.sampled_from([31, 32, 33, 63, 257, 700]))
        columns = {name: np.resize(np.asarray(column, float), n) for name, column in columns.items()}
    try:
        plain = compiled(asked, PASSES)
    except StlError:
        assume(False)
    sizes = data.draw(chunkings(n))
    expected = offline(plain, columns), online(plain, columns, sizes)
    for without in [(), *SUBSETS[:-1]]:
        program = compiled(asked, without)
        assert (offline(program, columns), online(program, columns, sizes)) == expected


@given(st.data())
def test_a_state_continues_whichever_passes_are_left_out(data: st.DataObject) -> None:
    formula = data.draw(formulas())
    assume(variables(formula))
    columns = data.draw(traces(min_size=2))
    n = len(columns["x"])
    seen = data.draw(st.integers(0, n))
    program = compiled((formula,), data.draw(st.sampled_from([(), *SUBSETS])))
    monitor, other = monitor_of(program), monitor_of(program)
    try:
        monitor.push(None, columns_of(program, columns, 0, seen))
        other.restore(monitor.state())
        rest = [bits(each.push(None, columns_of(program, columns, seen))) for each in (monitor, other)]
        assert rest[0] == rest[1]
        assert monitor.latest(0) == other.latest(0)
        assert bits(monitor.finish()) == bits(other.finish())
    except core().Undefined:
        assume(False)
