"""After many samples, of which what is final is forgotten, monitors report as after few."""

from __future__ import annotations

import copy
import itertools

import pytest

import rtamt

#: So often may a monitor forget what is final; traces are longer.
SAMPLES = 150

times = pytest.mark.parametrize("time", ["discrete", "dense"])


@times
@pytest.mark.parametrize(
    ("text", "satisfied"),
    [
        ("once(x > 100)", False),
        ("historically(x < 100)", True),
        ("once[2:inf](x > 100)", False),
        ("not once(x > 100)", True),
        ("always[0:2] historically(x < 100)", True),
    ],
)
def test_unbounded_past_is_decided_at_every_sample(text, satisfied, time):
    monitor = rtamt.parse(text, time=time).monitor(verdict="eager")
    found = [monitor.update(t, x=t % 7) for t in range(SAMPLES)]
    found.append(monitor.finish())
    verdicts = list(itertools.chain.from_iterable(found))
    assert {each.satisfied for each in verdicts} == {satisfied}
    if time == "discrete":
        assert [each.time for each in verdicts] == list(range(SAMPLES))
    else:
        assert [each.begin for each in verdicts] == [0, *(each.end for each in verdicts[:-1])]
        assert verdicts[-1].end == SAMPLES - 1 + 1e-9


@times
@pytest.mark.parametrize("verdict", ["interval", "causation"])
def test_unbounded_past_over_truth_is_known_at_every_sample(verdict, time):
    monitor = rtamt.parse("once(x > 100)", time=time, semantics="boolean").monitor(verdict=verdict)
    for t in range(SAMPLES):
        monitor.update(t, x=t % 7)
        if verdict == "interval":
            assert monitor.interval(t) == rtamt.Interval(-float("inf"), -float("inf"))
        else:
            assert monitor.causation(t) == rtamt.Causation(-float("inf"), -float("inf"))


@pytest.mark.parametrize("copies", [False, True])
def test_decisions_have_the_times_of_their_samples_as_they_were_given(copies):
    start = 1_700_000_000.0
    given = [start + t / 1000 for t in range(SAMPLES)]
    monitor = rtamt.parse("prev(prev(x > 0))", period="1ms").monitor(verdict="eager")
    found = []
    for t in given:
        found += monitor.update(t, x=1)
        monitor = copy.copy(monitor) if copies else monitor
    assert [each.time for each in found] == given
    assert [each.decided_at for each in found[2:]] == given[:-2]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("mode", ["eager", "interval", "causation"])
@pytest.mark.parametrize("operator", ["count", "duration"])
def test_bounds_of_a_huge_sum_are_refused_before_they_fill_the_memory(operator, mode, backend):
    spec = rtamt.parse(f"{operator}[0:10000000](x >= 1) >= 3", backend=backend)
    with pytest.raises(rtamt.UsageError) as error:
        spec.monitor(verdict=mode)
    assert str(error.value) == (
        "a window has 10,000,001 samples; before its value is known, a sum, count, mean, integral or duration reads "
        "at most 10,000,000: shorten the window, lengthen the period or monitor with verdict='delayed'"
    )
