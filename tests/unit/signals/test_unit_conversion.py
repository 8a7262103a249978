"""Values in the declared unit: exact factors and offsets, and never a silent wrong scale."""

import sys
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rtamt.errors import TraceError, UsageError
from rtamt.signals.unit_conversion import Conversion, conversion_of, converted

CASES = [
    ("km/h", "m/s", Fraction(5, 18), 0),
    ("kmph", "m/s", Fraction(5, 18), 0),
    ("m/s", "km/h", Fraction(18, 5), 0),
    ("degC", "K", 1, Fraction(27315, 100)),
    ("°F", "°C", Fraction(5, 9), Fraction(-160, 9)),
    ("rpm", "deg/s", 6, 0),
    ("mm", "m", Fraction(1, 1000), 0),
    ("%", "-", Fraction(1, 100), 0),
    ("1/min", "Hz", Fraction(1, 60), 0),
    ("bar", "Pa", 100_000, 0),
    ("kg/(m*s)", "g/(cm*s)", 10, 0),
    ("inch", "mm", Fraction(127, 5), 0),
]


@pytest.mark.parametrize(("recorded", "declared", "scale", "offset"), CASES)
def test_conversions_are_exact(recorded, declared, scale, offset):
    assert conversion_of("v", recorded, declared) == Conversion(Fraction(scale), Fraction(offset))


@pytest.mark.parametrize(
    ("recorded", "declared"),
    [("m", "m"), ("m / s", "m/s"), ("m/s²", "m/s^2"), ("N*m", "J"), ("km/h", "kmph")],
)
def test_the_same_unit_changes_nothing(recorded, declared):
    values = np.array([-0.0, 1.5])
    assert converted(values, "v", recorded, declared) is values


def test_equal_texts_need_no_library(monkeypatch):
    monkeypatch.setitem(sys.modules, "pint", None)
    assert conversion_of("v", "bananas", "bananas") is None
    with pytest.raises(UsageError) as caught:
        conversion_of("v", "km/h", "m/s")
    assert str(caught.value) == (
        "converting 'v' from km/h to m/s needs the package 'pint', which is not installed: pip install 'rtamt[units]'"
    )


MESSAGES = [
    ("kg", "m", "'v' is recorded in kg, which cannot be converted to m, its declared unit"),
    # radians have no dimension in pint: 1 rpm would be 0.105 Hz
    ("rpm", "Hz", "'v' is recorded in rpm, which cannot be converted to Hz, its declared unit"),
    ("deg", "-", "'v' is recorded in deg, which cannot be converted to -, its declared unit"),
    ("dB", "-", "'v' is recorded in dB, which cannot be converted to -, its declared unit"),
    ("foo", "m", "the recorded unit 'foo' of 'v' is unknown, so that it cannot be converted (declared: m); declare the "
     "recorded unit, or give another one to rtamt.read(units=...)"),
    ("m", "foo", "the declared unit 'foo' of 'v' is unknown, so that it cannot be converted (recorded: m); declare the "
     "recorded unit, or give another one to rtamt.read(units=...)"),
]  # fmt: skip


@pytest.mark.parametrize(("recorded", "declared", "message"), MESSAGES)
def test_what_cannot_be_converted(recorded, declared, message):
    with pytest.raises(TraceError) as caught:
        conversion_of("v", recorded, declared)
    assert str(caught.value) == message
    assert caught.value.variable == "v"


@pytest.mark.parametrize(
    "hostile",
    ["9**9**9**9", "m**99999999", "m" * 10**6, "(" * 10**4, "exit()", "m\x00", "1e999 m", "{}", "m*" * 29],
)
def test_a_hostile_unit_is_unknown(hostile):
    with pytest.raises(TraceError, match="unit"):
        conversion_of("v", hostile, "m")


def test_a_value_beyond_a_double_is_an_error_and_infinity_is_none():
    assert converted(np.array([np.inf, -np.inf]), "v", "km", "m").tolist() == [np.inf, -np.inf]
    with pytest.raises(TraceError) as caught:
        converted(np.array([1.0, 1e306]), "v", "km", "m")
    assert str(caught.value) == "'v' is 1e+306 km at sample 1, beyond the range of a double in m"


@given(st.integers(-(2**30), 2**30), st.sampled_from(CASES))
def test_what_is_a_double_in_both_units_is_converted_exactly(number, case):
    _, _, scale, offset = case
    exact = number * Fraction(scale) + Fraction(offset)
    assert Conversion(Fraction(scale), Fraction(offset))(np.array([float(number)]))[0] == pytest.approx(
        float(exact), rel=4e-16, abs=0
    )
    if exact.denominator == 1:
        assert Conversion(Fraction(scale), Fraction(offset))(float(number)) == float(exact)
