"""Checks in chunks, and first violations: the same numbers as of the whole recording."""

import contextlib
import io
import json
import sqlite3
import tempfile
from contextlib import closing
from datetime import datetime, timedelta, timezone
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pyarrow import feather, parquet

import rtamt
from rtamt.batch import evaluate_requirements
from rtamt.cli import main
from rtamt.engine.discrete.evaluate import Run
from rtamt.engine.native import core
from rtamt.readers import arrow, csv, rows
from rtamt.signals import arrays, dense_arrays
from rtamt.signals.episodes import Episodes
from rtamt.violations import first_violation
from tests.support import strategies


def same(streamed, result):
    assert streamed.robustness == result.robustness
    assert streamed.satisfied == result.satisfied
    assert streamed.first_violation == first_violation(result)
    assert streamed.samples == result.trace.samples
    if streamed.episodes is not None:
        assert streamed.episodes == Episodes.of(result.episodes())


#: Texts that read x, to be checked in chunks.
TOPS = st.sampled_from(
    (
        "always(x == x) and always({})",
        "always(x == x) and eventually({})",
        "always(x == x) and ({})",
        "always(x == x and ({}))",
        "always[1:5](x == x and ({}))",
        "x == x and ({})",
    )
)


@pytest.mark.parametrize(
    ("text", "violated"),
    [
        ("always(x >= 3)", 2),
        ("always[3:4](x >= 3)", 4),
        ("always[0:1](x >= 3)", None),
        ("eventually(x >= 9)", 0),
        ("eventually(x >= 7)", None),
        ("x >= 3 and always[3:inf](x >= 3)", 4),
        ("always(x >= 2) and always(x <= 6)", 3),
        ("x >= 3 -> always(x >= 3)", 0),
        ("always(x >= 3 -> eventually[0:1](x >= 7))", 0),
        ("always(once[2:2](x >= 3))", 0),
        ("x >= 5.5", 0),
    ],
)
def test_first_violation_and_values_by_hand(text, violated):
    data = {"time": [0, 1, 2, 3, 4], "x": [5, 6, 2.5, 7, 1]}
    result = rtamt.parse(text).evaluate(data)
    if text == "always(x >= 2) and always(x <= 6)":
        assert result.robustness == -1
    assert first_violation(result) == violated
    chunks = [{name: column[i : i + 2] for name, column in data.items()} for i in (0, 2, 4)]
    same(rtamt.check_stream(rtamt.parse(text), chunks), result)


def test_dense_first_violation_is_in_the_times_of_the_recording():
    ns = np.array([10**18, 10**18 + 5, 10**18 + 9])
    for times, unit, expected in (
        ([0.0, 0.5, 0.9], None, 0.5),
        (ns, "ns", 10**18 + 5),
        (ns.astype("M8[ns]"), None, ns[1:2].astype("M8[ns]")[0]),
        (ns.astype("m8[ns]"), None, ns[1:2].astype("m8[ns]")[0]),
    ):
        result = rtamt.parse("always(x >= 3)").evaluate(
            {"x": (times, [5, 2, 1])}, time="dense", time_unit=unit
        )
        assert first_violation(result) == expected
    result = rtamt.parse("always[0.2:0.3](x >= 3)").evaluate(
        {"x": ([1.0, 1.1, 1.9], [5, 2, 1])}, time="dense"
    )
    assert first_violation(result) == 1.2


def test_a_window_that_fails_after_the_last_sample():
    spec = rtamt.parse("always(once[0:5](x >= 3))")
    data = {"x": ([0.0, 1.0], [5, 2])}
    result = spec.evaluate(data, time="dense")
    assert (result.satisfied, first_violation(result)) == (False, 6)
    same(rtamt.check_stream(spec, [data], time="dense"), result)


def test_the_minimum_over_time():
    spec = rtamt.parse("always[0:1](x >= 3)")
    chunks = [{"time": [0, 1], "x": [5, 6]}, {"time": [2, 3], "x": [1, 8]}]
    streamed = rtamt.check_stream(spec, chunks)
    assert (streamed.robustness, streamed.minimum, streamed.samples, streamed.period) == (2, -2, 4, 1)
    assert rtamt.check_stream(rtamt.parse("always(x >= 3)"), chunks).minimum is None


@settings(max_examples=60)
@given(st.data())
def test_law_chunks_give_what_the_whole_gives(data):
    formula = data.draw(strategies.formulas(max_depth=3))
    trace = data.draw(strategies.traces(max_size=12))
    n = len(trace["x"])
    text = data.draw(TOPS).format(formula)
    spec = rtamt.parse(text, period=1)
    columns = {
        "time": np.arange(n, dtype=float),
        **{name: trace[name] for name in ("x", "y") if name in spec.input_names},
    }
    try:
        result = spec.evaluate(columns)
    except rtamt.EvaluationError:
        return
    sizes = data.draw(strategies.chunkings(n))
    ends = np.cumsum(sizes)
    chunks = [{k: v[e - s : e] for k, v in columns.items()} for s, e in zip(sizes, ends, strict=True)]
    streamed = rtamt.check_stream(spec, chunks)
    same(streamed, result)


@settings(max_examples=60)
@given(st.data())
def test_law_dense_chunks_give_what_the_whole_gives(data):
    formula = data.draw(strategies.formulas(max_depth=3, discrete=False, arithmetic=False))
    trace = data.draw(strategies.dense_traces())
    spec = rtamt.parse(data.draw(TOPS).format(formula), time="dense", resolution=1)
    used = {name: trace[name] for name in spec.input_names}
    in_seconds = {name: (times.astype(float), values) for name, (times, values) in used.items()}
    try:
        result = spec.evaluate(in_seconds)
    except rtamt.TraceError:
        return
    chunks = data.draw(strategies.dense_chunkings(used))
    seconds = [{k: (t.astype(float), v) for k, (t, v) in chunk.items()} for chunk in chunks]
    same(rtamt.check_stream(spec, seconds), result)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "always(eventually(x))",
            "'eventually' without an upper bound stands below another operator here, so that the recording cannot "
            "be checked in chunks; give it a bound, such as eventually[0:10], or read the recording whole\n"
            "  line 1, column 8:\n"
            "    always(eventually(x))\n"
            "           ^^^^^^^^^^^^^",
        ),
        (
            "x until y",
            "'until' without an upper bound needs the whole future here, so that the recording cannot be checked in "
            "chunks; give it a bound, such as until[0:10], or read the recording whole\n"
            "  line 1, column 1:\n"
            "    x until y\n"
            "    ^^^^^^^^^",
        ),
        ("true", "the formula reads no variable, so that there is nothing to check in chunks"),
        ("x", "the trace is empty: give at least one sample"),
    ],
)
def test_messages(text, message):
    with pytest.raises(rtamt.StlError) as error:
        rtamt.check_stream(rtamt.parse(text), [])
    assert str(error.value) == message


def test_files_and_queries_in_chunks(tmp_path, monkeypatch):
    monkeypatch.setattr(arrow, "CHUNK", 10)
    monkeypatch.setattr(rows, "CHUNK", 7)
    table = pa.table({"t_ms": np.arange(95) * 100, "x": np.cos(np.arange(95)), "note": ["a"] * 95})
    parquet.write_table(table, tmp_path / "log.parquet", row_group_size=33)
    feather.write_feather(table, str(tmp_path / "log.feather"))
    monkeypatch.setattr(csv, "BLOCK", 9)
    lines = [f"{100 * i},{float(np.cos(i))!r},a" for i in range(95)]
    (tmp_path / "log.csv").write_text("t_ms,x,note\n" + "\n".join(lines))
    with closing(sqlite3.connect(tmp_path / "log.db")) as database:
        database.execute("create table log (t_ms integer, x real)")
        database.executemany(
            "insert into log values (?, ?)", [(100 * i, float(np.cos(i))) for i in range(95)]
        )
        database.commit()
    spec = rtamt.parse("always(x >= 0 -> eventually[0:500ms](x <= 0))")
    whole = spec.evaluate(rtamt.read(table))
    for source, options in [
        (tmp_path / "log.csv", {}),
        (tmp_path / "log.parquet", {}),
        (tmp_path / "log.feather", {}),
        (f"sqlite:///{tmp_path}/log.db", {"query": "select t_ms, x from log order by t_ms"}),
    ]:
        chunks = list(rtamt.scan(source, columns=["x"], **options))
        assert len(chunks) >= 10
        streamed = rtamt.check_stream(spec, chunks)
        same(streamed, whole)
        assert streamed.samples == 95


def test_a_requirement_counted_the_samples_of_the_variables_of_others_in_chunks():
    spec = rtamt.parse("require A: always(x >= 0); require B: always(y >= 0)", time="dense")
    columns = {"time": [0, 1, 2, 3, 4], "x": [None, 1, 1, 1, 1], "y": [1, None, None, 1, None]}
    whole = evaluate_requirements(spec, rtamt.read(columns))
    table = pa.table(columns)
    chunks = [rtamt.read(table.slice(begin, 2)) for begin in (0, 2, 4)]
    streamed = rtamt.check_stream(spec, chunks)
    assert {name: part.samples for name, part in streamed.requirements.items()} == {"A": 4, "B": 2}
    assert {name: part.trace.samples for name, part in whole.items()} == {"A": 4, "B": 2}
    assert streamed.samples == spec.evaluate(rtamt.read(columns)).trace.samples == 5


def test_an_episode_lasted_to_the_end_of_the_variables_of_other_requirements_in_chunks():
    spec = rtamt.parse("require A: always(x >= 0); require B: eventually[0:2](y >= 1)", time="dense")
    data = {"x": ([0, 1, 5], [1, 1, 1]), "y": ([0, 2], [0, 0])}
    streamed = rtamt.check_stream(spec, [data]).requirements["B"]
    alone = rtamt.check_stream(spec.select("B"), [data])
    (whole,) = evaluate_requirements(spec, data)["B"].episodes()
    assert (whole.begin, whole.end, whole.worst, whole.at) == (0, 2, -1, 0)
    assert streamed.episodes == alone.episodes == Episodes.of([whole])


def test_samples_that_two_variables_have_in_turn_were_counted_once_in_chunks():
    spec = rtamt.parse("always(x + y >= 0)", time="dense")
    data = {"x": ([0, 2, 4], [1, 1, 1]), "y": ([1, 3, 4], [1, 1, 1])}
    assert rtamt.check_stream(spec, [data]).samples == spec.evaluate(data).trace.samples == 5


def test_what_cannot_be_read_in_chunks():
    with pytest.raises(
        rtamt.UsageError, match=r"^a dict cannot be read in chunks; read it whole with rtamt.read$"
    ):
        next(rtamt.scan({"x": [1]}))


def test_datetimes_with_a_time_zone_in_chunks():
    zone = timezone(timedelta(hours=9))
    moments = [datetime(2024, 5, 1, 19, 0, second, tzinfo=zone) for second in range(4)]
    spec = rtamt.parse("always(x >= 3)", time="dense")
    chunks = [{"x": (moments[:2], [5, 4])}, {"x": (moments[2:], [1, 0])}]
    streamed = rtamt.check_stream(spec, chunks)
    same(streamed, spec.evaluate({"x": (moments, [5, 4, 1, 0])}))
    assert str(streamed.first_violation).startswith("2024-05-01T10:00:02")


@st.composite
def parts_without_variables(draw, depth=3):
    """Draw the text of a formula that reads no variable: what it means depends on where windows end."""
    kind = draw(st.sampled_from(("constant", "window", "binary", "not", "and"))) if depth else "constant"
    if kind == "constant":
        return draw(st.sampled_from(("true", "false", "(2 > 1)", "(0 >= 1)")))
    below = draw(parts_without_variables(depth=depth - 1))
    if kind == "not":
        return f"not({below})"
    if kind == "window":
        name = draw(st.sampled_from(("once", "historically", "eventually", "always")))
        return f"{name}{draw(bounds())}({below})"
    if kind == "binary":
        name = draw(st.sampled_from(("since", "until")))
        return f"(({below}) {name}{draw(bounds())} ({draw(parts_without_variables(depth=depth - 1))}))"
    name = draw(st.sampled_from(("and", "or", "->")))
    return f"(({below}) {name} ({draw(parts_without_variables(depth=depth - 1))}))"


@st.composite
def bounds(draw):
    """Draw an interval in steps of 100 ms, or none; longer than the trace, too."""
    begin, length = draw(st.sampled_from((0, 1, 3, 5, 50))), draw(st.sampled_from((0, 2, 4, 90, None)))
    return draw(
        st.sampled_from(("", f"[{begin}00ms:{'inf' if length is None else f'{begin + length}00ms'}]"))
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
@settings(max_examples=40)
@given(data=st.data())
def test_law_parts_that_read_no_variable_are_parts_like_others(time, data):
    free = data.draw(parts_without_variables())
    other = data.draw(st.sampled_from(("always(x >= 3)", "eventually[0:300ms](x >= 3)", "x >= 3")))
    shape = st.sampled_from(
        ("{0} or {1}", "{0} and {1}", "{1} -> {0}", "always({0} or {1})", "not {0} and {1}")
    )
    text = data.draw(shape).format(free, other)
    n = data.draw(st.integers(1, 8))
    recording = {
        "time": [i / 10 for i in range(n)],
        "x": data.draw(st.lists(st.sampled_from([1.0, 3.0, 4.0]), min_size=n, max_size=n)),
    }
    spec = rtamt.parse(text, time=time, period="100ms" if time == "discrete" else None)
    result = spec.evaluate(recording)
    violated = first_violation(result)
    assert (violated is None) == result.satisfied
    assert result.satisfied == spec.evaluate(recording, semantics="boolean").satisfied
    (judged,) = evaluate_requirements(spec, recording).values()
    assert (judged.robustness, judged.satisfied, first_violation(judged)) == (
        result.robustness,
        result.satisfied,
        violated,
    )
    domain = ("--period", "100ms") if time == "discrete" else ("--time", "dense")
    checked = check_in_process(text, recording, *domain)
    assert (float(checked["robustness"]), checked["satisfied"], checked["first_violation"]) == (
        result.robustness,
        result.satisfied,
        violated,
    )
    cut = data.draw(st.integers(0, n))
    chunks = [
        {name: column[part] for name, column in recording.items()} for part in (slice(cut), slice(cut, None))
    ]
    try:
        streamed = rtamt.check_stream(spec, chunks)
    except rtamt.BoundError:  # below another operator unbounded future needs the whole recording
        return
    same(streamed, result)


def check_in_process(text, recording, *options):
    """Return the row that ``rtamt check`` prints."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "log.csv")
        rows = zip(recording["time"], recording["x"], strict=True)
        path.write_text("time,x\n" + "".join(f"{time},{x}\n" for time, x in rows))
        out = io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
            assert main(["check", text, str(path), "--json", *options]) < 2
    return json.loads(out.getvalue())


def test_the_right_answer_beside_a_window_over_a_constant():
    text = "once[500ms:500ms] false or always(x >= 3)"
    times = [i / 10 for i in range(9)]
    for values, violated in (([5] * 9, None), ([5, 5, 5, 1, 5, 5, 5, 5, 5], 0.0)):
        for time in ("discrete", "dense"):
            spec = rtamt.parse(text, time=time)
            result = spec.evaluate({"time": times, "x": values})
            assert first_violation(result) == violated
            same(rtamt.check_stream(spec, [{"time": times, "x": values}]), result)
    alone = rtamt.parse("historically[0:1] false").evaluate({"time": [0, 1]})
    assert first_violation(alone) == 0


@pytest.mark.parametrize("bound", ["1e300", "1e9"])
def test_a_bound_beyond_every_trace_is_rejected_where_it_stands(bound):
    with pytest.raises(rtamt.BoundError) as error:
        rtamt.parse(f"once[0:{bound}](x > 0)", time="dense")
    assert str(error.value).splitlines()[-1].strip() == "^" * (len(bound) + 4)
    assert "more than can be counted" in error.value.message
    assert len(error.value.message) < 200


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_no_minus_before_a_zero_as_in_an_evaluation(time):
    spec = rtamt.parse("not(x <= x)", time=time)
    recording = {"time": [0.0, 1.0], "x": [1.0, 2.0]}
    answers = [spec.evaluate(recording).robustness, rtamt.check_stream(spec, [recording]).robustness]
    assert list(map(str, answers)) == ["0.0", "0.0"]


def test_each_chunk_is_normalised_once(monkeypatch):
    counts = {"discrete": 0, "dense": 0}
    discrete, dense = arrays.columns_of, dense_arrays.columns_of

    def counted(time, function):
        def call(*args, **options):
            counts[time] += 1
            return function(*args, **options)

        return call

    monkeypatch.setattr(arrays, "columns_of", counted("discrete", discrete))
    monkeypatch.setattr(dense_arrays, "columns_of", counted("dense", dense))
    spec = rtamt.parse("always(x >= 3) and eventually(y >= 1); always[0:1](x >= y)")
    chunks = [{"time": [t, t + 1], "x": [5, 4], "y": [1, 0]} for t in (0, 2, 4)]
    for time in counts:
        assert rtamt.check_stream(spec, chunks, time=time).samples == 6
    assert counts == {"discrete": 3, "dense": 3}


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_robustness_and_verdicts_of_all_requirements_come_from_one_program(time, monkeypatch):
    spec = rtamt.parse("require A: always(x >= 3); require B: eventually(y >= x)", time=time)
    owner, name = (core(), "dense_evaluate") if time == "dense" else (Run, "over")
    runs = []
    run = getattr(owner, name)
    monkeypatch.setattr(owner, name, lambda *args: runs.append(args) or run(*args))
    found = evaluate_requirements(spec, {"time": [0, 1, 2], "x": [5, 4, 2], "y": [0, 0, 4]})
    assert {key: (part.robustness, part.satisfied) for key, part in found.items()} == {
        "A": (-1.0, False),
        "B": (2.0, True),
    }
    assert (first_violation(found["A"]), first_violation(found["B"])) == (2.0, None)
    assert len(runs) == 2  # one for what unbounded future reads, and one for the rest


def test_a_value_that_does_not_exist_after_all_that_is_read_is_no_error():
    # After the last sample the windows of 'once' empty, and 1/0 is read by nobody.
    spec = rtamt.parse("always(x >= 0) and eventually[0:1](1 / (once[0:5] x) > 0)", time="dense")
    data = {"x": ([0.0, 1.0, 4.0], [2, 0, 0])}
    result = spec.evaluate(data)
    assert (result.satisfied, first_violation(result)) == (True, None)
    (part,) = evaluate_requirements(spec, data).values()
    assert (part.robustness, part.satisfied) == (result.robustness, True)


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    "text",
    [
        "input bool b; float x; require X: x >= 0; require B: eventually(b == 1)",
        "input bool b; float x; require X: always(x >= 0); require B: always(b)",
        "input bool b; float x; always(x >= 0) and always(b)",
    ],
)
def test_a_number_was_a_boolean_beside_a_requirement_that_does_not_read_it(text, backend, time):
    spec = rtamt.parse(text, time=time, backend=backend)
    message = "'b' is 2 at sample 0, time 0 s, and declared as bool, which is 1 or 0"
    data = {"time": [0, 1, 2], "x": [0, 1, 2], "b": [2, 1, 1]}
    with pytest.raises(rtamt.TraceError, match=message):
        spec.evaluate(data)
    with pytest.raises(rtamt.TraceError, match=message):
        rtamt.check_stream(spec, [data])
    check = spec.domain.part("early_check")([*spec.requirements.values()])
    with pytest.raises(rtamt.TraceError, match=message):
        check.take(data)
