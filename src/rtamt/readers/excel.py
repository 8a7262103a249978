"""Excel workbooks, with openpyxl: a sheet with a row of names, then a row for each sample."""

from __future__ import annotations

import zlib
from contextlib import ExitStack
from itertools import chain
from typing import TYPE_CHECKING, Any
from zipfile import BadZipFile

from rtamt.errors import TraceError, did_you_mean
from rtamt.readers.rows import table_of_rows
from rtamt.readers.source import Source, library, opening

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence


# What openpyxl lets through of a damaged workbook, when it is opened and when its rows are read.
_DAMAGE = (
    BadZipFile,
    zlib.error,
    SyntaxError,
    LookupError,
    ValueError,
    TypeError,
    AttributeError,
    EOFError,
    RuntimeError,
)


def open_excel(path: str, sheet: str | None = None) -> Source:
    """Open a workbook. ``sheet``: by default the one sheet that has something in it."""
    openpyxl = library("openpyxl", "Excel")
    exceptions = library("openpyxl.utils.exceptions", "Excel")
    with ExitStack() as stack:
        with opening(path, "Excel", exceptions.InvalidFileException, *_DAMAGE):
            file = stack.enter_context(open(path, "rb"))
            book = openpyxl.load_workbook(file, read_only=True, data_only=True)
        stack.callback(book.close)
        found = {page.title: page for page in book.worksheets}
        name = _choose(path, found, sheet)
        rows = _filled(found[name], path)
        header = next(rows, None)
        if header is None:
            raise TraceError(f"{path} is empty: it needs a row of column names, then a row for each sample")
        if all(isinstance(cell, (int, float)) for cell in header if cell is not None):
            raise TraceError(
                f"{path}: expected a row of column names, such as time, x; the first row is {header}"
            )
        columns = ["" if cell is None else str(cell).strip() for cell in header]
        notes = (f"sheet '{name}'",) if len(found) > 1 else ()
        return Source(path, (table_of_rows(columns, rows),), notes=notes, close=stack.pop_all().close)


def _choose(path: str, found: dict[str, Any], sheet: str | None) -> str:
    if sheet is not None:
        if sheet not in found:
            raise TraceError(
                f"{path} has no sheet '{sheet}', only {', '.join(found)}{did_you_mean(sheet, found)}"
            )
        return sheet
    full = [name for name, page in found.items() if next(_filled(page, path), None) is not None]
    if len(full) > 1:
        raise TraceError(
            f"{path} has several sheets: {', '.join(full)}; choose one with sheet=, or on the command line --sheet"
        )
    return full[0] if full else next(iter(found))


def _filled(page: Any, path: str) -> Iterator[Sequence[Any]]:
    """Yield the rows that have a value in them, all as long as the first one."""
    width = None
    with opening(path, "Excel", *_DAMAGE):
        for row in page.iter_rows(values_only=True):
            if all(cell is None for cell in row):
                continue
            if width is None:
                width = max(i for i, cell in enumerate(row) if cell is not None) + 1
            yield tuple(chain(row, [None] * (width - len(row))))[:width]
