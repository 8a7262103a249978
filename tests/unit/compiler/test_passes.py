"""Passes: they are named in the program's header, and each can be left out."""

from __future__ import annotations

import struct
import zlib
from fractions import Fraction

import pytest

import rtamt
from rtamt.compiler.passes import LOADED, bits_of, without_of
from rtamt.compiler.plan import compile_program
from rtamt.compiler.program import Program
from rtamt.errors import UsageError
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar

FORMULA = desugar(parse_formula("always[0:2](x + y >= 3)"))


def with_header_byte(code: bytes, place: int, value: int) -> bytes:
    body = bytearray(code[:-4])
    body[place] = value
    return bytes(body) + struct.pack("<I", zlib.crc32(body))


@pytest.mark.parametrize("name", LOADED)
def test_a_pass_that_is_left_out_is_a_bit_of_the_header(name):
    program = compile_program((FORMULA,), Fraction(1), without=[name])
    assert program.without == {name}
    assert program.code()[11] == bits_of({name})
    assert without_of(bits_of({name})) == {name}


def test_by_default_no_pass_is_left_out():
    assert compile_program((FORMULA,), Fraction(1)).code()[11] == 0


def test_a_name_that_is_no_pass_is_an_error():
    with pytest.raises(AssertionError):
        compile_program((FORMULA,), Fraction(1), without=["fusion"])


def test_a_program_read_from_bytes_leaves_out_what_its_header_names():
    code = rtamt.parse("x >= 3").compile(period=1).to_bytes()
    program = Program.from_bytes(with_header_byte(code, 11, 3))
    assert program.without == {"fuse", "reuse"}
    assert program.to_bytes() == with_header_byte(code, 11, 3)


def test_an_unknown_pass_in_the_header_is_damage():
    code = rtamt.parse("x >= 3").compile(period=1).to_bytes()
    with pytest.raises(UsageError, match=r"it leaves out unknown passes \(4\)"):
        Program.from_bytes(with_header_byte(code, 11, 4))
