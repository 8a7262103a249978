"""delay, ahead, diff, rate, held and if, worked out by hand: both time domains, both back ends, online too."""

from __future__ import annotations

import pickle
from typing import Any

import pytest

import rtamt

X, Y = [1.0, 4.0, 2.0, -3.0, 0.0, 7.0], [0.0, 1.0, 0.0, 0.0, 1.0, 0.0]

DISCRETE = [
    ("delay(x)", [1, 1, 4, 2, -3, 0]),
    ("delay[2](x, y)", [0, 1, 1, 4, 2, -3]),
    ("ahead[2](x)", [2, -3, 0, 7, 7, 7]),
    ("diff[2](x)", [0, 3, 1, -7, -2, 10]),
    ("rate(x)", [0, 6, -4, -10, 6, 14]),
    ("held(x, y > 0)", [1, 4, 4, 4, 0, 0]),
    ("held(x, y > 0, -9)", [-9, 4, 4, 4, 0, 0]),
    ("if y > 0 then x else -x", [-1, 4, -2, 3, 0, -7]),
]


def columns(spec: rtamt.Specification) -> dict[str, Any]:
    return {name: {"x": X, "y": Y}[name] for name in spec.input_names}


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(("text", "expected"), DISCRETE)
def test_discrete_offline_and_online_through_a_pickle(text: str, expected: list[float], backend: str) -> None:
    text = text.replace("[2]", "[1]")  # two periods
    spec = rtamt.parse(text, period="500ms", backend=backend)
    assert spec.evaluate(columns(spec)).signal.values.tolist() == expected
    monitor = spec.monitor()
    told = []
    for i in range(len(X)):
        value = monitor.update(i / 2, **{name: column[i] for name, column in columns(spec).items()})
        told += [] if value is None else [value]
        monitor = pickle.loads(pickle.dumps(monitor))
    assert [*told, *monitor.finish().values] == expected


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "times", "values"),
    [
        ("delay[2](x)", [0, 5, 9], [1, 4, 2]),
        ("delay[2](x, 0)", [0, 2, 5, 9], [0, 1, 4, 2]),
        ("ahead[2](x)", [0, 1, 5, 9], [1, 4, 2, 2]),
        ("rate[2](x)", [0, 3, 5, 7, 9], [0, 1.5, 0, -1, 0]),
        # Just before y ended being positive, at 5, x was 4.
        ("held(x, y > 0)", [0, 4, 9], [1, 4, 4]),
        ("held(x, y > 0, -1)", [0, 4, 9], [-1, 4, 4]),
    ],
)
def test_dense(text: str, times: list[float], values: list[float], backend: str) -> None:
    spec = rtamt.parse(text, time="dense", backend=backend)
    data = {"x": [[0, 1], [3, 4], [7, 2], [9, 2]], "y": [[0, 0], [4, 1], [5, 0], [9, 0]]}
    signal = spec.evaluate({name: data[name] for name in spec.input_names}).signal
    assert (signal.times.tolist(), signal.values.tolist()) == (times, values)


@pytest.mark.parametrize(
    ("text", "past"),
    [
        ("ahead[2](x) > x", "(if once[2:2] true then x else 1) > delay[2](x)"),
        ("minimum[0:2](ahead[1](x)) > 0", "minimum[0:2](if once[1:1] true then x else inf) > 0"),
        (
            "delay[1](ahead[2](x)) > y",
            "(if once[2:2] true then (if once[3:3] true then delay[1](x) else held(x, rise(once[2:2] true))) else 1)"
            " > delay[2](y)",
        ),
    ],
)
def test_a_number_of_the_future_becomes_one_of_the_past(text: str, past: str) -> None:
    assert str(rtamt.parse(text).pastified()) == past


def test_dense_time_has_no_sampling_period_to_leave_out() -> None:
    with pytest.raises(
        rtamt.SpecificationError, match="'delay' without a duration means one sampling period"
    ):
        rtamt.parse("delay(x) > 0", time="dense").evaluate({"x": [[0, 1]]})


def test_bounds_of_an_open_condition_are_the_hull_of_both_numbers() -> None:
    monitor = rtamt.parse("if next(y > 0) then x else 5").monitor(verdict="interval")
    monitor.update(0, x=1, y=0)
    assert monitor.interval(0) == rtamt.Interval(1, 5)
