"""The end of a trace: every kind of monitor reports it once, and takes no sample after it."""

import pytest

import rtamt
from tests.unit.engine.test_update_arguments import KINDS, opened

NOTHING = {
    "discrete": {
        "delayed": "Signal(times=array([], dtype=float64), values=array([], dtype=float64))",
        "eager": "[]",
        "interval": "[]",
        "causation": "None",
    },
    "dense": {
        "delayed": "Signal(times=array([], dtype=float64), values=array([], dtype=float64))",
        "eager": "[]",
        "interval": "[]",
        "causation": "Causation(violation=inf, satisfaction=-inf)",
    },
}
FINISHED = "the monitor has finished its trace; call reset() before the next sample"


def is_over(monitor, kind):
    assert repr(monitor.finish()) == NOTHING[kind["time"]][kind.get("verdict", "delayed")]


@pytest.mark.parametrize("formula", ["eventually[0:2](x > 0)", "x > 0", "once[0:1](x > 0)"])
@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(kind.values()))
def test_a_second_finish_does_not_repeat_the_report_of_the_first(kind, formula):
    monitor = opened(kind, formula=formula)
    for time in range(3):
        monitor.update(time, x=float(time))
    monitor.finish()
    is_over(monitor, kind)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: "-".join(kind.values()))
def test_no_sample_is_taken_after_the_end(kind):
    monitor = opened(kind, formula="eventually[0:2](x > 0)")
    monitor.update(0, x=1.0)
    monitor.finish()
    samples = {"x": ([3.0], [1.0])} if kind["time"] == "dense" else {"time": [3.0], "x": [1.0]}
    calls = {
        "update": lambda: monitor.update(3, x=1.0),
        "carefully": lambda: monitor.update(3, x=1),
        "update_many": lambda: monitor.update_many(samples),
        "step": lambda: monitor.step(1.0),
        "watermark": lambda: monitor.watermark(3),
        "advance": lambda: monitor.advance(3),
    }
    for name, call in calls.items():
        if hasattr(monitor, name) or name == "carefully":
            with pytest.raises(rtamt.UsageError) as caught:
                call()
            assert str(caught.value) == FINISHED, name
    is_over(monitor, kind)
    monitor.reset()
    monitor.update(0, x=1.0)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("time", "settings"),
    [("discrete", {}), ("discrete", {"verdict": "interval"}), ("dense", {})],
    ids=["discrete", "interval", "dense"],
)
def test_a_second_finish_of_quantifiers_does_not_repeat_the_report_of_the_first(backend, time, settings):
    text = 'group cars = "car_*"\nforall v in cars: eventually[0:2](v.x >= 3)'
    monitor = rtamt.parse(text, time=time, backend=backend).monitor(**settings)
    monitor.update(0, **{"car_1.x": 1.0})
    monitor.update(1, **{"car_1.x": 2.0})
    assert len(monitor.finish())
    assert len(monitor.finish()) == 0
    with pytest.raises(rtamt.UsageError) as caught:
        monitor.update(2, **{"car_1.x": 2.0})
    assert str(caught.value) == FINISHED
