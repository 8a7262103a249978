"""What is no time and no number, in both time domains, both back ends, and on every way in."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from decimal import Decimal
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
import pytest

import rtamt

NO_LENGTH = "a timedelta64 without a unit of fixed length"
BEYOND = "cannot reach"
TOO_FAR = "too far from 0"

#: Times, and what is said of them in dense time, in discrete time, and by the reader.
TIMES: dict[str, tuple[Any, str, str, str]] = {
    "timedeltas without a unit": (np.array([0, 1], "m8"), NO_LENGTH, NO_LENGTH, NO_LENGTH),
    "one of them in a list": ([np.timedelta64(0, "s"), np.timedelta64(1)], NO_LENGTH, NO_LENGTH, NO_LENGTH),
    "months": (np.array([0, 1], "m8[M]"), NO_LENGTH, NO_LENGTH, NO_LENGTH),
    "datetime.min": ([datetime.min, datetime.min + timedelta(1)], TOO_FAR, BEYOND, BEYOND),
    "datetime.min in a zone": (
        [
            datetime.min.replace(tzinfo=timezone(timedelta(hours=1))),
            datetime(2020, 1, 1, tzinfo=timezone.utc),
        ],
        TOO_FAR,
        BEYOND,
        BEYOND,
    ),
    "the year 9999": (np.array(["9999-01-01", "9999-01-02"], "M8[us]"), TOO_FAR, BEYOND, BEYOND),
    "the year 9999 of pandas": (
        pd.Series(np.array(["9999-01-01", "9999-01-02"], "M8[us]")),
        TOO_FAR,
        BEYOND,
        BEYOND,
    ),
    "the year 9999 of polars": (
        pl.Series([datetime(9999, 1, 1), datetime(9999, 1, 2)]),
        TOO_FAR,
        BEYOND,
        BEYOND,
    ),
    "the year 9999 beside nanoseconds": (
        [np.datetime64("9999-01-01", "s"), np.datetime64("2020-01-01", "ns")],
        TOO_FAR,
        BEYOND,
        BEYOND,
    ),
    "years without end": (np.array([10**15, 10**16], "M8[Y]"), TOO_FAR, BEYOND, BEYOND),
    "complex": (np.array([0, 1], complex), "expected a number", "expected a number", "expected a number"),
    "ragged": ([0, [1, 2]], "is [1, 2] at sample 1", "is [1, 2] at sample 1", "cannot be read as a sequence"),
    "a longdouble": (
        np.array(["0", "1e400"], np.longdouble),
        "give a finite time",
        "beyond the range of a double",
        "beyond the range of a double",
    ),
    "infinity": ([0.0, float("inf")], "give a finite time", "give a finite", "expected a finite number"),
    "masked": (
        np.ma.masked_array([0.0, 1.0], [False, True]),
        "give a finite time",
        "give a finite",
        "is empty",
    ),
    "texts": (["0", "1"], "expected a number", "expected a number", "expected a number"),
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("times", "dense", "discrete", "read"), TIMES.values(), ids=TIMES)
def test_times_that_are_none(times: Any, dense: str, discrete: str, read: str) -> None:
    def by_reader() -> Any:
        return rtamt.parse("x").evaluate(rtamt.read({"time": times, "x": [1.0, 2.0]}))

    data = {"time": times, "x": [1.0, 2.0]}
    ways: list[tuple[Any, str]] = [(by_reader, read)]
    for backend in ("cpp", "python"):
        spec = rtamt.parse("x", backend=backend)
        ways += [
            (lambda spec=spec: spec.evaluate(data, time="dense"), dense),
            (lambda spec=spec: spec.monitor(time="dense").update_many({"x": (times, [1.0, 2.0])}), dense),
            (lambda spec=spec: rtamt.check_stream(spec, [data], time="dense"), dense),
            (lambda spec=spec: spec.evaluate(data), discrete),
            (lambda spec=spec: spec.monitor().update_many(data), discrete),
            (lambda spec=spec: rtamt.check_stream(spec, [data]), discrete),
        ]
    for way, said in ways:
        with pytest.raises(rtamt.TraceError) as error:
            way()
        assert said in str(error.value)
        assert "\n" not in str(error.value)


VALUES: dict[str, Any] = {
    "a duration": np.timedelta64(5, "s"),
    "a duration without a unit": np.timedelta64(5),
    "a decimal": Decimal(1),
    "a longdouble beyond every double": np.longdouble("1e400"),
    "an integer beyond every double": 10**400,
    "complex": 1j,
}


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("value", VALUES.values(), ids=VALUES)
@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["dense", "discrete"])
def test_values_that_are_no_numbers(value: Any, backend: str, time: str) -> None:
    spec = rtamt.parse("x", backend=backend, time=time)
    for way in (
        lambda: spec.evaluate({"time": [0.0, 1.0], "x": [1.0, value]}),
        lambda: spec.monitor(time=time).update_many(
            {"x": [[0.0, value]]} if time == "dense" else {"x": [value]}
        ),
        lambda: spec.monitor(time=time).update(0.0, x=value),
    ):
        with pytest.raises(rtamt.TraceError, match=r"expected a number|range of a double|has 2 dimensions"):
            way()
    monitor = spec.monitor(time=time)
    monitor.update(0.0, x=1.0)
    with pytest.raises(
        rtamt.TraceError, match=r"^'x' is .* at sample 1, (expected a number|beyond the range .*)$"
    ):
        monitor.update(1.0, x=value)
    assert monitor.samples == 1


@pytest.mark.parametrize(
    "time", [{"x": 1.0}, None, float("nan"), [1], "1", np.timedelta64(5), Decimal(1)], ids=str
)
@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("domain", ["dense", "discrete"])
@pytest.mark.parametrize("values", [{}, {"x": 1.0}], ids=["nothing", "x"])
def test_an_update_at_what_is_no_time(time: Any, backend: str, domain: str, values: dict[str, float]) -> None:
    for before in (0, 1):
        monitor: Any = rtamt.parse("x", backend=backend).monitor(time=domain)
        for i in range(before):
            monitor.update(float(i), x=1.0)
        with pytest.raises(rtamt.TraceError, match=r"time"):
            monitor.update(time, **values)
        assert monitor.samples == before


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_a_dense_update_without_values_tells_nothing(backend: str) -> None:
    monitor = rtamt.parse("x", backend=backend).monitor(time="dense")
    assert len(monitor.update(1.0)) == 0
    assert monitor.update(0.0, x=1.0).points() == [(0.0, 1.0)]
    assert len(monitor.update(5.0)) == 0
    assert monitor.update(1.0, x=2.0).points() == [(1.0, 2.0)]


def test_integers_of_polars_with_128_bits_are_numbers() -> None:
    series = pl.Series([0, 1], dtype=pl.Int128)
    for time in ("dense", "discrete"):
        assert rtamt.parse("x").evaluate({"time": series, "x": series}, time=time).signal.values.tolist() == [
            0,
            1,
        ]
    assert rtamt.read(pl.DataFrame({"time": series, "x": series}))["x"].values.tolist() == [0, 1]


@pytest.mark.parametrize("time", ["dense", "discrete"])
def test_a_unit_that_is_none_and_one_too_many(time: str) -> None:
    spec = rtamt.parse("x", time=time)
    for call in (
        lambda: spec.evaluate({"time": [0], "x": [1]}, time_unit="day"),
        lambda: spec.monitor(time=time, time_unit="day"),
        lambda: rtamt.read({"time": [0], "x": [1]}, time_unit="day"),
        lambda: rtamt.check_stream(spec, [], time=time, time_unit="day"),
    ):
        with pytest.raises(
            rtamt.UsageError, match=r"^'day' is not a unit of time; units: h, min, s, ms, us, ns$"
        ):
            call()
    read = rtamt.read({"time": [0, 1], "x": [1, 2]})
    for call in (
        lambda: spec.evaluate(read, time_unit="ns"),
        lambda: spec.monitor(time=time, time_unit="ns").update_many(read),
        lambda: rtamt.check_stream(spec, [read], time=time, time_unit="ns"),
    ):
        with pytest.raises(rtamt.UsageError) as error:
            call()
        assert str(error.value) == (
            "a trace that was read knows its unit of time: give time_unit= to rtamt.read, "
            "not to what takes the trace"
        )
    with pytest.raises(rtamt.TraceError, match=r"expected a number of ns"):
        spec.evaluate({"time": np.array([0], "M8[s]"), "x": [1]}, time_unit="ns")


@pytest.mark.parametrize("number", [1_700_000_000_123, 1_700_000_000_123.0, 17 * 10**14, 17 * 10**17])
@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_milliseconds_since_1970_are_never_seconds_in_one_place_and_milliseconds_in_another(
    time: str, backend: str, number: float
) -> None:
    unit = {13: "ms", 16: "us", 19: "ns"}[len(f"{number:.0f}")]
    spec = rtamt.parse("historically[0:1](x >= 0)", time=time, backend=backend, resolution="1ms")
    data = {"time": [number, number + 1000], "x": [1, -1]}
    ways = {
        "evaluate": lambda: spec.evaluate(data),
        "array": lambda: spec.evaluate({"time": np.array(data["time"]), "x": np.array(data["x"])}),
        "frame": lambda: spec.evaluate(pd.DataFrame(data)),
        "read": lambda: rtamt.read(data),
        "read a frame": lambda: rtamt.read(pd.DataFrame(data)),
        "stream": lambda: rtamt.check_stream(spec, [data]),
        "batch": lambda: rtamt.evaluate_batch(spec, [data]),
        "update": lambda: spec.monitor().update(number, x=1),
        "update_many": lambda: spec.monitor().update_many(data),
    }
    for way, call in ways.items():
        with pytest.raises(rtamt.TraceError) as info:
            call()
        assert f"is {number} at sample 0, too large for seconds: if it counts {unit}" in str(info.value), way
    assert rtamt.parse("x").evaluate({**data, "time": [1e10, 1e10 + 1]}).robustness == 1
