"""Excel workbooks, with openpyxl: a sheet with a row of names, then a row for each sample."""

from __future__ import annotations

import re
from contextlib import ExitStack
from functools import cache
from itertools import chain, repeat
from math import isfinite
from typing import TYPE_CHECKING, Any
from zipfile import ZipFile

from rtamt.errors import TraceError, choices
from rtamt.lazy.dataclasses import replace
from rtamt.readers.dates import is_date
from rtamt.readers.rows import table_of_rows
from rtamt.readers.source import Source, library, printable
from rtamt.signals.time_columns import column_name, is_stamps, may_be_stamps, split_unit

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence

    from rtamt.readers.source import Field

#: Bytes of a workbook's parts, unpacked: a few MB of a zip file can expand to any number of GB.
MOST_BYTES = 2**30
#: How much smaller than its content a large part can be: what repeats itself that often is no table.
MOST_RATIO, LARGE_PART = 500, 2**26
#: Rows that Excel can hold.
MOST_ROWS = 2**20
#: The limit on cells up to the last one of each row: a lone cell far to the right implies thousands of empty ones.
MOST_CELLS = 2**28
#: Milliseconds of a day, in which Excel counts.
_MILLISECONDS = 86_400_000
#: How far, in milliseconds, a date of 15 digits, as they are saved, lies from what it stands for.
_SAVED = 0.01

#: Bytes of a sheet that are examined at a time.
_BLOCK = 2**20
#: A row with its number, which is optional.
_ROW = re.compile(rb'<row(?: [^>]*)? r="(?P<number>[0-9]{1,9})"')
#: A cell with a formula and no value; the value of one that gives a text may be empty.
_NO_VALUE = re.compile(
    rb'<c r="(?P<cell>[A-Z0-9]+)"(?![^>]*t="str")[^>]*>\s*<f\b(?:[^>]*/>|[^>]*>[^<]*</f>)\s*'
    rb"(?:<v\s*/>|<v>\s*</v>)?\s*</c>"
)


def open_excel(path: str, sheet: str | None = None) -> Source:
    """Open a workbook. ``sheet``: by default the one sheet that has something in it."""
    openpyxl = library("openpyxl", "Excel")
    with ExitStack() as stack:
        file = stack.enter_context(open(path, "rb"))
        _check_size(path, file)
        book = openpyxl.load_workbook(file, read_only=True, data_only=True)
        stack.callback(book.close)
        found = {page.title: page for page in book.worksheets}
        for page in book.worksheets:
            page.reset_dimensions()  # what the file claims them to be, not what they are
        for page in [found[sheet]] if sheet in found else book.worksheets:
            _check_rows(path, page)
        name = _choose(path, found, sheet)
        _check_formulas(path, found[name])
        rows = _filled_rows(found[name], path)
        header = next(rows, None)
        if header is None:
            raise TraceError(f"{path} is empty: it needs a row of column names, then a row for each sample")
        if all(isinstance(cell, (int, float)) for cell in header if cell is not None):
            raise TraceError(
                f"{path}: expected a row of column names, such as time, x; the first row is {header}"
            )
        columns = ["" if cell is None else column_name(str(cell)) for cell in header]
        first = next(rows, None)
        if first is not None:
            rows = chain([first], rows)
        if _is_timed(columns, first or ()):
            rows = (row for row in rows if _is_filled(row))
        notes = (f"sheet '{name}'",) if len(found) > 1 else ()

        @cache
        def rounded(timestamps: Field) -> tuple[str, ...]:
            letters = openpyxl.utils.get_column_letter(columns.index(timestamps.column) + 1)
            return _rounded_dates(found[name], letters, book._date_formats)

        table = replace(table_of_rows(columns, rows), losses_of_times=rounded)
        return Source(path, (table,), notes=notes, close=stack.pop_all().close)


def _check_size(path: str, file: Any) -> None:
    with ZipFile(file) as archive:
        parts = archive.infolist()
    for part in parts:
        if part.file_size > max(LARGE_PART, MOST_RATIO * part.compress_size):
            raise TraceError(
                f"{path} has a part '{printable(part.filename)}' that unpacks to {part.file_size / 2**20:,.1f} MiB "
                f"from {part.compress_size / 2**20:,.1f} MiB: save its sheets as CSV"
            )
    size = sum(part.file_size for part in parts)
    if size > MOST_BYTES:
        raise TraceError(
            f"{path} unpacks to {size / 2**20:,.1f} MiB, more than the {MOST_BYTES // 2**20:,} MiB that are read of "
            f"a workbook: save its sheets as CSV, or split it"
        )
    file.seek(0)


def _check_rows(path: str, page: Any) -> None:
    """Raise :class:`TraceError` at a row that openpyxl would keep in memory, whatever its length, or leave out."""
    last, size = 0, 0
    for text in _pieces(page):
        for match in _ROW.finditer(text):
            number = int(match["number"])
            if number <= last:
                raise TraceError(
                    f"row {number} in the sheet '{page.title}' of {path} comes after row {last}: open the workbook in "
                    f"a spreadsheet and save it"
                )
            last = number
        if b"</sheetData>" in text:
            return
        size = 0 if b"</row>" in text else size + len(text)
        if size > LARGE_PART:
            raise TraceError(
                f"a row after row {last} in the sheet '{page.title}' of {path} has more than {LARGE_PART // 2**20} "
                f"MiB: delete what is far from the table, or save the sheet as CSV"
            )


def _check_formulas(path: str, page: Any) -> None:
    """Raise :class:`TraceError` at a formula without its value, which nothing has computed since it was written."""
    for text in _pieces(page):
        found = _NO_VALUE.search(text) if b"<f" in text else None
        if found is not None:
            cell = found["cell"].decode("ascii", "replace")
            raise TraceError(
                f"the cell {cell} in the sheet '{page.title}' of {path} is a formula without its value: open the "
                f"workbook in a spreadsheet and save it"
            )


def _pieces(page: Any) -> Iterator[bytes]:
    """Yield the text of a sheet in pieces that end between two cells."""
    rest = b""
    with page._get_source() as source:
        while block := source.read(_BLOCK):
            text = rest + block
            end = max(text.rfind(b"<c "), len(text) - _BLOCK, 0)
            yield text[:end]
            rest = text[end:]
    yield rest


def _rounded_dates(page: Any, letters: str, styles: Collection[int]) -> tuple[str, ...]:
    """Return a note on dates and durations between two milliseconds in a column, to which openpyxl rounds them.

    ``letters``: those of the column. ``styles``: those of dates and durations.
    """
    if not styles:
        return ()
    numbers = "|".join(map(str, sorted(styles))).encode()
    dates = re.compile(
        rb'<c r="(?P<cell>' + letters.encode() + rb'[0-9]+)"[^>]* s="(?:' + numbers + rb')"[^>]*>\s*'
        rb"(?:<f\b(?:[^>]*/>|[^>]*>[^<]*</f>)\s*)?<v>(?P<days>[-+.0-9Ee]+)</v>"
    )
    count, first = 0, ""
    for text in _pieces(page):
        for found in dates.finditer(text):
            try:
                milliseconds = float(found["days"]) * _MILLISECONDS
            except ValueError:  # not a number: openpyxl has the error
                continue
            if isfinite(milliseconds) and abs(milliseconds - round(milliseconds)) > _SAVED:
                count += 1
                first = first or found["cell"].decode("ascii")
    if not count:
        return ()
    some = (
        f"1 date of sheet '{page.title}' is finer than 1 ms and was rounded"
        if count == 1
        else f"{count:,} dates of sheet '{page.title}' are finer than 1 ms and were rounded"
    )
    return (f"{some} (the first in {first}); save such timestamps as numbers of seconds",)


def _choose(path: str, found: dict[str, Any], sheet: str | None) -> str:
    if sheet is not None:
        if sheet not in found:
            raise TraceError(f"{path} has no sheet '{sheet}'{choices(sheet, found, 'sheets')}")
        return sheet
    full = [name for name, page in found.items() if next(_filled_rows(page, path), None) is not None]
    if len(full) > 1:
        raise TraceError(
            f"{path} has several sheets: {', '.join(full)}; choose one with sheet=, or on the command line --sheet"
        )
    if not found:
        raise TraceError(f"{path} has no sheet of cells")
    return full[0] if full else next(iter(found))


def _filled_rows(page: Any, path: str) -> Iterator[Sequence[Any]]:
    """Yield the rows from the first one to the last one that have a value in them, all as long as the first one."""
    width, cells, empty = None, 0, 0
    for number, whole in enumerate(page.iter_rows(values_only=True), 1):
        cells += len(whole)
        if number > MOST_ROWS or cells > MOST_CELLS:
            raise TraceError(
                f"the sheet '{page.title}' of {path} reaches beyond {MOST_ROWS:,} rows or {MOST_CELLS:,} cells, "
                f"empty ones included: delete what is far from the table, or save the sheet as CSV"
            )
        row = whole[:width]
        if not _is_filled(row):
            empty += width is not None
            continue
        if width is None:
            width = max(i for i, cell in enumerate(row) if cell is not None) + 1
        yield from repeat((None,) * width, empty)
        empty = 0
        yield tuple(chain(row, [None] * (width - len(row))))[:width]


def _is_filled(row: Sequence[Any]) -> bool:
    return row.count(None) < len(row)


def _is_timed(columns: Sequence[str], first: Sequence[Any]) -> bool:
    """Return whether a table may have timestamps, from its names and its first row: empty rows are then no samples."""
    names = [split_unit(column)[0] for column in columns]
    return not names[0] or any(is_stamps(n) or may_be_stamps(n) for n in names) or any(map(is_date, first))
