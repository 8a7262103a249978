"""In dense time each requirement of a file starts with its own variables: one answer at every entry point."""

from __future__ import annotations

import copy
import io
import json
import pickle
import sys
import tempfile
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.batch import evaluate_requirements
from rtamt.cli import main
from rtamt.errors import EvaluationError, UsageError
from rtamt.language.parsing.grammar import is_number
from rtamt.violations import first_violation
from tests.support import strategies

VARIABLES = ("x", "y", "z")
DECLARED = "input float x  input float y  input float z  "


@st.composite
def files(draw: st.DrawFn, **more: Any) -> tuple[rtamt.Specification, dict[str, Any]]:
    """Draw requirements over some of three variables each, and a recording in which each variable starts on its own."""
    texts = []
    for i in range(draw(st.integers(2, 4))):
        names = draw(st.lists(st.sampled_from(VARIABLES), min_size=1, max_size=2, unique=True))
        formula = draw(strategies.formulas(3, tuple(names), discrete=False, **more))
        texts.append(f"require R{i}: {f'({formula}) >= 0' if is_number(formula) else formula}")
    backend = draw(st.sampled_from(("cpp", "cpp", "python")))
    spec = rtamt.parse(DECLARED + "; ".join(texts), time="dense", resolution=1, backend=backend)
    assume(spec.input_names)
    trace = draw(strategies.dense_traces(VARIABLES, max_size=6))
    return spec, {name: trace[name] for name in spec.input_names}


def seconds(trace: dict[str, Any]) -> dict[str, Any]:
    return {name: (times.astype(float), values) for name, (times, values) in trace.items()}


def value_at(signal: Any, times: Any) -> Any:
    values = signal.values[np.maximum(np.searchsorted(signal.times, times, side="right") - 1, 0)]
    return np.where(times < signal.times[0], np.inf, values)


def pickle_round_trip(monitor: Any) -> Any:
    return pickle.loads(pickle.dumps(monitor))


def outcome_of(result: Any) -> tuple[float, bool, Any]:
    when = result.first_violation if hasattr(result, "first_violation") else first_violation(result)
    return result.robustness, result.satisfied, when


@settings(max_examples=60)
@given(files(unbounded_future=True, arithmetic=False), st.data())
def test_evaluate_judge_streams_and_each_requirement_alone(drawn: Any, data: st.DataObject) -> None:
    spec, trace = drawn
    result = spec.evaluate(seconds(trace))
    parts = result.requirements
    for name, alone in spec.requirements.items():
        whole = alone.evaluate(seconds(trace)) if alone.input_names else parts[name]
        assert outcome_of(parts[name]) == outcome_of(whole)
        inside = whole.signal.times
        np.testing.assert_array_equal(value_at(parts[name].signal, inside), whole.signal.values)
    assert {name: outcome_of(part) for name, part in evaluate_requirements(spec, seconds(trace)).items()} == {
        name: outcome_of(part) for name, part in parts.items()
    }
    violations = [first_violation(part) for part in parts.values() if not part.satisfied]
    assert outcome_of(result) == (
        min(part.robustness for part in parts.values()),
        not violations,
        min(violations, default=None),
    )
    times = np.unique(np.concatenate([each.signal.times for each in (result, *parts.values())]))
    lowest = np.minimum.reduce([value_at(part.signal, times) for part in parts.values()])
    np.testing.assert_array_equal(value_at(result.signal, times), lowest)
    assert result.signal.times[0] == times[0]
    chunks = [seconds(chunk) for chunk in data.draw(strategies.dense_chunkings(trace))]
    try:
        streamed = rtamt.check_stream(spec, chunks)
    except rtamt.BoundError:  # unbounded future below another operator needs the whole recording
        return
    assert outcome_of(streamed) == outcome_of(result)
    assert {name: outcome_of(part) for name, part in streamed.requirements.items()} == {
        name: outcome_of(part) for name, part in parts.items()
    }


@settings(max_examples=60)
@given(files(), st.data())
def test_a_monitor_gives_what_the_evaluation_gives(drawn: Any, data: st.DataObject) -> None:
    spec, trace = drawn
    names = list(spec.requirements)
    updates = [seconds(chunk) for chunk in data.draw(strategies.dense_chunkings(trace))]
    branch = data.draw(st.integers(0, len(updates)))
    try:
        result = spec.evaluate(seconds(trace))
    except EvaluationError:
        return
    monitor = spec.monitor(time="dense", watch=names)
    every: dict[str, list[Any]] = {name: [] for name in ("", *names)}

    def take(signal: Any) -> None:
        for name, before in every.items():
            known = monitor[name] if name else signal
            assert not len(known) or not before or known.times[0] > before[-1].times[-1]
            before.extend([known] if len(known) else [])

    try:
        for i, update in enumerate(updates):
            if i == branch:  # a copy goes on where the monitor stood
                monitor = data.draw(st.sampled_from((copy.copy, pickle_round_trip)))(monitor)
            take(monitor.update_many(update))
        take(monitor.finish())
    except EvaluationError:  # of an instant that no value of the evaluation depends on
        return
    expected = {"": result.signal, **{name: part.signal for name, part in result.requirements.items()}}
    for name, signals in every.items():
        times = np.concatenate([signal.times for signal in signals])
        values = np.concatenate([signal.values for signal in signals])
        online = SimpleNamespace(times=times, values=values)
        assert (times[0], times[-1]) == (expected[name].times[0], expected[name].times[-1])
        at = np.union1d(times, expected[name].times)
        np.testing.assert_array_equal(value_at(online, at), value_at(expected[name], at))


@settings(max_examples=25)
@given(files(arithmetic=False), st.booleans())
def test_the_commands_give_what_the_evaluation_gives(drawn: Any, large: bool) -> None:
    spec, trace = drawn
    # The commands count the ticks of rise and fall in nanoseconds.
    result = rtamt.parse(spec.text, time="dense", backend=spec.backend).evaluate(seconds(trace))
    times = np.unique(np.concatenate([ticks for ticks, _ in trace.values()]))
    columns = {
        name: dict(zip(*map(np.ndarray.tolist, column), strict=True)) for name, column in trace.items()
    }
    rows = [f"{t}," + ",".join(str(columns[name].get(t, "")) for name in columns) for t in times.tolist()]
    table = "\n".join([",".join(("t", *columns)), *rows])
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        if large:
            patch.setattr("rtamt.cli.runner.LARGE", 0)
        Path("spec.stl").write_text(spec.text, encoding="utf-8")
        Path("log.csv").write_text(table, encoding="utf-8")
        options = ("--time", "dense", "--backend", spec.backend)
        rows = [
            json.loads(line) for line in command(patch, ["check", "spec.stl", "log.csv", "--json", *options])
        ]
        lines = [json.loads(line) for line in command(patch, ["monitor", "spec.stl", *options], table)]
    assert [(float(row["robustness"]), row["satisfied"], row["first_violation"]) for row in rows] == [
        outcome_of(part) for part in result.requirements.values()
    ]
    at = np.array([line["time"] for line in lines])
    np.testing.assert_array_equal([float(line["robustness"]) for line in lines], value_at(result.signal, at))
    for name, part in result.requirements.items():
        values = [float(line["requirements"].get(name, "inf")) for line in lines]
        np.testing.assert_array_equal(values, value_at(part.signal, at))


def command(patch: pytest.MonkeyPatch, args: list[str], stdin: str = "") -> list[str]:
    """Run the command line in this process; return the lines it printed."""
    out = io.StringIO()
    patch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(stdin.encode())))
    patch.setattr(sys, "stdout", out)
    assert main(args) < 2
    return out.getvalue().splitlines()


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_failed_update_moves_no_requirement(backend: str) -> None:
    text = "require A: once(sqrt(x) >= 0); require B: historically(sqrt(y) >= 0); require C: always[0:1](x + y >= 0)"
    spec = rtamt.parse(text, time="dense", resolution=1, backend=backend)
    monitor = spec.monitor(time="dense", watch=["A", "B", "C"])
    monitor.update(0.0, x=1, y=2)
    monitor.update(1.0, x=2, y=1)
    for bad in ({"x": -1}, {"y": -1}, {"x": -1, "y": 3}, {"x": 1, "y": -1}):
        before = pickle.dumps(monitor), [str(monitor[name]) for name in "ABC"]
        with pytest.raises(EvaluationError) as error:
            monitor.update_many(
                {name: ([2.0, 3.0], [value, 1]) for name, value in {"x": 1, "y": 1, **bad}.items()}
            )
        assert str(error.value).startswith(f"'sqrt({'x' if bad.get('x') == -1 else 'y'})'")
        assert (pickle.dumps(monitor), [str(monitor[name]) for name in "ABC"]) == before
    untouched = spec.monitor(time="dense")
    for time, x, y in ((0.0, 1, 2), (1.0, 2, 1)):
        untouched.update(time, x=x, y=y)
    assert str(monitor.update(3.0, x=1, y=1)) == str(untouched.update(3.0, x=1, y=1))
    assert str(monitor.finish()) == str(untouched.finish())


def test_what_has_no_single_start_is_explained_requirement_by_requirement() -> None:
    spec = rtamt.parse("require slow: always(v <= 3); require near: always(d >= 1)", time="dense")
    result = spec.evaluate({"v": ([0.0, 1.0], [5, 2]), "d": ([0.5, 2.0], [4, 3])})
    with pytest.raises(UsageError) as error:
        result.explain()
    assert str(error.value) == (
        "the requirements start at different times, 'slow' at 0 s and 'near' at 0.5 s; explain one of them, such as "
        "result.requirements['slow']"
    )
    assert result.requirements["slow"].explain().critical.time == 0.0
    assert result["slow"].values.tolist() == result.requirements["slow"].signal.values.tolist()


def test_many_specifications_over_one_recording_start_as_each_alone() -> None:
    specs = [
        rtamt.parse(text, time="dense", resolution=1)
        for text in ("require A: always(x <= 3); require B: once(y >= 1)", "always(x <= 3)", "x + y >= 9")
    ]
    data = {"x": ([0.0, 1.0, 5.0], [5, 2, 1]), "y": ([2.0, 3.0], [4, 3])}
    alone = [spec.evaluate({name: data[name] for name in spec.input_names}) for spec in specs]
    found = rtamt.evaluate_all(specs, data)
    assert [outcome_of(result) for result in found] == [outcome_of(result) for result in alone]
    assert found[0].robustness == -2.0
    assert [str(result.signal) for result in found] == [str(result.signal) for result in alone]
