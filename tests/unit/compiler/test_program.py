"""What a formula compiles to, and the bytes that carry it."""

from fractions import Fraction

import pytest

import rtamt
from rtamt.compiler.plan import compile_plan, compile_program
from rtamt.compiler.program import OPCODES, Program
from rtamt.engine.native import core
from rtamt.errors import UsageError
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar

ONE = Fraction(1)


def listing(text: str) -> str:
    return compile_program((desugar(parse_formula(text)),), ONE).disassemble()


def test_opcodes_are_those_of_the_core() -> None:
    assert core().opcode_names() == list(OPCODES)


def test_listing() -> None:
    assert listing("x >= 3 -> eventually[0:5](y >= 3)") == (
        "%0   lag 0    input x\n"
        "%1   lag 0    const 3.0\n"
        "%2   lag 0    sub %0 %1\n"
        "%3   lag 0    neg %2\n"
        "%4   lag 0    input y\n"
        "%5   lag 0    sub %4 %1\n"
        "%6   lag 5    slide_max %5 n=6\n"
        "%7   lag 5    shift %3 n=5 fill=0.0\n"
        "%8   lag 5    max %7 %6  -> output"
    )


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("once[2:2](x > 0) or once[2:2](x > 0)", 5),
        ("x and x", 2),
        ("always[0:0] x", 1),
        ("2 + 3 * 4", 5),
    ],
)
def test_nothing_is_computed_twice(text: str, count: int) -> None:
    assert len(listing(text).splitlines()) == count


def test_unbounded_future_is_cut_into_stages() -> None:
    plan = compile_plan((desugar(parse_formula("always(x -> eventually[1:inf] y)")),), ONE, 10)
    assert [[scan.kind for scan in stage.scans] for stage in plan.stages] == [["run_max"], ["run_min"]]
    assert plan.program.inputs == ("x", "y", "#1.0")


def test_bounds_beyond_the_trace_are_cut_to_it() -> None:
    formula = desugar(parse_formula("always[0:1000000] x"))
    program = compile_program((formula,), ONE, clip=10)
    assert program.lags == (10,)


@pytest.mark.parametrize(
    ("text", "lag"),
    [
        ("always[0:3](x >= 3 -> eventually[1:5](y >= 3))", 8),
        ("ahead[2](3) >= 3", 2),
        ("ahead[2](3) >= 3 and always[0:1](x >= 3)", 2),
        ("next(ahead[2](3) >= 3)", 3),
        ("eventually[2:2](true)", 2),
    ],
)
def test_an_output_is_known_at_its_horizon_even_if_it_could_be_known_earlier(text: str, lag: int) -> None:
    assert compile_program([desugar(parse_formula(text))], Fraction(1)).lags == (lag,)


def test_memory_is_told_before_it_runs() -> None:
    for text, doubles in [
        ("always[0:9999](x)", 10_000),
        ("x until[1:9999] y", 20_000),
        ("x since[1:9999] y", 10_000),
    ]:
        program = compile_program((desugar(parse_formula(text)),), ONE)
        assert doubles <= core().memory(program.to_bytes()) / 8 <= 1.25 * doubles


@pytest.mark.parametrize("code", [None, 3, "RTAMTPRG", ["RTAMTPRG"]])
def test_what_is_no_bytes_is_no_program_and_the_message_says_so(code: object) -> None:
    with pytest.raises(UsageError) as caught:
        Program.from_bytes(code)
    assert str(caught.value) == (
        f"expected the bytes of a program, as to_bytes() returns them, got {code!r}; "
        f"read them from a file with open(..., 'rb')"
    )


@pytest.mark.parametrize("kind", [bytes, bytearray, memoryview])
def test_a_program_is_read_from_all_that_holds_bytes(kind: type) -> None:
    program = rtamt.parse("x >= 3").compile()
    assert Program.from_bytes(kind(program.to_bytes())).to_bytes() == program.to_bytes()
