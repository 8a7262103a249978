"""Ranges that a text declares bound what is not known yet; a sample outside is an error at every entry point."""

from dataclasses import replace
from math import inf

import pytest

import rtamt
from rtamt.plot.band import band
from rtamt.search import Problem, Range
from rtamt.signals.outcomes import Interval
from tests.support import c_api

TEXT = "input float x in [0, 10]  input float y in [-1, inf]  always[0:1](x <= 12 and y >= -2)"
OUTSIDE = (
    "'x' is 11 at sample 1, time 1 s, outside its declared range [0, 10]: correct the value, "
    "or declare a wider range"
)


def ends(monitor):
    known = monitor.interval()
    return known.lower, known.upper


def test_the_ranges_of_the_variables_that_the_formula_reads():
    spec = rtamt.parse("float a in [0, 1]  float b  float c in [2, 3]  require A: a > b; require C: c > 2")
    assert spec.ranges == {"a": (0.0, 1.0), "c": (2.0, 3.0)}
    assert spec.requirements["A"].ranges == {"a": (0.0, 1.0)}


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_later_samples_lie_in_the_declared_ranges(backend, time):
    spec = rtamt.parse(TEXT, time=time, backend=backend)
    bounds = spec.monitor(verdict="interval")
    bounds.update(0, x=3, y=7)
    assert bounds.interval() == Interval(1.0, 9.0)
    (verdict,) = spec.monitor(verdict="eager").update(0, x=3, y=7)
    assert (verdict.satisfied, verdict.decided_at) == (True, 0.0)


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("mode", ["eager", "interval"])
def test_a_sample_outside_is_an_error_and_the_state_is_kept(mode, time):
    monitor, twin = (rtamt.parse(TEXT, time=time).monitor(verdict=mode) for _ in range(2))
    for each in (monitor, twin):
        each.update(0, x=3, y=7)
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(1, x=11, y=0)
    assert str(error.value) == OUTSIDE
    assert monitor.update(1, x=10, y=0) == twin.update(1, x=10, y=0)
    assert monitor.finish() == twin.finish()


def test_given_ranges_override_declared_ones_each_alone():
    monitor = rtamt.parse(TEXT).monitor(verdict="interval", ranges={"x": (-inf, inf)})
    monitor.update(0, x=11, y=7)
    assert monitor.interval() == Interval(-inf, 1.0)
    with pytest.raises(rtamt.TraceError, match=r"'y' is -2 .* outside its declared range \[-1, inf\]"):
        monitor.update(1, x=11, y=-2)


def test_other_modes_do_not_check_ranges():
    spec = rtamt.parse(TEXT)
    assert spec.monitor().update(0, x=13, y=0) is None
    assert spec.monitor(verdict="causation").update(0, x=13, y=0).violation == -1.0


def test_explanations_suppose_the_declared_ranges():
    monitor = rtamt.parse("float x in [0, 10]  float y  always[0:1](x <= 12 or y > 0)").monitor(
        verdict="eager", explain=True
    )
    (verdict,) = monitor.update(0, x=3, y=7)
    assert monitor.explain(verdict) == []


def test_a_compiled_program_of_bounds_agrees_with_the_monitor():
    spec = rtamt.parse(TEXT)
    program, monitor = spec.compile(verdict="interval"), spec.monitor(verdict="interval", at="start")
    there = c_api.Monitor(program.to_bytes())
    monitor.update(0, x=3, y=7)
    assert there.step([3.0, 7.0], 4) == [*ends(monitor), inf, 0.0]
    with pytest.raises(c_api.RefusedError) as error:
        there.step([11.0, 0.0], 4)
    assert error.value.args == (1, f"{OUTSIDE}.")
    twin = c_api.Monitor(program.to_bytes())
    twin.restore(there.save())
    monitor.update(1, x=10, y=0)
    assert there.step([10.0, 0.0], 4) == twin.step([10.0, 0.0], 4) == [*ends(monitor), inf, 0.0]
    there.reset()
    with pytest.raises(c_api.RefusedError, match="'y' is -2 at sample 0, time 0 s, outside"):
        there.step([1.0, -2.0], 4)


def test_damaged_ranges_of_a_program_are_refused():
    program = rtamt.parse(TEXT).compile(verdict="interval")
    graph = program.metadata.early
    low, high = graph[-32:-24], graph[-24:-16]
    for damaged in (graph[:-8], graph[:-32] + high + low + graph[-16:], graph + b"\0"):
        code = replace(program, metadata=replace(program.metadata, early=damaged)).to_bytes()
        with pytest.raises(c_api.RefusedError, match="its graph is damaged"):
            c_api.Monitor(code)


def test_missing_and_uncertain_samples_of_a_recording_lie_in_the_declared_ranges():
    spec = rtamt.parse("float x in [0, 10]  always(x <= 8)")
    assert spec.evaluate({"x": [3, None, 7]}).interval == Interval(-2.0, 1.0)
    assert spec.evaluate({"x": [3, 9.8]}, uncertainty={"x": 0.5}).interval == Interval(
        -2.0, pytest.approx(-1.3)
    )
    assert spec.evaluate({"x": [3, None, 12]}, ranges={"x": (0, 20)}).interval == Interval(-12.0, -4.0)
    with pytest.raises(rtamt.TraceError) as error:
        spec.evaluate({"x": [3, None, 12]})
    assert str(error.value) == (
        "'x' is 12 at sample 2, outside its declared range [0, 10]: correct the value, or declare a wider range"
    )


def test_evaluations_of_exact_recordings_do_not_check_ranges():
    spec = rtamt.parse("float x in [0, 10]  always(x <= 8)")
    result = spec.evaluate({"x": [3, 12]})
    assert result.robustness == -4.0
    found = band(result)
    assert (found.lower.tolist(), found.upper.tolist()) == ([-inf, -inf], [5.0, -4.0])


def test_a_search_goes_beyond_declared_ranges_as_evaluations_do():
    spec = rtamt.parse("float x in [0, 10]  always[0:3](x <= 11)", period=1)

    def plant(a):
        for t in range(4):
            yield float(t), {"x": a + t}

    found = Problem(spec, plant, {"a": Range(0, 20)}, 3).run({"a": 10.5})
    assert (found.robustness, found.satisfied, found.stopped) == (-0.5, False, 1.0)
