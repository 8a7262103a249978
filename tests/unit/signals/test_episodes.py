"""Episodes of violation: offline and online, in both time domains."""

from __future__ import annotations

import copy
import pickle
from itertools import groupby, pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt import Episode

VALUES = st.lists(st.integers(-3, 3).map(float), min_size=1, max_size=30)
BACKENDS = pytest.mark.parametrize("backend", ["cpp", "python"])


def runs(times, values):
    """Return the episodes of samples by their definition."""
    found = []
    for violated, group in groupby(zip(times, values, strict=True), lambda pair: pair[1] < 0):
        if violated:
            run = list(group)
            at, worst = min(run, key=lambda pair: pair[1])
            found.append(Episode(run[0][0], run[-1][0], worst, at))
    return found


@given(values=VALUES)
def test_episodes_are_the_maximal_runs_of_violation(values):
    times = [0.5 * k for k in range(len(values))]
    spec = rtamt.parse("always(x >= 0)", period="500ms")
    assert spec.evaluate({"time": times, "x": values}).episodes() == runs(times, values)


@given(values=VALUES, cuts=st.lists(st.integers(0, 30), max_size=4), single=st.booleans())
def test_monitor_finds_the_episodes_of_the_recording_whatever_the_chunks(values, cuts, single):
    spec = rtamt.parse("always[0:2](x >= 0); z = eventually[0:1](x >= 1)")
    times = [float(k) for k in range(len(values))]
    monitor = spec.monitor(watch=["z"], episodes=True)
    if single:
        for t, x in zip(times, values, strict=True):
            monitor.update(t, x=x)
    else:
        edges = sorted({0, *(min(cut, len(values)) for cut in cuts), len(values)})
        for a, b in pairwise(edges):
            monitor.update_many({"time": times[a:b], "x": values[a:b]})
    monitor.finish()
    result = spec.evaluate({"time": times, "x": values})
    assert monitor.episodes() == runs(times, result.signal.values.tolist())
    assert monitor.episodes("z") == runs(times, result["z"].values.tolist())


@given(
    gaps=st.lists(st.tuples(st.integers(1, 4), st.integers(-3, 3)), min_size=1, max_size=15),
    cut=st.integers(0, 15),
)
def test_dense_monitor_finds_the_episodes_of_the_recording(gaps, cut):
    times = np.cumsum([gap for gap, _ in gaps]).astype(float).tolist()
    values = [float(value) for _, value in gaps]
    monitor = rtamt.parse("x >= 0").monitor(time="dense", episodes=True)
    for t, x in zip(times[:cut], values[:cut], strict=True):
        monitor.update(t, x=x)
    monitor.update_many({"x": (times[cut:], values[cut:])})
    monitor.finish()
    result = rtamt.parse("always(x >= 0)").evaluate({"x": (times, values)}, time="dense")
    assert monitor.episodes() == result.episodes()
    # By definition: the value of a sample holds up to the next one.
    ends = [*times[1:], times[-1]]
    expected = []
    for violated, group in groupby(zip(times, ends, values, strict=True), lambda each: each[2] < 0):
        if violated:
            run = list(group)
            begin, _, worst = min(run, key=lambda each: each[2])
            expected.append(Episode(run[0][0], run[-1][1], worst, begin))
    assert result.episodes() == expected


@BACKENDS
def test_episodes_of_always_are_those_within_its_window(backend):
    x = [-1, -1, 2, -2, -3, 1, -4]
    spec = rtamt.parse("always[1:4](x >= 0)", backend=backend)
    assert spec.evaluate({"x": x}).episodes() == [Episode(1, 1, -1, 1), Episode(3, 4, -3, 4)]
    times = list(range(7))
    dense = spec.evaluate({"x": (times, x)}, time="dense")
    assert dense.episodes() == [Episode(1, 2, -1, 1), Episode(3, 4, -3, 4)]
    assert rtamt.parse("always[1.5:3.5](x >= 0)", backend=backend).evaluate(
        {"x": (times, x)}, time="dense"
    ).episodes() == [Episode(1.5, 2, -1, 1.5), Episode(3, 3.5, -2, 3)]


def test_episodes_have_the_times_of_the_recording():
    start = np.datetime64("2024-05-01T12:00:00", "ns")
    times = start + np.arange(4) * np.timedelta64(1, "s")
    result = rtamt.parse("always(x >= 0)").evaluate({"time": times, "x": [1, -1, -2, 1]})
    assert result.episodes() == [Episode(times[1], times[2], -2, times[2])]
    monitor = rtamt.parse("x >= 0").monitor(episodes=True)
    monitor.update_many({"time": times, "x": [1, -1, -2, 1]})
    assert monitor.episodes() == result.episodes()


def test_each_of_several_requirements_has_its_episodes():
    spec = rtamt.parse("require low: always(x <= 3); require high: always(x >= 1)")
    result = spec.evaluate({"x": [0, 2, 5, 5]})
    assert result.requirements["low"].episodes() == [Episode(2, 3, -2, 2)]
    assert result.requirements["high"].episodes() == [Episode(0, 0, -1, 0)]
    with pytest.raises(rtamt.UsageError) as error:
        result.episodes()
    assert str(error.value) == (
        "the specification has several requirements; ask one of them for its episodes, such as "
        "result.requirements['low']"
    )
    spec = rtamt.parse("require low: x <= 3; require high: x >= 1")
    monitor = spec.monitor(watch=["low", "high"], episodes=True)
    for t, x in enumerate([0, 2, 5, 5]):
        monitor.update(t, x=x)
    assert monitor.episodes("low") == [Episode(2, 3, -2, 2)]
    assert monitor.episodes("high") == [Episode(0, 0, -1, 0)]
    assert monitor.episodes() == [Episode(0, 0, -1, 0), Episode(2, 3, -2, 2)]


@BACKENDS
@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("twin", [copy.copy, lambda monitor: pickle.loads(pickle.dumps(monitor))])
def test_copy_remembers_episodes_of_its_own(twin, time, backend):
    monitor = rtamt.parse("x >= 0", backend=backend).monitor(time=time, episodes=True)
    monitor.update(0, x=-1)
    monitor.update(1, x=1)
    other = twin(monitor)
    other.update(2, x=-5)
    monitor.update(2, x=5)
    assert len(monitor.episodes()) == 1
    assert [episode.worst for episode in other.episodes()] == [-1, -5]
    monitor.reset()
    assert monitor.episodes() == []


@BACKENDS
def test_failed_sample_is_no_part_of_an_episode(backend):
    monitor = rtamt.parse("sqrt(x) >= 1", backend=backend).monitor(episodes=True)
    monitor.update(0, x=0)
    with pytest.raises(rtamt.EvaluationError):
        monitor.update(1, x=-1)
    with pytest.raises(rtamt.EvaluationError):
        monitor.step(-1)
    monitor.step(4)
    assert monitor.episodes() == [Episode(0, 0, -1, 0)]


def test_monitor_that_remembers_no_episodes_says_how_to():
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.parse("x >= 0").monitor().episodes()
    assert str(error.value) == ("the monitor does not remember episodes; make it with monitor(episodes=True)")
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.parse("x >= 0").monitor(verdict="eager", episodes=True)
    assert str(error.value) == "episodes= belongs to verdict='delayed', and this is verdict='eager'"
