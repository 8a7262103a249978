"""Everything that is read from a file: a good file of each kind, what reads it, and ways to damage it."""

from __future__ import annotations

import datetime as dt
import json
import os
import sqlite3
import tempfile
from contextlib import closing
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import asammdf
import numpy as np
import openpyxl
import pyarrow as pa
from pyarrow import feather, parquet

import rtamt
from rtamt import fmi
from rtamt.cli.stdin_reader import Samples
from rtamt.errors import StlError
from rtamt.language.printing.latex import to_latex
from rtamt.language.printing.printer import to_text
from rtamt.readers.formats import FORMATS
from rtamt.readers.source import is_our_error
from rtamt.search.config import load_search
from rtamt.search.fmu import FmuPlant
from tests.unit.readers.bags import Bag
from tests.unit.readers.test_formats import ulog

if TYPE_CHECKING:
    from collections.abc import Callable
    from random import Random

CSV = "t [ms],x,note\n0,1.5,go\n100,2,\n# a comment\n200,-3e2,stop\n"
TABLE = pa.table({"t": pa.array([0, 100, 200], pa.int64()), "x": [5.0, None, 6.0], "mode": ["a", "b", "a"]})
STL = """specification gnt_follows_req
input float req @ topic(req, rtamt/req)
input float gnt
const float low = 3
output float out
always((req >= low) -> eventually[0:5s](gnt >= 3)) // "prose"
"""
PROBLEM = """formula = "always[0:2](x <= 6)"
plant = "math:sin"
duration = 2
period = "100ms"
[inputs]
x = { low = 1, high = 12 }
[search]
optimizer = "random"
budget = 50
"""


@dataclass(frozen=True)
class Target:
    """A kind of file. ``make`` writes a good one, ``read`` reads one; either takes a path."""

    suffix: str
    make: Callable[[Path], object]
    read: Callable[[str], object]

    def __str__(self) -> str:
        return self.suffix


# ---- good files ----------------------------------------------------------------------------------


def _excel(path: Path) -> None:
    book = openpyxl.Workbook()
    for row in (("t", "x", "note"), (0, 1.5, "go"), (1, None, "on"), (2, 3, "stop")):
        book.worksheets[0].append(row)
    book.save(path)


def _ulog(path: Path) -> None:
    rows = [(1_000_000, 12.5), (1_500_000, 12.25)]
    ulog(path, [("battery", 0, "float x", rows), ("battery", 1, "float x", rows)], dropouts=[100])


def _mdf(path: Path) -> None:
    with asammdf.MDF(version="4.10") as file:
        file.start_time = dt.datetime(2024, 5, 1, 12, tzinfo=dt.timezone.utc)
        for name, unit in (("speed", "m/s"), ("torque", "Nm")):
            file.append([asammdf.Signal(np.arange(3.0), np.arange(3.0) / 2, name=name, unit=unit)])
        file.save(path, overwrite=True)


def _bag(kind: str) -> Callable[[Path], None]:
    def make(path: Path) -> None:
        with tempfile.TemporaryDirectory() as folder:
            with Bag(Path(folder), kind) as bag:
                for i in range(5):
                    bag.stamped("/req", i, float(i))
                    bag.plain("/other", i, float(i))
            path.write_bytes(bag.path.read_bytes())

    return make


def _database(path: Path) -> None:
    path.unlink(missing_ok=True)
    with closing(sqlite3.connect(path)) as connection:
        connection.execute("create table log (t real, x real, note text)")
        connection.executemany("insert into log values (?, ?, ?)", [(i, i * 0.5, "go") for i in range(50)])
        connection.commit()


def _lines(path: Path) -> None:
    rows = [{"time": i, "x": 0.5 * i, "note": "go"} for i in range(4)]
    path.write_text("".join(json.dumps(row) + "\n" for row in rows), encoding="utf-8")


def _unit(path: Path) -> None:
    fmi.export(rtamt.parse("x >= 0", period="100ms"), path)


def _text(content: str) -> Callable[[Path], object]:
    return lambda path: path.write_text(content, encoding="utf-8")


# ---- what reads them -----------------------------------------------------------------------------


def _recording(path: str) -> None:
    trace = rtamt.read(path)
    # A binary format can hold NaN, which is refused when a formula reads it.
    if path.endswith((".csv", ".xlsx")):
        assert not any(np.isnan(trace[name].values).any() for name in trace)


def _query(path: str) -> None:
    rtamt.read(f"sqlite:///{path}", query="select t, x, note from log")


def _stdin(path: str) -> None:
    samples = Samples(["x"])
    for number, line in enumerate(Path(path).read_bytes().splitlines(keepends=True), 1):
        samples.read(line, number)


def _unit_read(path: str) -> None:
    # Described only: a unit runs code of its own when it is simulated.
    next(FmuPlant(path, duration=1, step=0.1)(nothing=1.0), None)


def _specification(path: str) -> None:
    spec = rtamt.load(path)
    for assertion in spec.document.assertions:
        to_text(assertion.formula)
        to_latex(assertion.formula)


TARGETS = (
    Target(".csv", _text(CSV), _recording),
    Target(".parquet", lambda path: parquet.write_table(TABLE, path), _recording),
    Target(".arrow", lambda path: feather.write_feather(TABLE, path), _recording),
    Target(".xlsx", _excel, _recording),
    Target(".ulg", _ulog, _recording),
    Target(".mf4", _mdf, _recording),
    Target(".bag", _bag("ros1"), _recording),
    Target(".db3", _bag("sqlite3"), _recording),
    Target(".mcap", _bag("mcap"), _recording),
    Target(".mcap", _bag("mcap"), lambda path: rtamt.read(path, recover=True)),
    Target(".sqlite", _database, _query),
    Target(".jsonl", _lines, _stdin),
    Target(".stl", _text(STL), _specification),
    Target(".toml", _text(PROBLEM), load_search),
    Target(".fmu", _unit, _unit_read),
)


def not_damaged() -> set[str]:
    """Return the names of formats of recordings of which no file is damaged here: there should be none."""
    known = {target.suffix for target in TARGETS}
    return {known_format.name for known_format in FORMATS if known.isdisjoint(known_format.suffixes)}


@cache
def good(target: Target) -> bytes:
    """Return a good file of a kind."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "good" + target.suffix)
        target.make(path)
        return path.read_bytes()


# ---- damage --------------------------------------------------------------------------------------


def damaged(data: bytes, random: Random) -> bytes:
    """Return a file with some bits turned, bytes replaced, cut out, put in or moved, or with its end cut off."""
    result = bytearray(data)
    for _ in range(random.choice((1, 1, 1, 2, 3, 8, 30))):
        if not result:
            break
        at = random.randrange(len(result))
        length = random.choice((1, 2, 4, 8, 30, 300))
        kind = random.choice(("bit", "bit", "byte", "integer", "cut", "put", "end", "splice", "fill"))
        if kind == "bit":
            result[at] ^= 1 << random.randrange(8)
        elif kind == "byte":
            result[at] = random.choice((0, 1, 0x7F, 0x80, 0xFF, random.randrange(256)))
        elif kind == "integer":
            size = random.choice((2, 4, 8))
            value = random.choice(
                (0, 1, 2 ** (8 * size - 1) - 1, 2 ** (8 * size - 1), 2 ** (8 * size) - 1, 2**16 - 1)
            )
            result[at : at + size] = value.to_bytes(size, "little")
        elif kind == "cut":
            del result[at : at + length]
        elif kind == "put":
            result[at:at] = random.randbytes(min(length, 8))
        elif kind == "end":
            del result[at:]
        elif kind == "splice":
            begin = random.randrange(len(result))
            result[at : at + length] = result[begin : begin + length]
        else:
            result[at : at + length] = bytes(length)
    return bytes(result)


def outcome(target: Target, data: bytes, folder: str) -> str:
    """Read a file with these bytes; return "read", or the error's sentence. Anything else goes through."""
    path = os.path.join(folder, "log" + target.suffix)
    Path(path).write_bytes(data)
    try:
        target.read(path)
    except StlError as error:
        # What our own code did not expect is not to be hidden behind a sentence on the file.
        cause: Any = error.__cause__
        if cause is not None and not isinstance(cause, StlError) and is_our_error(cause):
            raise cause from None
        return str(error)
    return "read"
