"""Monitors of bounds with lateness: the first samples wait until the start of the trace is known."""

from __future__ import annotations

import copy
from math import inf

import pytest

import rtamt
from rtamt import EvaluationError, Interval, StlError, TraceError
from tests.unit.verdicts.early.test_interval import SETTINGS, ends, interval


@pytest.mark.parametrize("how", ["newer sample", "watermark", "end"])
@pytest.mark.parametrize("copied", [False, True])
@pytest.mark.parametrize("correction", ["reject", "replay"])
def test_first_samples_within_the_lateness_are_lost_by_no_change(how: str, copied: bool, correction: str):
    monitor = interval("once[0:1](x >= 3)", lateness=3, on_correction=correction)
    for t in (2, 0, 1, 2):
        monitor.update(t, x=9 if t == 2 else 4 + t)
        assert monitor.changes() == []
    if how == "end":
        changes = monitor.finish()
    elif how == "watermark":
        monitor.watermark(2)
        changes = monitor.changes()
    else:
        monitor.update(12, x=1)
        changes = monitor.changes()
    expected = [(0, 1.0, True), (1, 2.0, True), (2, 6.0, True)]
    assert [(c.begin, c.interval.lower, c.final) for c in changes][:3] == expected
    assert not any(change.retracted for change in changes)
    if how == "end":
        return
    if copied:
        monitor = copy.copy(monitor)
        assert monitor.changes() == changes
    monitor.update(13, x=4)
    assert [change.begin for change in monitor.changes() if change.end <= 2] == []


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("origin", [0, 1000])
def test_no_bounds_at_an_instant_before_the_start_of_the_trace_is_known(origin: int, backend: str):
    monitor = rtamt.parse("once[1:1](x >= 5)", period=1, backend=backend).monitor(
        verdict="interval", ranges={"x": (0, 10)}, lateness=2
    )
    monitor.update(origin, x=7)
    with pytest.raises(rtamt.UsageError) as error:
        monitor.interval(origin)  # the first sample if no earlier one comes, -inf, else the second one
    assert str(error.value) == (
        f"the trace has not started at {origin} s: it does when no earlier sample can come; "
        f"until then interval() gives the bounds at its start"
    )
    assert ends(monitor) == (-inf, -inf)
    monitor.update(origin - 1, x=8)
    monitor.watermark(origin)
    assert ends(monitor, origin) == (3, 3)


def test_first_samples_in_the_reverse_order_need_one_rehearsal_and_give_the_bounds_of_those_in_order(
    monkeypatch,
):
    spec = rtamt.parse("historically[0:3](sqrt(x) >= 1) since y > 0", period=1)
    reverse, other = (spec.monitor(verdict="interval", lateness=101) for _ in range(2))
    opened = []
    session = reverse._session.open
    monkeypatch.setattr(reverse._session, "open", lambda: opened.append(session()) or opened[-1])
    samples = [(t, {"x": 1.0 + t % 7, "y": float(t % 3)}) for t in range(1, 101)]
    for (last, at_end), (first, at_begin) in zip(reversed(samples), samples, strict=True):
        reverse.update(last, **at_end)
        other.update(first, **at_begin)
    assert len(opened) == 1
    for monitor in (reverse, other):
        with pytest.raises(EvaluationError, match=r"'sqrt\(x\)' has no value at sample 0, time 0 s"):
            monitor.update(0, x=-1.0)
        monitor.update(0, x=1.0, y=1.0)
        assert monitor.changes() == []
        monitor.update(101, x=2.0, y=1.0)
        assert monitor.samples == 102
    assert reverse.changes() == other.changes() != []
    assert len(opened) == 1
    assert reverse.finish() == other.finish()


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", [rtamt.Discrete("1s"), rtamt.Dense("1s")])
def test_trace_starts_as_soon_as_no_earlier_sample_can_arrive(time, backend):
    def monitor(**settings):
        made = rtamt.parse("always[0:1](x >= 3)", time=time, backend=backend).monitor(
            verdict="interval", **settings
        )
        made.watermark(-5)
        return made

    late = monitor(lateness="2s")
    late.update(2, x=5.0)
    late.update(1, x=4.0)
    assert late.interval() == Interval(-inf, inf)
    late.update(3, x=6.0)  # one at 0 s would be too late
    assert late.interval().upper == 1.0
    replays = monitor(on_correction="replay")
    replays.update(0, x=4.0)
    assert replays.interval() == Interval(-inf, 1.0)
    for declare in (lambda each: each.watermark(-1), lambda each: each.advance(1)):
        before, after = monitor(lateness="2s"), monitor(lateness="2s")
        declare(before)
        before.update(0, x=4.0)
        after.update(0, x=4.0)
        declare(after)
        for each in (before, after):
            assert each.interval() == Interval(-inf, 1.0)
            each.update(1, x=5.0)
            with pytest.raises(TraceError, match="later than the lateness of 2 s allows"):
                each.update(-1, x=3.0)


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_first_samples_in_the_reverse_order_fail_where_an_operation_depends_on_the_start(backend):
    spec = rtamt.parse("sqrt(delay[1](x, 4)) >= 0", period=1, backend=backend)
    monitor = spec.monitor(verdict="interval", lateness=9)
    monitor.update(5, x=1.0)
    monitor.update(4, x=1.0)
    with pytest.raises(EvaluationError, match="has no value at sample 1, time 4 s"):
        monitor.update(3, x=-1.0)
    monitor.update(3, x=9.0)
    monitor.finish()
    assert [monitor.interval(t) for t in (3, 4, 5)] == [Interval(v, v) for v in (2.0, 3.0, 1.0)]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("time", "x", "message"),
    [
        (2, 50, "'x' is 50 at sample 2, time 2 s, outside its declared range [0, 10]"),
        (inf, 5.0, "time is inf at sample 2: give a finite number of seconds"),
        ("noon", 5.0, "time is 'noon' at sample 2, expected a number of seconds"),
    ],
)
def test_error_names_the_number_of_a_sample_that_would_wait_for_the_start(backend, time, x, message):
    monitor = rtamt.parse("x >= 1", period=1, backend=backend).monitor(**SETTINGS, lateness=4)
    monitor.update(0, x=1.0)
    monitor.update(1, x=1.0)
    with pytest.raises(StlError) as caught:
        monitor.update(time, x=x)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("again", [lambda monitor: monitor, copy.copy])
@pytest.mark.parametrize(
    ("time", "x", "message"),
    [
        (1, 7.0, "'x' is 7 at time 1 s, which contradicts what was known of it, 4: correct it"),
        (2, -1.0, "'sqrt(x)' has no value at sample 1, time 2 s"),
        (0, -1.0, "'sqrt(x)' has no value at sample 0, time 0 s"),
        (1.5, 4.0, "sample 1 at 1.5 s is 0.5 s after the one before, expected 1 s"),
    ],
)
def test_a_wrong_sample_before_the_start_is_an_error_and_does_not_block_all_later_ones(
    backend, again, time, x, message
):
    spec = rtamt.parse("historically[0:1](sqrt(x) >= 1)", period=1, backend=backend)
    monitor, other = (spec.monitor(verdict="interval", lateness=2) for _ in range(2))
    monitor.update(1, x=4.0)
    other.update(1, x=4.0)
    first = again(monitor)
    with pytest.raises(StlError) as caught:
        first.update(time, x=x)
    assert str(caught.value).startswith(message)
    for then, value in ((2, 9.0), (0, 1.0), (3, 4.0), (4, 4.0)):
        first.update(then, x=value)
        other.update(then, x=value)
        assert first.changes() == other.changes()
    assert first.interval() == Interval(0.0, 0.0)
    assert first.finish() == other.finish()
