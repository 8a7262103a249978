"""A fleet with a monitor for each key against monitors that are made anew and take all samples of a key.

It is restored from its snapshots on the way.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError, SpecificationError, TraceError
from rtamt.language.printing.printer import to_text
from tests.support.strategies import formulas

#: Whether time is dense, whether samples are late, whether values may be missing or uncertain; and the settings.
MODES: dict[str, tuple[bool, bool, bool, dict[str, Any]]] = {
    "delayed": (False, False, False, {"time_unit": "s"}),
    "delayed dense": (True, False, False, {}),
    "eager": (False, False, True, {"verdict": "eager"}),
    "eager dense": (True, False, True, {"verdict": "eager"}),
    "interval": (False, False, True, {"verdict": "interval"}),
    "interval at the start": (False, False, True, {"verdict": "interval", "at": "start"}),
    "interval with late samples": (False, True, True, {"verdict": "interval", "lateness": 2}),
    "interval with corrections": (
        False, True, False, {"verdict": "interval", "lateness": 3, "on_correction": "replay"}
    ),
    "interval dense": (True, False, True, {"verdict": "interval", "ranges": {"x": (-9, 9)}}),
    "interval dense with late samples": (True, True, True, {"verdict": "interval", "lateness": 2}),
    "causation": (False, False, False, {"verdict": "causation"}),
    "causation dense": (True, False, False, {"verdict": "causation"}),
}  # fmt: skip
NUMBERS = st.integers(-9, 8).map(lambda k: k / 2)


class Alone:
    """Samples of each key, for new monitors of which a batch asks; a batch that fails leaves none behind."""

    def __init__(self, spec: rtamt.Specification, made: dict[str, Any]) -> None:
        self.spec, self.made = spec, made
        self.taken: dict[Any, list[tuple[float, dict[str, Any]]]] = {}
        self.late = 0

    def update(self, keys: list[Any], times: list[float], rows: list[dict[str, Any]]) -> list[Any]:
        monitors: dict[Any, Any] = {}
        taken = {key: list(samples) for key, samples in self.taken.items()}
        found, late = [], 0
        for key, time, row in zip(keys, times, rows, strict=True):
            if key not in monitors:
                monitors[key] = self.spec.monitor(**self.made)
                for then, sample in taken.setdefault(key, []):
                    monitors[key].update(then, **sample)
            try:
                report = reported(monitors[key], monitors[key].update(time, **row), time)
            except TraceError as error:
                if "later than the lateness" not in str(error):
                    raise
                late += 1
                bounds = monitors[key].interval()
                report = [bounds.lower, bounds.upper, True, []]
            else:
                taken[key].append((time, row))
            found.append(report)
        self.taken = taken
        self.late += late
        return found


def reported(monitor: Any, report: Any, time: float) -> Any:
    """Return what an update of a monitor reported as plain values."""
    if isinstance(report, rtamt.Signal):
        return list(zip(report.times.tolist(), report.values.tolist(), strict=True))
    if isinstance(report, rtamt.Causation):
        return [report.violation, report.satisfaction]
    if isinstance(report, list):
        return [
            (each.begin, each.end, each.satisfied, each.decided_at)
            if isinstance(each, rtamt.VerdictRun)
            else (each.time, each.time, each.satisfied, each.decided_at)
            for each in report
        ]
    if hasattr(monitor, "interval"):
        bounds = monitor.interval()
        changes = [
            (each.begin, each.end, each.interval.lower, each.interval.upper, each.final, each.retracted)
            for each in (monitor.changes() if monitor.at == "every" else ())
        ]
        return [bounds.lower, bounds.upper, False, changes]
    return [report, None if report is None else time - monitor.horizon]


def of_fleet(update: Any, keys: list[Any]) -> list[Any]:
    """Return what an update of a fleet has of each sample as plain values."""
    n = len(keys)
    if isinstance(update, rtamt.FleetPoints):
        return grouped(update, keys, (update.times, update.values))
    if isinstance(update, rtamt.FleetVerdicts):
        return grouped(update, keys, (update.times, update.ends, update.satisfied, update.decided_at))
    assert len(update) == n
    if isinstance(update, rtamt.FleetCausation):
        return [
            list(row) for row in zip(update.violation.tolist(), update.satisfaction.tolist(), strict=True)
        ]
    if isinstance(update, rtamt.FleetBounds):
        every = update.changes
        changes = grouped(
            every, keys, (every.begins, every.ends, every.lower, every.upper, every.final, every.retracted)
        )
        bounds = (update.lower.tolist(), update.upper.tolist(), update.late.tolist(), changes)
        return [list(row) for row in zip(*bounds, strict=True)]
    return [
        [value, time] if known else [None, None]
        for value, time, known in zip(
            update.values.tolist(), update.times.tolist(), update.known, strict=True
        )
    ]


def grouped(rows: Any, keys: list[Any], columns: tuple[Any, ...]) -> list[Any]:
    """Return the rows of each sample of a batch."""
    found: list[Any] = [[] for _ in keys]
    lists = [column.tolist() for column in columns]
    for key, index, *row in zip(rows.keys.tolist(), rows.index.tolist(), *lists, strict=True):
        assert key == keys[index]
        found[index].append(tuple(row))
    return found


def columns_of(names: tuple[str, ...], rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return a column for each variable; where a sample does not have it, masked."""
    found: dict[str, Any] = {}
    for name in names:
        values = np.empty(len(rows), object)
        for i, row in enumerate(rows):
            values[i] = row.get(name)
        absent = [name not in row for row in rows]
        found[name] = np.ma.array(values, mask=absent) if any(absent) else list(values)
    return found


@pytest.mark.parametrize("mode", MODES)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_each_report_is_that_of_a_monitor_of_the_key(mode: str, data: st.DataObject) -> None:
    dense, shuffled, partial, made = MODES[mode]
    formula = data.draw(formulas(max_depth=3, discrete=not dense, arithmetic=not partial))
    spec = rtamt.parse(to_text(formula), time="dense" if dense else "discrete")
    names = spec.input_names
    assume(names)
    ranges = made.get("ranges", {})
    made = {**made, "ranges": {name: ranges[name] for name in names if name in ranges}} if ranges else made
    try:
        spec.monitor(**made)
    except SpecificationError:  # shares have no causation
        assume(False)
    every = data.draw(
        st.sampled_from([[3, -1, 2**40], ["a", "\u00c4\U0001f600", "long-" * 9], [b"a", b"\xff", b"b"]])
    )
    fleet, alone = rtamt.Fleet(spec, 3, **made), Alone(spec, made)
    clocks = dict.fromkeys(every, 0.0)
    for _ in range(data.draw(st.integers(2, 5))):
        keys = data.draw(st.lists(st.sampled_from(every), min_size=1, max_size=8))
        times, rows, ahead = [], [], dict(clocks)
        for key in keys:
            times.append(ahead[key] - (data.draw(st.integers(0, 3)) if shuffled else 0))
            ahead[key] += data.draw(st.sampled_from([0.5, 1.0, 2.25])) if dense else 1.0
            rows.append(
                {name: sample(data, partial) for name in names if not dense or data.draw(st.integers(0, 3))}
            )
        wrong = data.draw(st.sampled_from([None, None, "nan", "back", "unknown"]))
        if wrong == "nan":
            rows[-1] = {**rows[-1], names[0]: np.nan}
        elif wrong == "back":
            times[-1] = -50.0 if keys[-1] in alone.taken or keys[-1] in keys[:-1] else np.inf
        columns = columns_of(names, rows)
        if wrong == "unknown":
            columns["zz"] = [1.0] * len(keys)
            rows[-1] = {**rows[-1], "zz": 1.0}
        try:
            expected = alone.update(keys, times, rows)
        except (TraceError, EvaluationError):
            with pytest.raises((TraceError, EvaluationError)):
                fleet.update_many(keys, times, columns)
        else:
            clocks = ahead
            update = fleet.update_many(keys, times, columns)
            assert of_fleet(update, keys) == expected
        assert sorted(fleet.keys()) == sorted(alone.taken)
        assert fleet.late == alone.late
        if alone.taken and data.draw(st.booleans()):
            gone = data.draw(st.sampled_from(sorted(alone.taken)))
            fleet.drop([gone])
            del alone.taken[gone]
        if data.draw(st.booleans()):
            fleet = rtamt.Fleet.restore(spec, fleet.snapshot(), **made)
    for key in every:
        assert (key in fleet) == (key in alone.taken)


def sample(data: st.DataObject, partial: bool) -> Any:
    """Return a value of a sample: a number or, where it may be, bounds or nothing."""
    number = data.draw(NUMBERS)
    kind = data.draw(st.integers(0, 5)) if partial else 0
    return None if kind == 5 else (number, number + 1) if kind == 4 else number


SUITES: dict[str, dict[str, Any]] = {
    "delayed dense": {"time": "dense"},
    "eager": {"verdict": "eager"},
    "interval dense": {"time": "dense", "verdict": "interval", "lateness": 2},
    "causation": {"verdict": "causation"},
}


@pytest.mark.parametrize("mode", SUITES)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_a_fleet_of_a_suite_is_a_fleet_of_each_requirement(mode: str, data: st.DataObject) -> None:
    made = dict(SUITES[mode])
    time = made.pop("time", "discrete")
    texts = [to_text(data.draw(formulas(max_depth=2, discrete=time == "discrete"))) for _ in range(2)]
    specs = {f"R{i}": rtamt.parse(text, time=time) for i, text in enumerate(texts)}
    assume(all(spec.input_names for spec in specs.values()))
    try:
        suite, alone = (
            rtamt.Suite(specs),
            {name: rtamt.Fleet(spec, 9, **made) for name, spec in specs.items()},
        )
        fleet = rtamt.Fleet(suite, 9, **made)
    except SpecificationError:  # shares have no causation
        assume(False)
    names = {name for spec in specs.values() for name in spec.input_names}
    for step in range(data.draw(st.integers(1, 6))):
        keys = data.draw(st.lists(st.integers(0, 2), min_size=1, max_size=4, unique=True))
        times = [step + data.draw(st.sampled_from([0, 0, 0.25])) * (time == "dense") for _ in keys]
        columns = {name: [data.draw(NUMBERS) for _ in keys] for name in sorted(names)}
        expected, failed = {}, False
        for name, spec in specs.items():
            own = {each: columns[each] for each in spec.input_names}
            try:
                copied = rtamt.Fleet.restore(spec, alone[name].snapshot(), **made)
                expected[name] = copied, copied.update_many(keys, times, own)
            except (TraceError, EvaluationError):
                failed = True
        if failed:
            with pytest.raises((TraceError, EvaluationError)):
                fleet.update_many(keys, times, columns)
            continue
        update = fleet.update_many(keys, times, columns)
        for name, (copied, found) in expected.items():
            assert repr(update[name]) == repr(found)
            alone[name] = copied
        fleet = rtamt.Fleet.restore(suite, fleet.snapshot(), **made)
        assert fleet.late == max(each.late for each in alone.values())
