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
    ("step", "count", "rounded"),
    [
        (250, 2, "1 date of sheet 'Sheet' is finer than 1 ms and was rounded"),
        (250, 4, "3 dates of sheet 'Sheet' are finer than 1 ms and were rounded"),
        (2500, 50_000, "25,000 dates of sheet 'Sheet' are finer than 1 ms and were rounded"),
    ],
)
def test_dates_between_milliseconds_have_a_note(tmp_path, start, step, count, rounded):
    """They were rounded without a word; 50,000 rows are several blocks of the file."""
    assert trace_of(tmp_path / "a.xlsx", start, step, count).losses == (
        f"{rounded} (the first in A3); save such timestamps as numbers of seconds",
    )


def test_dates_that_formulas_compute_have_a_note_too(tmp_path):
    trace_of(tmp_path / "a.xlsx", DATE, 1000, 3)
    with zipfile.ZipFile(tmp_path / "a.xlsx") as book, zipfile.ZipFile(tmp_path / "b.xlsx", "w") as new:
        for name in book.namelist():
            cell = re.compile(rb"(<c r=\"A4\"[^>]*>)<v>[^<]*</v>")
            new.writestr(name, cell.sub(rb"\1<f>A3+0.0000005</f><v>46143.4166667</v>", book.read(name)))
    assert rtamt.read(tmp_path / "b.xlsx").losses == (
        "1 date of sheet 'Sheet' is finer than 1 ms and was rounded (the first in A4); "
        "save such timestamps as numbers of seconds",
    )


@pytest.mark.parametrize("options", [{}, {"columns": ["x"]}, {"time": "t"}, {"time": ""}], ids=str)
def test_dates_that_are_not_read_have_no_note(tmp_path, options):
    """Such as those of events beside the timestamps; the note is about the column that is read."""
    book = openpyxl.Workbook()
    book.active.append(["event", "t", "x"])
    for i in range(3):
        book.active.append([DATE + dt.timedelta(microseconds=250 * i), i / 10, i])
    book.save(tmp_path / "a.xlsx")
    assert rtamt.read(tmp_path / "a.xlsx", **options).losses == ()
    (note,) = rtamt.read(tmp_path / "a.xlsx", time="event", columns=["x"]).losses
    assert note.startswith("2 dates of sheet 'Sheet' are finer than 1 ms and were rounded (the first in A3)")


def test_chunks_have_the_note_too(tmp_path):
    trace_of(tmp_path / "a.xlsx", DATE, 250, 4)
    for part in rtamt.scan(tmp_path / "a.xlsx"):
        assert part.losses[0].startswith("3 dates of sheet 'Sheet' are finer than 1 ms")
