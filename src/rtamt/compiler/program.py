"""A compiled formula: a flat list of instructions, executed by every host of the core.

Slots and lags. At slot s (the s-th sample) an instruction with lag L yields its value at sample
s - L; a future window [a, b] adds b to the lag, and operands are delayed until their lags agree.
Values outside the trace are *absent*: kernels skip them, which clips windows at both ends. One
program therefore serves both offline and online evaluation, without pastification.

The bytes are those of core/program/program.hpp (documented there and in ``to_bytes``): header, records of
40 bytes, outputs, a note, CRC-32. The note is empty in programs that stay in Python; in those that
leave it (``verdicts.standalone``) it is their metadata (``metadata.py``).
"""

from __future__ import annotations

import struct
import zlib
from functools import cached_property
from itertools import starmap
from math import isnan
from types import MappingProxyType

from rtamt.errors import UsageError, shown
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.rewrite.desugar import written
from rtamt.signals.discrete import Discrete
from rtamt.signals.time_domains import DOMAINS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.metadata import Metadata
    from rtamt.language.formula import Apply, Formula
    from rtamt.language.operators import Operator
    from rtamt.signals.time_domain_interface import TimeDomain

    #: An instruction as the core reads it: the code of its opcode, operands or NO_OPERAND, 0; ``n``, ``x`` and ``lag``.
    Record = tuple[int, int, int, int, int, float, int]

#: Opcodes in the order of the core's enumeration; a test compares the two.
OPCODES = (
    "input", "const",
    "neg", "abs", "sqrt", "exp", "ln",
    "add", "sub", "mul", "div", "pow", "log", "min", "max", "holds_gt", "holds_ge", "holds_eq",
    "shift", "slide_max", "slide_min", "run_max", "run_min", "since", "until", "call",
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "hypot", "sinh", "cosh", "tanh",
    "degrees", "radians", "floor", "ceil", "round", "sign", "mod", "at_least",
    "slide_sum", "run_sum",
    "rank_max", "rank_min",
)  # fmt: skip

#: The code of each opcode.
CODES = {opcode: code for code, opcode in enumerate(OPCODES)}

#: Time domains, in the order of their codes.
_DOMAINS = tuple(DOMAINS.values())

NO_OPERAND = 0xFFFFFFFF
_HEADER = struct.Struct("<8sHBBIIIII")
_RECORD = struct.Struct("<B3xIIIqdq")
#: The first bytes of every program.
MAGIC = b"RTAMTPRG"
_VERSION = 1
_CHECKSUM = 4


class Instruction(NamedTuple):
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
        if self.opcode.startswith("rank_"):
            parts.append(f"k={int(self.x)}")
        return " ".join(parts)


def records_of(instructions: Iterable[Instruction]) -> tuple[Record, ...]:
    """Return instructions as the core reads them."""
    return tuple(
        [
            (CODES[opcode], NO_OPERAND if a is None else a, NO_OPERAND if b is None else b, 0, n, x, lag)
            for opcode, a, b, n, x, lag in instructions
        ]
    )


def instruction_of(record: Record) -> Instruction:
    """Return the instruction that the core reads as ``record``."""
    code, a, b, _, n, x, lag = record
    first, second = (None if operand == NO_OPERAND else operand for operand in (a, b))
    return Instruction(OPCODES[code], first, second, n, x, lag)


@dataclass(frozen=True, slots=True)
class CallSite:
    """A call of a custom operator, and the instructions that it reads.

    It runs a user-supplied kernel, or else the definition. ``begin`` and ``end`` are the
    interval in steps (samples or ticks), ``end=None`` if unbounded; ``ahead`` is the number of
    steps after the present one that it reads.
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


@dataclass(frozen=True)
class Program:
    """Instructions in SSA form, without duplicates.

    ``period`` is the sampling period, in dense time the length of a tick (seconds). ``outputs`` are
    indices of instructions; ``lags`` are the samples or ticks after which each output is known.
    ``value_of`` maps each core sub-formula to its instruction, ``origins`` the other way round; programs
    read from bytes have neither. ``metadata`` is for programs that run outside Python.
    """

    #: The instructions as the core reads them: most programs are run, and not looked at.
    records: tuple[Record, ...]
    inputs: tuple[str, ...]
    outputs: tuple[int, ...]
    period: Fraction
    value_of: Mapping[Formula, int] = field(default_factory=lambda: MappingProxyType({}))
    origins: Sequence[Formula | None] = ()
    domain: type[TimeDomain] = Discrete
    calls: tuple[CallSite, ...] = ()
    metadata: Metadata | None = None
    #: The values that :meth:`with_parameters` has put in; ``value_of`` and ``origins`` have others.
    parameters: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    #: Passes of the core that are left out (``passes.py``).
    without: frozenset[str] = frozenset()
    #: The instructions of parameters, each with its name.
    parametric: Mapping[int, str] = field(default_factory=lambda: MappingProxyType({}))
    #: Whether no sample takes longer than others, whatever the windows.
    worst_case: bool = False

    @cached_property
    def instructions(self) -> tuple[Instruction, ...]:
        """The instructions."""
        return tuple(map(instruction_of, self.records))

    @property
    def lags(self) -> tuple[int, ...]:
        """Samples (or ticks) after which each output's value at a sample is known."""
        return tuple([self.records[i][-1] for i in self.outputs])

    def with_parameters(self, values: Mapping[str, float]) -> Program:
        """Return the program with values of parameters."""
        instructions = list(self.instructions)
        for place, name in self.parametric.items():
            instructions[place] = instructions[place]._replace(x=values[name])
        return replace(self, records=records_of(instructions), parameters=values)

    def place_of(self, formula: Formula) -> int:
        """Return the instruction of a core sub-formula."""
        from rtamt.language.parameters import with_values

        (shape,) = with_values([formula], dict.fromkeys(self.parameters, 0.0))
        return self.value_of[shape]

    def origin_of(self, place: int) -> Formula | None:
        """Return the core sub-formula that an instruction computes."""
        from rtamt.language.parameters import with_values

        origin = self.origins[place]
        return None if origin is None else with_values([origin], self.parameters)[0]

    def for_worst_case(self, formulas: Iterable[Formula] = ()) -> Program:
        """Return the program whose windows take the same time at every sample.

        ``formulas``: as written, for the message. Raises :class:`UsageError` if it has a sum over a window.
        """
        from rtamt.language.printing.printer import excerpt

        for place, (instruction, origin) in enumerate(zip(self.instructions, self.origins, strict=True)):
            if instruction.opcode == "slide_sum":
                assert origin is not None
                meanings = {} if self.metadata is None else self.metadata.meanings
                window = meanings.get(place) or excerpt(written(origin, formulas))
                raise UsageError(
                    f"worst_case=True does not take '{window}', a sum over a window: it is added in blocks, "
                    f"so that some samples take longer; leave worst_case out"
                )
        return replace(self, worst_case=True)

    def to_bytes(self) -> bytes:
        """Serialise the program for execution outside Python.

        Raises :class:`UsageError` if the program calls a custom operator.
        """
        if self.calls:
            raise UsageError(
                f"the program calls '{self.calls[0].op.name}', which the core does not know: bytes cannot carry "
                f"an operator's own code; expand it into the operators of STL, or run the program in Python"
            )
        return self.code() if self.metadata is None else self._carried

    def code(self) -> bytes:
        """Return the bytes that the core runs in this process, together with the calls: without metadata."""
        return self._code

    @cached_property
    def _code(self) -> bytes:
        return self._with_note(b"")

    @cached_property
    def _carried(self) -> bytes:
        assert self.metadata is not None
        return self._with_note(self.metadata.to_bytes(self.inputs, self.period))

    def _with_note(self, note: bytes) -> bytes:
        from rtamt.compiler.passes import bits_of

        domain = _DOMAINS.index(self.domain)
        counts = len(self.records), len(self.inputs), len(self.outputs), len(note), int(self.worst_case)
        parts = [_HEADER.pack(MAGIC, _VERSION, domain, bits_of(self.without), *counts)]
        parts += starmap(_RECORD.pack, self.records)
        parts += [struct.pack(f"<{len(self.outputs)}I", *self.outputs), note]
        body = b"".join(parts)
        return body + struct.pack("<I", zlib.crc32(body))

    @staticmethod
    def from_bytes(code: bytes | bytearray | memoryview) -> Program:
        """Read a program with metadata written by ``to_bytes``; raise :class:`UsageError` for anything else.

        >>> import rtamt
        >>> program = rtamt.parse("always[0:200ms](x >= 3)").compile(period="100ms")
        >>> Program.from_bytes(program.to_bytes()).disassemble() == program.disassemble()
        True
        """
        from rtamt.compiler.metadata import Metadata, damaged
        from rtamt.compiler.passes import without_of

        if not isinstance(code, (bytes, bytearray, memoryview)):
            raise UsageError(
                f"expected the bytes of a program, as to_bytes() returns them, got {shown(code)}; "
                f"read them from a file with open(..., 'rb')"
            )
        code = bytes(code)
        if len(code) < _HEADER.size + _CHECKSUM or not code.startswith(MAGIC):
            raise damaged(f"it does not begin with '{MAGIC.decode()}'")
        _, version, domain, bits, size, inputs, outputs, length, options = _HEADER.unpack_from(code)
        if version != _VERSION:
            raise damaged(f"its format has version {version}, and this is for version {_VERSION}")
        expected = _HEADER.size + _RECORD.size * size + 4 * outputs + length + _CHECKSUM
        if len(code) != expected:
            raise damaged(f"it has {len(code)} bytes where its header promises {expected}")
        body, (checksum,) = code[:-_CHECKSUM], struct.unpack("<I", code[-_CHECKSUM:])
        if zlib.crc32(body) != checksum:
            raise damaged("its checksum does not match, so it was damaged on the way")
        if length == 0 or domain >= len(_DOMAINS):
            raise damaged("it has no metadata" if length == 0 else f"its time domain is {domain}")
        without = without_of(bits)
        if without is None:
            raise damaged(f"it leaves out unknown passes ({bits})")
        if options > 1:
            raise damaged(f"it has unknown options ({options})")
        read = _RECORD.iter_unpack(body[_HEADER.size : _HEADER.size + _RECORD.size * size])
        records = tuple([_checked(i, record, inputs) for i, record in enumerate(read)])
        end = len(body) - length
        places = struct.unpack(f"<{outputs}I", body[end - 4 * outputs : end])
        if any(place >= size for place in places):
            raise damaged("it has an output that is no instruction")
        metadata, names, period = Metadata.from_bytes(body[end:], inputs, outputs)
        return Program(
            records,
            names,
            places,
            period,
            domain=_DOMAINS[domain],
            metadata=metadata,
            without=without,
            worst_case=bool(options),
        )

    def disassemble(self) -> str:
        """Return a listing: index, lag in samples, instruction.

        >>> from fractions import Fraction
        >>> from rtamt.compiler.plan import compile_program
        >>> from rtamt.language.parsing.parser import parse_formula
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


def _checked(index: int, record: Record, inputs: int) -> Record:
    from rtamt.compiler.metadata import damaged

    code, a, b, _, n, x, lag = record
    if code >= len(OPCODES):
        raise damaged(f"instruction {index} has the unknown opcode {code}")
    opcode = OPCODES[code]
    if opcode == "call":
        raise damaged(f"instruction {index} calls an operator that bytes cannot carry")
    if any(operand >= index for operand in (a, b) if operand != NO_OPERAND):
        raise damaged(f"instruction {index} ({opcode}) reads one that is not before it")
    if (opcode == "input" and not 0 <= n < inputs) or isnan(x):
        raise damaged(f"instruction {index} ({opcode}) holds a number that it cannot have")
    return code, a, b, 0, n, x, lag
