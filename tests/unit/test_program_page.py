"""docs/reference/program.md says what is true of the bytes and of the dump."""

import re
import struct
from pathlib import Path

import rtamt
from rtamt.compiler.program import OPCODES

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "program.md").read_text(encoding="utf-8")


def test_the_opcodes_are_listed_by_number():
    table = PAGE.partition("<!-- opcodes -->")[2].partition("\n\n")[0]
    listed = re.findall(r"\b(\d+) (\w+) \|", table)
    assert listed == [(str(i), name) for i, name in enumerate(OPCODES)]


def test_the_bytes_are_where_the_tables_say():
    program = rtamt.parse("const float limit = 3  always[0:200ms](x / y >= limit)", period="100ms").compile()
    code = program.to_bytes()
    assert code[:8] == b"RTAMTPRG"
    version, domain, zero, instructions, inputs, outputs, length, rest = struct.unpack_from(
        "<HBBIIIII", code, 8
    )
    assert (version, domain, zero, instructions, inputs, outputs, rest) == (1, 0, 0, 8, 2, 2, 0)
    window = 32 + 40 * 5
    assert struct.unpack_from("<BxxxIIIqdq", code, window) == (20, 4, 0xFFFFFFFF, 0, 3, 0.0, 2)
    assert struct.unpack_from("<II", code, 32 + 40 * instructions) == (5, 7)
    note = code[32 + 40 * instructions + 4 * outputs : -4]
    assert len(note) == length
    assert struct.unpack_from("<qqI", note) == (1, 10, 0)
