"""One table, one answer: every entry point reads a table alike, or rejects it with the same error."""

import datetime as dt
import io
import json
import re
import sys
from dataclasses import dataclass

import pandas as pd
import polars as pl
import pyarrow as pa
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.cli import main
from rtamt.readers import csv

#: Names of the column of timestamps; columns that leave open which one it is, or whether there is one.
CLOCKS = ["time", "t", "Time [ms]", "time_ms", "stamp_us", "timestamp", "t (ns)", "Time(s)", "when"]
UNCLEAR = [["t", "timestamp"], ["sim_time"], ["timeMs"], ["header.stamp"], ["elapsed"], ["time_min"]]
UNITS = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}
#: Which unit a name has in it.
WRITTEN = {"s": r"\(s\)", "ms": "ms", "us": "us", "ns": "ns"}
EPOCH = dt.datetime(2026, 3, 1, 12)


ABOUT_CLOCKS = "may hold the time|unit of the|too large"


@dataclass(frozen=True)
class Asked:
    """A table, and how it is read: what the options of the command line say."""

    names: list[str]
    rows: list[list[str | None]]
    formula: str
    time: str
    period: str | None
    unit: str | None

    @property
    def options(self):
        period = [] if self.period is None else ["--period", self.period]
        return ["--time", self.time, *period, *([] if self.unit is None else ["--time-unit", self.unit])]

    @property
    def units(self):
        return {} if self.unit is None else {"time": self.unit}

    def spec(self):
        return rtamt.parse(f"always({self.formula})", time=self.time, period=self.period)

    def csv(self):
        return "".join(
            ",".join("" if c is None else c for c in row) + "\n" for row in [self.names, *self.rows]
        )

    def jsonl(self):
        rows = [dict(zip(self.names, map(cell, row), strict=True)) for row in self.rows]
        return "".join(json.dumps(row) + "\n" for row in rows)

    def columns(self):
        return {name: [cell(row[i]) for row in self.rows] for i, name in enumerate(self.names)}


@st.composite
def tables(draw):
    clocks = draw(st.sampled_from([[name] for name in CLOCKS] * 3 + UNCLEAR + [[]]))
    period = draw(st.sampled_from([1000, 1000, 500, 100, 1]))  # ms
    given_period = draw(st.sampled_from([None, f"{period}ms", f"{period}ms"]))
    jitter = 0 if given_period is None else draw(st.sampled_from([0, 0, period / 25]))
    start = draw(st.sampled_from([0, 0, 12_000, 1_700_000_000_000]))  # ms
    time = draw(st.sampled_from(["discrete", "dense"]))
    style = draw(st.sampled_from(["integers", "floats", "dates", "zoned", "spaced"]))
    says = (
        None
        if not clocks
        else next((u for u, pattern in WRITTEN.items() if re.search(pattern, clocks[0])), None)
    )
    unit = says or draw(st.sampled_from(["s", "ms", "us", "ns"]))
    values = draw(st.lists(st.integers(-2, 5), min_size=1, max_size=7))
    empty = draw(st.integers(0, 20))
    rows = [
        [stamp(start + i * period + jitter * (i % 2), style, unit)] * len(clocks)
        + [None if i == empty else str(value), "a"]
        for i, value in enumerate(values)
    ]
    said = unit if says is None and style in ("integers", "floats") and draw(st.booleans()) else None
    # In dense time "always" looks beyond the last sample, where a window that begins later slides on.
    later = "[500ms:1s]" if given_period and period < 1000 and time == "discrete" else ""
    bound = draw(st.sampled_from(["", "[0:1s]", later, f"[0:{2 * period}ms]"]))
    names = [*clocks, "x", "note"]
    formula = f"historically{bound}(x >= 0)"
    return Asked(names, rows, formula, time, given_period if time == "discrete" else None, said)


def stamp(ms, style, unit):
    if style in ("integers", "floats"):
        exact = ms * UNITS[unit] / 1000
        return str(int(exact)) if style == "integers" and exact == int(exact) else repr(exact)
    moment = EPOCH + dt.timedelta(milliseconds=ms % 10**9)
    if style == "dates":
        return moment.isoformat(timespec="microseconds")
    return f"{moment.isoformat(' ', 'microseconds')}{'+02:00' if style == 'zoned' else ''}"


def cell(text):
    """Return a text as a frame or a JSON object holds it."""
    if text is None or not re.fullmatch(r"-?[0-9.e+]+", text):
        return text
    return int(text) if re.fullmatch(r"-?[0-9]+", text) else float(text)


# ---- the entry points: the least robustness, or what is wrong -----------------------------------------


def sentence(error):
    """Return an error without the name of what was read."""
    return re.sub(
        r"\S*log\.csv|a pandas frame|a polars frame|an arrow table|a dict|stdin", "SOURCE", str(error)
    )


def checked(asked, capsys):
    capsys.readouterr()
    main(["check", f"always({asked.formula})", "log.csv", "--json", *asked.options])
    row = json.loads(capsys.readouterr().out)
    return sentence(row["error"]) if "error" in row else float(row["robustness"])


def monitored(asked, text, capsys, monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
    capsys.readouterr()
    code = main(["monitor", asked.formula, *asked.options])
    out, err = capsys.readouterr()
    if code:
        return sentence(err.removeprefix("rtamt: ").strip())
    return min(float(json.loads(line)["robustness"]) for line in out.splitlines())


def evaluated(asked, data):
    try:
        return asked.spec().evaluate(rtamt.read(data, columns=["x"], units=asked.units)).robustness
    except rtamt.StlError as error:
        return sentence(error)


def streamed(asked):
    spec = asked.spec()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(csv, "BLOCK", 2)
        try:
            chunks = rtamt.scan("log.csv", columns=["x"], units=asked.units)
            return rtamt.check_stream(spec, chunks).robustness
        except rtamt.StlError as error:
            return sentence(error)


@settings(max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(asked=tables())
def test_every_entry_point_reads_a_table_alike_or_rejects_it_alike(asked, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text(asked.csv())
    frame = pd.DataFrame(asked.columns())
    answers = {
        "check": checked(asked, capsys),
        "CSV on stdin": monitored(asked, asked.csv(), capsys, monkeypatch),
        "JSON on stdin": monitored(asked, asked.jsonl(), capsys, monkeypatch),
        "read": evaluated(asked, "log.csv"),
        "chunks": streamed(asked),
        "dict": evaluated(asked, asked.columns()),
        "pandas": evaluated(asked, frame),
        "polars": evaluated(asked, pl.DataFrame(asked.columns(), strict=False)),
        "arrow": evaluated(asked, pa.Table.from_pandas(frame)),
    }
    numbers = {name: answer for name, answer in answers.items() if isinstance(answer, float)}
    assert len(set(numbers.values())) <= 1, answers
    if asked.time == "discrete" and asked.period is None:
        # A bound may be no multiple of what the monitor assumes, or the timestamps are another period apart.
        del answers["CSV on stdin"], answers["JSON on stdin"]
    missing = any(row[-2] is None for row in asked.rows)
    about_clocks = {a for a in answers.values() if isinstance(a, str) and re.search(ABOUT_CLOCKS, a)}
    if about_clocks and not missing:
        assert about_clocks == set(answers.values()), answers
    if not missing:
        assert len(numbers.keys() & answers.keys()) in (0, len(answers)), answers


def test_a_monitor_that_is_given_no_period_never_answers_as_if_it_were_another(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    for gap in (0.5, 0.95, 0.999, 1, 1.05, 2):
        rows = [[repr(i * gap), str(x), "a"] for i, x in enumerate([1, 1, -1, 1])]
        for formula in ("historically(x >= 0)", "historically[0:19s](x >= 0)"):
            asked = Asked(["t", "x", "note"], rows, formula, "discrete", None, None)
            (tmp_path / "log.csv").write_text(asked.csv())
            answer = monitored(asked, asked.csv(), capsys, monkeypatch)
            if gap == 1:
                assert answer == checked(asked, capsys) == -1
            else:
                assert "s after the one before, expected 1 s" in answer
