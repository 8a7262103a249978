"""The hardest values of parameters that recordings satisfy; brute force is in tests/laws/test_mining_laws.py."""

import numpy as np
import pytest

import rtamt
from rtamt.errors import TraceError, UsageError
from rtamt.mining import mine

DRIVES = {"low": {"x": [5.0, 3.25]}, "high": {"x": [7.5, 1.0]}}


def test_a_threshold_is_confirmed_on_both_sides():
    found = mine(rtamt.parse("parameter float limit = 9  always(x <= limit)"), DRIVES)
    (point,) = found.points
    assert (point.values, point.harder, point.violated_by) == (
        {"limit": 7.5},
        {"limit": 7.4999},
        {"limit": "high"},
    )
    assert found.tight
    assert found.alone == {"low": 5.0, "high": 7.5}
    assert found.with_values().evaluate(DRIVES["high"]).robustness == 0
    assert repr(found) == "<limit=7.5 on 2 recordings>"


@pytest.mark.parametrize("start", [-1e6, -1.0, 0.0, 7.5, 1e6])
@pytest.mark.parametrize(
    ("scale", "tight"), [(1e-6, 2.5e-6), (1.0, 2.5), (1e9, 2.5e9), (0.0, 0.0), (-1.0, -1.0)]
)
def test_the_value_does_not_depend_on_the_default(start, scale, tight):
    spec = rtamt.parse(f"parameter float limit = {start}  always(x <= limit)")
    (point,) = mine(spec, [{"x": [scale * 1.0, scale * 2.5]}], resolutions={"limit": 5e-7}).points
    assert point.values["limit"] == pytest.approx(tight, abs=5e-7)
    assert point.tight


@pytest.mark.parametrize("start", [0.0, 1e6])
@pytest.mark.parametrize("tight", [1.2345e-6, -0.012345, 123450.0])
def test_a_value_far_smaller_than_the_default_has_five_significant_digits(start, tight):
    spec = rtamt.parse(f"parameter float limit = {start}  always(x <= limit)")
    (point,) = mine(spec, [{"x": [tight]}]).points
    assert (point.values, point.tight) == ({"limit": tight}, True)


@pytest.mark.parametrize(
    ("text", "ranges", "start"),
    [
        ("always(x <= limit)", {}, "limit=0: "),
        ("always(abs(x - limit) <= 9)", {"limit": (2, 3)}, "limit=2: "),
    ],
)
def test_a_recording_whose_missing_samples_leave_the_verdict_open_is_named(text, ranges, start):
    spec = rtamt.parse(f"parameter float limit = 0  {text}")
    with pytest.raises(TraceError) as failure:
        mine(spec, {"gaps": {"x": [0, None]}}, ranges=ranges)
    assert str(failure.value).startswith(f"gaps, with {start}")
    assert "missing or uncertain; read result.interval" in str(failure.value)


def test_a_strict_comparison_needs_the_next_value():
    spec = rtamt.parse("parameter float limit = 9  always(x < limit)")
    (point,) = mine(spec, DRIVES, resolutions={"limit": 0.5}).points
    assert (point.values, point.harder) == ({"limit": 8.0}, {"limit": 7.5})


def test_bounds_are_multiples_of_the_sampling_period():
    spec = rtamt.parse("parameter float within = 0.5  always(x > 3 -> eventually[0:within](x < 1))")
    time = np.arange(40) / 10
    x = np.where((time > 0.95) & (time < 1.75), 5.0, 0.0)
    found = mine(spec, {"a": {"time": time, "x": x}})
    (point,) = found.points
    assert (point.values, point.harder) == ({"within": 0.8}, {"within": 0.7})
    assert found.resolutions == {"within": 0.1}
    with pytest.raises(UsageError) as failure:
        mine(spec, {"a": {"time": time, "x": x}}, resolutions={"within": 0.25})
    assert str(failure.value) == (
        "the resolution of 'within' is 0.25, and bounds are multiples of the sampling period, 0.1; "
        "give a multiple of it"
    )


RISE = {"x": [0.0, 0.0, 0.0, 0.0, 2.0]}


@pytest.mark.parametrize(
    ("window", "values", "harder"),
    [("(0:w]", 4.0, 3.0), ("[0:w)", 5.0, 4.0), ("(0:w)", 5.0, 4.0), ("[0:w]", 4.0, 3.0)],
)
def test_a_window_with_an_excluded_bound_is_neither_empty_nor_too_short(window, values, harder):
    spec = rtamt.parse(f"parameter float w = 2  always(x < 1 -> eventually{window}(x > 1))")
    (point,) = mine(spec, [RISE]).points
    assert (point.values, point.harder) == ({"w": values}, {"w": harder})
    (short,) = mine(spec, [{"x": [2.0, 2.0]}]).points  # no sample needs a window
    assert (short.values, short.tight) == ({"w": window.count("(") + window.count(")") + 0.0}, True)


def test_a_window_that_begins_at_a_parameter_ends_after_it():
    spec = rtamt.parse("parameter float w = 1  always(eventually(w:5](x >= 0) or x < 9)")
    (point,) = mine(spec, [{"x": [1.0] * 9}], ranges={"w": (0, 4)}).points
    assert (point.values, point.tight) == ({"w": 4.0}, True)
    with pytest.raises(UsageError, match="and end it at 4 or earlier"):
        mine(spec, [{"x": [1.0] * 9}], ranges={"w": (0, 5)})


@pytest.mark.parametrize(
    ("text", "data", "settings", "value"),
    [
        ("float w = 1  always(x > 0 -> eventually[0:w](x <= 0))", [(0, 1.0), (1 / 3, 0.0)], "dense", 0.33334),
        ("int w = 2 [ms]  always(x < 1 -> eventually[0:w](x > 1))", [0.0] * 13 + [2.0], "100us", 2.0),
    ],
)
def test_the_longest_window_that_is_tried_reaches_the_last_sample(text, data, settings, value):
    chosen = {"time": "dense"} if settings == "dense" else {"period": settings}
    (point,) = mine(rtamt.parse(f"parameter {text}", **chosen), [{"x": data}]).points
    assert point.values == {"w": value}
    assert point.tight


def test_a_bound_beside_a_member_of_an_enumeration_reads_its_text():
    spec = rtamt.parse(
        "enum Mode { OFF, ON }\ninput Mode mode\ninput bool b\nparameter float w = 1\n"
        "always(mode == OFF and b -> eventually[0:w](mode == ON))"
    )
    (point,) = mine(spec, [{"mode": ["OFF", "OFF", "ON"], "b": [True] * 3}]).points
    assert (point.values, point.harder) == ({"w": 2.0}, {"w": 1.0})


def test_a_bound_with_a_unit_and_a_window_that_cannot_be_shorter():
    spec = rtamt.parse("parameter float within = 500 [ms]  eventually[0:within](x > 3)")
    (point,) = mine(spec, [{"time": [0, 0.25, 0.5], "x": [1, 1, 5]}]).points
    assert (point.values, point.harder) == ({"within": 500.0}, {"within": 250.0})
    (point,) = mine(spec, [{"time": [0, 0.25, 0.5], "x": [5, 1, 5]}]).points
    assert (point.values, point.hardest, point.tight) == ({"within": 0.0}, ("within",), True)


def test_dense_time():
    spec = rtamt.parse("parameter float within = 1  eventually[0:within](x > 3)", time="dense")
    (point,) = mine(spec, [{"x": [[0, 1], [1.75, 5], [3, 0]]}]).points
    assert point.values["within"] == 1.75
    assert point.tight


def test_a_whole_number():
    spec = rtamt.parse("parameter int most = 9  always(count[0:10](x > 3) <= most)")
    (point,) = mine(spec, [{"x": [1, 5, 1, 5, 1, 5]}]).points
    assert (point.values, point.harder) == ({"most": 3.0}, {"most": 2.0})


def test_two_parameters_have_a_front():
    spec = rtamt.parse(
        "parameter float level = 3  parameter float within = 1  eventually[0:within](always(x >= level))"
    )
    found = mine(spec, [{"x": [0, 1, 2, 4, 5]}])
    front = [(point.values["level"], point.values["within"]) for point in found.points]
    assert front == [(0, 0), (1, 1), (2, 2), (4, 3), (5, 4)]
    assert found.tight
    assert found.undecided == 0
    assert repr(found) == "<front of level, within with 5 points on 1 recording>"
    few = mine(spec, [{"x": [0, 1, 2, 4, 5]}], points=3)
    assert len(few.points) == 3
    assert 0 < few.undecided < 1
    first = mine(spec, [{"x": [0, 1, 2, 4, 5]}], parameters=["within", "level"], order=True)
    assert [point.values for point in first.points] == [{"within": 0.0, "level": 0.0}]


def test_parameters_that_are_no_numbers_keep_their_values():
    spec = rtamt.parse("parameter bool strict = true  parameter float p = 1  always(x <= p or not strict)")
    assert repr(mine(spec, DRIVES)) == "<p=7.5 on 2 recordings>"


def test_three_parameters_in_their_order():
    spec = rtamt.parse(
        "parameter float a = 1  parameter float b = 1  parameter float c = 1  always(x <= a and y >= b and x - y <= c)"
    )
    (point,) = mine(spec, [{"x": [1.0, 2.0], "y": [0.5, 3.0]}]).points
    assert point.values == {"a": 2.0, "b": 0.5, "c": 0.5}
    assert point.tight


@pytest.mark.parametrize("optimizer", [None, "random"])
def test_a_parameter_without_a_direction_is_searched(optimizer):
    spec = rtamt.parse("parameter float middle = 1  always(abs(x - middle) <= 2)")
    found = mine(spec, [{"x": [3.0, 4.0, 5.0]}], ranges={"middle": (0, 4)}, optimizer=optimizer)
    (point,) = found.points
    assert 3 <= point.values["middle"] <= 3.1
    assert not found.tight
    assert found.with_values().evaluate({"x": [3.0, 4.0, 5.0]}).satisfied
    assert found.to_dict()["parameters"][0]["easier"] == "unknown"


def test_the_end_of_a_range_is_not_tight():
    found = mine(
        rtamt.parse("parameter float limit = 9  always(x <= limit)"), DRIVES, ranges={"limit": (8, 10)}
    )
    assert found.points[0].values == {"limit": 8.0}
    assert not found.tight


def test_a_spent_budget_leaves_values_that_hold():
    spec = rtamt.parse("parameter float limit = 9  always(x <= limit)")
    found = mine(spec, DRIVES, ranges={"limit": (0, 1000)}, evaluations=8)
    assert not found.finished
    assert not found.tight
    assert found.evaluations == 8
    assert found.with_values().evaluate(DRIVES["high"]).satisfied
    with pytest.raises(UsageError) as failure:
        mine(spec, DRIVES, evaluations=1)
    assert str(failure.value) == (
        "the budget of 1 evaluations was spent before any values were found; give a larger one"
    )


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (
            "always(x <= 3)",
            {},
            "the specification declares no parameter to mine; declare one, such as parameter float limit = 30",
        ),
        (
            "parameter float p = 1  always(x <= 3)",
            {},
            "no parameter in the formula of the specification is a number, so there is nothing to mine",
        ),
        (
            "parameter float p = 1  parameter float q = 1  always(x <= q)",
            {"parameters": ["p"]},
            "the parameter 'p' is not in the formula, so every value is the same; leave it out",
        ),
        (
            "parameter float limit = 1  always(x <= limit)",
            {"parameters": ["limti"]},
            "there is no parameter 'limti'; did you mean 'limit'? (parameters: limit)",
        ),
        (
            "parameter bool p = true  always(x <= 3 or p)",
            {"parameters": ["p"]},
            "the parameter 'p' is no number, so it has no tight value; leave it out",
        ),
        (
            "parameter float p = 1  always(x <= p) and x > 6",
            {"ranges": {"p": (0, 10)}},
            "no values in their ranges satisfy the specification on all recordings: 'low' violates it with the easiest "
            "ones, p=10; "
            "leave the recording out, or widen a range",
        ),
        (
            "parameter float p = 1  always(x <= p or x <= 9)",
            {},
            "no recording restricts 'p': the hardest value that was tried, -999999999999999, satisfies the "
            "specification; give a range, or leave it out",
        ),
        (
            "parameter float p = 1  always(abs(x - p) <= 3)",
            {},
            "the formula does not decide whether larger or smaller values of 'p' are harder; give its range",
        ),
        (
            "parameter float p = 1  always(abs(x - p) <= 3)",
            {"ranges": {"p": (20, 30)}},
            "none of the 205 values that were tried satisfies the specification on all recordings; there may be "
            "others, so give narrower ranges",
        ),
        (
            "parameter float p = 1  always(x <= p)",
            {"ranges": {"p": (3, 1)}},
            "the range of 'p' ends at 1, where it should begin; exchange its ends",
        ),
        (
            "parameter float p = 1  always(x <= p)",
            {"ranges": {"p": 3}},
            "the range of 'p' is 3; give two numbers, such as (0, 60)",
        ),
        (
            "parameter float p = 1  always(x <= p)",
            {"resolutions": {"p": 0}},
            "the resolution of 'p' is 0; give a number above 0",
        ),
        (
            "parameter float p = 1  always(x <= p)",
            {"timeout": 0},
            "timeout is 0; give a number of seconds above 0",
        ),
        (
            "parameter float p = 1  always(x <= p)",
            {"points": 1},
            "points is 1; give a whole number of 2 or more",
        ),
        (
            'group cars = "car_*"  parameter float p = 1  always(forall c in cars: c.x <= p)',
            {},
            "templates over the members of groups cannot be mined; name the variables of the members",
        ),
    ],
)
def test_what_is_wrong_is_said(text, options, message):
    with pytest.raises(UsageError) as failure:
        mine(rtamt.parse(text), DRIVES, **options)
    assert str(failure.value) == message


def test_wrong_recordings():
    spec = rtamt.parse("parameter float p = 1  always(sqrt(x) <= p)")
    with pytest.raises(UsageError, match="recordings is empty; give one recording or more"):
        mine(spec, {})
    with pytest.raises(UsageError, match=r"recordings is 'log\.csv'; give a list of recordings"):
        mine(spec, "log.csv")
    with pytest.raises(UsageError, match="mine takes a specification"):
        mine("x > 3", [{"x": [1]}])
    with pytest.raises(TraceError, match=r"^bad, with p=1: "):
        mine(spec, {"bad": {"x": [-1.0]}})


def test_progress_is_told():
    made = []
    found = mine(rtamt.parse("parameter float p = 1  always(x <= p)"), DRIVES, progress=made.append)
    assert made == list(range(1, found.evaluations + 1))


def test_plots():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    one = mine(rtamt.parse("parameter float limit = 9  always(x <= limit)"), DRIVES).plot()
    assert [label.get_text() for label in one.get_yticklabels()] == ["low", "high"]
    assert one.get_title(loc="right") == "limit = 7.5"
    spec = rtamt.parse("parameter float a = 3  parameter float b = 1 [m]  always(x <= a or x <= 2 * b)")
    two = mine(spec, DRIVES, ranges={"a": (0, 9), "b": (0, 9)}, points=2).plot()
    assert (two.get_xlabel(), two.get_ylabel()) == ("a", "b [m]")
    spec = rtamt.parse("parameter float middle = 1  always(abs(x - middle) <= 5)")
    tried = mine(spec, DRIVES, ranges={"middle": (0, 5)}).plot()
    assert tried.get_title(loc="right").endswith("values tried, not proven tight")
    spec = rtamt.parse(
        "parameter float a = 1  parameter float b = 1  parameter float c = 1  x <= a and x >= b and x <= c"
    )
    with pytest.raises(UsageError) as failure:
        mine(spec, DRIVES).plot()
    assert str(failure.value) == (
        "there are 3 parameters (a, b, c), and a plot has room for two; mine two of them"
    )
