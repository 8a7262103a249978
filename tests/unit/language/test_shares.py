"""Shares of a window: what is read and printed, values computed by hand, and what they are equal to."""

from __future__ import annotations

import copy
from fractions import Fraction
from math import inf

import numpy as np
import pytest

import rtamt
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.shares import Share, ShareKind

X = [5, 1, 4, 2, 3]


@pytest.mark.parametrize(
    ("text", "share"),
    [
        ("atleast[0:5](80%, x)", Share(Fraction(80), ShareKind.PERCENT)),
        ("wasatleast[0:5](100/3%, x)", Share(Fraction(100, 3), ShareKind.PERCENT)),
        ("atleast(0:5](3, x)", Share(Fraction(3), ShareKind.SAMPLES)),
        ("atleast[0:5](300ms, x)", Share(Fraction(3, 10), ShareKind.DURATION)),
    ],
)
def test_a_share_is_exact_and_printed_as_it_was_written(text, share):
    formula = parse_formula(text)
    assert formula.interval.share == share
    assert str(formula) == text
    assert parse_formula(str(formula)) == formula


def test_latex_of_a_share():
    assert parse_formula("atleast[0:5](80%, x)").latex() == r"\mathrm{atleast}_{[0, 5]}(80\%, x)"


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # Three of four: the third largest; samples after the end count as true.
        ("atleast[0:3](75%, x)", [2, 2, 3, 3, inf]),
        ("atleast[0:3](60%, x)", [2, 2, 3, 3, inf]),
        ("atleast[0:3](3, x)", [2, 2, 2, -inf, -inf]),
        ("atleast[0:3](2s, x)", [4, 3, 3, 2, -inf]),
        ("atleast[1:2](2, x)", [1, 2, 2, -inf, -inf]),
        ("wasatleast[0:2](2, x)", [-inf, 1, 4, 2, 3]),
        ("wasatleast[0:2](50%, x)", [inf, 5, 4, 2, 3]),
        ("wasatleast[1:2](100%, x)", [inf, 5, 1, 1, 2]),
        ("wasatleast(0:2](2, x)", [-inf, -inf, 1, 1, 2]),
    ],
)
def test_values_in_discrete_time(text, expected, backend):
    assert rtamt.parse(text, backend=backend).evaluate({"x": X}).signal.values.tolist() == expected


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # What leaves the window behind comes in ahead: 5 for two ticks, but for three from 2 on only.
        ("atleast[0:4](2s, x)", [(0, 5)]),
        ("atleast[0:4](75%, x)", [(0, 1), (2, 5)]),
        ("wasatleast[0:2](1s, x)", [(0, -inf), (1, 5), (2, 1), (4, 5)]),
        ("wasatleast[0:2](50%, x)", [(0, inf), (1, 5), (2, 1), (4, 5)]),
        ("wasatleast[0:2](100%, x)", [(0, 5), (1, 1), (5, 5)]),
    ],
)
def test_values_in_dense_time(text, expected, backend):
    spec = rtamt.parse(text, time="dense", resolution="1s", backend=backend)
    signal = spec.evaluate({"x": ([0, 1, 3, 6], [5, 1, 5, 5])}).signal
    pairs = list(zip(signal.times.tolist(), signal.values.tolist(), strict=True))
    assert [pair for k, pair in enumerate(pairs) if not k or pair[1] != pairs[k - 1][1]] == expected


@pytest.mark.parametrize(
    ("share", "same"),
    [
        ("atleast[1:4](100%, x)", "always[1:4] x"),
        ("atleast[1:4](1, x)", "eventually[1:4] x"),
        ("wasatleast[1:4](100%, x)", "historically[1:4] x"),
        ("wasatleast[1:4](1, x)", "once[1:4] x"),
        ("not atleast[1:4](3, x)", "atleast[1:4](50%, not x)"),  # 2 of 4 samples
        ("not wasatleast[0:4](2s, x)", "wasatleast[0:4](80%, not x)"),
    ],
)
def test_what_a_share_is_equal_to(share, same):
    data = {"x": np.random.default_rng(1).integers(-3, 4, 40).astype(float)}
    one, other = (rtamt.parse(text).evaluate(data).signal.values for text in (share, same))
    np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize(
    "text", ["atleast[0:50](80%, x >= 0)", "(wasatleast[0:30](7, x)) and wasatleast[0:30](20%, x)"]
)
def test_a_monitor_gives_the_same_one_by_one_also_after_a_copy_and_a_failed_update(text):
    x = np.random.default_rng(2).normal(size=300)
    expected = rtamt.parse(text).evaluate({"x": x}).signal.values
    monitor = rtamt.parse(f"max(min({text}, 9), -9) + 1 / x > -inf and ({text})").monitor()
    known = []
    for t, value in enumerate(x):
        if t % 50 == 49:
            monitor = copy.deepcopy(monitor)
        if t % 37 == 36:
            with pytest.raises(rtamt.TraceError):
                monitor.update(t, x=float("nan"))
        known.append(monitor.update(t, x=value))
    values = [v for v in known if v is not None] + monitor.finish().values.tolist()
    np.testing.assert_array_equal(values, expected)


def test_an_update_that_fails_after_the_window_has_moved_is_taken_back():
    spec = rtamt.parse("sqrt(wasatleast[0:3](50%, x)) >= 0 and wasatleast[0:3](2, x) > 0")
    monitor, other = spec.monitor(), spec.monitor()
    for t, x in enumerate([3, 1, 2, 4, 2, 5]):
        monitor.update(t, x=x)
        other.update(t, x=x)
    with pytest.raises(rtamt.EvaluationError):
        monitor.update_many({"time": [6, 7, 8, 9], "x": [-1, -2, -3, -4]})
    rest = {"time": [6, 7, 8], "x": [1, 7, 3]}
    np.testing.assert_array_equal(monitor.update_many(rest).values, other.update_many(rest).values)


@pytest.mark.parametrize(
    ("text", "settings", "message"),
    [
        ("atleast[0:3](0%, x)", {}, "the share 0% is not positive: at least nothing always holds"),
        ("atleast[0:3](101%, x)", {}, "the share 101% is more than the whole window, 100%"),
        (
            "atleast[0:3](1.5, x)",
            {},
            "1.5 is not a whole number of samples; write a duration with a unit, or a share with %",
        ),
        (
            "atleast[0:3](x, x)",
            {},
            "expected a share of the window, such as 80%, 3 (samples) or 3s, got 'x'; "
            "write atleast[0:5](80%, ...)",
        ),
        ("atleast[0:3](1e400%, x)", {}, "the share is beyond the range of a double"),
        ("atleast[0:3](3/1e400 s, x)", {}, "the share is beyond the range of a double"),
        (f"atleast[0:3](0.{'1' * 4000}%, x)", {}, "the share has more than 4,000 characters"),
        ("atleast[0:3](3/0s, x)", {}, "expected a positive number after '/', got '0'"),
        ("atleast[0:3](3 x)", {}, "expected ',' and a formula after the share 3, got 'x'"),
        ("atleast(3, x)", {}, "'atleast' needs an interval with an upper bound, such as atleast[0:5]"),
        (
            "atleast[0:3](5, x)",
            {"period": 1},
            "the window [0:3] has 4 samples, fewer than the share 5 of it; make the window longer or the share "
            "smaller",
        ),
        (
            "atleast[0:3](1500ms, x)",
            {"period": 1},
            "the share 1500ms is not a whole number of periods of 1 s; change it or the period",
        ),
        (
            "atleast[0:3](2, x)",
            {"time": "dense"},
            "a number of samples is a share in discrete time only; write a duration, such as 3s, or 80%",
        ),
        (
            "atleast[3:3](80%, x)",
            {"time": "dense"},
            "the window [3:3] is an instant, which has no share in dense time; make it longer",
        ),
    ],
)
def test_shares_that_cannot_be_used(text, settings, message):
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse(text, **settings)
    assert info.value.message == message
    assert "^" in str(info.value)


def test_no_causation():
    with pytest.raises(rtamt.SpecificationError) as info:
        rtamt.parse("atleast[0:3](80%, x > 0)").monitor(verdict="causation")
    assert info.value.message == (
        "'atleast[0:3](80%, x > 0)' is a share of a window, which has no causation; use another verdict mode"
    )


def test_the_past_form_counts_what_is_outside_as_the_future_form_does():
    assert str(rtamt.parse("wasatleast[0:2](50%, eventually[0:1] x)").pastified()) == (
        "wasatleast[0:2](50%, once[1:1] true -> once[0:1] x)"
    )
    assert str(rtamt.parse("wasatleast[0:2](2, eventually[0:1] x)").pastified()) == (
        "wasatleast[0:2](2, once[0:1] x and once[1:1] true)"
    )
