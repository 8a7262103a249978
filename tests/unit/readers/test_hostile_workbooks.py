"""Workbooks that openpyxl reads in part, or in more memory and time than their size suggests."""

from zipfile import ZIP_DEFLATED, ZipFile

import pytest

import rtamt
from rtamt.errors import TraceError
from rtamt.readers import excel

openpyxl = pytest.importorskip("openpyxl")
_SHEET = "xl/worksheets/sheet1.xml"


def changed(folder, old: bytes, new: bytes, part: str = _SHEET):
    """Return the path of a workbook, with time and x of five samples, in which a text of a part is replaced."""
    book = openpyxl.Workbook()
    for row in [("time", "x"), *((k, k) for k in range(5))]:
        book.active.append(row)
    first, path = folder / "first.xlsx", folder / "a.xlsx"
    book.save(first)
    with ZipFile(first) as source, ZipFile(path, "w", ZIP_DEFLATED) as target:
        for name in source.namelist():
            content = source.read(name)
            if name == part:
                assert old in content
                content = content.replace(old, new)
            target.writestr(name, content)
    return path


def message(path) -> str:
    with pytest.raises(TraceError) as caught:
        rtamt.read(path)
    return str(caught.value)


@pytest.mark.parametrize(("number", "last"), [(30, "row 4"), (2, "row 2")])
def test_rows_after_one_of_a_higher_number_were_left_out(tmp_path, number, last):
    path = changed(tmp_path, b'<row r="3"', b'<row r="%d"' % number)
    assert message(path) == (
        f"{last} in the sheet 'Sheet' of {path} comes after row {number}: open the workbook in a spreadsheet "
        "and save it"
    )


def test_rows_without_numbers_are_read(tmp_path):
    path = changed(tmp_path, b'<row r="3"', b"<row")
    assert list(rtamt.read(path)["x"].values) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("part", [_SHEET, "xl/styles.xml"])
def test_a_part_that_was_unpacked_to_hundreds_of_megabytes(tmp_path, monkeypatch, part):
    monkeypatch.setattr(excel, "LARGE_PART", 2**20)
    end = b"</sheetData>" if part == _SHEET else b"</fonts>"
    path = changed(tmp_path, end, b"<c/>" * 2**19 + end, part)
    assert message(path).startswith(
        f"{path} has a part '{part}' that unpacks to 2.0 MiB from 0.0 MiB: save its sheets"
    )


def test_a_row_of_any_length_was_kept_in_memory(tmp_path, monkeypatch):
    monkeypatch.setattr(excel, "LARGE_PART", 2**21)
    monkeypatch.setattr(excel, "MOST_RATIO", 10_000)
    end = b"</sheetData>"
    path = changed(tmp_path, end, b'<row r="7">' + b"<c/>" * 2**20 + b"</row>" + end)
    assert message(path) == (
        f"a row after row 7 in the sheet 'Sheet' of {path} has more than 2 MiB: delete what is far from the table, or "
        f"save the sheet as CSV"
    )


def test_a_long_sheet_with_short_rows_is_read(tmp_path, monkeypatch):
    monkeypatch.setattr(excel, "LARGE_PART", 2**20)
    rows = b"".join(
        b'<row r="%d"><c r="A%d"><v>%d</v></c><c r="B%d"><v>1</v></c></row>' % (k, k, k, k)
        for k in range(7, 40_000)
    )
    path = changed(tmp_path, b"</sheetData>", rows + b"</sheetData>")
    assert len(rtamt.read(path)["x"].values) == 39_998
