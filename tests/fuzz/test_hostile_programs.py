"""A program that was damaged or made to do harm is refused in a sentence, or runs in bounded memory.

The checksum is set right after every change: else it alone would refuse everything. The same under
the address sanitizer, in C++: program_fuzz.cpp.
"""

from __future__ import annotations

import struct
import zlib
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtamt.compiler.plan import compile_program
from rtamt.engine import _core
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar
from rtamt.signals.discrete import Discrete
from rtamt.signals.time_domains import DOMAINS

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn

    from rtamt.signals.time_domain_interface import TimeDomain

FORMULAS = (
    "x >= 3 -> eventually[0:5](y >= 3)",
    "historically[1:3](x + y > 2) xor once x",
    "(x until[1:3] y) since[0:2] (x == 1)",
    "x precedes[1:3] sqrt(abs(x)) / max(y, -x)",
)
CORPUS = Path(__file__).parent / "corpus" / "program"
HEADER, RECORD, CHECKSUM = 32, 40, 4
# Of a record the operands, the width and the lag: offset, kind, least and largest value.
FIELDS = (
    (4, "I", 0, 2**32 - 1),
    (8, "I", 0, 2**32 - 1),
    (16, "q", -(2**63), 2**63 - 1),
    (32, "q", -(2**63), 2**63 - 1),
)
EDGES = (0, 1, 2, 2**31, 2**47, 2**48, 2**62, 2**63 - 1)
N = 12
MOST_MEMORY = 2**26
MOST_UNREAD = 2**16  # inputs that no instruction reads
LONGEST_TAIL = 10_000  # slots that the end of a trace takes
REFUSED = "This is not a program that can be run: "


def compile_text(text: str, domain: type[TimeDomain]) -> bytes:
    return compile_program((desugar(parse_formula(text)),), Fraction(1), domain=domain).to_bytes()


PROGRAMS = [compile_text(text, domain) for text in FORMULAS for domain in DOMAINS.values()]


def seal(body: bytes) -> bytes:
    return body + struct.pack("<I", zlib.crc32(body))


def records(program: bytes) -> int:
    return int(struct.unpack_from("<I", program, 12)[0])


@st.composite
def damaged(draw: DrawFn) -> bytes:
    """Draw a valid program with bits turned, numbers replaced, or an end cut off or added."""
    program = draw(st.sampled_from(PROGRAMS))
    body = bytearray(program[:-CHECKSUM])
    for _ in range(draw(st.integers(1, 4))):
        kind = draw(st.sampled_from(("bit", "byte", "field", "field", "count")))
        at = draw(st.integers(0, len(body) - 1))
        if kind == "bit":
            body[at] ^= 1 << draw(st.integers(0, 7))
        elif kind == "byte":
            body[at] = draw(st.integers(0, 255))
        elif kind == "field":
            record = HEADER + RECORD * draw(st.integers(0, records(program) - 1))
            offset, form, low, high = draw(st.sampled_from(FIELDS))
            edges = st.sampled_from([v for v in EDGES if v <= high])
            struct.pack_into(f"<{form}", body, record + offset, draw(edges | st.integers(low, high)))
        else:
            field = draw(st.sampled_from((12, 16, 20, 24)))
            struct.pack_into("<I", body, field, draw(st.integers(0, 40) | st.integers(0, 2**32 - 1)))
    if draw(st.integers(0, 9)) == 0:
        at = draw(st.integers(0, len(body)))
        body = body[:at] if draw(st.booleans()) else body + draw(st.binary(max_size=50))
    return seal(bytes(body))


def run(program: bytes) -> None:
    """Load a program and run it over a short trace, every way there is."""
    dense = len(program) > 10 and program[10] % 2 == 1
    inputs = struct.unpack_from("<I", program, 16)[0] if len(program) >= HEADER else 0
    inputs = min(inputs, max(len(program), MOST_UNREAD))
    values = list((3 * np.arange(N) + np.arange(inputs)[:, None]) % 5 - 2.0)
    names = [f"v{k}" for k in range(inputs)]
    if dense:
        monitor: Any = _core.DenseMonitor(program, names)
        if min(monitor.last_possible, 2**61) < 10_000:
            return
        columns: Any = [
            (np.arange(N, dtype=np.int64) * (1 + k % 3), column) for k, column in enumerate(values)
        ]
    else:
        if _core.memory(program) > MOST_MEMORY or longest_lag(program) > LONGEST_TAIL:
            return
        monitor = _core.Monitor(program, names)
        columns = values
    try:
        if dense:
            monitor.push(columns)
            _core.dense_evaluate(program, columns)
        else:
            monitor.push(None, columns)
            _core.evaluate(program, columns, N)
        monitor.finish()
    except _core.Undefined as error:
        instruction = error.args[0]
    else:
        instruction = 0
    assert 0 <= instruction < records(program)


def longest_lag(program: bytes) -> int:
    lags = [struct.unpack_from("<q", program, HEADER + RECORD * k + 32)[0] for k in range(records(program))]
    return max(lags, default=0)


def reject_or_run(program: bytes) -> None:
    try:
        run(program)
    except ValueError as error:
        said = str(error)
    else:
        said = REFUSED + "no."
    assert said.startswith(REFUSED)
    assert said.endswith(".")


@given(damaged())
def test_a_damaged_program_is_refused_in_a_sentence_or_runs(program: bytes) -> None:
    reject_or_run(program)


@pytest.mark.parametrize("path", sorted(CORPUS.iterdir()), ids=lambda path: path.name)
def test_what_fuzzing_tried_is_refused_in_a_sentence_or_runs(path: Path) -> None:
    reject_or_run(seal(path.read_bytes()[1:-CHECKSUM]))  # the first byte is the fuzzer's own


@pytest.mark.parametrize("program", PROGRAMS[:2])
def test_inputs_that_nothing_stands_behind_are_refused_before_memory_is_taken_for_them(
    program: bytes,
) -> None:
    body = bytearray(program[:-CHECKSUM])
    struct.pack_into("<I", body, 16, 2**32 - 1)
    with pytest.raises(ValueError, match="^" + REFUSED) as info:
        run(seal(bytes(body)))
    assert str(info.value) == (
        f"{REFUSED}it promises 4294967295 inputs, more than the 65536 that are possible for one of its size."
    )


def test_a_value_before_its_operands_are_known_is_refused() -> None:
    program = compile_text("always[0:1] eventually[0:3] x", Discrete)
    body = bytearray(program[:-CHECKSUM])
    struct.pack_into("<q", body, HEADER + RECORD * (records(program) - 1) + 32, 2)
    with pytest.raises(ValueError, match="^" + REFUSED) as info:
        run(seal(bytes(body)))
    assert str(info.value) == (
        f"{REFUSED}instruction 2 (slide_min) has the lag 2, before its operands are known at 3."
    )


def test_every_valid_program_runs() -> None:
    for program in PROGRAMS:
        run(program)
