"""What users of RTAMT asked of verdicts: what an output before the horizon means, and one of exactly 0."""

from __future__ import annotations

from math import inf

import pytest

import rtamt

XS = [1.0, 5.0, 4.0, 6.0, 3.5]


def pastified(text: str) -> rtamt.StlDiscreteTimeOnlineSpecification:
    spec = rtamt.StlDiscreteTimeOnlineSpecification()
    spec.declare_var("x", "float")
    spec.spec = text
    spec.parse()
    spec.pastify()
    return spec


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("always[0:2](x >= 3)", [-2.0, 1.0, 0.5]),
        ("eventually[0:2](x >= 3)", [2.0, 3.0, 3.0]),
        ("eventually[1:2](x >= 3) and x >= 0", [1.0, 3.0, 3.0]),
        ("next(next(x >= 3))", [1.0, 3.0, 0.5]),
    ],
)
def test_issues_59_and_66_there_is_no_value_before_the_horizon(
    text: str, expected: list[float], backend: str
) -> None:
    spec = rtamt.parse(text, backend=backend)
    monitor = spec.monitor()
    found = [monitor.update(t, x=x) for t, x in enumerate(XS)]
    assert found == [None, None, *expected]
    offline = spec.evaluate({"x": XS}).signal.values.tolist()
    assert [*expected, *monitor.finish().values] == offline


def test_issues_59_and_66_offline_every_instant_has_a_value_from_windows_cut_at_the_end() -> None:
    assert rtamt.parse("always[0:2](x >= 3)").evaluate({"x": [5, 1]}).signal.values.tolist() == [-2.0, -2.0]
    assert rtamt.parse("always[1:2](x >= 3)").evaluate({"x": [5, 1]}).signal.values.tolist() == [-2.0, inf]


@pytest.mark.parametrize(
    ("text", "before", "expected"),
    [
        # a window of the past, cut at the first sample
        ("always[0:2](x >= 3)", [-2.0, -2.0], [-2.0, 1.0, 0.5]),
        ("eventually[0:2](x >= 3)", [-2.0, 2.0], [2.0, 3.0, 3.0]),
        # a window that holds no sample yet
        ("eventually[0:2](next(x) >= 3) or false", [-2.0, 2.0, 2.0], [3.0, 3.0]),
        ("x >= 3 and eventually[2:2](x >= 3)", [-inf, -inf], [-2.0, 2.0, 0.5]),
    ],
)
def test_issues_59_and_66_the_papers_api_gives_a_number_at_once_which_is_that_of_the_pastified_formula(
    text: str, before: list[float], expected: list[float]
) -> None:
    spec = pastified(text)
    assert [spec.update(t, [("x", x)]) for t, x in enumerate(XS)] == [*before, *expected]
    past = rtamt.parse(str(rtamt.parse(text).pastified()))
    assert past.evaluate({"x": XS}).signal.values.tolist() == [*before, *expected]
    offline = rtamt.parse(text).evaluate({"x": XS}).signal.values.tolist()
    assert offline[: len(expected)] == expected


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(
    ("text", "holds"),
    [
        ("x >= 3", True),
        ("x <= 3", True),
        ("x == 3", True),
        ("x > 3", False),
        ("x < 3", False),
        ("x != 3", False),
        ("not (x > 3)", True),
        ("not (x >= 3)", False),
        ("always[0:1](x >= 3)", True),
        ("always[0:1](x > 3)", False),
        ("x > 3 -> x >= 9", True),
        ("x >= 3 <-> x > 3", False),
        ("x - 3", False),
    ],
)
def test_issues_71_and_172_a_robustness_of_0_has_a_boolean_verdict(
    text: str, holds: bool, backend: str
) -> None:
    result = rtamt.parse(text, backend=backend).evaluate({"x": [3, 5]})
    assert result.robustness == 0
    assert result.satisfied is holds


def test_issues_71_and_172_the_verdict_is_the_comparison_and_not_the_sign() -> None:
    # 0.1 + 0.2 > 0.3, by less than a printed number shows
    result = rtamt.parse("x + y > 0.3").evaluate({"x": [0.1], "y": [0.2]})
    assert result.satisfied is True
    assert 0 < result.robustness < 1e-16
