"""A fleet against one monitor for each key: the same bits, whatever comes in which order."""

from __future__ import annotations

import contextlib
import struct
import zlib
from math import floor
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.engine.discrete.fleet import DiscreteFleet
from rtamt.engine.discrete.monitor import Monitor
from rtamt.errors import EvaluationError, TraceError, UsageError
from rtamt.language.formula import Apply
from rtamt.language.operators import STL
from rtamt.language.printing.printer import to_text
from rtamt.signals.discrete import Discrete
from tests.support.strategies import formulas

if TYPE_CHECKING:
    from rtamt.language.formula import Formula

NAMES = ("x", "y")
NUMBERS = st.integers(-9, 8).map(lambda k: -0.0 if k == -9 else k / 2)


def bits(value: float) -> bytes:
    return struct.pack("<d", value + 0.0)  # of two zeros a minimum may be either


class Alone:
    """One monitor for each key; a batch that fails changes none."""

    def __init__(self, formula: Formula, domain: Discrete) -> None:
        self.formula, self.domain = formula, domain
        self.monitors: dict[Any, Monitor] = {}
        self.times: dict[Any, list[float]] = {}

    def update(
        self, keys: list[Any], times: list[float], rows: list[dict[str, float]]
    ) -> list[tuple[Any, ...]]:
        before = {key: monitor.__copy__() for key, monitor in self.monitors.items()}
        seen = {key: list(times) for key, times in self.times.items()}
        found = []
        try:
            for key, time, row in zip(keys, times, rows, strict=True):
                monitor = self.monitors.setdefault(key, Monitor(self.formula, self.domain))
                value = monitor.update(time, **{name: row[name] for name in monitor.input_names})
                past = self.times.setdefault(key, [])
                past.append(time)
                lag = monitor._lags[0]
                known = value is not None
                found.append((known, bits(value) if known else b"", past[-1 - lag] if known else None))
        except (TraceError, EvaluationError):
            self.monitors, self.times = before, seen
            raise
        return found

    def drop(self, key: Any) -> None:
        del self.monitors[key], self.times[key]


def taken(fleet: DiscreteFleet, keys: list[Any], times: list[float], rows: list[dict[str, float]]) -> Any:
    columns = {name: np.array([row[name] for row in rows]) for name in NAMES}
    ((values, known, when, warming),) = fleet.update(np.array(keys), np.array(times), columns)
    assert not warming.any()
    return [
        (bool(k), bits(v) if k else b"", float(t) if k else None)
        for v, k, t in zip(values, known, when, strict=True)
    ]


def clone(fleet: DiscreteFleet, monitor: Monitor) -> DiscreteFleet:
    return DiscreteFleet(monitor, 0, state=fleet.snapshot())


@settings(max_examples=120, deadline=None)
@given(st.data())
def test_a_fleet_reports_what_a_monitor_of_each_key_does_bit_for_bit(data: st.DataObject) -> None:
    formula = data.draw(formulas(max_depth=4))
    domain = Discrete(period=1, tolerance=0.25)
    monitor = Monitor(formula, domain)
    names = data.draw(
        st.sampled_from([[3, -1, 2**40], ["a", "Ä€\U0001f600", "long-" * 9], [b"a", b"\xff", b"abcdefghi"]])
    )
    fleet, alone = DiscreteFleet(monitor, 3), Alone(formula, domain)
    clocks = {key: data.draw(st.sampled_from([0.0, -7.5, 1e9])) for key in names}
    for _ in range(data.draw(st.integers(1, 6))):
        keys = data.draw(st.lists(st.sampled_from(names), min_size=1, max_size=12))
        times, rows = [], []
        ahead = dict(clocks)
        for key in keys:
            ahead[key] += data.draw(st.sampled_from([1.0, 1.0, 1.0, 1.0, 1.125, 0.75]))
            times.append(ahead[key])
            rows.append({name: data.draw(NUMBERS) for name in NAMES})
        if data.draw(st.booleans()):
            at = data.draw(st.integers(0, len(keys) - 1))
            wrong = data.draw(st.sampled_from(["gap", "back", "nan", "none"]))
            if wrong == "nan" and monitor.input_names:
                rows[at][monitor.input_names[0]] = np.nan
            elif wrong in ("gap", "back") and (keys[at] in alone.monitors or keys[at] in keys[:at]):
                times[at] += 5.0 if wrong == "gap" else -5.0
        try:
            expected = alone.update(keys, times, rows)
        except (TraceError, EvaluationError) as error:  # wrong data comes first, wherever it is in the batch
            with pytest.raises((type(error), TraceError)) as caught:
                taken(fleet, keys, times, rows)
            assert "of the batch: " in str(caught.value)
        else:
            clocks = ahead
            assert taken(fleet, keys, times, rows) == expected
        assert sorted(fleet.keys()) == sorted(alone.monitors)
        if alone.monitors and data.draw(st.booleans()):
            gone = data.draw(st.sampled_from(sorted(alone.monitors)))
            assert fleet.drop(np.array([gone])) is None
            alone.drop(gone)
        if data.draw(st.booleans()):
            fleet = clone(fleet, monitor)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_a_failed_batch_is_reported_as_the_monitor_of_the_key_does(data: st.DataObject) -> None:
    arithmetic = data.draw(formulas(max_depth=2))
    quotient = data.draw(st.sampled_from(["x / y >= 0", "sum[0:2](x / y) >= 1", "x / maximum[0:1](y) >= 0"]))
    formula = Apply(STL["and"], (rtamt.parse(quotient).formula, arithmetic))
    monitor = Monitor(formula)
    fleet, alone = DiscreteFleet(monitor, 10), Alone(formula, Discrete(period=1))
    n = data.draw(st.integers(1, 12))
    rows = [{name: data.draw(NUMBERS) for name in NAMES} for _ in range(n)]
    at = data.draw(st.integers(0, n - 1))
    rows[at] = rows[max(at - 1, 0)] = {"x": 0.0, "y": 0.0}
    times = list(map(float, range(n)))
    with pytest.raises(EvaluationError) as expected:
        alone.update([7] * n, times, rows)
    with pytest.raises(EvaluationError) as caught:
        taken(fleet, [7] * n, times, rows)
    index, _, message = str(caught.value).removeprefix("key 7 at index ").partition(" of the batch: ")
    assert message == str(expected.value)
    assert len(fleet) == 0
    assert isinstance(taken(fleet, [7] * int(index), times[: int(index)], rows[: int(index)]), list)


@settings(max_examples=60, deadline=None)
@given(st.data())
def test_after_a_change_of_the_requirement_what_is_known_is_what_an_unchanged_fleet_would_report(
    data: st.DataObject,
) -> None:
    old, new = data.draw(formulas(max_depth=3)), data.draw(formulas(max_depth=4))
    before, after = Monitor(old), Monitor(new)
    n, m = data.draw(st.integers(0, 12)), data.draw(st.integers(1, 30))
    rows = [{name: data.draw(NUMBERS) for name in NAMES} for _ in range(n + m)]
    keys, times = [1] * (n + m), [float(t) for t in range(n + m)]
    columns = {name: np.array([row[name] for row in rows]) for name in NAMES}
    whole, part = DiscreteFleet(after, 1), DiscreteFleet(before, 1)
    try:
        ((expected, final, instants, _),) = whole.update(np.array(keys), np.array(times), columns)
        if n:
            part.update(np.array(keys[:n]), np.array(times[:n]), {k: v[:n] for k, v in columns.items()})
    except EvaluationError:
        assume(False)
    changed = DiscreteFleet(after, 0, state=part.snapshot())
    for at in range(n, n + m):
        ((value, known, time, warming),) = changed.update(
            np.array(keys[at : at + 1]),
            np.array(times[at : at + 1]),
            {k: v[at : at + 1] for k, v in columns.items()},
        )
        assert known[0] or warming[0] or not final[at]
        if known[0]:
            assert final[at]
            assert (bits(value[0]), time[0]) == (bits(expected[at]), instants[at])
        if data.draw(st.integers(0, 9)) == 0:
            changed = DiscreteFleet(after, 0, state=changed.snapshot())
    if old == new:
        assert not warming[0]


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_damaged_bytes_are_no_state(data: st.DataObject) -> None:
    formula = data.draw(formulas(max_depth=3))
    monitor = Monitor(formula)
    fleet = DiscreteFleet(monitor, 4)
    keys = data.draw(st.sampled_from([[1, 2, 1], ["a", "bcd", "a"]]))
    columns = {name: np.array([1.0, 2.0, 3.0]) for name in NAMES}
    try:
        fleet.update(np.array(keys), np.array([0.0, 0.0, 1.0]), columns)
    except EvaluationError:
        assume(False)
    state = bytearray(fleet.snapshot())
    kind = data.draw(st.sampled_from(["flip", "flip", "flip", "cut", "grow"]))
    mended = data.draw(st.booleans())
    if kind == "cut":
        del state[data.draw(st.integers(0, len(state) - 1)) :]
    elif kind == "grow":
        state += bytes(data.draw(st.integers(1, 40)))
    else:
        for _ in range(data.draw(st.integers(1, 3))):
            state[data.draw(st.integers(0, len(state) - 1))] ^= data.draw(st.integers(1, 255))
    if mended and len(state) > 4:
        state[-4:] = struct.pack("<I", zlib.crc32(state[:-4]))
    if bytes(state) == fleet.snapshot():
        return
    try:
        forged = DiscreteFleet(monitor, 100, state=bytes(state))
    except UsageError:
        return
    assert mended, "a checksum that does not match is not noticed"
    with contextlib.suppress(TraceError, EvaluationError, UsageError):
        forged.update(np.array(keys), np.array([2.0, 1.0, 3.0]), columns)
    assert len(forged) <= 100


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_in_event_time_the_order_of_arrival_and_the_batches_do_not_matter(data: st.DataObject) -> None:
    """Random arrival orders within the lateness, late samples, gaps and restarts, against a monitor of each key."""
    formula = data.draw(formulas(max_depth=3))
    spec = rtamt.parse(to_text(formula), period=1)
    gaps = data.draw(st.sampled_from(["restart", "hold"]))
    lateness = data.draw(st.sampled_from([0, 1, 2.5, 5]))
    names: list[Any] = data.draw(st.sampled_from([[3, -1], ["a", "Ä€\U0001f600"]]))
    inputs = spec.input_names
    sent: list[tuple[float, Any, float, dict[str, float]]] = []  # arrival, key, time, values
    for key in names:
        time = data.draw(st.sampled_from([0.0, -7.5, 1e6]))
        for _ in range(data.draw(st.integers(1, 9))):
            row = {name: data.draw(NUMBERS) for name in inputs}
            delay = data.draw(st.sampled_from([0.0, 0.5, 1.0, 2.5, 4.0, 20.0]))
            sent += [(time + delay, key, time, row)] * data.draw(st.sampled_from([1, 1, 1, 2]))
            time += data.draw(st.sampled_from([1.0, 1.0, 1.0, 1.0625, 3.0, 2.5]))
    sent.sort(key=lambda each: (each[0], str(each[1])))
    expected, late = ordered(sent, float(lateness))
    wanted = [
        found
        for key in names
        for found in monitored(
            spec, [(time, row) for other, time, row in expected if other == key], gaps, key
        )
    ]
    fleet = rtamt.Fleet(spec, 2, lateness=lateness, gaps=gaps)
    assume(all(each is not None for each in wanted))
    reported, diverted = [], []
    rest = sent
    while rest:
        size = data.draw(st.integers(1, len(rest)))
        batch, rest = rest[:size], rest[size:]
        keys = np.array([key for _, key, _, _ in batch])
        columns = {name: np.array([row[name] for _, _, _, row in batch]) for name in inputs}
        update = fleet.update_many(keys, np.array([time for _, _, time, _ in batch]), columns)
        diverted += update.late.tolist()
        reported += reports(keys, update)
        if data.draw(st.booleans()):
            fleet = rtamt.Fleet.restore(spec, fleet.snapshot())
        if data.draw(st.booleans()):
            twin = rtamt.Fleet.restore(spec, fleet.snapshot())
            # Of the same state as that of the fleet, whose windows may lie elsewhere.
            before = twin.snapshot()
            with pytest.raises(TraceError):
                twin.update_many([*names, names[0]], [0.5, 1e7, np.inf], {name: [1.0] * 3 for name in inputs})
            assert twin.snapshot() == before
    assert diverted == late
    assert fleet.late == sum(late)
    reported += reports(np.array([]), fleet.watermark(np.inf))
    assert fleet.waiting == 0
    assert sorted(reported, key=str) == sorted(wanted, key=str)


def reports(keys: Any, update: rtamt.FleetUpdate) -> list[tuple[Any, ...]]:
    """Return key, time and value of all that an update made known."""
    own = zip(keys, update.times, update.values, update.known, strict=True)
    found = [(key.item(), float(time), bits(value)) for key, time, value, known in own if known]
    released = update.released
    others = zip(released.keys.tolist(), released.times.tolist(), released.values, strict=True)
    return found + [(key, time, bits(value)) for key, time, value in others]


def ordered(
    sent: list[tuple[float, Any, float, dict[str, float]]], lateness: float
) -> tuple[list[tuple[Any, float, dict[str, float]]], list[bool]]:
    """Return the samples that are not late in the order of their times, and which are: by the definition."""
    newest: dict[Any, float] = {}
    taken: dict[tuple[Any, float], dict[str, float]] = {}
    late = []
    for _, key, time, row in sent:
        known = newest.get(key, -np.inf)
        late.append(time < known - lateness or (key, time) in taken)
        if not late[-1]:
            newest[key] = max(known, time)
            taken[key, time] = row
    return [(key, time, taken[key, time]) for key, time in sorted(taken, key=lambda each: each[1])], late


def monitored(spec: Any, samples: list[tuple[float, dict[str, float]]], gaps: str, key: Any) -> list[Any]:
    """Return key, time and value of what a monitor makes known; [None] if it rejects a sample."""
    monitor, found, times = spec.monitor(), [], []
    lag = round(monitor.horizon)
    held: dict[str, float] = {}
    filled = []
    for time, row in samples:
        periods = floor(time - times[-1] + 0.5) if times else 1
        fits = bool(times) and abs(time - times[-1] - periods) <= 0.1 * periods
        if gaps == "hold" and periods > 1 and fits:
            filled += [(times[-1] + i * ((time - times[-1]) / periods), held) for i in range(1, periods)]
        filled.append((time, row))
        times.append(time)
        held = row
    times = []
    try:
        for time, row in filled:
            if times and abs(time - times[-1] - 1) > 0.1 and gaps == "restart":
                monitor, times = spec.monitor(), []
            value = monitor.update(time, **row)
            times.append(time)
            if value is not None:
                found.append((key, times[-1 - lag], bits(value)))
    except (TraceError, EvaluationError):
        return [None]
    return found
