"""CSV files as a source of signals; ``csv.py`` reads what is in them."""

from __future__ import annotations

import csv
from itertools import islice
from typing import TYPE_CHECKING

from rtamt.readers.cells import Cells
from rtamt.readers.csv import blocks, read_header
from rtamt.readers.frames import field_of
from rtamt.readers.source import Field, Source, Table, opening

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.readers.source import Raw

#: Lines that are looked at to tell columns of numbers from columns of text.
_SAMPLE = 100


def open_csv(path: str) -> Source:
    """Open a CSV file; columns whose first lines hold no number at all are text."""
    with opening(path, "CSV"), open(path, encoding="utf-8-sig", newline="", errors="replace") as lines:
        header, rows = read_header(lines, path)
        sample = [row for row in csv.reader(islice(rows, _SAMPLE), delimiter=header.delimiter) if row]
    fields = []
    for i, column in enumerate(header.names):
        cells = [row[i].strip() for row in sample if len(row) > i and row[i].strip()]
        text = bool(cells) and not any(_is_number(cell) for cell in cells)
        fields.append(field_of(column, "text" if text else "number"))

    def load(wanted: Sequence[Field]) -> list[Raw]:
        with opening(path, "CSV", UnicodeDecodeError), open(path, encoding="utf-8-sig", newline="") as lines:
            header, rows = read_header(lines, path)
            columns = [Cells(header, field.column) for field in wanted]
            positions = [header.names.index(field.column) for field in wanted]
            for block in blocks(rows, header):
                numbers = [line for line, _ in block]
                for cells, position in zip(columns, positions, strict=True):
                    cells.extend([row[position] for _, row in block], numbers)
        return [cells.values() for cells in columns]

    return Source(path, (Table(tuple(fields), load),))


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True
