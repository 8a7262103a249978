"""Dates and durations of Excel workbooks, which openpyxl rounds to milliseconds."""

import datetime as dt
import re
import zipfile

import openpyxl
import pytest

import rtamt

DATE, DURATION = dt.datetime(2026, 5, 1, 10), dt.timedelta(hours=30)


def trace_of(path, start, step, count):
    """Return the trace of a sheet with stamps ``step`` microseconds apart."""
    book = openpyxl.Workbook()
    book.active.append(["time", "x"])
    for i in range(count):
        book.active.append([start + dt.timedelta(microseconds=step * i), i])
    book.save(path)
    return rtamt.read(path)


@pytest.mark.parametrize("start", [DATE, DURATION], ids=["dates", "durations"])
@pytest.mark.parametrize("step", [1000, 33_000, 10_000_001])
def test_dates_at_whole_milliseconds_have_no_note(tmp_path, start, step):
    """A file holds 15 digits of a date, so that microseconds are lost before it is read."""
    assert trace_of(tmp_path / "a.xlsx", start, step, 5).losses == ()


@pytest.mark.parametrize("start", [DATE, DURATION], ids=["dates", "durations"])
@pytest.mark.parametrize(
    ("step", "count", "rounded"), [(250, 2, "1 date"), (250, 4, "3 dates"), (2500, 50_000, "25,000 dates")]
)
def test_dates_between_milliseconds_have_a_note(tmp_path, start, step, count, rounded):
    """They were rounded without a word; 50,000 rows are several blocks of the file."""
    assert trace_of(tmp_path / "a.xlsx", start, step, count).losses == (
        f"rounded to 1 ms: {rounded} of the sheet 'Sheet', the first in cell A3; "
        f"save finer timestamps as numbers of seconds",
    )


def test_dates_that_formulas_compute_have_a_note_too(tmp_path):
    trace_of(tmp_path / "a.xlsx", DATE, 1000, 3)
    with zipfile.ZipFile(tmp_path / "a.xlsx") as book, zipfile.ZipFile(tmp_path / "b.xlsx", "w") as new:
        for name in book.namelist():
            cell = re.compile(rb"(<c r=\"A4\"[^>]*>)<v>[^<]*</v>")
            new.writestr(name, cell.sub(rb"\1<f>A3+0.0000005</f><v>46143.4166667</v>", book.read(name)))
    assert rtamt.read(tmp_path / "b.xlsx").losses == (
        "rounded to 1 ms: 1 date of the sheet 'Sheet', the first in cell A4; "
        "save finer timestamps as numbers of seconds",
    )
