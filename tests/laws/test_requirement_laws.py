"""Several requirements in a text: their minimum is the robustness of all, their conjunction the verdict."""

from __future__ import annotations

import contextlib
import io
import json
import re
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conformance.cases import FILES, read
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.cli import main
from rtamt.errors import EvaluationError
from rtamt.fmi.variables import variables_of
from rtamt.language.formula import Apply, Formula, Var, fold
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document
from rtamt.violations import first_violation
from tests.support import c_api
from tests.support.strategies import chunkings, dense_traces, formulas, traces

DECLARED = "float x  float y  "


@st.composite
def several(draw: st.DrawFn, **more: Any) -> tuple[str, list[Formula]]:
    """Draw a text of two to four requirements, and their formulas."""
    drawn = draw(st.lists(formulas(max_depth=3, **more), min_size=2, max_size=4))
    written = [f"({formula}) >= 0" if is_number(formula) else str(formula) for formula in drawn]
    explicit = draw(st.booleans())
    parts = [f"require R-{i}: {text}" if explicit else text for i, text in enumerate(written)]
    return DECLARED + "; ".join(parts), [parse_formula(text) for text in written]


def value_at(signal: Any, times: Any) -> Any:
    """Return the value of a signal at each of the times: +inf before it starts."""
    values = signal.values[np.maximum(np.searchsorted(signal.times, times, side="right") - 1, 0)]
    return np.where(times < signal.times[0], np.inf, values)


def minimum(signals: list[Any], times: Any) -> Any:
    return np.minimum.reduce([value_at(signal, times) for signal in signals])


@settings(max_examples=40)
@given(several(unbounded_future=True), traces(), st.sampled_from(("cpp", "python")))
def test_discrete_evaluation(drawn: tuple[str, list[Formula]], columns: dict[str, Any], backend: str) -> None:
    text, alone = drawn
    spec = rtamt.parse(text, backend=backend)
    assume(spec.input_names)
    assert [part.formula for part in spec.requirements.values()] == alone
    try:
        result = spec.evaluate(columns)
        parts = list(result.requirements.values())
        singly = [rtamt.parse(f"{DECLARED}{formula}", backend=backend).evaluate(columns) for formula in alone]
    except EvaluationError:
        return
    np.testing.assert_array_equal(
        result.signal.values, minimum([part.signal for part in parts], result.signal.times)
    )
    for part, single in zip(parts, singly, strict=True):
        np.testing.assert_array_equal(part.signal.values, single.signal.values)
        assert (part.satisfied, first_violation(part)) == (single.satisfied, first_violation(single))
    assert result.robustness == min(part.robustness for part in parts)
    assert result.satisfied is all(part.satisfied for part in parts)
    when = [first_violation(part) for part in parts if not part.satisfied]
    assert first_violation(result) == min(when, default=None)


@settings(max_examples=40)
@given(several(discrete=False, unbounded_future=True), dense_traces(), st.sampled_from(("cpp", "python")))
def test_dense_evaluation(drawn: tuple[str, list[Formula]], trace: Any, backend: str) -> None:
    spec = rtamt.parse(drawn[0], backend=backend, time="dense", resolution=1)
    assume(spec.input_names)
    data = {name: (times.astype(float), values) for name, (times, values) in trace.items()}
    try:
        result = spec.evaluate(data)
        parts = list(result.requirements.values())
        satisfied = [part.satisfied for part in parts]
    except EvaluationError:
        return
    for part in parts:
        assert part.signal.times[-1] == result.signal.times[-1]
        if part.specification.input_names:
            assert_same(part, part.specification.evaluate(data))
    times = np.unique(np.concatenate([part.signal.times for part in (result, *parts)]))
    np.testing.assert_array_equal(
        value_at(result.signal, times), minimum([part.signal for part in parts], times)
    )
    assert result.signal.times[0] == min(part.signal.times[0] for part in parts)
    assert (result.robustness, result.satisfied) == (min(part.robustness for part in parts), all(satisfied))
    when = [first_violation(part) for part in parts if not part.satisfied]
    assert first_violation(result) == min(when, default=None)


def assert_same(part: rtamt.Result, alone: rtamt.Result) -> None:
    """A requirement means the same in a file as alone, where it is reported up to its own last sample only."""
    told = [(each.robustness, each.satisfied, first_violation(each)) for each in (part, alone)]
    assert told[0] == told[1]
    assert part.signal.times[0] == alone.signal.times[0]
    np.testing.assert_array_equal(value_at(part.signal, alone.signal.times), alone.signal.values)
    np.testing.assert_array_equal(
        value_at(part.signal, times := part.signal.times[part.signal.times <= alone.signal.times[-1]]),
        value_at(alone.signal, times),
    )


@settings(max_examples=40)
@given(several(), traces(), st.sampled_from(("standard", "boolean")))
def test_monitor(drawn: tuple[str, list[Formula]], columns: dict[str, Any], semantics: str) -> None:
    spec = rtamt.parse(drawn[0])
    names = list(spec.requirements)
    data = {name: columns[name] for name in spec.input_names}
    assume(data)
    monitor = spec.monitor(watch=names, semantics=semantics)
    overall, each = [], {name: [] for name in names}
    try:
        for i in range(len(columns["x"])):
            known = monitor.update(float(i), **{name: float(column[i]) for name, column in data.items()})
            overall += [] if known is None else [known]
            for name in names:
                value = monitor[name]
                each[name] += [] if value is None else [value]
        overall += monitor.finish().values.tolist()
        for name in names:
            each[name] += monitor[name].values.tolist()
    except EvaluationError:
        return
    np.testing.assert_array_equal(overall, np.minimum.reduce([each[name] for name in names]))


@settings(max_examples=30)
@given(st.data(), st.booleans())
def test_chunks(data: st.DataObject, dense: bool) -> None:
    text, _ = data.draw(several(discrete=not dense))
    spec = rtamt.parse(text, **({"time": "dense", "resolution": 1} if dense else {}))
    columns = data.draw(traces())
    n = len(columns["x"])
    assume(spec.input_names)
    whole = {"time": np.arange(n, dtype=float), **columns}
    ends = np.cumsum(data.draw(chunkings(n)))
    chunks = [
        {k: v[a:b] for k, v in whole.items()} for a, b in zip([0, *ends[:-1]], ends, strict=True) if b > a
    ]
    try:
        if dense:
            chunks = [{k: (c["time"], v) for k, v in c.items() if k != "time"} for c in chunks]
            result = spec.evaluate({k: (whole["time"], v) for k, v in columns.items()})
        else:
            result = spec.evaluate(whole)
        found = rtamt.check_stream(spec, chunks, **({} if dense else {"period": 1}))
        parts = {
            name: (p.robustness, p.satisfied, first_violation(p)) for name, p in result.requirements.items()
        }
    except EvaluationError:
        return
    assert (found.robustness, found.satisfied) == (result.robustness, result.satisfied)
    assert found.first_violation == first_violation(result)
    told = {name: (p.robustness, p.satisfied, p.first_violation) for name, p in found.requirements.items()}
    assert told == parts
    assert found.minimum == min(part.minimum for part in found.requirements.values())


@settings(max_examples=30)
@given(several(), traces())
def test_program(drawn: tuple[str, list[Formula]], columns: dict[str, Any]) -> None:
    spec = rtamt.parse(drawn[0])
    program = spec.compile()
    names = [f".{name}" for name in spec.requirements]
    assert program.metadata is not None
    assert program.metadata.outputs == tuple(
        f"{o}{n}" for n in ("", *names) for o in ("robustness", "verdict")
    )
    declared = [variable.name for variable in variables_of(program, {}, {})]
    assert all(f"known_since{name}" in declared for name in names)
    monitor = c_api.Monitor(program.to_bytes())
    known: list[list[float]] = [[] for _ in program.metadata.outputs]
    rows = [[float(columns[name][i]) for name in spec.input_names] for i in range(len(columns["x"]))]
    try:
        for row in rows:
            for values, value in zip(known, monitor.step(row, len(known)), strict=True):
                values.extend([] if value is None else [value])
        monitor.finish()
    except c_api.RefusedError:
        return
    for output, values in enumerate(known):
        values.extend(monitor.last_output(output)[1].tolist())
        assert len(values) == len(rows)
    for which in (0, 1):
        np.testing.assert_array_equal(known[which], np.minimum.reduce(known[2 + which :: 2]))


@settings(max_examples=15)
@given(several(unbounded_future=True), traces(), st.booleans(), st.booleans())
def test_check(drawn: tuple[str, list[Formula]], columns: dict[str, Any], dense: bool, large: bool) -> None:
    spec = rtamt.parse(drawn[0])
    assume(spec.input_names)
    domain = ("--time", "dense") if dense else ("--period", "1s")
    with tempfile.TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        if large:
            patch.setattr("rtamt.cli.runner.LARGE", 0)
        Path("spec.stl").write_text(drawn[0], encoding="utf-8")
        rows = zip(range(len(columns["x"])), columns["x"], columns["y"], strict=True)
        Path("log.csv").write_text(
            "t,x,y\n" + "".join(f"{t},{x},{y}\n" for t, x, y in rows), encoding="utf-8"
        )
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = main(["check", "spec.stl", "log.csv", "--json", *domain])
    assume(code != 2)
    told = [json.loads(line) for line in out.getvalue().splitlines()]
    result = (
        spec.evaluate(columns, period=1)
        if not dense
        else spec.evaluate(
            {name: (np.arange(len(values), dtype=float), values) for name, values in columns.items()},
            time="dense",
        )
    )
    assert [float(row["robustness"]) for row in told] == [p.robustness for p in result.requirements.values()]
    assert [row["satisfied"] for row in told] == [p.satisfied for p in result.requirements.values()]
    assert min(float(row["robustness"]) for row in told) == result.robustness
    assert code == (0 if result.satisfied else 1)


def test_a_thousand_requirements_are_no_deep_recursion() -> None:
    text = "\n".join(f"require R{i}: always(x >= {i % 7} -> eventually[0:1](y >= {i}))" for i in range(1000))
    spec = rtamt.parse(text)
    result = spec.evaluate({"x": [1.0, 2.0], "y": [1.0, 900.0]})
    assert first_violation(result) == 0
    assert min(part.robustness for part in result.requirements.values()) == result.robustness
    assert len(str(spec).split(" and ")) == 1000


CORPUS = sorted({case.formula for name in FILES for case in read(name)})


#: The words that files have gained; the corpus has none of them as an operator.
WORDS = (
    *("require", "severity", "def", "import", "sample", "hold", "parameter", "table", "enum"),
    *("group", "forall", "exists", "count", "where"),
)


@pytest.mark.parametrize("word", WORDS)
def test_the_corpus_with_a_word_of_files_as_a_variable_means_what_it_meant(word: str) -> None:
    for text in CORPUS[WORDS.index(word) % 3 :: 3]:
        renamed = re.sub(r"\bx\b", word, text)
        before = parse_document(text).formula
        assert parse_document(renamed).formula == fold(
            before,
            lambda node, args: (
                Var(word)
                if node == Var("x")
                else replace(node, args=args)
                if isinstance(node, Apply)
                else node
            ),
        )
