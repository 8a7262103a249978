"""Rows of CSV files that are empty, or may be comments, and cells that are no numbers."""

import pytest

import rtamt
from rtamt.errors import TraceError
from rtamt.readers import csv as csv_module
from tests.unit.readers.csv_files import as_lists, read


@pytest.mark.parametrize("block", [1, 2, 65_536])
@pytest.mark.parametrize("gap", ["", "   ", '""'])
def test_an_empty_line_between_samples_of_one_column_is_a_missing_sample(write, monkeypatch, gap, block):
    monkeypatch.setattr(csv_module, "BLOCK", block)
    with pytest.raises(TraceError) as error:
        rtamt.read(write(f"x\n1\n2\n{gap}\n4\n\n\n"))
    assert str(error.value) == (
        "'x' is missing at sample 2 of log.csv: fill the gap, or name the column of timestamps, so that each signal "
        "has its own time base"
    )
    assert as_lists(read(write("x\n1\n2\n4\n\n  \n"))) == {"x": [1.0, 2.0, 4.0]}


def test_empty_lines_between_rows_of_several_columns_are_no_rows(write):
    assert as_lists(read(write("x,y\n1,2\n\n3,4\n"))) == {"x": [1.0, 3.0], "y": [2.0, 4.0]}


@pytest.mark.parametrize("first", ["#N/A", "#DIV/0!", "#7", '"#7"', "#0.5"])
def test_a_row_that_may_be_a_sample_is_not_dropped_as_a_comment(write, first):
    with pytest.raises(TraceError) as error:
        read(write(f"y,x\n1,2\n{first},9\n"), ["x"])
    first = first.strip('"')
    assert str(error.value) == (
        f"log.csv, line 3: '{first}' may begin a sample or a comment: begin no sample with '#', and a comment with '# '"
    )


@pytest.mark.parametrize(
    ("content", "first", "last"),
    [
        ('time,x,note\n0,1,"a\n1,9,c\n2,1,"d\n3,1,e\n', 2, 4),
        ('time,note,x\n0,a,1\n1,"b,1\n2,"c,9\n', 3, 4),
        ('time,x\n0,1\n1,"5\n2,9\n', 3, 4),
    ],
)
def test_a_quote_that_nothing_closes_does_not_swallow_rows(write, content, first, last):
    with pytest.raises(TraceError) as error:
        read(write(content), ["x"])
    assert str(error.value) == (
        f"log.csv, line {first}: a cell begins with a quote that nothing closes before line {last}: close it, or write "
        f"it twice in quotes"
    )


@pytest.mark.parametrize(
    ("cell", "hint"),
    [
        ("n/a", "; where a sample is missing, leave the cell empty"),
        ("#N/A", "; where a sample is missing, leave the cell empty"),
        ("1.#IND", "; where a sample is missing, leave the cell empty"),
        (
            "01.05.2026 12:00:00",
            "; write dates as in 2026-05-01T12:00:00.5, times since a start in seconds",
        ),
        ("2026-05-01", ""),
        ("1.234.567", ""),
    ],
)
def test_the_message_for_a_cell_says_how_to_write_what_is_meant(write, cell, hint):
    with pytest.raises(TraceError) as error:
        read(write(f"time,x\n0,1\n1,{cell}\n"), ["x"])
    assert str(error.value) == f"log.csv, line 3: 'x' is '{cell}', expected a number{hint}"


@pytest.mark.parametrize("unit", ["ms", "[ms]"])
def test_the_message_for_a_row_of_units_says_where_to_write_them(write, unit):
    with pytest.raises(TraceError) as error:
        read(write(f"time,x\n{unit},V\n0,1\n100,2\n"), ["x"])
    assert str(error.value) == (
        f"log.csv, line 2: 'time' is '{unit}', expected a number; if the line holds units, write them behind the "
        "names, such as 'time [ms]', and delete it"
    )
