"""CSV files as a source of signals; ``csv.py`` reads their content."""

from __future__ import annotations

from codecs import getincrementaldecoder
from io import TextIOWrapper
from itertools import chain, islice, pairwise
from typing import TYPE_CHECKING

from rtamt.errors import TraceError
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.readers.csv import (
    Column,
    Header,
    block_of,
    blocks,
    is_boolean,
    is_number,
    lines_of,
    plain,
    read_header,
    rows,
)
from rtamt.readers.csv_arrow import exact, plain_blocks
from rtamt.readers.csv_cells import LARGEST, Cells
from rtamt.readers.dates import is_date
from rtamt.readers.frames import field_of
from rtamt.readers.source import Field, Source, Table
from rtamt.readers.timestamps import is_axis
from rtamt.signals.arrays import is_masked

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.readers.source import Raw

#: Lines that are examined to distinguish columns of numbers from columns of text.
_SAMPLE = 100

#: The cell in place of one that is no number, where a column is lenient.
_NAN = ("nan",)

#: Bytes that are examined to decide whether a header is UTF-8.
_BEGINNING = 1 << 20


def open_csv(path: str) -> Source:
    """Open a CSV file; columns whose first lines hold no number at all are text."""
    with open(path, encoding="utf-8-sig", newline="", errors="replace") as file:
        lines = lines_of(file, path)
        header, rest = read_header(lines, path)
        sample = [row for _, row in islice(rows(rest, header, header.line), _SAMPLE)]
    if any("\ufffd" in name for name in header.names):
        _require_utf8(path)
    if any("\0" in name for name in header.names):  # UTF-16
        raise _no_utf8(path)
    cells = [
        [row[i].strip() for row in sample if len(row) > i and row[i].strip()]
        for i in range(len(header.names))
    ]
    fields = [field_of(column, _kind(cells[i])) for i, column in enumerate(header.names)]
    first = list(map(float, cells[0])) if all(map(is_number, cells[0])) else []
    rising = len(first) == len(sample) and all(a < b for a, b in pairwise(first))
    fields[0] = replace(fields[0], axis=not header.names[0] and is_axis(first), rising=rising)

    def chunks(wanted: Sequence[Field]) -> Iterator[list[Raw]]:
        try:
            yield from _chunks(path, header, wanted)
        except UnicodeDecodeError:
            raise _no_utf8(path) from None

    def load(wanted: Sequence[Field]) -> list[Raw]:
        parts = list(chunks(wanted))
        return [_join([part[i] for part in parts]) for i in range(len(wanted))]

    return Source(path, (Table(tuple(fields), load, chunks, fresh=True),))


def _require_utf8(path: str) -> None:
    """Raise :class:`TraceError` if the beginning of a file is not UTF-8."""
    with open(path, "rb") as file:
        try:
            getincrementaldecoder("utf-8")().decode(file.read(_BEGINNING))
        except UnicodeDecodeError:
            raise _no_utf8(path) from None


def _no_utf8(path: str) -> TraceError:
    return TraceError(
        f"'{path}' is not UTF-8 text; save it as CSV in UTF-8 (spreadsheets offer this under 'save as')"
    )


def _chunks(path: str, header: Header, wanted: Sequence[Field]) -> Iterator[list[Raw]]:
    """Yield columns block by block: by pyarrow and numpy as long as lines are plain numbers, then cell by cell."""
    # The first of several columns with one name.
    places = {name: i for i, name in reversed(list(enumerate(header.names)))}
    columns = [Column(f.column, places[f.column], f.skip_nan, f.lenient) for f in wanted]
    line, end = header.line, 0
    for block in plain_blocks(path, header, columns):
        for part in block.parts:
            yield [exact(column) for column in part]
        line, end = line + block.lines, block.end
    with open(path, "rb") as file:
        file.seek(end)
        with TextIOWrapper(file, "utf-8" if end else "utf-8-sig", newline="") as text:
            lines = lines_of(text, path, line if end else 0)
            rest = lines if end else read_header(lines, path)[1]
            yield from _blocks(rest, header, wanted, columns, line)


def _blocks(
    lines: Iterator[str], header: Header, wanted: Sequence[Field], columns: Sequence[Column], line: int
) -> Iterator[list[Raw]]:
    """Yield columns block by block; ``line``: that of the file before these lines."""
    while block := list(islice(lines, block_of(header))):
        values = plain(block, header, columns)
        if values is None or np.abs(values).max(initial=0) >= LARGEST:
            break
        yield [exact(column) for column in values]
        line += len(block)
    # What was a number so far stays one.
    dated = False if line > header.line else None
    cells = [Cells(header, f.column, dated, skip_nan=f.skip_nan, type_=f.type) for f in wanted]
    for several in blocks(chain(block, lines), replace(header, line=line)):
        numbers = [number for number, _ in several]
        for column, place in zip(cells, columns, strict=True):
            texts = [row[place.position] for _, row in several]
            try:
                column.extend(texts, numbers)
            except TraceError:
                if not place.lenient:
                    raise
                column.extend(_NAN * len(texts), numbers)
        yield [column.take() for column in cells]


def _join(parts: Sequence[Raw]) -> Raw:
    if any(map(is_masked, parts)):
        joined: Raw = np.ma.concatenate(parts)  # type: ignore[no-untyped-call] # of NumPy
        return joined
    return np.concatenate(parts) if parts else np.empty(0)


def _kind(cells: Sequence[str]) -> str:
    if cells and is_date(cells[0]):
        return "time"
    numeric = any(is_boolean(cell) or is_number(cell.replace(",", ".")) for cell in cells)
    return "text" if cells and not numeric else "number"
