"""The types of parameters in the metadata of a program; what is damaged there is rejected by one sentence."""

from __future__ import annotations

import struct
from fractions import Fraction
from types import MappingProxyType

import pytest

import rtamt
from rtamt.compiler.metadata import Metadata
from rtamt.language.value_types import Enumeration
from rtamt.lazy.dataclasses import replace

MODE = Enumeration("Mode", (("MANUAL", 0), ("AUTO", -4)))
PLAIN = Metadata(outputs=("robustness",), parameters=MappingProxyType({"c": (1,), "wanted": (2,)}))
TYPED = replace(PLAIN, enumerations=MappingProxyType({"wanted": MODE}))
INPUTS = ("mode",)


def note_of(metadata: Metadata) -> bytes:
    return metadata.to_bytes(INPUTS, Fraction(1))


def read(note: bytes) -> Metadata:
    return Metadata.from_bytes(note, len(INPUTS), 1)[0]


def refusal(note: bytes) -> str:
    with pytest.raises(rtamt.UsageError) as caught:
        read(note)
    return str(caught.value).removeprefix("this is not a program that can be read: ")


def test_enumerated_parameters_are_written_after_two_lists_of_booleans():
    plain, typed = note_of(PLAIN), note_of(TYPED)
    members = b"\x06\0\0\0MANUAL" + struct.pack("<qI", 0, 4) + b"AUTO" + struct.pack("<q", -4)
    head = struct.pack("<5I", 0, 0, 1, 1, 4)
    assert typed == plain + head + b"Mode" + struct.pack("<I", 2) + members
    assert read(typed) == TYPED
    both = replace(TYPED, booleans=frozenset({"c"}))
    assert read(note_of(both)) == both


def test_damaged_types_of_parameters_are_rejected():
    plain, typed = note_of(PLAIN), note_of(TYPED)
    for size in range(len(plain) + 1, len(typed)):
        if size != len(plain) + 8:  # two empty lists of Booleans
            assert refusal(typed[:size]) == "its metadata is shorter than it should be"
    assert read(typed[: len(plain) + 8]) == PLAIN
    assert refusal(typed + b"x") == "its metadata is longer than it should be"
    index = len(plain) + 12
    outside = typed[:index] + b"\x02" + typed[index + 1 :]
    assert refusal(outside) == "its metadata names parameter 2 of 2"
    twice = typed[: index - 4] + b"\x02" + typed[index - 3 :] + typed[index:]
    assert refusal(twice) == "its parameter 'wanted' has two types"
    assert refusal(note_of(replace(TYPED, booleans=frozenset({"wanted"})))) == (
        "its parameter 'wanted' has two types"
    )
    empty = replace(PLAIN, enumerations=MappingProxyType({"wanted": Enumeration("Mode", ())}))
    assert refusal(note_of(empty)) == "its enumeration 'Mode' has no members"
    for place in (8, 16, 24):  # the number of parameters, the length of a name, the number of members
        note = typed[: len(plain) + place] + b"\xff\xff\xff\xff" + typed[len(plain) + place + 4 :]
        assert refusal(note) == "its metadata is shorter than it should be"


def test_a_program_without_enumerated_parameters_ends_with_the_size_of_its_graph():
    text = "enum Mode { MANUAL, AUTO }  input Mode mode  input float x  parameter float c = 1  mode == AUTO or x >= c"
    program = rtamt.parse(text, period="1s").compile()
    note = program.metadata.to_bytes(program.inputs, program.period)
    assert program.metadata.enumerations == {}
    assert note == replace(program.metadata, early=b"").to_bytes(program.inputs, program.period)
    assert note.endswith(b"mode == AUTO or x >= c" + struct.pack("<I", 0))
