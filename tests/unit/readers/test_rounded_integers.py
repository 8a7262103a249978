"""Integers of recordings that no double holds: the nearest double, and a note beside the verdict."""

import sqlite3
from contextlib import closing
from decimal import Decimal

import numpy as np
import pandas as pd
import polars as pl
import pytest

import rtamt
from rtamt.readers.numbers import rounded

EVEN = 2**53
ODD = EVEN + 1
ROWS = {"time": [0, 1, 2], "x": [1, ODD, ODD], "y": [1, EVEN, EVEN]}
NOTE = "rounded to doubles: 2 integers of x beyond 2^53, the first at 1 s"


def csv(folder):
    pd.DataFrame(ROWS).to_csv(folder / "a.csv", index=False)
    return folder / "a.csv"


def parquet(folder):
    pd.DataFrame(ROWS).to_parquet(folder / "a.parquet")
    return folder / "a.parquet"


@pytest.mark.parametrize("write", [csv, parquet])
def test_a_file_with_integers_that_no_double_holds_has_a_note(tmp_path, write) -> None:
    trace = rtamt.read(write(tmp_path))
    assert trace.remarks == (NOTE,)
    assert rtamt.parse("always(x - y >= 0)").evaluate(trace).robustness == 0


def test_a_database_with_such_integers_has_the_same_note(tmp_path) -> None:
    with closing(sqlite3.connect(tmp_path / "log.db")) as connection:
        pd.DataFrame(ROWS).to_sql("log", connection, index=False)
        connection.commit()
    trace = rtamt.read(f"sqlite:///{tmp_path}/log.db", query="select * from log")
    assert trace.remarks == (NOTE,)


@pytest.mark.parametrize(
    "data",
    [
        ROWS,
        pd.DataFrame(ROWS),
        pl.DataFrame(ROWS),
        pl.DataFrame(ROWS).to_arrow(),
        pd.DataFrame(ROWS).astype({"x": "uint64"}),
        {**ROWS, "x": [1, Decimal(ODD), Decimal(f"{ODD}.00")]},
        {**ROWS, "x": np.array([None, np.int64(ODD), np.uint64(ODD)], dtype=object)},
    ],
    ids=["dict", "pandas", "polars", "arrow", "unsigned", "decimals", "objects"],
)
def test_data_in_memory_that_is_read_has_the_same_note(data) -> None:
    assert rtamt.read(data).remarks == (NOTE,)


@pytest.mark.parametrize(
    "data",
    [
        pd.DataFrame({"time": [0, 1, 2], "x": pd.array([1, None, ODD], dtype="Int64")}),
        pl.DataFrame({"time": [0, 1, 2], "x": [1, None, ODD]}),
        pl.DataFrame({"time": [0, 1, 2], "x": [1, None, ODD]}).to_arrow(),
    ],
    ids=["pandas", "polars", "arrow"],
)
def test_missing_samples_beside_them_change_nothing(data) -> None:
    trace = rtamt.read(data)
    assert trace["x"].values.tolist() == [1, EVEN]
    assert trace.remarks == ("rounded to doubles: 1 integer of x beyond 2^53, the first at 2 s",)


def test_integers_that_doubles_hold_and_numbers_that_are_no_integers_have_no_note() -> None:
    exact = {"time": [0, 1], "x": [EVEN + 2, 2**62], "y": [1e300, 0.1], "z": [-EVEN, EVEN]}
    assert rtamt.read(exact).remarks == ()


@pytest.mark.parametrize(
    ("values", "found"),
    [
        (np.array([-(2**63), 2**63 - 1, 2**62]), [False, True, False]),
        (np.array([2**64 - 1, 2**63, 2**63 + 1], dtype=np.uint64), [True, False, True]),
        (np.array([ODD, None, 1.5, -ODD], dtype=object), [True, False, False, True]),
    ],
)
def test_the_greatest_integers_are_compared_exactly(values, found) -> None:
    assert rounded(values).tolist() == found
