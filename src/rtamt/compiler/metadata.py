"""The metadata of a program: names, the sampling period, and the formulas of instructions.

The byte format is described field by field in core/program/metadata.hpp.
"""

from __future__ import annotations

import struct
from fractions import Fraction
from types import MappingProxyType

from rtamt.errors import UsageError
from rtamt.language.value_types import Enumeration
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_COUNT, _CODE = struct.Struct("<I"), struct.Struct("<q")
_STEP = struct.Struct("<qq")

#: How many characters a message shows on each side of a wrong one.
_AROUND = 20


@dataclass(frozen=True, slots=True)
class Metadata:
    """Names and texts of a program.

    ``formula`` is its text. ``outputs`` are their names. ``parameters`` maps a parameter or named constant to the
    instructions that hold its value. ``meanings`` maps an instruction to the formula it computes. ``early``: of a
    program of bounds its graph, as the core reads it (core/c_api/early_runner.hpp). ``booleans``: the inputs and
    parameters that are declared as bool. ``enumerations``: the types of the parameters that have members as values.
    """

    name: str = ""
    formula: str = ""
    outputs: tuple[str, ...] = ()
    parameters: Mapping[str, tuple[int, ...]] = field(default_factory=lambda: MappingProxyType({}))
    meanings: Mapping[int, str] = field(default_factory=lambda: MappingProxyType({}))
    early: bytes = b""
    booleans: frozenset[str] = frozenset()
    enumerations: Mapping[str, Enumeration] = field(default_factory=lambda: MappingProxyType({}))

    def to_bytes(self, inputs: tuple[str, ...], period: Fraction) -> bytes:
        """Serialise the metadata together with the program's inputs and period."""
        try:
            step = _STEP.pack(period.numerator, period.denominator)
        except struct.error:
            raise UsageError(f"the period of {period} s does not fit into a program: round it") from None
        parts = [step, *map(_text, (self.name, self.formula, *inputs, *self.outputs))]
        parts.append(_COUNT.pack(len(self.parameters)))
        for name, places in self.parameters.items():
            parts += [_text(name), struct.pack(f"<{len(places) + 1}I", len(places), *places)]
        parts.append(_COUNT.pack(len(self.meanings)))
        for place, text in self.meanings.items():
            parts += [_COUNT.pack(place), _text(text)]
        parts += [_COUNT.pack(len(self.early)), self.early]
        if self.booleans or self.enumerations:
            for names in (inputs, tuple(self.parameters)):
                truths = [i for i, name in enumerate(names) if name in self.booleans]
                parts.append(struct.pack(f"<{len(truths) + 1}I", len(truths), *truths))
        if self.enumerations:
            parts.append(_COUNT.pack(len(self.enumerations)))
        for i, name in enumerate(self.parameters):
            if name in self.enumerations:
                parts += [_COUNT.pack(i), _enumeration(self.enumerations[name])]
        return b"".join(parts)

    @staticmethod
    def from_bytes(note: bytes, inputs: int, outputs: int) -> tuple[Metadata, tuple[str, ...], Fraction]:
        """Read metadata, the names of the inputs, and the period; the counts are given by the program."""
        reader = _Reader(note)
        numerator, denominator = reader.take(_STEP)
        if numerator <= 0 or denominator <= 0:
            raise damaged(f"the length of its step is {numerator}/{denominator} s")
        name, formula = reader.text(), reader.text()
        names = tuple(reader.text() for _ in range(inputs))
        results = tuple(reader.text() for _ in range(outputs))
        parameters = {reader.text(): tuple(reader.numbers()) for _ in range(reader.number())}
        meanings = {reader.number(): reader.text() for _ in range(reader.number())}
        early = reader.bytes(reader.number())
        booleans: set[str] = set()
        if reader.left():
            booleans.update(reader.items(names, "input"), reader.items(tuple(parameters), "parameter"))
        enumerations: dict[str, Enumeration] = {}
        for _ in range(reader.number() if reader.left() else 0):
            parameter = reader.item(tuple(parameters), "parameter")
            if parameter in enumerations or parameter in booleans:
                raise damaged(f"its parameter '{parameter}' has two types")
            enumerations[parameter] = reader.enumeration()
        reader.end()
        metadata = Metadata(
            name,
            formula,
            results,
            MappingProxyType(parameters),
            MappingProxyType(meanings),
            early,
            frozenset(booleans),
            MappingProxyType(enumerations),
        )
        return metadata, names, Fraction(numerator, denominator)


def damaged(reason: str) -> UsageError:
    """Return the error for bytes that are not a program."""
    return UsageError(f"this is not a program that can be read: {reason}")


def encoded(text: str) -> bytes:
    """Return a text of a program in UTF-8; raise :class:`UsageError` where it has a character that UTF-8 lacks."""
    try:
        return text.encode()
    except UnicodeEncodeError as error:
        around = text[max(error.start - _AROUND, 0) : error.start + _AROUND]
        raise UsageError(
            f"a program cannot contain {text[error.start]!a}, which UTF-8 lacks: correct the name in {around!a}"
        ) from None


def _text(text: str) -> bytes:
    data = encoded(text)
    return _COUNT.pack(len(data)) + data


def _enumeration(enumeration: Enumeration) -> bytes:
    parts = [_text(enumeration.name), _COUNT.pack(len(enumeration.members))]
    for member, code in enumeration.members:
        parts += [_text(member), _CODE.pack(code)]
    return b"".join(parts)


class _Reader:
    """A reader of fields from the front; lengths are not trusted."""

    def __init__(self, note: bytes) -> None:
        self._note = note
        self._at = 0

    def take(self, layout: struct.Struct) -> tuple[int, ...]:
        return layout.unpack(self.bytes(layout.size))

    def number(self) -> int:
        return self.take(_COUNT)[0]

    def numbers(self) -> list[int]:
        return [self.number() for _ in range(self.number())]

    def text(self) -> str:
        try:
            return self.bytes(self.number()).decode()
        except UnicodeDecodeError:
            raise damaged("a text in its metadata is not UTF-8") from None

    def items(self, names: tuple[str, ...], what: str) -> list[str]:
        """Return the names that listed indices stand for."""
        return [self.item(names, what) for _ in range(self.number())]

    def item(self, names: tuple[str, ...], what: str) -> str:
        """Return the name that an index stands for."""
        index = self.number()
        if index >= len(names):
            raise damaged(f"its metadata names {what} {index} of {len(names)}")
        return names[index]

    def enumeration(self) -> Enumeration:
        name = self.text()
        members = tuple((self.text(), self.take(_CODE)[0]) for _ in range(self.number()))
        if not members:
            raise damaged(f"its enumeration '{name}' has no members")
        return Enumeration(name, members)

    def left(self) -> bool:
        return self._at < len(self._note)

    def end(self) -> None:
        if self._at != len(self._note):
            raise damaged("its metadata is longer than it should be")

    def bytes(self, size: int) -> bytes:
        if size > len(self._note) - self._at:
            raise damaged("its metadata is shorter than it should be")
        self._at += size
        return self._note[self._at - size : self._at]
