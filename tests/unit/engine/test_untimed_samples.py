"""Samples without timestamps have the times of a recording without timestamps, however they arrive."""

from __future__ import annotations

import numpy as np
import pytest

import rtamt


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("period", ["100ms", "1/3", "7us", "1s"])
def test_chunks_of_any_size(period, backend):
    n, spec = (
        60,
        rtamt.parse(
            "always[0:0](x >= 0)", period=float(1 / 3) if period == "1/3" else period, backend=backend
        ),
    )
    data = np.arange(float(n))
    whole = spec.evaluate({"x": data}).signal.times.tolist()
    for sizes in ([1] * n, [2] * (n // 2), [7] * 9, [n]):
        monitor, times, place = spec.monitor(), [], 0
        for size in sizes:
            times += monitor.update_many({"x": data[place : place + size]}).times.tolist()
            place += size
        assert times == whole


def test_after_a_time_that_was_given_they_count_from_it():
    monitor = rtamt.parse("x >= 0", period="100ms").monitor()
    monitor.update(5.0, x=1.0)
    found = [monitor.update_many({"x": [1.0]}).times.item() for _ in range(3)]
    assert found == pytest.approx([5.1, 5.2, 5.3], abs=1e-12)
