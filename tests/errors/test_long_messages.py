"""What the caller gives is repeated in a message, but never pages of it."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING, Any

import pytest

import rtamt
from rtamt.errors import StlError

if TYPE_CHECKING:
    from collections.abc import Callable

DIGITS = "1" * 100_000
NUMBER = 10**6000  # more digits than Python writes
SPEC = rtamt.parse("always[0:1](x >= 3)")


def rtamts() -> Any:
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.declare_var("x", "float")
    spec.spec = "x >= 3"
    spec.parse()
    return spec


LONG: dict[str, Callable[[], Any]] = {
    "a number in a formula": lambda: rtamt.parse(f"x >= {DIGITS}"),
    "a number in a file": lambda: rtamt.parse(f"const float c = {DIGITS}  x >= c"),
    "a bound": lambda: rtamt.parse(f"always[0:0.{DIGITS}](x >= 3)").monitor(),
    "a unit": lambda: rtamt.parse(f"always[0:1{'q' * 100_000}](x >= 3)"),
    "no token": lambda: rtamt.parse(f"x >= 3 {'$' * 100_000}"),
    "a variable": lambda: rtamt.parse(f"{'y' * 100_000} >= 3").evaluate({"time": [0], "x": [1]}),
    "a key": lambda: SPEC.evaluate({"time": [0], "y" * 100_000: [1]}),
    "a watched formula": lambda: SPEC.monitor(watch="y" * 100_000),
    "a constant": lambda: rtamt.parse("x >= c", constants={"c": NUMBER}),
    "a period": lambda: SPEC.monitor(period=f"{DIGITS}ms"),
    "an integer as a period": lambda: SPEC.monitor(period=NUMBER),
    "a negative period": lambda: SPEC.monitor(period=-NUMBER),
    "a tiny period": lambda: SPEC.monitor(period=Fraction(1, NUMBER)),
    "a tiny resolution": lambda: SPEC.monitor(time="dense", resolution=Fraction(1, NUMBER)),
    "a tolerance": lambda: SPEC.monitor(tolerance=-NUMBER),
    "a value": lambda: SPEC.monitor().update(0, x=NUMBER),
    "a text as a value": lambda: SPEC.monitor().update(0, x=DIGITS),
    "a time": lambda: SPEC.monitor().update(NUMBER, x=1),
    "a dense time": lambda: SPEC.monitor(time="dense").update(NUMBER, x=1),
    "a column": lambda: SPEC.evaluate({"time": [0, 1], "x": [1, NUMBER]}),
    "a semantics": lambda: rtamt.parse("x", semantics=DIGITS),
    "pairs": lambda: rtamts().update(0, DIGITS),
    "a type": lambda: rtamt.StlDiscreteTimeSpecification().declare_var("x", DIGITS),
    "a sampling period": lambda: rtamt.StlDiscreteTimeSpecification().set_sampling_period(NUMBER, "s"),
    "a name": lambda: rtamts().get_value("y" * 100_000),
}


@pytest.mark.parametrize("what", LONG)
def test_a_message_repeats_no_pages(what: str) -> None:
    with pytest.raises(StlError) as caught:
        LONG[what]()
    assert len(str(caught.value)) < 1000


def test_what_is_abbreviated_says_so() -> None:
    with pytest.raises(StlError) as caught:
        rtamt.parse(f"x >= {DIGITS}")
    assert f"{'1' * 60}… (abbreviated: 100000 characters) …{'1' * 60}" in str(caught.value)
    with pytest.raises(StlError) as caught:
        SPEC.monitor().update(0, x=NUMBER)
    assert str(caught.value) == (
        "'x' is <an int of about 6001 digits> at sample 0, beyond the range of a double (1.8e308): use a larger unit"
    )
