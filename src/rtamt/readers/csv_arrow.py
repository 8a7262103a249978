"""Decimal numbers of large CSV files by pyarrow, where it is installed: the same numbers in less time.

What is not plain ends the quick way: quotes, comments, rows of another width, bytes that are not UTF-8, and, in the
columns that are read, empty cells, text, NaN, infinity and dates. ``csv_source.py`` reads on from there, and finds
the place of what is wrong.
"""

from __future__ import annotations

import os
from importlib import import_module
from typing import TYPE_CHECKING, Any

from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.readers.csv import LONGEST_LINE
from rtamt.readers.csv_cells import LARGEST

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.readers.csv import Column, Header
    from rtamt.readers.source import Raw
    from rtamt.signals.arrays import FloatArray

#: Bytes of a file from which the time to import pyarrow pays off.
_WORTH = 2**22
#: Bytes that are read at a time; more only where a row has more.
_SIZE = 2**23
#: Bytes that a thread of pyarrow parses at a time.
_PARSED = 2**21
#: Values that are examined first to decide whether a column holds integers.
_FIRST = 64


class Block(NamedTuple):
    """Rows of plain numbers: their columns in parts, and the position in the file after all of them."""

    parts: list[list[FloatArray]]
    lines: int
    end: int


def plain_blocks(path: str, header: Header, columns: Sequence[Column]) -> Iterator[Block]:
    """Yield the rows after the header as long as all cells of these columns are decimal numbers, and no row is odd."""
    arrow = _arrow() if columns and os.path.getsize(path) >= _WORTH else None
    if arrow is not None:
        from rtamt.readers.ahead import ahead

        yield from ahead(_blocks(arrow, path, header, columns))


def _blocks(arrow: Any, path: str, header: Header, columns: Sequence[Column]) -> Iterator[Block]:
    with open(path, "rb") as file:
        head = [file.readline() for _ in range(header.line)]
        if any(b"\r" in line.rstrip(b"\r\n") for line in head):  # these would be counted as lines
            return
        end = file.tell()
        # One piece of memory for all blocks: new memory costs more than to read into it.
        buffer, kept = bytearray(_SIZE), 0
        while True:
            read = file.readinto(memoryview(buffer)[kept:])
            filled = kept + read
            # Whole rows; the last one may end with the file.
            size = buffer.rfind(b"\n", 0, filled) + 1 if read else filled
            if size:
                parts = _numbers(arrow, buffer, size, header, columns)
                if parts is None:
                    return
                end += size
                yield Block(parts, sum(len(part[0]) for part in parts), end)
            elif not read:
                return
            kept = filled - size
            rest = buffer[size:filled]
            if kept >= LONGEST_LINE:  # which is an error line by line
                return
            if kept == len(buffer):
                buffer = bytearray(2 * kept)
            buffer[:kept] = rest


def _numbers(
    arrow: Any, buffer: bytearray, size: int, header: Header, columns: Sequence[Column]
) -> list[list[FloatArray]] | None:
    """Return the columns of some lines, in parts; None unless their cells are decimal numbers that doubles can hold."""
    from rtamt.readers.arrow import values_in_place

    quotes, comments, returns = (buffer.find(odd, 0, size) >= 0 for odd in (b'"', b"#", b"\r"))
    if quotes or comments:
        return None
    if returns and buffer.count(b"\r", 0, size) != buffer.count(b"\r\n", 0, size):
        return None
    names = [str(i) for i in range(len(header.names))]
    wanted = [names[column.position] for column in columns]
    text = memoryview(buffer)[:size]
    if not _is_utf8(text):
        return None
    try:
        table = arrow.csv.read_csv(
            arrow.BufferReader(text),
            arrow.csv.ReadOptions(column_names=names, block_size=_PARSED),
            arrow.csv.ParseOptions(
                delimiter=header.delimiter, quote_char=False, double_quote=False, ignore_empty_lines=False
            ),
            arrow.csv.ConvertOptions(
                column_types=dict.fromkeys(wanted, "float64"),
                include_columns=list(dict.fromkeys(wanted)),
                null_values=[],
            ),
        )
    except (
        ValueError
    ):  # ArrowInvalid: a cell that is empty or no number, an empty line, a row of another width
        return None
    parts = [
        [values_in_place(batch.column(batch.schema.get_field_index(name))) for name in wanted]
        for batch in table.to_batches()
    ]
    return parts if all(_in_range(column) for part in parts for column in part) else None


def _is_utf8(text: memoryview) -> bool:
    if np.frombuffer(text, np.uint8).max() < 0x80:  # ASCII
        return True
    try:
        str(text, "utf-8")
    except UnicodeDecodeError:
        return False
    return True


def _in_range(column: FloatArray) -> bool:
    """Return whether all numbers are finite, and integers among them exact."""
    return bool(max(-column.min(), column.max()) < LARGEST)


def exact(column: FloatArray) -> Raw:
    """Return a column of integers as int64: timestamps are exact then."""
    if _are_integers(column[:_FIRST]) and _are_integers(column):
        return column.astype(np.int64)
    return column


def _are_integers(column: FloatArray) -> bool:
    return bool((np.isfinite(column) & (column == np.rint(column))).all())


def _arrow() -> Any:
    """Return pyarrow with its reader of CSV, None where it is not installed."""
    try:
        import_module("pyarrow.csv")
    except ImportError:
        return None
    return import_module("pyarrow")
