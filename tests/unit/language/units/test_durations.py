"""Durations: exact in, readable out."""

from fractions import Fraction

import numpy as np
import pytest

from rtamt.errors import UsageError
from rtamt.language.units.durations import UNITS, decimal, duration, exact, format_duration


@pytest.mark.parametrize(
    ("value", "unit", "seconds"),
    [
        ("100ms", "s", Fraction(1, 10)),
        (" 0.1 s ", "ms", Fraction(1, 10)),
        ("1/3s", "s", Fraction(1, 3)),
        ("1 / 3 ms", "s", Fraction(1, 3000)),
        ("1e-3", "ms", Fraction(1, 10**6)),
        ("1_000us", "s", Fraction(1, 1000)),
        (".5ns", "s", Fraction(5, 10**10)),
        (0.1, "s", Fraction(1, 10)),
        (5, "s", Fraction(5)),
        (5, "us", Fraction(5, 10**6)),
        (0, "s", Fraction(0)),
        (Fraction(1, 3), "s", Fraction(1, 3)),
        (np.float64(0.1), "s", Fraction(1, 10)),
        (np.float32(0.1), "s", Fraction(1, 10)),
        (np.int64(7), "ms", Fraction(7, 1000)),
    ],
)
def test_duration_is_exact(value, unit, seconds):
    assert duration(value, unit) == seconds


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        ("", "''"),
        ("fast", "'fast'"),
        ("ms", "'ms'"),
        ("1/0s", "'1/0s'"),
        ("1 2", "'1 2'"),
        ("inf", "'inf'"),
        ("1e999", "'1e999'"),
        ("1e-999999999", "'1e-999999999'"),
        ("9" * 5000, "'" + "9" * 12 + "..." + "9" * 13 + "'"),
        (float("inf"), "inf"),
        (float("nan"), "nan"),
        (True, "True"),
        (None, "None"),
        (1j, "1j"),
    ],
)
def test_no_duration(value, shown):
    with pytest.raises(UsageError) as info:
        duration(value)
    assert str(info.value) == f"{shown} is not a duration; write for example '100ms', '1/3s' or 5"


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: duration("5 day"), "'day' is not a unit of time; units: h, min, s, ms, us, ns"),
        (lambda: duration(5, "d"), "'d' is not a unit of time; units: h, min, s, ms, us, ns"),
        (lambda: duration("-1 s"), "a duration may not be negative, got '-1 s'"),
        (lambda: duration(-0.5), "a duration may not be negative, got -0.5"),
    ],
)
def test_unusable_duration(call, sentence):
    with pytest.raises(UsageError) as info:
        call()
    assert str(info.value) == sentence


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (Fraction(0), "0 s"),
        (Fraction(5), "5 s"),
        (Fraction(3, 2), "1.5 s"),
        (Fraction(1, 10), "100 ms"),
        (Fraction(1, 8), "125 ms"),
        (Fraction(25, 10**7), "2.5 us"),
        (Fraction(1, 10**9), "1 ns"),
        (Fraction(1, 10**10), "0.1 ns"),
        (Fraction(1, 3), "1/3 s"),
        (Fraction(-1, 10), "-100 ms"),
    ],
)
def test_format_duration(seconds, text):
    assert format_duration(seconds) == text


def test_decimal_is_exact_or_none():
    assert [decimal(Fraction(n, 40)) for n in (-1, 0, 1, 40, 41)] == ["-0.025", "0", "0.025", "1", "1.025"]
    assert decimal(Fraction(1, 7)) is None


def test_exact_refuses_what_no_double_holds():
    assert exact("0e-999999999") == 0
    with pytest.raises(ValueError, match=r"^1e-400 is beyond the range of a double$"):
        exact("1e-400")
    with pytest.raises(ValueError, match=r"1{4000} has more than 4,000 characters$"):
        exact("0." + "1" * 4000)


def test_units_cannot_be_changed():
    with pytest.raises(TypeError):
        UNITS["min"] = Fraction(60)
