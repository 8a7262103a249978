"""A check of a file in chunks has the outcome of the whole recording: verdicts, times, episodes, errors and notes."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import event, example, given, settings
from hypothesis import strategies as st
from pyarrow import parquet

import rtamt
from rtamt.cli.outcome import Outcome, Requirement
from rtamt.cli.reading_options import Reading
from rtamt.cli.runner import evaluate

PERIODS = [1.0, 0.01, 0.1, 1e-3, 0.125, 1 / 3]
NEVER = 10**12
TEXTS = [
    "always(x >= 0)",
    "always[0:2](x + y >= -1)",
    "historically(x <= 1)",
    "always(x >= 1 -> eventually[0:2](y >= 0.5))",
    "eventually(x > 2)",
    "x >= 0 and always(y >= 0)",
    "(x >= 0) until[0:2] (y >= 0.5)",
    "always((x >= 0) since[0:2] (y > 0))",
    "not always(x > 0)",
    "always(sum[0:1](x) > 0)",
    "always(sqrt(x + 0.5) < 1.8)",
    "require A: always(x >= 0)\nrequire B: eventually[0:2](y >= 1)",
    "require A: always[0:3](x + y >= 0)\nrequire B: once[0:1](y > 0)\nrequire C: always(x >= 0)",
]


@st.composite
def logs(draw: Any) -> tuple[dict[str, list[Any]], str]:
    """Columns of a recording, and the unit of its timestamps: regular ones with at most two faults."""
    n = draw(st.integers(1, 24))
    values = st.sampled_from([-2.0, -0.5, 0.0, 0.5, 1.0, 3.0])
    columns: dict[str, list[Any]] = {name: draw(st.lists(values, min_size=n, max_size=n)) for name in "xy"}
    start, period = draw(st.sampled_from([0.0, 5.0, 1.7e9])), draw(st.sampled_from(PERIODS))
    times: list[Any] = [start + i * period for i in range(n)]
    unit = draw(st.sampled_from(["", "", "", " [ns]", " dates", "none"]))
    for _ in range(draw(st.sampled_from([0, 0, 1, 1, 2]))):
        place = draw(st.integers(0, n - 1))
        fault = draw(
            st.sampled_from(
                "nan none late ended inf text gap swap repeat jitter slower nan-time no-time".split()
            )
        )
        name = draw(st.sampled_from("xy"))
        if fault in {"nan", "none", "inf", "text"}:
            columns[name][place] = {"nan": np.nan, "none": None, "inf": np.inf, "text": "bad"}[fault]
        elif fault in {"late", "ended"}:
            missing = slice(place) if fault == "late" else slice(place, n)
            columns[name][missing] = [None] * len(columns[name][missing])
        elif fault == "swap":
            times[place], times[place - 1] = times[place - 1], times[place]
        elif fault == "repeat":
            times[place] = times[place - 1]
        elif fault in {"nan-time", "no-time"}:
            times[place] = np.nan if fault == "nan-time" and not unit else None
        elif fault == "gap":
            times[place:] = [None if t is None else t + 3.5 * period for t in times[place:]]
        elif fault == "jitter":
            times = [None if t is None else t + draw(st.floats(-0.04, 0.04)) * period for t in times]
        else:
            after = enumerate(times[place:])
            times[place:] = [None if t is None else t + i * period * 0.05 for i, t in after]
    if unit in {" [ns]", " dates"}:
        times = [None if t is None or np.isnan(t) else round(t * 1e9) for t in times]
    return {**({} if unit == "none" else {"time": times}), **columns}, unit


def write(columns: dict[str, list[Any]], unit: str, path: Path) -> None:
    """Write a recording as Parquet or CSV, as the name of the file says."""
    if path.suffix == ".csv":
        cells = {name: ["" if v is None else str(v) for v in column] for name, column in columns.items()}
        if unit == " dates" and "time" in columns:
            cells["time"] = ["" if v is None else str(np.datetime64(v, "ns")) for v in columns["time"]]
        names = [name + (unit if name == "time" and unit == " [ns]" else "") for name in cells]
        rows = zip(*cells.values(), strict=True)
        path.write_text("".join(f"{','.join(row)}\n" for row in [names, *rows]), encoding="utf-8")
        return
    made = {}
    for name, column in columns.items():
        if name == "time" and unit == " dates":
            made[name] = pa.array(column, pa.timestamp("ns"))
        elif any(isinstance(value, str) for value in column):
            made[name] = pa.array([None if v is None else str(v) for v in column])
        else:
            made[name + (unit if name == "time" and unit == " [ns]" else "")] = pa.array(column)
    parquet.write_table(pa.table(made), path, row_group_size=7)


def checked(requirement: Requirement, path: Path, **sizes: int) -> list[Outcome]:
    with pytest.MonkeyPatch.context() as patch:
        for name, size in {"LARGE": NEVER, "MODERATE": NEVER, **sizes}.items():
            patch.setattr(f"rtamt.cli.runner.{name}", size)
        patch.setattr("rtamt.readers.arrow.CHUNK", 3)
        patch.setattr("rtamt.readers.csv.BLOCK", 3)
        patch.setattr("rtamt.readers.csv_arrow._WORTH", 0)
        patch.setattr("rtamt.readers.csv_arrow._SIZE", 100)  # two rows or more
        found = evaluate([requirement], str(path), Reading())
    return [replace(outcome, result=None, seconds=0.0) for outcome in found]


def requirement(text: str, *, dense: bool) -> Requirement:
    spec = rtamt.parse(text, time="dense" if dense else "discrete")
    several = len(spec.requirements) > 1
    rows = [Requirement(spec.select(name), text, name) for name in spec.requirements] if several else []
    return Requirement(spec, text, "R", tuple(rows))


THIRDS = {"time": [0, 333333333, 666666667, 1_000_000_000], "x": [-2.0] * 4, "y": [-2.0] * 4}


@settings(max_examples=3 * settings().max_examples)
@given(logs(), st.sampled_from(TEXTS), st.booleans(), st.sampled_from(["log.parquet", "log.csv"]))
@example((THIRDS, " [ns]"), TEXTS[0], False, "log.parquet")
def test_the_outcome_in_chunks_is_that_of_the_whole_recording(
    log: Any, text: str, dense: bool, name: str
) -> None:
    asked = requirement(text, dense=dense and "sum" not in text)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, name)
        write(*log, path)
        whole = checked(asked, path)
        event(f"{whole[0].verdict}")
        assert checked(asked, path, MODERATE=0) == whole
        if not any(outcome.error for outcome in whole):
            large = checked(asked, path, LARGE=0)
            assert [outcome.verdict for outcome in large] == [outcome.verdict for outcome in whole]
