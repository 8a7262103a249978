"""The times for which a fleet reports robustness."""

import numpy as np
import pytest

import rtamt


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_times_are_those_of_the_samples_one_horizon_before(backend):
    spec = rtamt.parse("next(next(x * x))", period=0.1, backend=backend)
    times = 1700000000.1 + 0.1 * np.arange(9)
    samples = {"x": np.zeros(9)}
    update = rtamt.Fleet(spec, 2).update_many([3] * 9, times, samples)
    assert update.times[update.known].tolist() == times[:-2].tolist()
    assert spec.monitor().update_many({"time": times, **samples}).times.tolist() == times[:-2].tolist()
