"""Every sentence about intervals that cannot be used, in full, with its caret."""

from __future__ import annotations

import pytest

import rtamt


def test_a_bound_that_is_no_multiple_of_the_period() -> None:
    with pytest.raises(rtamt.BoundError) as info:
        rtamt.parse("always[0:0.25](x >= 3)", period="100ms")
    assert str(info.value) == (
        "The operator bound must be a multiple of the sampling period: 250 ms is not a whole number of periods "
        "of 100 ms; change the bound or the period\n"
        "  line 1, column 7:\n"
        "    always[0:0.25](x >= 3)\n"
        "          ^^^^^^^^"
    )


def test_the_period_may_also_come_with_the_data() -> None:
    spec = rtamt.parse("always[0:1](x >= 3)")
    place = "\n  line 1, column 7:\n    always[0:1](x >= 3)\n          ^^^^^"
    with pytest.raises(rtamt.BoundError) as info:
        spec.evaluate({"time": [0, 2], "x": [1, 2]})
    assert str(info.value) == (
        "The operator bound must be a multiple of the sampling period: 1 s is not a whole number of periods "
        "of 2 s; change the bound or the period (the period was taken from the timestamps; period=, or "
        "on the command line --period, sets it)" + place
    )
    with pytest.raises(rtamt.BoundError) as info:
        spec.monitor(period="300ms")
    assert str(info.value) == (
        "The operator bound must be a multiple of the sampling period: 1 s is not a whole number of periods "
        "of 300 ms; change the bound or the period" + place
    )


@pytest.mark.parametrize(
    "use",
    [
        lambda spec: spec.monitor(),
        lambda spec: spec.monitor(verdict="eager"),
        lambda spec: spec.evaluate({"x": [1, 2]}),
        lambda spec: rtamt.Fleet(spec, 1),
    ],
)
def test_a_period_that_nobody_gave_is_named_as_the_default(use) -> None:
    with pytest.raises(rtamt.BoundError) as info:
        use(rtamt.parse("always[0:500ms](x >= 3)"))
    assert str(info.value) == (
        "The operator bound must be a multiple of the sampling period: 500 ms is not a whole number of periods of 1 s; "
        "change the bound or the period (the period is the default; period=, or on the command line --period, sets it)"
        "\n  line 1, column 7:\n    always[0:500ms](x >= 3)\n          ^^^^^^^^^"
    )


@pytest.mark.parametrize(
    ("text", "settings", "sentence", "marks"),
    [
        (
            "always(1, 2) x",
            {"period": 1},
            "the interval (1:2) is empty: with a sampling period of 1 s no period lies in it; "
            "close a bound, or choose a shorter period",
            "      ^^^^^^",
        ),
        (
            "x since(0, 1us) y",
            {"time": "dense", "resolution": "1us"},
            "the interval (0:1us) is empty: with a resolution of 1 us no tick lies in it; "
            "close a bound, or choose a finer resolution",
            "       ^^^^^^^^",
        ),
    ],
)
def test_a_half_open_interval_that_contains_no_step(
    text: str, settings: dict[str, object], sentence: str, marks: str
) -> None:
    with pytest.raises(rtamt.BoundError) as info:
        rtamt.parse(text, **settings)
    assert str(info.value) == f"{sentence}\n  line 1, column {marks.index('^') + 1}:\n    {text}\n    {marks}"


def test_unbounded_future_online() -> None:
    with pytest.raises(rtamt.BoundError) as info:
        rtamt.parse("x >= 1 and (eventually y >= 1)").monitor()
    assert str(info.value) == (
        "'eventually' without an upper bound needs the whole future and cannot be monitored online; "
        "give it a bound, such as eventually[0:10], evaluate the finished trace offline, "
        "or monitor its bounds or verdicts (verdict='interval', 'eager')\n"
        "  line 1, column 13:\n"
        "    x >= 1 and (eventually y >= 1)\n"
        "                ^^^^^^^^^^^^^^^^^"
    )


def test_unbounded_future_cannot_be_pastified() -> None:
    with pytest.raises(rtamt.BoundError) as info:
        rtamt.parse("always(x >= 1)").pastified()
    assert str(info.value) == (
        "Cannot pastify an unbounded always. Give it an upper bound, such as always[0:10]\n"
        "  line 1, column 1:\n"
        "    always(x >= 1)\n"
        "    ^^^^^^^^^^^^^^"
    )


def test_tenths_are_exact_multiples() -> None:
    spec = rtamt.parse("always[0:0.3](x >= 3)", period=0.1)
    assert spec.evaluate({"x": [4, 5, 6, 1]}).robustness == -2


def test_nested_bounds_that_add_up_to_more_than_ticks_can_count():
    text = "always[0:7e7] " * 40 + "x"
    message = (
        "the bounds from here inwards add up to 2310000000 s, 2.31e+18 ticks of 1 ns, more than can be counted; "
        "shorten them, or choose a coarser resolution"
    )
    spec = rtamt.parse(text)
    for call in (
        lambda: rtamt.parse(text, time="dense"),
        lambda: spec.evaluate({"x": [[0, 1]]}, time="dense"),
        lambda: spec.monitor(time="dense"),
    ):
        with pytest.raises(rtamt.BoundError) as info:
            call()
        assert info.value.message == message
        assert info.value.span.start == 7 * len("always[0:7e7] ") + len("always")
    assert spec.evaluate({"x": [[0, 1]]}, time="dense", resolution="1us").robustness == 1.0


@pytest.mark.parametrize(
    ("unit", "text", "sentence", "marks"),
    [
        (
            "m",
            "always[0:k](x >= 3)",
            "'k' is in m, and a bound is a time: declare it in h, min, s, ms, us or ns, or without a unit",
            "         ^",
        ),
        (
            "m/s",
            "f(x, k)",
            "in 'f': 'w' is in m/s, and a bound is a time: declare it in h, min, s, ms, us or ns, or without a unit",
            "^^^^^^^",
        ),
        (
            "ms",
            "always[0:k ms](x >= 3)",
            "'k' has a unit already, ms; leave out the unit here",
            "           ^^",
        ),
        (
            "ms",
            "always[0:k s](x >= 3)",
            "'k' has a unit already, ms; leave out the unit here",
            "           ^",
        ),
    ],
)
def test_a_constant_in_the_wrong_unit_for_a_bound(unit: str, text: str, sentence: str, marks: str) -> None:
    with pytest.raises(rtamt.BoundError) as info:
        rtamt.parse(f"const float k = 5 [{unit}]\ndef f(y, w) = always[0:w](y >= 3)\n{text}")
    assert str(info.value) == f"{sentence}\n  line 3, column {marks.index('^') + 1}:\n    {text}\n    {marks}"
