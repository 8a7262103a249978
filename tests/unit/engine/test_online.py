"""What monitors of both time domains share: watched formulas, copies, pickles, and variables of any name."""

from __future__ import annotations

import copy
import pickle
from datetime import datetime, timedelta, timezone
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.engine.dense.monitor import DenseMonitor
from rtamt.errors import BoundError, NameInFormulaError, ParseError, TraceError, UsageError
from rtamt.language.parsing.parser import parse_formula

TEXT = "asked = req >= 3; granted = eventually[0:2](gnt >= 3); always[0:2](asked -> granted)"
TIMES = pytest.mark.parametrize("time", ["discrete", "dense"])
BACKENDS = pytest.mark.parametrize("backend", ["cpp", "python"])


@BACKENDS
def test_each_sub_specification_is_known_at_its_own_horizon(backend: str) -> None:
    monitor = rtamt.parse(TEXT, backend=backend).monitor(watch=("asked", "granted", "gnt - req"))
    assert monitor["asked"] is None
    told = []
    for t, (req, gnt) in enumerate([(5, 1), (2, 4), (1, 0), (0, 0), (0, 0)]):
        result = monitor.update(float(t), req=req, gnt=gnt)
        told.append((result, monitor["asked"], monitor["granted"], monitor["gnt - req"]))
    assert told == [
        (None, 2.0, None, -4.0),
        (None, -1.0, None, 2.0),
        (None, -2.0, 1.0, -1.0),
        (None, -3.0, 1.0, 0.0),
        (1.0, -3.0, -3.0, 0.0),
    ]
    assert repr(monitor.finish()) == "Signal(times=array([1., 2., 3., 4.]), values=array([1., 2., 3., 3.]))"
    assert repr(monitor["granted"]) == "Signal(times=array([3., 4.]), values=array([-3., -3.]))"
    assert repr(monitor["asked"]) == "Signal(times=array([], dtype=float64), values=array([], dtype=float64))"
    monitor.reset()
    assert monitor["granted"] is None


@BACKENDS
def test_a_chunk_makes_all_of_it_known(backend: str) -> None:
    monitor = rtamt.parse(TEXT, backend=backend).monitor(watch=["granted", "asked"])
    monitor.step(5, 1)
    assert len(monitor.update_many({"req": [2, 1, 0], "gnt": [4, 0, 0]})) == 0
    assert repr(monitor["asked"]) == "Signal(times=array([1., 2., 3.]), values=array([-1., -2., -3.]))"
    assert repr(monitor["granted"]) == "Signal(times=array([0., 1.]), values=array([1., 1.]))"
    monitor.step(0, 0)
    assert (monitor["asked"], monitor["granted"]) == (-3.0, -3.0)
    monitor.update_many({"req": [], "gnt": []})
    assert len(monitor["asked"]) == 0


@BACKENDS
def test_in_dense_time_a_watched_signal_is_told_as_the_result_is(backend: str) -> None:
    monitor = rtamt.parse(TEXT, backend=backend).monitor(time="dense", watch="granted")
    monitor.update(0.0, req=5.0, gnt=1.0)
    assert len(monitor["granted"]) == 0
    for t, gnt in ((1.0, 4.0), (4.5, 0.0)):
        monitor.update(t, gnt=gnt, req=0.0)
    assert repr(monitor["granted"]) == "Signal(times=array([0. , 2.5]), values=array([1., 1.]))"
    monitor.update_many({})
    assert len(monitor["granted"]) == 0
    with pytest.raises(TraceError):
        monitor.update(4.0, req=1.0)
    monitor.finish()
    assert repr(monitor["granted"]) == "Signal(times=array([4.5]), values=array([-3.]))"


@TIMES
@BACKENDS
def test_a_failed_update_leaves_what_is_watched_as_it_was(backend: str, time: Any) -> None:
    monitor = rtamt.parse("once[0:3](sqrt(x) >= 1)", backend=backend).monitor(time=time, watch="x")
    monitor.update(0.0, x=4.0)
    before = repr(monitor["x"])
    for t, x in ((1.0, -1.0), (-1.0, 4.0)):
        with pytest.raises(rtamt.StlError):
            monitor.update(t, x=x)
        assert repr(monitor["x"]) == before


@TIMES
def test_what_is_not_watched_is_an_error_that_lists_what_is(time: Any) -> None:
    spec = rtamt.parse(TEXT)
    with pytest.raises(
        UsageError,
        match=r"^'asket' is not watched; did you mean 'asked'\?; the monitor watches 'asked', 'req'$",
    ):
        spec.monitor(time=time, watch=["asked", "req", "asked"])["asket"]
    with pytest.raises(UsageError, match=r"^'asked' is not watched; name it in monitor\(watch=...\)$"):
        spec.monitor(time=time)["asked"]


@TIMES
def test_what_cannot_be_watched_says_why(time: Any) -> None:
    spec = rtamt.parse(
        "input float x; input float z; later = eventually(x >= 1); odd = z >= 1; require it: once(x >= 2)"
    )
    with pytest.raises(
        UsageError, match=r"^'odd' reads 'z', which the formula does not; watch what reads x only$"
    ):
        spec.monitor(time=time, watch="odd")
    with pytest.raises(rtamt.SpecificationError, match=r"eventually"):
        spec.monitor(time=time, watch="later")
    with pytest.raises(ParseError):
        spec.monitor(time=time, watch="x >=")
    with pytest.raises(NameInFormulaError):
        spec.monitor(time=time, watch="w >= 1")
    with pytest.raises(BoundError):
        spec.monitor(time=time, watch="once[0:1.0000000005] (x >= 1)")


@TIMES
@BACKENDS
def test_a_look_ahead_goes_its_own_way(backend: str, time: Any) -> None:
    monitor: Any = rtamt.parse("historically(x >= 0)", backend=backend).monitor(time=time, watch="x")
    monitor.update(0, x=5)
    for branch in (copy.copy(monitor), copy.deepcopy(monitor), pickle.loads(pickle.dumps(monitor))):
        assert repr(branch["x"]) == repr(monitor["x"])
        branch.update(1, x=-9)
        branch.finish()
        assert branch.samples == 2
    assert monitor.samples == 1
    assert repr(monitor.update(1, x=7)) in ("5.0", "Signal(times=array([1.]), values=array([5.]))")


@TIMES
def test_a_fresh_and_a_finished_monitor_can_be_copied_too(time: Any) -> None:
    fresh: Any = rtamt.parse("x >= 0", period="100ms").monitor(time=time)
    twin = pickle.loads(pickle.dumps(fresh))
    twin.update(0.5, x=1)
    assert (fresh.samples, twin.samples) == (0, 1)
    twin.finish()
    with pytest.raises(UsageError, match="has finished its trace"):
        copy.copy(twin).update(0.6, x=1)


def test_settings_survive_a_pickle() -> None:
    monitor = rtamt.parse("once[0:200ms](x >= 0)").monitor(period="100ms", tolerance=0.5, watch="x")
    monitor.update(0, x=1)
    twin = pickle.loads(pickle.dumps(monitor))
    assert (twin.update(0.14, x=-3), twin["x"]) == (1.0, -3.0)


def test_what_no_specification_has_made_cannot_be_pickled_but_copied() -> None:
    monitor = DenseMonitor(parse_formula("x >= 1"))
    assert copy.copy(monitor).input_names == ("x",)
    with pytest.raises(
        UsageError, match=r"^only a monitor that Specification.monitor\(\) has made can be pickled$"
    ):
        pickle.dumps(monitor)


def test_the_state_of_another_program_is_refused() -> None:
    one, other = (rtamt.parse(text).monitor() for text in ("once[0:2](x >= 1)", "once[0:3](x >= 1)"))
    with pytest.raises(UsageError, match=r"compiles its formula to another program; make a new monitor$"):
        one._resume(other._state())
    with pytest.raises(ValueError, match=r"^This is not the state of a monitor of this program\.$"):
        one._backend.restore(other._backend.state()[:-1])


@BACKENDS
def test_a_variable_called_time(backend: str) -> None:
    """Once an error about dimensions: 'time' was taken for timestamps that all variables share."""
    spec = rtamt.parse("time >= 1", backend=backend, time="dense")
    monitor: Any = spec.monitor()
    monitor.update(0.0, time=3.0)
    assert repr(monitor.update(1.0, time=0.5)) == "Signal(times=array([1.]), values=array([-0.5]))"
    assert (
        repr(monitor.update_many({"time": ([2.0], [4.0])})) == "Signal(times=array([2.]), values=array([3.]))"
    )
    assert spec.evaluate({"time": ([0.0, 1.0], [3.0, 0.5])}).signal.values.tolist() == [2.0, -0.5]
    with pytest.raises(TraceError, match=r"^the formula has no variable 'time'; variables: x$"):
        rtamt.parse("x >= 1", backend=backend).monitor(time="dense").update(0.0, x=1.0, time=2.0)


@BACKENDS
def test_in_dense_time_objects_are_taken_apart_and_what_is_not_read_is_left_out(backend: str) -> None:
    text = "from msgs import Req; input Req req; input float other; req.value >= 1"
    monitor = rtamt.parse(text, backend=backend).monitor(time="dense")
    for t in (0.0, 1.0):
        signal = monitor.update(t, req=SimpleNamespace(value=3.0 + t), other=1.0)
        assert (signal.times.tolist(), signal.values.tolist()) == ([t], [2.0 + t])
    with pytest.raises(TraceError, match="'req' has no field 'value' at sample 2"):
        monitor.update(2.0, req=SimpleNamespace(wrong=1))


@BACKENDS
def test_times_too_far_for_ticks_are_told_without_a_warning(backend: str) -> None:
    monitor = rtamt.parse("x >= 1", backend=backend).monitor(time="dense")
    for _ in range(2):
        with pytest.raises(
            TraceError, match=r"^the time of 'x' is 1e\+300 at sample \d, too large for seconds"
        ):
            monitor.update(1e300, x=1.0)
        monitor.update(monitor.samples * 1.0, x=1.0)


def test_datetimes_of_any_time_zone_are_instants() -> None:
    noon = datetime(2024, 6, 1, 12, tzinfo=timezone.utc)
    later = datetime(2024, 6, 1, 14, 0, 1, tzinfo=timezone(timedelta(hours=2)))
    monitor = rtamt.parse("x >= 1").monitor(time="dense")
    monitor.update(noon, x=2.0)
    signal = monitor.update(later, x=3.0)
    assert signal.times.tolist() == np.array(["2024-06-01T12:00:01"], "datetime64[ns]").tolist()
