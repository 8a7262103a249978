"""Plain decimal numbers of large CSV files by pyarrow, where it is installed: the same numbers in less time.

What is not plain ends the quick way: empty cells, text, quotes, comments, NaN, infinity, dates, rows of another
width. ``csv_source.py`` reads on from there, and finds the place of what is wrong.
"""

from __future__ import annotations

import os
from importlib import import_module
from io import BytesIO
from typing import TYPE_CHECKING, Any

from rtamt.lazy_numpy import np
from rtamt.lazy_tuples import NamedTuple
from rtamt.readers.ahead import ahead
from rtamt.readers.arrow import values_of
from rtamt.readers.csv_cells import LARGEST

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.readers.csv import Column, Header
    from rtamt.signals.arrays import FloatArray

#: Bytes of a file from which the time to import pyarrow pays off.
_WORTH = 2**22
#: Bytes that are read at a time.
_SIZE = 2**23

_PLAIN = b"0123456789+-.eE\r\n"


class Block(NamedTuple):
    """Rows of plain numbers: their columns, and the position in the file after them."""

    columns: list[FloatArray]
    lines: int
    end: int


def plain_blocks(path: str, header: Header, columns: Sequence[Column]) -> Iterator[Block]:
    """Yield the rows after the header as long as all of their cells are plain decimal numbers."""
    arrow = _arrow() if columns and os.path.getsize(path) >= _WORTH else None
    if arrow is not None:
        yield from ahead(_blocks(arrow, path, header, columns))


def _blocks(arrow: Any, path: str, header: Header, columns: Sequence[Column]) -> Iterator[Block]:
    with open(path, "rb") as file:
        head = [file.readline() for _ in range(header.line)]
        if any(b"\r" in line.rstrip(b"\r\n") for line in head):  # these would be counted as lines
            return
        while text := file.read(_SIZE):
            values = _numbers(arrow, text + file.readline(), header, columns)
            if values is None:
                return
            yield Block(values, len(values[0]), file.tell())


def _numbers(arrow: Any, text: bytes, header: Header, columns: Sequence[Column]) -> list[FloatArray] | None:
    """Return the columns of some lines, None unless all cells are plain decimal numbers that doubles can hold."""
    if text.translate(None, _PLAIN + header.delimiter.encode()):
        return None
    if b"\r" in text and text.count(b"\r") != text.count(b"\r\n"):
        return None
    names = [str(i) for i in range(len(header.names))]
    wanted = [names[column.position] for column in columns]
    try:
        table = arrow.read_csv(
            BytesIO(text),
            arrow.ReadOptions(column_names=names),
            arrow.ParseOptions(
                delimiter=header.delimiter, quote_char=False, double_quote=False, ignore_empty_lines=False
            ),
            arrow.ConvertOptions(
                column_types=dict.fromkeys(wanted, "float64"),
                include_columns=list(dict.fromkeys(wanted)),
                null_values=[],
            ),
        )
    except (
        ValueError
    ):  # ArrowInvalid: a cell that is empty or no number, an empty line, a row of another width
        return None
    values = [values_of(table.column(name)) for name in wanted]
    if any(np.abs(column).max(initial=0) >= LARGEST for column in values):
        return None
    return values


def _arrow() -> Any:
    """Return the reader of pyarrow, None where it is not installed."""
    try:
        return import_module("pyarrow.csv")
    except ImportError:
        return None
