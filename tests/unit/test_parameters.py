"""Parameters: declared in a text, set without parsing it again."""

import copy
import pickle
from decimal import Decimal
from fractions import Fraction

import pytest

import rtamt
from rtamt.errors import BoundError, UsageError

TEXT = """
input float x
parameter float limit = 4 [m]
parameter float "reaction time" = 2
parameter float gap = 4

low = x <= limit
require LOW: always[0:"reaction time"](low)
require GAP: x >= -gap
"""
DATA = {"x": [1, 2, 3, 1]}


def pickle_round_trip(one):
    return pickle.loads(pickle.dumps(one))


@pytest.fixture(scope="module")
def spec():
    return rtamt.parse(TEXT, period=1)


def test_parameters_have_the_values_of_the_text_until_they_are_set(spec):
    assert dict(spec.parameters) == {"limit": 4.0, "reaction time": 2.0, "gap": 4.0}
    assert dict(spec.with_parameters(limit=3).parameters) == {"limit": 3.0, "reaction time": 2.0, "gap": 4.0}
    assert spec.evaluate(DATA).robustness == 1.0
    assert spec.with_parameters(limit=3).evaluate(DATA).robustness == 0.0


def test_parameters_of_equal_values_are_set_apart(spec):
    assert str(spec.with_parameters(gap=1).requirements["GAP"]) == "x >= -(1)"
    assert str(spec.with_parameters(gap=1).requirements["LOW"]) == "always[0:2](x <= 4)"


def test_a_parameter_bounds_an_interval(spec):
    assert str(spec.with_parameters(**{"reaction time": 3}).requirements["LOW"]) == "always[0:3](x <= 4)"
    assert spec.with_parameters(**{"reaction time": 3}).monitor().horizon == 3.0


def test_a_value_given_as_bound_is_checked_anew_and_pointed_at(spec):
    with pytest.raises(BoundError) as error:
        spec.with_parameters(**{"reaction time": 1.5})
    assert "1.5 s is not a whole number of periods of 1 s" in str(error.value)
    assert str(error.value).splitlines()[-1].strip() == "^" * len('[0:"reaction time"]')
    assert spec.parameters["reaction time"] == 2.0


def test_values_set_one_after_the_other_are_kept(spec):
    both = spec.with_parameters(limit=3).with_parameters(gap=1)
    assert (both.parameters["limit"], both.parameters["gap"]) == (3.0, 1.0)
    assert spec.with_parameters(limit=4) is spec


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"limt": 3},
            "there is no parameter 'limt'; did you mean 'limit'? (parameters: limit, reaction time, gap)",
        ),
        ({"limit": float("nan")}, "the parameter 'limit' is nan; give a number"),
        ({"limit": "3"}, "the parameter 'limit' is '3'; give a number"),
    ],
)
def test_wrong_values_are_one_sentence(spec, values, message):
    monitor = spec.monitor()
    for call in (spec.with_parameters, monitor.reset):
        with pytest.raises(UsageError) as error:
            call(**values)
        assert str(error.value) == message


def test_a_whole_number_takes_no_fraction():
    spec = rtamt.parse("input float x  parameter int most = 2  x <= most")
    assert dict(spec.with_parameters(most=3.0).parameters) == {"most": 3.0}
    with pytest.raises(
        UsageError,
        match=r"^the parameter 'most' is 2\.5, and declared as a whole number; declare it as float$",
    ):
        spec.with_parameters(most=2.5)


def test_two_parameters_in_one_text_are_not_the_name_of_one(spec):
    with pytest.raises(UsageError) as error:
        spec.with_parameters(**{"limit=1,gap": 2})
    assert str(error.value) == ("'limit=1,gap' names several parameters; set each by itself, such as limit=3")


def test_a_specification_without_parameters_says_so():
    with pytest.raises(
        UsageError, match=r"^there is no parameter 'limit'; declare it: parameter float limit = \.\.\.$"
    ):
        rtamt.parse("x <= 3").with_parameters(limit=3)


def test_copies_and_pickles_keep_the_values(spec):
    assigned = spec.with_parameters(limit=3, **{"reaction time": 1})
    again = pickle_round_trip(assigned)
    assert again.parameters == assigned.parameters
    assert str(again.select("LOW")) == "always[0:1](x <= 3)"
    assert str(again.with_parameters(limit=2).requirements["LOW"]) == "always[0:1](x <= 2)"


def test_a_pickled_replaced_formula_still_has_its_parameters(spec):
    past = pickle_round_trip(spec.with_formula(spec.pastified()))
    assert str(past.with_parameters(limit=1)).startswith("historically[0:2](x <= 1)")
    with pytest.raises(UsageError, match="set it before with_formula"):
        past.with_parameters(**{"reaction time": 1})


@pytest.mark.parametrize("verdict", ["delayed", "eager", "interval", "causation"])
def test_a_monitor_is_reset_to_other_values(spec, verdict):
    def replay_values(monitor):
        return [str(monitor.update(t, x=x)) for t, x in enumerate(DATA["x"])]

    monitor = spec.monitor(verdict=verdict)
    before = replay_values(monitor)
    monitor.reset(limit=1, **{"reaction time": 1})
    expected = spec.with_parameters(limit=1, **{"reaction time": 1}).monitor(verdict=verdict)
    assert replay_values(monitor) == replay_values(expected)
    twins = copy.copy(monitor), pickle_round_trip(monitor)
    for twin in (*twins, monitor):
        twin.reset()  # the values stay
        expected.reset()
        assert replay_values(twin) == replay_values(expected)
    monitor.reset(limit=4, **{"reaction time": 2})
    assert replay_values(monitor) == before


def test_a_watched_formula_has_the_values_of_its_monitor(spec):
    monitor = spec.with_parameters(limit=2).monitor(watch=["low", spec.document.definitions["low"]])
    monitor.update(0, x=5)
    assert monitor["low"] == monitor[spec.document.definitions["low"]] == -3.0


def test_other_values_are_neither_parsed_nor_compiled_again(spec, monkeypatch):
    def again(*_args, **_settings):
        raise AssertionError("parsed or compiled again")

    dense = {"x": ([0, 1, 2, 3], DATA["x"])}
    modes = ("delayed", "eager", "interval", "causation")
    spec.evaluate(DATA), spec.evaluate(dense, time="dense"), spec.monitor(time="dense")
    monitors = [spec.monitor(verdict=mode) for mode in modes]
    for place in ("rtamt.compiler.shared", "rtamt.specification", "rtamt.specification_parameters"):
        for name in ("compile_program", "compile_plan", "compile_graph", "parse_document"):
            monkeypatch.setattr(f"{place}.{name}", again, raising=False)
    new = spec.with_parameters(limit=1)
    assert new.evaluate(DATA).robustness == new.evaluate(dense, time="dense").robustness == -2.0
    for monitor in monitors:
        monitor.reset(limit=1)
    assert [monitors[0].update(t, x=x) for t, x in enumerate(DATA["x"])][-1] == -2.0
    new.monitor(time="dense")
    with pytest.raises(AssertionError, match="again"):
        spec.with_parameters(**{"reaction time": 3})


def test_an_operation_without_a_value_is_named_with_the_values_in_use():
    spec = rtamt.parse("parameter float limit = 4 always(sqrt(limit - x) <= 3)")
    spec.evaluate(DATA)
    with pytest.raises(rtamt.EvaluationError, match=r"^'sqrt\(2 - x\)' has no value at sample 2"):
        spec.with_parameters(limit=2).evaluate(DATA)
    monitor = spec.with_formula(rtamt.parse("x").formula).monitor(watch=["sqrt(limit - x)"])
    monitor.reset(limit=2)
    with pytest.raises(rtamt.EvaluationError, match=r"^'sqrt\(2 - x\)' has no value at sample 0"):
        monitor.update(0, x=5)


@pytest.mark.parametrize(
    "text",
    [
        "parameter >= 3",
        "float parameter; always(parameter >= 3)",
        "parameter = x > 3; always(parameter)",
        "float parameter float y; parameter S y > 3",
        "from messages import parameter parameter x float y; y > 3",
    ],
)
def test_the_word_parameter_is_not_reserved(text):
    assert rtamt.parse(text).formula is not None
    assert not rtamt.parse(text).parameters


def test_several_specifications_with_the_same_parameter_do_not_share_its_value(spec):
    pair = [spec.with_parameters(limit=1), spec.with_parameters(limit=2)]
    found = [result.robustness for result in rtamt.evaluate_all(pair, DATA)]
    assert found == [one.evaluate(DATA).robustness for one in pair] == [-2.0, -1.0]


def test_the_classes_of_rtamt_take_a_parameter_for_a_constant():
    spec = rtamt.StlDiscreteTimeSpecification()
    spec.spec = "float x parameter float limit = 4 low = x <= limit"
    spec.parse()
    assert spec.update(0, [("x", 1.0)]) == 3.0
    assert spec.get_value("low") == 3.0


def test_parameters_in_templates_have_the_values_in_use():
    spec = rtamt.parse(
        """
        input float x
        parameter float limit = 4
        parameter float within = 2
        def low(y, bound = limit) = y <= bound
        def soon(y) = eventually[0:within](low(y))
        require LOW: always[0:1](low(x))
        """
    ).with_parameters(limit=3, within=1)
    assert str(spec) == "always[0:1](x <= 3)"
    monitor = spec.monitor(watch=["soon(x)", "low(x, limit)"])
    monitor.update(0, x=1)
    monitor.update(1, x=2)
    assert (monitor["soon(x)"], monitor["low(x, limit)"]) == (2.0, 1.0)


STRICT = """
float x
parameter bool strict = false
parameter float limit = 4
require A: strict -> x <= 3
require B: x <= limit + strict
"""


def test_a_parameter_is_a_boolean():
    spec = rtamt.parse(STRICT)
    assert [str(one) for one in spec.requirements.values()] == ["false -> x <= 3", "x <= 4 + 0"]
    strict = spec.with_parameters(strict=True)
    assert [str(one) for one in strict.requirements.values()] == ["true -> x <= 3", "x <= 4 + 1"]
    assert r"\top \to" in strict.requirements["A"].formula.latex()
    assert spec.evaluate({"x": [3.5]}).robustness == 0.5
    assert strict.evaluate({"x": [3.5]}).robustness == -0.5
    assert pickle_round_trip(strict).evaluate({"x": [3.5]}).robustness == -0.5
    monitor = spec.monitor(watch=["strict -> x <= 2"])
    monitor.reset(strict=True)
    assert (monitor.update(0, x=3.5), monitor["strict -> x <= 2"]) == (-0.5, -1.5)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"strict": 2}, "the parameter 'strict' is 2; it is a bool, so give true or false"),
        ({"limit": True}, "the parameter 'limit' is True, and it is no bool; give a number"),
    ],
)
def test_values_of_another_type_are_one_sentence(values, message):
    with pytest.raises(UsageError) as error:
        rtamt.parse(STRICT).with_parameters(**values)
    assert str(error.value) == message


def test_the_sum_of_a_parameter_follows_its_value():
    spec = rtamt.parse("parameter float k = 1  float x  x <= sum[0:2](k)", period=1)
    for value in (1, 3, 0):
        found = spec.with_parameters(k=value).evaluate({"x": [0, 0, 0, 0]}).signal.values
        assert found.tolist() == [value, 2 * value, 3 * value, 3 * value]


WINDOW = "input float x  parameter float w = 1  parameter float limit = 3  always[0:w](x <= limit)"


@pytest.mark.parametrize(
    ("value", "period", "bound"),
    [
        (Fraction(1, 3), Fraction(1, 3), "1/3"),
        (Fraction(2, 3), Fraction(1, 3), "2/3"),
        (Fraction(1, 2), Fraction(1, 2), "0.5"),
        (Decimal("0.3"), Fraction(1, 10), "0.3"),
        (Decimal("1.1"), Decimal("0.1"), "1.1"),
    ],
)
def test_the_exact_value_of_a_bound_was_lost_to_a_double(value, period, bound):
    spec = rtamt.parse(WINDOW, period=Fraction(period)).with_parameters(w=value)
    assert str(spec.formula) == f"always[0:{bound}](x <= 3)"
    assert spec.parameters["w"] == float(value)
    for one in (spec.with_parameters(limit=4), pickle_round_trip(spec), copy.deepcopy(spec)):
        assert str(one.formula).startswith(f"always[0:{bound}]")
    assert str(spec.with_parameters(w=1).formula) == "always[0:1](x <= 3)"


def test_a_fraction_replaces_the_double_that_it_is_rounded_to():
    text = "input float x  parameter float w = 0.3333333333333333  always[0:w](x <= 3)"
    spec = rtamt.parse(text).with_parameters(w=Fraction(1, 3))
    assert str(spec.formula) == "always[0:1/3](x <= 3)"


def test_a_fraction_bounds_the_interval_of_a_constant():
    spec = rtamt.parse("always[0:w](x <= 3)", constants={"w": Fraction(1, 3)}, period=Fraction(1, 3))
    assert str(spec.formula) == "always[0:1/3](x <= 3)"


@pytest.mark.parametrize("value", [Decimal("1e400"), Decimal("nan"), Decimal("1e999999999")])
def test_decimals_that_are_no_doubles_are_one_sentence(value):
    with pytest.raises(UsageError) as error:
        rtamt.parse(WINDOW).with_parameters(limit=value)
    assert str(error.value) == f"the parameter 'limit' is {value!r}; give a number"


@pytest.mark.parametrize(
    "value",
    [Fraction(1, 10**320), Fraction(1, 10**400), Fraction(10**308), Decimal("1e-999999999"), Fraction(1, 3)],
)
def test_fractions_at_the_ends_of_the_range_of_doubles_are_values(value):
    spec = rtamt.parse(WINDOW).with_parameters(limit=value)
    assert spec.parameters["limit"] == float(value)
    assert type(spec.parameters["limit"]) is float
