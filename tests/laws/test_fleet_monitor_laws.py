"""A fleet with a monitor for each key against monitors that are made anew and take all samples of a key.

It is restored from its snapshots on the way.
"""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError, SpecificationError, TraceError
from rtamt.language.printing.printer import to_text
from tests.laws.fleet_batches import MODES, NUMBERS, columns_of, draw_batch, draw_fleet
from tests.support.strategies import formulas


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
            before = [then for then, _ in taken[key]]
            try:
                report = reported(monitors[key], monitors[key].update(time, **row), [*before, time])
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


def reported(monitor: Any, report: Any, times: list[float]) -> Any:
    """Return what an update of a monitor reported as plain values. ``times``: of all samples, the newest last."""
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
    if report is None:
        return [None, None]
    return [report, times[-1 - round(monitor.horizon / float(monitor.period))]]


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


@pytest.mark.parametrize("mode", MODES)
@settings(max_examples=25, deadline=None)
@given(data=st.data())
def test_each_report_is_that_of_a_monitor_of_the_key(mode: str, data: st.DataObject) -> None:
    drawn = draw_fleet(data, MODES[mode])
    spec, made = drawn.spec, drawn.settings
    every = data.draw(
        st.sampled_from([[3, -1, 2**40], ["a", "\u00c4\U0001f600", "long-" * 9], [b"a", b"\xff", b"b"]])
    )
    fleet, alone = rtamt.Fleet(spec, 3, **made), Alone(spec, made)
    clocks = dict.fromkeys(every, drawn.start)
    for _ in range(data.draw(st.integers(2, 5))):
        keys, times, rows, ahead = draw_batch(data, drawn, every, clocks, alone.taken)
        columns = columns_of(spec.input_names, rows)
        if data.draw(st.integers(0, 4)) == 4:  # a variable that the requirement does not read
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
