"""In discrete time, reports have the times that were given for samples, in whatever order they come."""

from __future__ import annotations

import copy
import pickle
from random import Random

import numpy as np
import pytest

import rtamt

backends = pytest.mark.parametrize("backend", ["cpp", "python"])


@backends
def test_a_late_sample_is_reported_with_its_time(backend):
    monitor = rtamt.parse("always[0:0.2](x >= 0)", period="100ms", backend=backend).monitor(
        verdict="interval", lateness="1s"
    )
    for k in (0, 1, 2, 3, 4, 5, 12):
        monitor.update(k / 10, x=k)
    monitor.update(0.8, x=8)
    assert [(each.begin, each.end) for each in monitor.changes()] == [(6 * 0.1, 0.8)]  # 0.6 has no sample yet
    monitor.update(0.6, x=6)
    assert [(each.begin, each.end) for each in monitor.changes()] == [(0.4, 0.4), (0.6, 0.6)]
    monitor.update(0.6 + 1e-9, x=6)  # the first time of an instant is kept
    monitor.update(0.7, x=7)
    assert [each.begin for each in monitor.changes()] == [0.5, 0.6, 0.7]


_NOON = np.datetime64("2026-03-01T12:00", "ns")
#: From a form of times to its unit, and to the time of a sample that is some milliseconds late.
_FORMS = {
    "seconds": (None, lambda k, late: k / 10 + late / 1000),
    "milliseconds": ("ms", lambda k, late: 100 * k + late),
    "minutes": ("min", lambda k, late: k / 600 + late / 60_000),
    "Unix times": (None, lambda k, late: 1_790_000_000.1 + k / 10 + late / 1000),
    "dates": (None, lambda k, late: _NOON + np.timedelta64(100 * k + late, "ms")),
}


@backends
@pytest.mark.parametrize("form", _FORMS)
def test_every_sample_is_reported_with_its_time_in_any_order(form, backend):
    unit, time_of = _FORMS[form]
    spec = rtamt.parse("always[0:0.3](x >= -9)", period="100ms", backend=backend)
    for seed in range(6):
        random = Random(seed)
        order = sorted(range(24), key=lambda k: k + random.uniform(0, 6))
        monitor = spec.monitor(verdict="interval", lateness="600ms", time_unit=unit)
        given, reported = {}, 0
        for count, k in enumerate(order):
            given[k] = time_of(k, random.choice((0, 0, 1)) if seed % 2 else 0)
            monitor.update(given[k], x=float(random.randrange(9)))
            if count in (3, 15):
                monitor = random.choice((copy.copy, lambda each: pickle.loads(pickle.dumps(each))))(monitor)
            for change in monitor.changes():
                for time in {change.begin, change.end}:
                    close = [time_of(k, -30) <= time <= time_of(k, 30) for k in given]
                    assert (time in given.values()) == any(close)
                    reported += any(close)
        assert reported > 30


@backends
def test_corrections_that_are_replayed_keep_the_times_of_samples(backend):
    monitor = rtamt.parse("always[0:0.2](x >= 0)", period="100ms", backend=backend).monitor(
        verdict="interval", lateness="1s", on_correction="replay"
    )
    for k in (0, 1, 2, 3, 4, 5, 12, 6):
        monitor.update(k / 10, x=k)
    monitor.update(0.6, x=-1)
    assert [(each.begin, each.end) for each in monitor.changes()] == [(0.4, 0.4), (0.5, 0.5), (0.6, 0.6)]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    "settings", [{"verdict": "eager"}, {"verdict": "interval"}, {"verdict": "causation"}]
)
@pytest.mark.parametrize("time", [1.05, 1.1])
def test_second_sample_of_an_instant_is_irregular(backend, settings, time):
    monitor = rtamt.parse("eventually[0:3](x >= 3)", period=1, backend=backend).monitor(**settings)
    monitor.update(0, x=5)
    monitor.update(1, x=5)
    with pytest.raises(
        rtamt.TraceError, match=rf"^sample 2 at {time} s is {time - 1:.2g} s after the one before"
    ):
        monitor.update(time, x=4)
    monitor.update(2, x=5)
