"""In which direction a parameter moves the verdict, by the formula alone."""

import pytest

import rtamt
from rtamt.errors import UsageError
from rtamt.mining import directions


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("always(x <= p)", "larger"),
        ("always(x < p)", "larger"),
        ("always(x >= p)", "smaller"),
        ("not always(x >= p)", "larger"),
        ("x >= p -> y >= 1", "larger"),
        ("y >= 1 -> x >= p", "smaller"),
        ("x == p", "unknown"),
        ("x != p", "unknown"),
        ("abs(x - p) <= 2", "unknown"),
        ("abs(x) <= 2 * p", "larger"),
        ("abs(x) <= -2 * p", "smaller"),
        ("abs(x) <= p * y", "unknown"),
        ("x / 2 - p / -4 >= 0", "larger"),
        ("x >= 1 <-> y >= p", "unknown"),
        ("x <= p and x >= p", "unknown"),
        ("x <= p or y <= p", "larger"),
        ("duration[0:5](x >= p) <= 3", "unknown"),
        ("count[0:5](x >= p) <= 3", "unknown"),
        ("sum[0:5](max(x, p)) <= 3", "smaller"),
        ("(if x >= p then 1 else 2) <= 1", "unknown"),
        ("(if x >= 1 then p else y) <= 1", "smaller"),
        ("atleast[0:5](80%, x <= p)", "larger"),
        ("eventually[0:p](x >= 1)", "larger"),
        ("always[0:p](x >= 1)", "smaller"),
        ("always[p:9](x >= 1)", "larger"),
        ("once[p:9](x >= 1)", "smaller"),
        ("minimum[0:p](x) >= 1", "smaller"),
        ("x >= 1 until[0:p] y >= 1", "larger"),
        ("x >= 1 since[p:9] y >= 1", "smaller"),
        ("x >= 1 unless[0:p] y >= 1", "unknown"),
        ("always[p:p](x >= 1)", "unknown"),
        ("always[p:2](x >= 1)", "larger"),
        ("delay[p](x) >= 1", "unknown"),
        ("sum[0:p](x) >= 1", "unknown"),
        ("atleast[0:p](80%, x <= 1)", "unknown"),
        ("eventually[0:p](always[0:p](x >= 1))", "unknown"),
        ("always[0:p](x >= p)", "smaller"),
        ("always[0:p](x <= p)", "unknown"),
        ("eventually[0:p](x <= p)", "larger"),
        ("x <= p unless[0:p] y >= 1", "unknown"),
    ],
)
def test_direction(text, expected):
    assert directions(rtamt.parse(f"parameter float p = 2  {text}", period=1)) == {"p": expected}


def test_a_range_decides_the_sign_of_a_factor():
    spec = rtamt.parse("parameter float p = 2  parameter float q = 2  x <= p * q")
    assert directions(spec) == {"p": "unknown", "q": "unknown"}
    assert directions(spec, {"p": (0, 3), "q": (-3, 0)}) == {"p": "smaller", "q": "larger"}


def test_a_parameter_with_a_unit_and_one_in_a_definition():
    spec = rtamt.parse(
        "parameter float w = 400 [ms]  parameter float p = 1  near = x <= p\ndef soon(d) = eventually[0:d](near)\n"
        "always(y >= 1 -> soon(w))",
        period="100ms",
    )
    assert directions(spec) == {"w": "larger", "p": "larger"}


def test_two_bounds_of_one_interval():
    spec = rtamt.parse("parameter float a = 1  parameter float b = 2  always[a:b](x >= 0)", period=1)
    with pytest.raises(UsageError) as failure:
        directions(spec)
    assert str(failure.value) == (
        "'a' and 'b' bound the same interval; mine one of them, with a value for the other"
    )
