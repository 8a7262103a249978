"""A trace means the same wherever it starts and however its times are told: to the last bit, on every way in.

Every trace here is shifted, in whole milliseconds that are no tenths of a second, and told in doubles, integers of
a unit, or dates; what comes out is what comes out of the same trace at 0, counted in milliseconds.
"""

from __future__ import annotations

import csv
import io
import json
import sys
from dataclasses import dataclass
from fractions import Fraction
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.cli import main
from rtamt.language.units.durations import NANOSECOND
from rtamt.signals.counting import counted, quotients
from rtamt.signals.ticks import TimeScale
from tests.support import c_api

if TYPE_CHECKING:
    from collections.abc import Callable

#: Milliseconds from 0: one day in 1970, a hundred of them, and now. None is a tenth of a second.
STARTS = (0, 7, 10_000_000_003, 1_700_000_000_009, -1_700_000_000_009)
FORMULAS = (
    "always[{a}ms:{b}ms](x >= 0)",
    "always(x >= 0)",
    "always[{a}ms:inf](once[{a}ms:{b}ms](y >= 1))",
    "always(y >= 0) and always(historically[0ms:{b}ms](x >= -1))",
    "eventually[0:{b}ms]((x >= 0) since[{a}ms:{b}ms] (y >= 2))",
    "once[{b}ms:{b}ms] false or always[{a}ms:{b}ms](x + y >= 0)",
    "once[{a}ms:{b}ms](x) until[0:{b}ms] y",
)


@dataclass(frozen=True)
class Way:
    """How times are told: from milliseconds to what the caller gives, and to what comes back."""

    give: Callable[[list[int]], Any]
    back: Callable[[int], Any]
    unit: str | None = None


def seconds(ms: int) -> float:
    return ms / 1000  # of two integers: rounded once


def date(ms: int) -> np.datetime64:
    return np.datetime64(ms * 10**6, "ns")


WAYS = {
    "list": Way(lambda ms: list(map(seconds, ms)), seconds),
    "array": Way(lambda ms: np.array([t / 1000 for t in ms]), seconds),
    "fractions": Way(lambda ms: [Fraction(t, 1000) for t in ms], seconds),
    "ms": Way(lambda ms: ms, lambda t: t, "ms"),
    "ms of numpy": Way(np.array, lambda t: t, "ms"),
    "ns": Way(lambda ms: [t * 10**6 for t in ms], lambda t: t * 10**6, "ns"),
    "us as doubles": Way(lambda ms: [float(t * 1000) for t in ms], lambda t: float(t * 1000), "us"),
    "dates": Way(lambda ms: np.array(ms, "M8[ms]"), date),
    "durations": Way(lambda ms: np.array(ms, "m8[ms]"), lambda t: np.timedelta64(t * 10**6, "ns")),
}


@dataclass(frozen=True)
class Case:
    """A formula, a trace that starts at 0, in milliseconds, and what is to come out."""

    text: str
    trace: dict[str, tuple[list[int], list[float]]]
    robustness: float
    satisfied: bool
    violated: int | None
    points: list[tuple[int, float]]

    def at(self, start: int, way: Way) -> dict[str, Any]:
        return {
            name: (way.give([start + t for t in times]), values)
            for name, (times, values) in self.trace.items()
        }


@st.composite
def cases(draw: Any, grain: int = 1) -> Case:
    a = draw(st.integers(0, 4)) * grain
    b = a + draw(st.integers(0, 4)) * grain
    text = draw(st.sampled_from(FORMULAS)).format(a=a, b=b)
    trace = {}
    for name in ("x", "y"):
        gaps = draw(st.lists(st.sampled_from([1, 1, 2, 3, 7, 50]), min_size=1, max_size=7))
        times = [grain * int(t) for t in np.cumsum(gaps) - gaps[0]]
        values = [draw(st.sampled_from([-1.5, -1.0, 0.0, 1.0, 2.0])) for _ in gaps]
        if name in rtamt.parse(text).input_names:
            trace[name] = (times, values)
    result = rtamt.parse(text).evaluate(trace, time="dense", resolution=f"{grain}ms", time_unit="ms")
    violated = rtamt.first_violation(result)
    points = list(zip(result.signal.times.tolist(), result.signal.values.tolist(), strict=True))
    return Case(text, trace, result.robustness, result.satisfied, violated, points)


def same(got: Any, expected: Any) -> None:
    assert got == expected
    assert type(got) is type(expected)


def same_signal(signal: Any, case: Case, start: int, way: Way) -> None:
    expected = np.array([way.back(start + t) for t, _ in case.points])
    assert signal.times.dtype == expected.dtype
    assert signal.times.tolist() == expected.tolist()
    assert signal.values.tolist() == [value for _, value in case.points]


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
@pytest.mark.parametrize("start", STARTS)
@settings(max_examples=6)
@given(case=cases(), backend=st.sampled_from(["cpp", "python"]), data=st.data())
def test_evaluations_streams_and_monitors(
    start: int, way: Way, case: Case, backend: str, data: st.DataObject
) -> None:
    spec = rtamt.parse(case.text, backend=backend, time="dense")
    whole = case.at(start, way)
    violated = None if case.violated is None else way.back(start + case.violated)
    result = spec.evaluate(whole, time_unit=way.unit)
    same_signal(result.signal, case, start, way)
    assert (result.robustness, result.satisfied) == (case.robustness, case.satisfied)
    same(rtamt.first_violation(result), violated)
    assert rtamt.robustness(case.text, whole, time="dense", time_unit=way.unit) == case.robustness
    (batch,) = rtamt.evaluate_batch(spec, [whole], time_unit=way.unit)
    same_signal(batch.signal, case, start, way)

    chunks = split(whole, data)
    streamed = rtamt.check_stream(spec, chunks, time_unit=way.unit)
    assert (streamed.robustness, streamed.satisfied) == (case.robustness, case.satisfied)
    same(streamed.first_violation, violated)

    if spec.horizon == float("inf"):
        return
    for feed in (monitored_in_chunks, monitored_one_by_one):
        signals = feed(spec, chunks, way.unit)
        times = [t for signal in signals for t in signal.times.tolist()]
        values = [v for signal in signals for v in signal.values.tolist()]
        told = stepped(times, values)
        expected = [(way.back(start + t), v) for t, v in case.points]
        plain = np.array([t for t, _ in expected]).tolist()
        assert told == stepped(plain, [v for _, v in expected])
        pairs = [t for signal in signals for t, _ in signal.points()]
        assert [np.array(t).tolist() for t in pairs] == times


def split(whole: dict[str, Any], data: st.DataObject) -> list[dict[str, Any]]:
    cuts = {
        name: sorted(data.draw(st.lists(st.integers(0, len(v)), max_size=2)))
        for name, (_, v) in whole.items()
    }
    chunks = []
    for i in range(3):
        chunk = {}
        for name, (times, values) in whole.items():
            ends = [0, *cuts[name], len(values), len(values), len(values)]
            chunk[name] = (times[ends[i] : ends[i + 1]], values[ends[i] : ends[i + 1]])
        chunks.append(chunk)
    ends_at = {name: sum(len(chunk[name][1]) for chunk in chunks) for name in whole}
    rest = {
        name: (times[ends_at[name] :], values[ends_at[name] :]) for name, (times, values) in whole.items()
    }
    return [*chunks, rest]


def monitored_in_chunks(spec: Any, chunks: Any, unit: str | None) -> list[Any]:
    monitor = spec.monitor(time="dense", time_unit=unit)
    return [*(monitor.update_many(chunk) for chunk in chunks), monitor.finish()]


def monitored_one_by_one(spec: Any, chunks: Any, unit: str | None) -> list[Any]:
    """The quick way in: of a C++ monitor, without arrays."""
    monitor = spec.monitor(time="dense", time_unit=unit)
    told = []
    for chunk in chunks:
        for name, (times, values) in chunk.items():
            told += [monitor.update(t, **{name: v}) for t, v in zip(times, values, strict=True)]
    return [*told, monitor.finish()]


def stepped(times: list[Any], values: list[float]) -> list[tuple[Any, float]]:
    """Return a step function as its changes alone."""
    changes: list[tuple[Any, float]] = []
    for time, value in zip(times, values, strict=True):
        if not changes or changes[-1][1] != value:
            changes.append((time, value))
    return changes


@pytest.mark.parametrize("start", STARTS)
@settings(max_examples=6)
@given(case=cases(grain=3))
def test_a_tick_that_is_no_fraction_of_a_second(start: int, case: Case) -> None:
    start -= start % 3
    for way in WAYS.values():
        spec = rtamt.parse(case.text, time="dense", resolution="3ms")
        result = spec.evaluate(case.at(start, way), time_unit=way.unit)
        same_signal(result.signal, case, start, way)
        violated = None if case.violated is None else way.back(start + case.violated)
        same(rtamt.first_violation(result), violated)
        streamed = rtamt.check_stream(spec, [case.at(start, way)], time_unit=way.unit)
        same(streamed.first_violation, violated)


@pytest.mark.parametrize("unit", ["s", "ms", "ns"])
@pytest.mark.parametrize("start", STARTS)
@settings(max_examples=5)
@given(case=cases())
def test_files_and_the_command_line(start: int, unit: str, case: Case, tmp_path_factory: Any) -> None:
    rows: dict[int, dict[str, Any]] = {}
    for name, (times, values) in case.trace.items():
        for t, v in zip(times, values, strict=True):
            rows.setdefault(t, {})[name] = v
    told = {"s": lambda ms: repr(ms / 1000), "ms": str, "ns": lambda ms: str(ms * 10**6)}[unit]
    path = tmp_path_factory.mktemp("law") / "log.csv"
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, [f"time [{unit}]", *case.trace])
        writer.writeheader()
        writer.writerows({f"time [{unit}]": told(start + t), **row} for t, row in sorted(rows.items()))
    read = rtamt.read(path)
    result = rtamt.parse(case.text).evaluate(read, time="dense")
    assert (result.robustness, result.satisfied) == (case.robustness, case.satisfied)
    violated = rtamt.first_violation(result)
    assert (None if violated is None else millis(violated) - start) == case.violated

    code, out = command("check", case.text, str(path), "--time", "dense", "--json")
    answer = json.loads(out, parse_float=Fraction)
    assert code == (0 if case.satisfied else 1)
    assert answer["satisfied"] is case.satisfied
    assert (
        None if answer["first_violation"] is None else answer["first_violation"] * 1000 - start
    ) == case.violated

    if rtamt.parse(case.text).horizon == float("inf"):
        return
    code, out = command("monitor", case.text, "--time", "dense", stdin=path.read_bytes())
    assert code == 0
    lines = [json.loads(line, parse_float=Fraction) for line in out.splitlines()]
    told_points = stepped(
        [line["time"] * 1000 - start for line in lines], [float(line["robustness"]) for line in lines]
    )
    assert told_points == stepped([t for t, _ in case.points], [v for _, v in case.points])


def millis(time: Any) -> Fraction:
    if isinstance(time, np.timedelta64):
        return Fraction(int(time.astype("m8[ns]").astype(np.int64)), 10**6)
    return Fraction(repr(time)) * 1000


def command(*args: str, stdin: bytes = b"") -> tuple[int, str]:
    """Run the command line, return its exit code and what it prints."""
    before = sys.stdin, sys.stdout
    text = io.BytesIO(stdin)
    sys.stdin, sys.stdout = SimpleNamespace(buffer=text, isatty=lambda: False), io.StringIO()
    try:
        code = main(args)
        return code, sys.stdout.getvalue()
    finally:
        sys.stdin, sys.stdout = before


@pytest.mark.parametrize("start", STARTS)
@settings(max_examples=8)
@given(case=cases())
def test_rtamts_classes_and_compiled_programs(start: int, case: Case) -> None:
    spec = rtamt.StlDenseTimeSpecification()
    for name in case.trace:
        spec.declare_var(name, "float")
    spec.spec = case.text
    spec.parse()
    given_points = [
        [n, [[seconds(start + t), v] for t, v in zip(*s, strict=True)]] for n, s in case.trace.items()
    ]
    assert spec.evaluate(*given_points) == [[seconds(start + t), v] for t, v in case.points]

    if rtamt.parse(case.text).horizon == float("inf"):
        return
    program = rtamt.parse(case.text).compile(time="dense")
    monitor = c_api.Monitor(program.to_bytes())
    samples = sorted(
        (start * 10**6 + t * 10**6, program.inputs.index(n), v)
        for n, s in case.trace.items()
        for t, v in zip(*s, strict=True)
    )
    told = [*(monitor.push([(i, t, v)]) for t, i, v in samples), monitor.finish()]
    ticks = [t // 10**6 - start for steps, _ in told for t in steps.tolist()]
    values = [v for _, found in told for v in found.tolist()]
    assert stepped(ticks, values) == stepped([t for t, _ in case.points], [v for _, v in case.points])


def test_streamed_a_dip_at_an_epoch_time_is_a_violation() -> None:
    spec = rtamt.parse("always[1ms:1ms](x >= 0)", time="dense")
    chunks = [{"x": [[1700000000.009, 5.0]]}, {"x": [[1700000000.010, -1.0]]}]
    result = rtamt.check_stream(spec, chunks)
    assert (result.robustness, result.satisfied, result.first_violation) == (-1.0, False, 1700000000.01)


# ---- discrete time -------------------------------------------------------------------------------


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS)
@pytest.mark.parametrize("start", STARTS)
@settings(max_examples=5)
@given(
    values=st.lists(st.sampled_from([-1.0, 1.0, 2.0]), min_size=1, max_size=8),
    lag=st.integers(0, 2),
    backend=st.sampled_from(["cpp", "python"]),
    data=st.data(),
)
def test_discrete_stamps_come_back_as_they_were_given(
    start: int, way: Way, values: list[float], lag: int, backend: str, data: st.DataObject
) -> None:
    text = f"always(eventually[0:{7 * lag}ms](x >= 0))"
    timestamps = [start + 7 * i for i in range(len(values))]
    recording = {"time": way.give(timestamps), "x": values}
    spec = rtamt.parse(text, period="7ms", backend=backend)
    result = spec.evaluate(recording, time_unit=way.unit)
    expected = np.array([way.back(t) for t in timestamps])
    assert result.signal.times.dtype == expected.dtype
    assert result.signal.times.tolist() == expected.tolist()
    violated = next((i for i in range(len(values)) if max(values[i : i + lag + 1]) < 0), None)
    same(rtamt.first_violation(result), None if violated is None else way.back(timestamps[violated]))

    cut = data.draw(st.integers(0, len(values)))
    chunks = [
        {name: column[part] for name, column in recording.items()} for part in (slice(cut), slice(cut, None))
    ]
    streamed = rtamt.check_stream(spec, chunks, time_unit=way.unit)
    same(streamed.first_violation, None if violated is None else way.back(timestamps[violated]))
    assert (streamed.robustness, streamed.satisfied) == (result.robustness, result.satisfied)

    online = rtamt.parse(f"eventually[0:{7 * lag}ms](x >= 0)", period="7ms", backend=backend)
    monitor = online.monitor(time_unit=way.unit)
    signals = [*(monitor.update_many(chunk) for chunk in chunks), monitor.finish()]
    assert [t for signal in signals for t in signal.times.tolist()] == expected.tolist()
    if way.unit is not None:
        monitor.reset()
        told = [monitor.update(t, x=x) for t, x in zip(recording["time"], values, strict=True)]
        assert told.count(None) == min(lag, len(values))
        assert monitor.finish().times.tolist() == expected.tolist()[len(values) - min(lag, len(values)) :]


# ---- ticks and times -----------------------------------------------------------------------------

TICKS = st.sampled_from(
    [NANOSECOND, Fraction(1, 10**6), Fraction(1, 1000), Fraction(1, 3), Fraction(3, 10**9)]
)


@given(st.lists(st.integers(-(2**61), 2**61), min_size=1, max_size=20), TICKS)
def test_ticks_are_told_as_the_nearest_double_that_is_not_read_as_an_earlier_tick(
    ticks: list[int], tick: Fraction
) -> None:
    scale = TimeScale(tick, "seconds")
    told = scale.times(np.array(ticks)).tolist()
    for t, time in zip(ticks, told, strict=True):
        nearest = t * tick.numerator / tick.denominator
        if counted(np.array([nearest]), 1 / tick)[0] < t:
            assert time == np.nextafter(nearest, np.inf)
            assert counted(np.array([time]), 1 / tick)[0] >= t
        else:
            assert time == nearest
    assert [scale.time(t) for t in ticks] == told


@given(st.lists(st.floats(-(2.0**31), 2.0**31), min_size=1, max_size=20), TICKS)
def test_a_double_comes_back_where_doubles_are_further_apart_than_ticks(
    doubles: list[float], tick: Fraction
) -> None:
    scale = TimeScale(tick, "seconds")
    ticks = scale.ticks(np.array(doubles), "x")
    assert ticks.tolist() == scale.ticks(doubles, "x").tolist()
    back = scale.times(ticks)
    assert scale.ticks(back, "x").tolist() == ticks.tolist(), "what is told means the same tick again"
    for double, told in zip(doubles, back.tolist(), strict=True):
        assert told == double or np.spacing(abs(double)) < tick


@given(st.integers(-(2**50), 2**50), TICKS)
def test_ticks_near_0_come_back_from_doubles(number: int, tick: Fraction) -> None:
    number %= min(2**50, int(10**11 / tick))  # further away a number is no time in seconds
    scale = TimeScale(tick, "seconds")
    assert scale.ticks(scale.times(np.array([number])), "x").tolist() == [number]


@given(st.integers(2**53, 2**62), st.integers(1, 2**20), st.integers(1, 2**40))
def test_quotients_are_rounded_once(number: int, numerator: int, denominator: int) -> None:
    numbers = np.array([number, -number, number - 1, 7])
    assert quotients(numbers, numerator, denominator).tolist() == [
        n * numerator / denominator for n in numbers.tolist()
    ]
