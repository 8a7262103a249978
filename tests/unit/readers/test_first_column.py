"""A first column that may hold the timestamps, under a name that is not that of a time column."""

from __future__ import annotations

import copy
import pickle
import sqlite3
from shlex import quote
from typing import TYPE_CHECKING, Any

import pandas as pd
import polars as pl
import pytest
import xarray as xr

import rtamt
from rtamt.errors import TraceError
from rtamt.readers import csv_arrow, csv_source

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

SPEC = rtamt.parse("always[0:2](x > 0)")


BY_ONE = "its values increase, but not by 1 from row to row;"


def rejected(column: str, why: str = BY_ONE) -> str:
    return (
        f"the first column '{column}' may hold the timestamps: {why} "
        f"choose it with time='{column}', on the command line --time-column {quote(column)}, or give the period of the "
        f"samples, such as period='1s', on the command line --period 1s"
    )


def evaluated(source: Any, **options: Any) -> float:
    return SPEC.evaluate(rtamt.read(source, **options)).robustness


def written(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "log.csv"
    path.write_text(text)
    return path


FRAME = pd.DataFrame({"Zeit": [0.0, 0.1, 0.2, 0.3], "x": [1, 2, -1, 4]})


def as_parquet(folder: Path) -> Any:
    FRAME.to_parquet(folder / "log.parquet")
    return folder / "log.parquet", {}


def as_excel(folder: Path) -> Any:
    FRAME.to_excel(folder / "log.xlsx", index=False)
    return folder / "log.xlsx", {}


def as_sql(folder: Path) -> Any:
    with sqlite3.connect(folder / "log.db") as database:
        FRAME.to_sql("log", database, index=False)
    return f"sqlite:///{folder / 'log.db'}", {"query": "select * from log"}


SOURCES: dict[str, Callable[[Path], Any]] = {
    "CSV": lambda folder: (written(folder, FRAME.to_csv(index=False)), {}),
    "Parquet": as_parquet,
    "Excel": as_excel,
    "SQL": as_sql,
    "pandas": lambda _: (FRAME, {}),
    "polars": lambda _: (pl.from_pandas(FRAME), {}),
    "dict": lambda _: (FRAME.to_dict("list"), {}),
    "array": lambda _: (FRAME.to_records(index=False), {}),
}


@pytest.mark.parametrize("columns", [None, ["x"]], ids=["all", "selected"])
@pytest.mark.parametrize("kind", SOURCES)
def test_every_source_is_rejected_if_its_first_column_may_hold_the_timestamps(
    tmp_path: Path, kind: str, columns: list[str] | None
) -> None:
    source, options = SOURCES[kind](tmp_path)
    trace = rtamt.read(source, columns=columns, **options)
    with pytest.raises(TraceError) as caught:
        SPEC.evaluate(trace)
    assert str(caught.value) == rejected("Zeit")
    assert SPEC.evaluate(trace, period="1s").robustness == -1


@pytest.mark.parametrize("column", ["Zeit [ms]", "t/ms", "tick_us"])
@pytest.mark.parametrize("kind", ["CSV", "pandas", "dict", "polars"])
def test_a_first_column_with_a_unit_of_time_counts_no_rows(tmp_path: Path, column: str, kind: str) -> None:
    frame = pd.DataFrame({column: [0, 1, 2], "x": [1, 2, -1]})
    sources = {
        "CSV": lambda: written(tmp_path, frame.to_csv(index=False)),
        "pandas": lambda: frame,
        "dict": lambda: frame.to_dict("list"),
        "polars": lambda: pl.from_pandas(frame),
    }
    trace = rtamt.read(sources[kind]())
    with pytest.raises(TraceError) as caught:
        SPEC.evaluate(trace)
    reason = "its values increase, and its name has a unit of time;"
    assert str(caught.value) == rejected(column, reason)
    assert SPEC.evaluate(trace, period="1s").robustness == -1
    assert SPEC.evaluate(rtamt.read(frame.rename(columns={column: "Zeit [s]"}))).robustness == -1


def test_a_frame_whose_first_column_has_a_unit_of_time_is_rejected() -> None:
    frame = pd.DataFrame({"tick_ms": [0, 1, 2], "x": [1, 2, -1]})
    with pytest.raises(TraceError) as caught:
        SPEC.evaluate(frame)
    assert str(caught.value) == (
        "the frame may have its timestamps in its first column 'tick_ms', whose values increase, and whose name has a "
        "unit of time: read the frame with rtamt.read(frame, time='tick_ms'), or give the period of the samples, such "
        "as period='1s'"
    )


ROWS = "whose values increase, but not by 1 from row to row"


@pytest.mark.parametrize(
    "index", [[0, 10, 20], [0, 3, 4], pd.RangeIndex(0, 30, 10), pd.Index([1, 5, 6], dtype="uint64")], ids=str
)
@pytest.mark.parametrize("name", [None, "tick"])
def test_integers_in_an_index_that_do_not_count_the_rows_are_rejected_unless_a_period_is_given(
    index: Any, name: str | None
) -> None:
    spec = rtamt.parse("always[0:2](x > 0)")
    frame = pd.DataFrame({"x": [1, 2, -1]}, index=pd.Index(index, name=name))
    called = f"its index '{name}'" if name else "its index"
    in_frame = (
        f"the frame may have its timestamps in {called}, {ROWS}: read the frame with rtamt.read(frame, "
        f"time='{name or 'index'}'), or give the period of the samples, such as period='1s'"
    )
    in_series = (
        f"'x' may have its timestamps in {called}, but those of a mapping are read from its key 'time': give them "
        f"there, or the bare values, with to_numpy(), if the index holds no times"
    )
    cases = [
        (frame, in_frame),
        ({"x": frame["x"]}, in_series),
        (rtamt.read(frame), rejected(name or "index")),
    ]
    numbered = pd.DataFrame({"x": [1, 2, -1]})
    for _ in range(2):  # also after an evaluation that has prepared the next one
        for data, message in cases:
            with pytest.raises(TraceError) as caught:
                spec.evaluate(data)
            assert str(caught.value) == message
            assert spec.evaluate(data, period=1).robustness == -1
        assert spec.evaluate(numbered).robustness == -1
    assert rtamt.read(frame, time=name or "index", time_unit="ms")["x"].times[-1] == index[-1] / 1000


@pytest.mark.parametrize(
    "index", [None, [5, 6, 7], [2, 0, 1], [0, 0, 1], ["a", "b", "c"], pd.RangeIndex(7, 10)], ids=str
)
def test_an_index_that_counts_the_rows_or_does_not_increase_leaves_samples_one_period_apart(
    index: Any,
) -> None:
    frame = pd.DataFrame({"x": [1, 2, -1]}, index=index)
    for data in (frame, {"x": frame["x"]}, rtamt.read(frame)):
        assert SPEC.evaluate(data).robustness == -1


def test_integers_in_the_index_of_a_frame_with_a_column_of_timestamps_are_not_considered() -> None:
    frame = pd.DataFrame({"x": [1, 2, -1], "time": [0, 1, 2]}, index=[0, 10, 20])
    assert SPEC.evaluate(frame).robustness == SPEC.evaluate(rtamt.read(frame)).robustness == -1


def test_integers_along_a_dimension_of_xarray_are_rejected_unless_they_count_the_rows() -> None:
    data = xr.Dataset({"x": ("step", [1, 2, -1])}, coords={"step": [0, 10, 20]})
    with pytest.raises(TraceError) as caught:
        SPEC.evaluate(rtamt.read(data))
    assert str(caught.value) == rejected("step")
    assert SPEC.evaluate(rtamt.read(data.assign_coords(step=[4, 5, 6]))).robustness == -1


TWO = "require A: always(Zeit >= 0)\nrequire B: always[0:2](x > 0)"


@pytest.mark.parametrize(
    "evaluate",
    [
        lambda data: rtamt.parse(TWO).evaluate(data),
        lambda data: rtamt.evaluate_all([rtamt.parse(TWO)], data),
        lambda data: rtamt.evaluate_all([*rtamt.parse(TWO).requirements.values()], data),
        lambda data: rtamt.check_stream(rtamt.parse(TWO), [data]),
    ],
    ids=["evaluate", "evaluate_all", "evaluate_all of several", "check_stream"],
)
def test_a_requirement_that_reads_the_column_does_not_decide_for_another(
    evaluate: Callable[[Any], Any],
) -> None:
    for data in (FRAME, rtamt.read(FRAME)):
        with pytest.raises(TraceError, match="first column 'Zeit'"):
            evaluate(data)


@pytest.mark.parametrize("name", ["Zeit", "tick_ms", "frame", "seq", "step", "zeit_s", "sekunden"])
def test_the_choice_of_a_column_or_of_none_is_followed(tmp_path: Path, name: str) -> None:
    path = written(tmp_path, f"{name},x\n0,1\n2,2\n4,-1\n6,4\n")
    with pytest.raises(TraceError, match=f"'{name}' may hold the timestamps"):
        evaluated(path)
    assert rtamt.read(path, time=name, time_unit="s").names == ("x",)
    assert evaluated(path, time="") == -1


def test_a_period_in_the_specification_is_a_choice(tmp_path: Path) -> None:
    path = written(tmp_path, "Zeit,x\n0,1\n0.1,2\n0.2,-1\n0.3,4\n")
    spec = rtamt.parse("always[0:200ms](x > 0)", period="100ms")
    assert spec.evaluate(rtamt.read(path)).robustness == -1


@pytest.mark.parametrize(
    "rows",
    [
        pytest.param("5,1\n6,2\n7,-1\n8,4\n", id="counts the rows"),
        pytest.param("0.1,1\n0.3,2\n0.2,-1\n0.4,4\n", id="decreases"),
        pytest.param("0.1,1\n,2\n0.3,-1\n0.4,4\n", id="has an empty cell"),
        pytest.param("0.1,1\nnan,2\n0.3,-1\n0.4,4\n", id="has NaN"),
        pytest.param("0.1,1\noff,2\n0.3,-1\n0.4,4\n", id="has text"),
        pytest.param("off,1\non,2\non,-1\noff,4\n", id="is text"),
    ],
)
def test_another_first_column_leaves_the_samples_one_second_apart(tmp_path: Path, rows: str) -> None:
    path = written(tmp_path, "first,x\n" + rows)
    assert evaluated(path, columns=["x"]) == -1


def test_text_behind_the_examined_rows_of_a_column_that_no_formula_reads_is_no_error(tmp_path: Path) -> None:
    rows = [f"{i / 10},1\n" for i in range(csv_source._SAMPLE + 50)]
    path = written(tmp_path, "".join(["first,x\n", *rows, "off,-1\n", "0.5,2\n"]))
    assert rtamt.parse("always(x > 0)").evaluate(rtamt.read(path, columns=["x"])).robustness == -1


def test_a_first_column_that_the_formula_reads_is_a_signal(tmp_path: Path) -> None:
    path = written(tmp_path, "distance,x\n1,1\n3,2\n7,-1\n")
    spec = rtamt.parse("always(distance > x)")
    assert spec.evaluate(rtamt.read(path)).robustness == 0
    assert spec.evaluate(rtamt.read(path, columns=spec.input_names)).robustness == 0
    renamed = rtamt.parse("always(d > x)")
    assert renamed.evaluate(rtamt.read(path, names={"d": "distance"})).robustness == 0


def test_chunks_are_rejected_where_the_count_of_rows_ends(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rtamt.readers.csv.BLOCK", 3)
    path = written(tmp_path, "seq,x\n" + "".join(f"{i},1\n" for i in (1, 2, 3, 4, 5, 6, 8, 9)))

    def chunks() -> Iterator[rtamt.Trace]:
        return rtamt.scan(path, columns=["x"])

    with pytest.raises(TraceError) as caught:
        rtamt.check_stream(SPEC, chunks())
    assert str(caught.value) == rejected("seq")
    assert rtamt.check_stream(SPEC, chunks(), period="1s").satisfied
    counting = written(tmp_path, "seq,x\n" + "".join(f"{i},1\n" for i in range(8)))
    assert rtamt.check_stream(SPEC, rtamt.scan(counting, columns=["x"])).satisfied


def test_a_first_column_that_increases_in_the_first_chunk_only_was_taken_for_timestamps(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("rtamt.readers.csv.BLOCK", 3)
    level = [f"{x},1\n" for x in (*range(0, 220, 2), 0)]  # longer than what is examined before a file is read
    path = written(tmp_path, "level,x\n" + "".join(level))
    for spec in (SPEC, rtamt.parse("require A: always(x > 0); require B: level >= 0")):
        whole = spec.evaluate(rtamt.read(path, columns=spec.input_names))
        streamed = rtamt.check_stream(spec, rtamt.scan(path, columns=spec.input_names))
        assert (streamed.robustness, streamed.samples) == (whole.robustness, len(level))


def test_a_large_file_is_rejected_by_the_quick_reader_as_well(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(csv_arrow, "_WORTH", 0)
    path = written(tmp_path, "Zeit,x\n0,1\n0.1,2\n0.2,-1\n0.3,4\n")
    with pytest.raises(TraceError, match="'Zeit' may hold the timestamps"):
        evaluated(path, columns=["x"])


@pytest.mark.parametrize("frame", [FRAME, pl.from_pandas(FRAME)], ids=["pandas", "polars"])
def test_an_evaluation_of_a_frame_itself_rejects_its_first_column_unless_a_period_is_given(
    frame: Any,
) -> None:
    for _ in range(3):
        with pytest.raises(TraceError) as caught:
            SPEC.evaluate(frame)
        assert str(caught.value) == (
            "the frame may have its timestamps in its first column 'Zeit', whose values increase, but not by 1 from "
            "row to row: read the frame with rtamt.read(frame, time='Zeit'), or give the period of the samples, such "
            "as period='1s'"
        )
        assert SPEC.evaluate(frame, period="1s").robustness == -1
        assert SPEC.evaluate(frame[["x"]]).robustness == -1


def test_a_selection_of_a_trace_is_rejected_like_it() -> None:
    trace = rtamt.read({"Zeit": [0, 2, 4, 6], "x": [1, 2, -1, 4]})
    with pytest.raises(TraceError, match="'Zeit' may hold the timestamps"):
        SPEC.evaluate(trace.select(["x"]))


GROUP = rtamt.parse('group cars = "car_*" { float x }; forall v in cars: always[0:2](v.x > 0)')
BOUND = rtamt.parse('input float y = "x"\nalways[0:2](y > 0)')


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    "frame", [FRAME, pl.from_pandas(FRAME), rtamt.read(FRAME)], ids=["pandas", "polars", "trace"]
)
def test_a_monitor_rejects_the_first_column_of_a_chunk_unless_a_period_is_given(
    frame: Any, backend: str
) -> None:
    spec = rtamt.parse(SPEC.text, backend=backend)
    monitor = spec.monitor()
    for each in (monitor, copy.copy(monitor), pickle.loads(pickle.dumps(monitor))):
        with pytest.raises(TraceError, match=r"'Zeit'.* increase, but not by 1 from row to row"):
            each.update_many(frame)
        assert each.samples == 0
    assert spec.monitor(period="1s").update_many(frame).values.tolist() == [-1, -1]
    assert monitor.update_many(
        {"x": frame["x"].values if frame is FRAME else [1, 2, -1, 4]}
    ).values.tolist() == [-1, -1]


def test_a_frame_is_looked_at_in_the_first_chunk_of_a_monitor_that_shows_more_than_one_row() -> None:
    monitor = SPEC.monitor()
    monitor.update_many(FRAME[:1])
    with pytest.raises(TraceError, match="'Zeit'"):
        monitor.update_many(FRAME[1:])
    assert monitor.samples == 1
    monitor.update_many(FRAME.assign(Zeit=[3, 1, 2, 3])[1:2])
    monitor.update_many(FRAME[2:])
    assert monitor.samples == 4


def test_a_check_of_frames_in_chunks_looks_at_the_first_column_as_a_monitor_does() -> None:
    chunks = [FRAME.assign(Zeit=[3, 1, 2, 3]), FRAME]
    assert (
        rtamt.check_stream(SPEC, chunks).robustness
        == SPEC.evaluate(pd.concat(chunks, ignore_index=True)).robustness
    )
    for wrong in ([FRAME], [FRAME[:1], FRAME[1:]]):
        with pytest.raises(TraceError, match="'Zeit'"):
            rtamt.check_stream(SPEC, wrong)


@pytest.mark.parametrize("spec", [GROUP, BOUND], ids=["group", "recorded name"])
def test_the_first_column_of_a_frame_is_rejected_beside_members_and_recorded_names(spec: Any) -> None:
    frame = FRAME.rename(columns={"x": "car_1.x"}) if spec is GROUP else FRAME
    for source in (frame, pl.from_pandas(frame), rtamt.read(frame)):
        for take in (spec.evaluate, spec.monitor().update_many):
            with pytest.raises(TraceError, match=r"'Zeit'.* increase, but not by 1 from row to row"):
                take(source)
        assert spec.evaluate(source, period="1s").robustness == -1
        assert spec.monitor(period="1s").update_many(source).values.tolist() == [-1, -1]


@pytest.mark.parametrize("spec", [GROUP, BOUND, SPEC], ids=["group", "recorded name", "own name"])
def test_the_first_column_of_a_frame_may_be_a_variable(spec: Any) -> None:
    frame = pd.DataFrame(
        {"car_1.x" if spec is GROUP else "x": [1.0, 2.5, 3.5, 4.0], "z": [1.0, 2.5, 3.5, 4.0]}
    )
    assert spec.evaluate(frame).robustness == 1
    assert spec.monitor().update_many(frame).values.tolist() == [1, 2.5]
