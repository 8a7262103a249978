"""First samples in dense time that have no value, before the start of the trace is known."""

from __future__ import annotations

import copy

import pytest

import rtamt
from rtamt import Interval
from rtamt.errors import EvaluationError

BACKENDS = pytest.mark.parametrize("backend", ["cpp", "python"])
#: Whether a copy of the monitor takes each sample.
COPIED = pytest.mark.parametrize("again", [lambda monitor: monitor, copy.copy])


def interval(text, backend, **settings):
    spec = rtamt.parse(text, backend=backend)
    return spec.monitor(verdict="interval", time=rtamt.Dense(resolution="1s"), lateness=5, **settings)


@BACKENDS
@COPIED
def test_sample_without_a_value_is_an_error_before_the_start_is_known(backend, again):
    monitor = interval("sqrt(x) >= 0", backend)
    with pytest.raises(EvaluationError, match=r"'sqrt\(x\)' has no value at time 3 s"):
        monitor.update(3, x=-1.0)
    assert monitor.samples == 0
    monitor.update(2, x=4.0)
    monitor = again(monitor)
    with pytest.raises(EvaluationError, match=r"'sqrt\(x\)' has no value at time 1 s"):
        monitor.update(1, x=-1.0)
    monitor = again(monitor)
    monitor.update(10, x=9.0)
    assert monitor.samples == 2
    monitor.finish()
    assert [monitor.interval(t) for t in (2, 9, 10)] == [Interval(v, v) for v in (2.0, 2.0, 3.0)]


@BACKENDS
@COPIED
def test_sample_that_moves_the_start_before_one_without_a_value_is_an_error(backend, again):
    monitor = interval("sqrt(x) >= y", backend)
    monitor.update(3, x=-1.0)  # the trace may start later
    monitor.update(5, y=0.0)
    monitor = again(monitor)
    with pytest.raises(EvaluationError, match=r"'sqrt\(x\)' has no value at time 3 s"):
        monitor.update(2, y=0.0)
    monitor = again(monitor)
    with pytest.raises(EvaluationError, match=r"'sqrt\(x\)' has no value at time 6 s"):
        monitor.update(6, x=-1.0)
    monitor.update(4, x=1.0)
    monitor.update(20, x=4.0)
    monitor.finish()
    assert [monitor.interval(t) for t in (5, 19, 20)] == [Interval(v, v) for v in (1.0, 1.0, 2.0)]


@BACKENDS
@COPIED
def test_operation_that_depends_on_the_start_is_computed_again_when_that_moves(backend, again):
    monitor = interval("sqrt(delay[1](x, 4)) >= 0", backend)
    monitor.update(5, x=1.0)
    monitor.update(4, x=1.0)
    monitor = again(monitor)
    with pytest.raises(EvaluationError, match="has no value at time 4 s"):
        monitor.update(3, x=-1.0)
    monitor = again(monitor)
    monitor.update(3, x=9.0)
    assert monitor.samples == 3
    monitor.finish()
    assert [monitor.interval(t) for t in (3, 4, 5)] == [Interval(v, v) for v in (2.0, 3.0, 1.0)]


@BACKENDS
def test_constant_without_a_value_is_an_error_at_the_start_that_is_known_so_far(backend):
    monitor = interval("sqrt(-1) * x >= 0", backend)
    for time in (3, 2, 20):
        with pytest.raises(EvaluationError, match=rf"'sqrt\(-1\)' has no value at time {time} s"):
            monitor.update(time, x=1.0)
    assert monitor.samples == 0


@BACKENDS
@pytest.mark.parametrize(("operand", "wrong"), [("{}", 4), ("delay[1]({}, 9)", 5)])
def test_no_requirement_keeps_a_sample_that_leaves_another_without_a_value(backend, operand, wrong):
    parts = (f"require of_{name}: sqrt({operand.format(name)} - 3) >= 0" for name in "xy")
    monitor = interval("\n".join(parts), backend)
    monitor.update(6, x=5.0, y=5.0)
    for x, y in ((5.0, 1.0), (1.0, 5.0)):  # the first x is taken back
        with pytest.raises(EvaluationError, match=f"has no value at time {wrong} s"):
            monitor.update(4, x=x, y=y)
    monitor.update(4, x=7.0, y=5.0)
    monitor.finish()
    assert monitor.interval(wrong) == Interval(2.0**0.5, 2.0**0.5)


@BACKENDS
def test_correction_repairs_a_first_sample_that_holds_no_value_up_to_the_start(backend):
    monitor = interval("sqrt(x) >= y", backend, on_correction="replay")
    monitor.update(3, x=-1.0)
    monitor.update(5, y=0.0)
    with pytest.raises(EvaluationError, match=r"'sqrt\(x\)' has no value at time 5 s"):
        monitor.update(20, x=4.0)
    monitor.update(3, x=9.0)
    monitor.update(2, y=0.0)
    with pytest.raises(EvaluationError, match=r"'sqrt\(x\)' has no value at time 3 s"):
        monitor.update(3, x=-1.0)
    monitor.update(20, x=4.0)
    assert monitor.interval(3) == Interval(3.0, 3.0)
