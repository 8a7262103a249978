"""Numbers of Python that no double is near, and decimals that are no number."""

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pandas as pd
import pytest

import rtamt

BEYOND = "beyond the range of a double (1.8e308): use a larger unit"
LARGE = {
    "a decimal": (Decimal("1e400"), "Decimal('1E+400')"),
    "a negative decimal": (Decimal("-1e400"), "Decimal('-1E+400')"),
    "an integer": (10**400, "100000000000000000...0000000000000000000"),
    "a fraction": (Fraction(10**400, 3), "Fraction(1000...0000000000, 3)"),
    "a longdouble": (np.longdouble("1e400"), "np.longdouble('1e+400')"),
}
SIGNALING = Decimal("sNaN")


def message(action):
    with pytest.raises(rtamt.TraceError) as caught:
        action()
    return str(caught.value)


def ways(times, values):
    """The same columns in all containers of objects."""
    objects = {"time": np.array(times, object), "x": np.array(values, object)}
    return {
        "a dict": [{"time": times, "x": values}, objects, {"x": (times, values)}],
        "a pandas frame": [
            pd.DataFrame({n: pd.Series(column, dtype=object) for n, column in objects.items()})
        ],
    }.items()


@pytest.mark.parametrize(("value", "shown"), LARGE.values(), ids=LARGE)
def test_a_number_beyond_the_range_of_doubles_is_an_error_and_never_infinite(value, shown):
    """Decimal("1e400") was read as inf, which satisfies `x >= 0`."""
    for source, containers in ways([0, 1, 2], [1, value, 3]):
        for data in containers:
            assert message(lambda data=data: rtamt.read(data, columns=["x"])) == (
                f"'x' of {source} is {shown} at sample 1, {BEYOND}"
            )
            assert rtamt.read(data).names == ()
    for source, containers in ways([0, value, 2], [1, 2, 3]):
        for data in containers:
            assert message(lambda data=data: rtamt.read(data)) == (
                f"the time column 'time' of {source} is {shown} at sample 1, {BEYOND}"
            )


@pytest.mark.parametrize(("value", "shown"), [pair for name, pair in LARGE.items() if "decimal" not in name])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_evaluations_monitors_and_fleets_name_the_range_too(value, shown, time):
    spec = rtamt.parse("x", time=time)
    batch = {"time": [0.0, 1.0], "x": [1.0, value]}
    said = f"'x' is {shown} at sample 1, {BEYOND}"
    monitor = spec.monitor()
    monitor.update(0.0, x=1.0)
    for action in (
        lambda: spec.evaluate(batch),
        lambda: spec.monitor().update_many(batch),
        lambda: rtamt.check_stream(spec, [batch]),
        lambda: monitor.update(1.0, x=value),
    ):
        assert message(action) == said
    if time == "discrete":
        fleet = rtamt.Fleet(spec, capacity=1)
        assert message(lambda: fleet.update_many([7, 7], [0.0, 1.0], {"x": [1.0, value]})) == (
            f"key 7 at index 1 of the batch: 'x' is {shown}, {BEYOND}"
        )
        monitor = spec.monitor()
        assert message(lambda: monitor.update(value, x=1.0)) == f"time is {shown} at sample 0, {BEYOND}"


def test_a_signaling_nan_is_a_nan():
    """It was a ValueError of Decimal.__float__, and an InvalidOperation in pandas, for which NaN is missing."""
    for source, containers in ways([0, 1, 2], [1, SIGNALING, 3]):
        for data in containers:
            values = rtamt.read(data)["x"].values
            assert np.array_equal(values, [1, np.nan, 3] if source == "a dict" else [1, 3], equal_nan=True)
    for source, containers in ways([0, SIGNALING, 2], [1, 2, 3]):
        problem = "nan at sample 1, expected a finite number" if source == "a dict" else "empty at sample 1"
        for data in containers:
            assert message(lambda data=data: rtamt.read(data)) == (
                f"the time column 'time' of {source} is {problem}"
            )


def test_decimals_hold_nanoseconds_since_1970():
    """They were rounded to doubles, 256 ns apart."""
    stamps = [1_700_000_000_000_000_001, Decimal(1_700_000_000_000_000_101), Decimal("1.7000000000000002e18")]
    times = rtamt.read({"time": stamps, "x": [1, 2, 3]}, units={"time": "ns"})["x"].times
    assert times.astype(int).tolist() == [int(stamp) for stamp in stamps]
