"""The guard around format libraries: whatever they raise is one sentence, now and when samples are read."""

import json
import struct
import types
import zlib
from functools import partial

import pytest

from rtamt.errors import TraceError
from rtamt.readers.source import Field, Source, Table, guarded, opening

#: What a module of this package sees.
OURS = {"__name__": "rtamt.readers.broken"}


def read_as_library(error):
    """Raise an error in a frame that is not ours."""
    json.loads("1", object_hook=None, parse_int=lambda _: (_ for _ in ()).throw(error))


@pytest.mark.parametrize(
    ("error", "reason"),
    [
        (struct.error("unpack requires a buffer of 4 bytes"), "unpack requires a buffer of 4 bytes"),
        (zlib.error("Error -3 while\ndecompressing"), "Error -3 while decompressing"),
        (UnicodeDecodeError("utf-8", b"\xff", 0, 1, "invalid start byte"),
         "'utf-8' codec can't decode byte 0xff in position 0: invalid start byte"),
        (MemoryError(), "it needs more memory than there is"),
        (RecursionError("maximum recursion depth exceeded"), "it is nested too deeply"),
        (AssertionError(), "unexpected contents (AssertionError)"),
        (IndexError("list index out of range"), "list index out of range"),
        (KeyError("x\x1b[31m"), r"unexpected contents (KeyError: 'x\x1b[31m')"),
        (OverflowError("int too large to convert"), "int too large to convert"),
        (OSError(22, "Invalid argument"), "Invalid argument"),
        (ValueError("very " * 100), ("very " * 40) + "..."),
    ],
)  # fmt: skip
def test_what_a_library_raises_is_one_sentence(error, reason):
    with pytest.raises(TraceError) as caught, opening("log.x", "a format"):
        read_as_library(error)
    assert str(caught.value) == (
        f"'log.x' cannot be read as a format: {reason}; "
        "the file is damaged, incomplete or of another kind: copy or export it again"
    )
    assert caught.value.__cause__ is error


@pytest.mark.parametrize("error", [KeyboardInterrupt(), TraceError("'x' is missing")])
def test_what_is_no_failure_of_a_library_goes_through(error):
    with pytest.raises(type(error)) as caught, opening("log.x", "a format"):
        read_as_library(error)
    assert caught.value is error


def made(*loads):
    """Return a source whose tables are loaded by these functions, under the guard."""
    tables = tuple(
        Table((Field("x", "x"),), load, lambda wanted, load=load: iter([load(wanted)])) for load in loads
    )
    return guarded(Source("log.x", tables), partial(opening, "log.x", "a format"))


def test_samples_that_are_read_later_are_read_under_the_same_guard():
    (table,) = made(lambda _: read_as_library(struct.error("unpack requires a buffer of 4 bytes"))).tables
    for read in (table.load, lambda wanted: next(table.chunks(wanted))):
        with pytest.raises(
            TraceError, match=r"^'log\.x' cannot be read as a format: unpack requires a buffer"
        ):
            read(table.fields)


def test_a_bug_of_ours_is_not_called_damage():
    code = types.FunctionType(compile("(lambda wanted: wanted.nothing)", "", "eval").co_consts[0], OURS)
    (table,) = made(code).tables
    with pytest.raises(AttributeError):
        table.load(table.fields)
