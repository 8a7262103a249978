"""A decision list that tells good recordings from bad ones."""

import numpy as np
import pytest

import rtamt
from rtamt.errors import TraceError, UsageError
from rtamt.mining import classify
from rtamt.mining.classifier_templates import Template
from rtamt.mining.decision_list import DecisionList, Rule, learn_list


def drives(seed=0, bad=20, good=24):
    """Return good recordings, and bad ones that are too fast or cool down at the end."""
    draw = np.random.default_rng(seed)
    time = np.arange(60) / 10

    def drive(peak, cools):
        speed = peak * np.sin(time / 2) + draw.normal(0, 0.2, len(time))
        heat = 80 + draw.normal(0, 0.3, len(time)) - np.where(time > 5, cools, 0)
        return {"time": time, "speed": speed, "heat": heat}

    fine = {f"good{k}": drive(draw.uniform(20, 30), 0) for k in range(good)}
    wrong = {f"bad{k}": drive(draw.uniform(35, 40) if k % 2 else 25, 0 if k % 2 else 9) for k in range(bad)}
    return fine, wrong


@pytest.fixture(scope="module")
def found():
    return classify(*drives())


def test_two_faults_need_two_rules(found):
    assert len(found.rules) == 2
    assert found.training == 1
    assert found.accuracy >= 0.9
    assert found.baseline == pytest.approx(24 / 44)
    assert repr(found).startswith("<2 rules: accuracy ")
    assert str(found).splitlines()[-1] == f"else {'good' if found.default else 'bad'}"


def test_the_specification_is_satisfied_where_a_recording_is_good(found):
    fine, wrong = drives()
    spec = rtamt.parse(found.text)
    assert {
        name: spec.evaluate(data).satisfied for name, data in {**fine, **wrong}.items()
    } == found.predicted
    assert list(spec.requirements) == ["GOOD"]
    fine, wrong = drives(seed=1)  # others of the same kind
    right = sum(spec.evaluate(data).satisfied for data in fine.values())
    right += sum(not spec.evaluate(data).satisfied for data in wrong.values())
    assert right >= 0.9 * (len(fine) + len(wrong))


def test_what_each_rule_covers_is_what_the_engine_finds(found):
    fine, wrong = drives()
    left = {**fine, **wrong}
    for rule in found.rules:
        spec = rtamt.parse(rule.text)
        covered = [name for name, data in left.items() if spec.evaluate(data).satisfied]
        good = sum(name.startswith("good") for name in covered)
        assert (good, len(covered) - good) == rule.covered
        left = {name: data for name, data in left.items() if name not in covered}


def test_the_result_is_the_same_each_time_and_the_seed_chooses_the_folds(found):
    assert classify(*drives()).to_dict() == found.to_dict()
    assert classify(*drives(), seed=1).rules == found.rules


def test_labels_without_meaning_are_no_better_than_the_majority():
    draw = np.random.default_rng(5)
    noise = [{"x": draw.normal(size=20)} for _ in range(60)]
    found = classify(noise[:30], noise[30:])
    assert found.baseline == 0.5
    assert found.accuracy < 0.7
    assert found.accuracy < found.training - 0.1
    assert found.to_dict()["recordings"][0]["name"] == "good 0"


def test_equal_recordings_have_no_rule():
    found = classify([{"x": [1.0, 2.0]}] * 5, [{"x": [1.0, 2.0]}] * 6)
    assert (found.rules, found.default, str(found)) == ((), False, "bad")
    assert found.baseline == found.training == 6 / 11


def test_given_templates():
    own = rtamt.parse(
        "parameter float top = 3  require A: always(speed <= 1.5 * top)\nrequire B: eventually(heat <= top)"
    )
    found = classify(*drives(bad=10, good=10), templates=own)
    assert found.templates == 2
    assert found.training == 1
    assert {rule.template.own[1] for rule in found.rules} == {"top"}
    never = rtamt.parse(
        "parameter float top = 3  always(speed <= top) and heat > 78.5 or always(speed <= top - 9)"
    )
    assert classify(*drives(bad=5, good=5), templates=[never]).templates == 1


@pytest.mark.parametrize("semantics", ["boolean", "input_vacuity", "input_robustness", "output_robustness"])
def test_semantics_do_not_hide_what_tells_recordings_apart(semantics):
    good, bad = [[{"x": [0, 1, top + k / 10]} for k in range(3)] for top in (2.0, 5.0)]
    found = classify(good, bad, folds=3, semantics=semantics)
    assert (found.accuracy, found.training) == (1, 1)


def test_a_threshold_in_a_gap_of_the_last_digits_agrees_with_the_engine():
    near = [1 + k * 1e-12 for k in range(2)]
    template = rtamt.parse("parameter float p = 1  always(x <= p)")
    good, bad = [[{"x": [value]} for _ in range(3)] for value in near]
    found = classify(good, bad, folds=3, templates=[template])
    assert (found.accuracy, found.training) == (1, 1)


def test_signals_are_chosen():
    found = classify(*drives(), signals=["heat"], rules=1)
    assert "speed" not in found.text
    assert len(found.rules) == 1


@pytest.mark.parametrize("default", [True, False])
@pytest.mark.parametrize(
    "classes",
    [(), (True,), (False,), (True, False), (False, True), (False, False, True), (True, False, False)],
)
def test_the_formula_of_a_list_is_the_list(default, classes):
    template = Template("x <= {p}", 1)
    rules = tuple(Rule(template, k, 0.0, good, (0, 0)) for k, good in enumerate(classes))
    decided = DecisionList(rules, default)
    table = np.array(np.meshgrid(*[[-1.0, 1.0]] * max(len(rules), 1))).reshape(max(len(rules), 1), -1).T
    formula = decided.formula()
    for row, good in zip(table, decided.predicted(table), strict=True):
        text = formula
        for k in range(len(rules)):
            text = text.replace(f"rule_{k + 1}", "true" if row[k] <= 0 else "false")
        assert rtamt.parse(f"x <= 0 or x > 0\nrequire GOOD: {text}").evaluate({"x": [1]}).satisfied == good


def test_the_first_rule_is_the_best_of_every_threshold():
    draw = np.random.default_rng(2)
    for _ in range(30):
        table, good = draw.integers(0, 6, (12, 3)).astype(float), draw.random(12) < 0.5
        templates = [Template(f"x{k} <= {{p}}", draw.choice([-1, 1])) for k in range(3)]
        rules = learn_list(templates, table, good, 1)
        fewest = min(good.sum(), (~good).sum())
        for column, template in enumerate(templates):
            for threshold in np.arange(0.5, 5):
                covered = template.direction * (threshold - table[:, column]) >= 0
                for part in (good, ~good):
                    rest = part[~covered]
                    fewest = min(fewest, (~part[covered]).sum() + min(rest.sum(), (~rest).sum()))
        assert (rules.predicted(table) != good).sum() == fewest


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"folds": 21}, "21 folds need 21 bad recordings or more, and there are 20; give more recordings, or 20 folds"),
        ({"folds": 1}, "folds is 1; give a whole number of 2 or more"),
        ({"rules": 0}, "rules is 0; give a whole number of 1 or more"),
        ({"signals": ["sped"]}, "no signal 'sped' is in every recording; did you mean 'speed'? (signals: speed, heat)"),
        ({"evaluations": 30}, "the budget was spent before the rules were learned; give a larger one"),
        (
            {"templates": ["always(x <= 3)"]},
            "templates has 'always(x <= 3)'; give specifications, from rtamt.parse or rtamt.load",
        ),
        ({"templates": []}, "there is no template; give specifications with a parameter each"),
        (
            {"templates": [rtamt.parse("parameter float a = 1  parameter float b = 1  speed <= a and heat <= b")]},
            "the template 'speed <= 1 and heat <= 1' has the parameters a, b; a template of a classifier has one",
        ),
        (
            {"templates": [rtamt.parse("parameter float a = 1  eventually[0:a](speed > 3)")]},
            "'a' of the template 'eventually[0:1](speed > 3)' bounds an interval; give a template with a threshold",
        ),
        (
            {"templates": [rtamt.parse("parameter int a = 1  always(speed <= a)")]},
            "'a' of the template 'always(speed <= 1)' is declared as a whole number; declare it as float",
        ),
        (
            {"templates": [rtamt.parse("parameter float a = 1  abs(speed - a) <= 3")]},
            "'a' of the template 'abs(speed - 1) <= 3' has no known direction; give a template with a threshold",
        ),
    ],
)  # fmt: skip
def test_what_is_wrong_is_said(options, message):
    with pytest.raises(UsageError) as failure:
        classify(*drives(), **options)
    assert str(failure.value) == message


def test_wrong_recordings():
    with pytest.raises(UsageError, match="bad is empty; give one recording or more"):
        classify([{"x": [1.0]}], [])
    with pytest.raises(
        UsageError, match="no signal is in every recording; give recordings of the same signals"
    ):
        classify([{"x": [1.0]}] * 2, [{"y": [1.0]}] * 2, folds=2)
    with pytest.raises(TraceError, match=r"^good 1: "):
        classify([{"x": [1.0, 2.0]}, {"x": [1.0, float("nan")]}], [{"x": [3.0, 2.0]}] * 2, folds=2)


def gaps(least, cars):
    """Return a drive with no car ahead at first, or at all: the gap is infinite, and its speed unknown."""
    draw = np.random.default_rng(round(100 * least))
    gap = least + 10 * draw.random(40)
    gap[: 10 if cars else None] = np.inf
    return {"gap": gap, "lead": np.where(np.isinf(gap), -np.inf, 20 + draw.random(40))}


def test_signals_may_be_infinite():
    good = [gaps(20 + k / 10, cars=k % 3 > 0) for k in range(8)]
    bad = [gaps(2 + k / 10, cars=True) for k in range(8)]
    found = classify(good, bad, folds=4, rules=1)
    assert (found.training, found.accuracy) == (1, 1)
    # Changes of each of the two signals, in both directions and windows, are undefined.
    assert (found.undefined, found.templates) == (8, 32)
    assert found.to_dict()["undefined"] == 8
    spec = rtamt.parse(found.text)
    named = {f"good {k}": data for k, data in enumerate(good)} | {
        f"bad {k}": data for k, data in enumerate(bad)
    }
    assert {name: spec.evaluate(data).satisfied for name, data in named.items()} == found.predicted
    axes = pytest.importorskip("matplotlib.figure").Figure()
    (panel,) = found.plot(axes).axes
    assert sum(len(line.get_xdata()) for line in panel.lines[:-1]) == len(named)
    low, high = panel.get_xlim()
    assert all(low <= x <= high for line in panel.lines for x in line.get_xdata())


def test_a_template_that_was_given_must_have_a_value_on_every_recording():
    wild = [{"x": [np.inf, -np.inf], "y": [np.inf, -np.inf]}] * 2
    own = rtamt.parse("parameter float p = 1  always(x - y <= p)")
    with pytest.raises(TraceError, match="has no value"):
        classify(wild, wild, folds=2, templates=[own])
    assert classify(wild, wild, folds=2, signals=["x"]).undefined == 2


def test_recordings_with_different_periods_have_templates_without_windows():
    slow = [{"time": [0, 2, 4], "x": [1.0, k, 2.0]} for k in range(3)]
    fast = [{"time": [0, 1, 2], "x": [5.0, 6.0, k + 7]} for k in range(3)]
    found = classify(slow, fast, folds=3)
    assert found.templates == 6
    assert found.training == 1


def test_the_plot_has_a_panel_for_each_rule(found):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    panels = found.plot().axes
    assert [axes.get_title(loc="left").split()[0] for axes in panels] == ["if", "else"]
    assert classify([{"x": [1.0]}] * 2, [{"x": [1.0]}] * 2, folds=2).plot().axes[0].get_title(loc="left")
