"""CSV files as a source of signals; ``csv.py`` reads what is in them."""

from __future__ import annotations

import csv
from itertools import islice
from typing import TYPE_CHECKING

from rtamt.readers.csv import read_csv, read_header
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
        data = read_csv(path, [field.column for field in wanted], time_column="")
        return [data[field.column] for field in wanted]

    return Source(path, (Table(tuple(fields), load),))


def _is_number(cell: str) -> bool:
    try:
        float(cell.replace(",", "."))
    except ValueError:
        return False
    return True
