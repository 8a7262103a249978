import json

import numpy as np
import pytest

import rtamt
from rtamt.errors import TraceError, UsageError
from rtamt.search import OPTIMIZERS, Problem, Pulse, Range, falsify, sensitivity
from tests.unit.search.plants import follower, thrown, valley

BALL = Problem(rtamt.parse("always[0:2](height <= 6)", period="100ms"), thrown, {"speed": Range(1, 12)})
VALLEY = Problem(rtamt.parse("always(z >= 0)"), valley, {"x": Range(0, 1), "y": Range(0, 1)})


@pytest.mark.parametrize("name", OPTIMIZERS)
def test_every_optimizer_finds_the_valley(name):
    found = falsify(VALLEY, optimizer=name, budget=400, seed=3)
    assert found.falsified
    assert found.best is found.evaluations[-1]
    point = found.best.point
    assert (point["x"] - 0.3) ** 2 + (point["y"] - 0.7) ** 2 < 0.05
    assert all(evaluation.satisfied for evaluation in found.evaluations[:-1])


@pytest.mark.parametrize("name", OPTIMIZERS)
def test_the_same_seed_gives_the_same_search(name):
    runs = [falsify(VALLEY, optimizer=name, budget=15, seed=7, stop=False).evaluations for _ in range(2)]
    assert runs[0] == runs[1]
    assert len(runs[0]) == 15


@pytest.mark.parametrize("name", OPTIMIZERS)
def test_an_optimizer_of_one_parameter(name):
    problem = Problem(rtamt.parse("always(z >= 0)"), valley, {"x": Range(0, 1), "y": 0.7})
    assert falsify(problem, optimizer=name, budget=200, seed=1).falsified


def test_a_simulation_stops_when_its_verdict_is_settled():
    asked = []

    def plant(speed):
        for sample in thrown(speed):
            asked.append(sample)
            yield sample

    problem = Problem(BALL.spec, plant, BALL.inputs)
    evaluation = problem.run({"speed": 12.0})
    whole = BALL.spec.evaluate({"height": [values["height"] for _, values in thrown(12.0)]})
    assert not evaluation.satisfied
    assert evaluation.stopped == 0.8
    assert len(asked) == 9
    # It is told how far the requirement is violated at least.
    assert whole.robustness < evaluation.robustness < 0
    assert problem.run({"speed": 12.0}, whole=True).robustness == whole.robustness


def test_a_verdict_settled_early_does_not_look_like_a_narrow_escape():
    # Satisfied at the first sample, and then by far: what may still come at its worst would tell 0.1.
    def plant(offset):
        for k in range(101):
            yield k / 10, {"x": 0.1 + offset if k < 50 else 9.0}

    spec = rtamt.parse("always[0:2](x >= 0) and eventually[0:10](x >= 0)", period="100ms")
    problem = Problem(spec, plant, {"offset": Range(1, 2)}, 10)
    early = problem.run({"offset": 1.0})
    assert early.stopped == 2.0
    assert early.robustness == problem.run({"offset": 1.0}, whole=True).robustness == 1.1


def test_a_plant_may_return_more_than_the_requirement_reads():
    def plant(x):
        return {"time": [0.0, 1.0], "z": [x, x], "w": [1, 2]}

    assert Problem(VALLEY.spec, plant, {"x": Range(0, 1)}).run({"x": 0.25}).robustness == 0.25


def test_samples_that_are_no_multiple_of_the_period_apart():
    def plant(speed):
        for k in range(10):
            yield 0.13 * k, {"height": speed}

    with pytest.raises(TraceError, match=r"^simulation 0 \(speed=2\): .*0\.13.*0\.1"):
        Problem(BALL.spec, plant, BALL.inputs).run({"speed": 2.0})


def test_a_simulation_whose_verdict_stays_open_runs_to_its_end():
    evaluation = BALL.run({"speed": 3.0})
    assert evaluation.satisfied
    assert evaluation.stopped is None
    expected = BALL.spec.evaluate({"height": [values["height"] for _, values in thrown(3.0)]})
    assert evaluation.robustness == expected.robustness


def test_a_grid_is_laid_out_as_it_is_given():
    found = sensitivity(VALLEY, grid={"y": 2, "x": [0.3, 0.5, 1.0]})
    assert list(found.axes) == ["y", "x"]
    assert found.robustness.shape == (2, 3)
    assert found.robustness[1, 2] == pytest.approx(0.49 + 0.09 - 0.05)


def test_a_sensitivity_is_exact_where_a_search_would_stop():
    found = sensitivity(BALL, grid={"speed": [3.0, 12.0]})
    whole = [
        BALL.spec.evaluate({"height": [v["height"] for _, v in thrown(s)]}).robustness for s in (3.0, 12.0)
    ]
    assert found.robustness.tolist() == whole


def test_several_workers_find_what_one_finds_in_the_same_order():
    one = sensitivity(VALLEY, grid={"x": 3, "y": 3})
    two = sensitivity(VALLEY, grid={"x": 3, "y": 3}, workers=2)
    assert one.evaluations == two.evaluations


def test_a_plant_that_no_worker_can_get():
    problem = Problem(VALLEY.spec, lambda x, y: valley(y, x), VALLEY.inputs)
    with pytest.raises(
        UsageError, match=r"the plant cannot be sent to several workers .*: make it a function"
    ):
        falsify(problem, workers=2)


def test_an_interrupted_search_goes_on_where_it_was(tmp_path):
    record = tmp_path / "run.jsonl"
    calls = []

    def counted(x, y):
        calls.append((x, y))
        if len(calls) == 8:
            raise KeyboardInterrupt
        return valley(x, y)

    problem = Problem(VALLEY.spec, counted, VALLEY.inputs)
    with pytest.raises(KeyboardInterrupt):
        falsify(problem, budget=20, seed=2, record=record, stop=False)
    assert len(record.read_text().splitlines()) == 1 + 7
    resumed = falsify(problem, budget=20, seed=2, record=record, stop=False)
    assert len(calls) == 8 + 13
    assert resumed.evaluations == falsify(VALLEY, budget=20, seed=2, stop=False).evaluations


def test_a_record_whose_last_line_was_cut_off_is_good_up_to_it(tmp_path):
    record = tmp_path / "run.jsonl"
    falsify(VALLEY, budget=5, seed=2, record=record, stop=False)
    record.write_text(record.read_text()[:-10])
    again = falsify(VALLEY, budget=5, seed=2, record=record, stop=False)
    assert again.evaluations == falsify(VALLEY, budget=5, seed=2, stop=False).evaluations
    assert len(record.read_text().splitlines()) == 6


def test_a_record_of_another_search_is_refused(tmp_path):
    record = tmp_path / "run.jsonl"
    falsify(VALLEY, budget=2, seed=2, record=record)
    with pytest.raises(
        UsageError, match="records a search with another seed: 2 there, 3 now; give the run a new"
    ):
        falsify(VALLEY, budget=2, seed=3, record=record)


@pytest.mark.parametrize("text", ["speed,height\n1,2\n", '{"search": 7}\n', "[" * 100_000 + "\n"])
def test_a_record_that_is_none(tmp_path, text):
    record = tmp_path / "run.jsonl"
    record.write_text(text)
    with pytest.raises(UsageError, match="is no record of a search; give the run a new file"):
        falsify(VALLEY, record=record)


def test_infinite_robustness_is_recorded_and_searched(tmp_path):
    problem = Problem(rtamt.parse("z >= 0 or true"), valley, VALLEY.inputs)
    record = tmp_path / "run.jsonl"
    found = falsify(problem, budget=6, record=record)
    assert [evaluation.robustness for evaluation in found.evaluations] == [np.inf] * 6
    assert json.loads(record.read_text().splitlines()[1])["robustness"] == "inf"
    assert falsify(problem, budget=6, record=record).evaluations == found.evaluations


def test_nan_from_the_plant_names_simulation_variable_and_sample():
    problem = Problem(VALLEY.spec, lambda **_: {"z": [1.0, float("nan")]}, {"x": Range(0, 1)})
    with pytest.raises(TraceError) as caught:
        problem.run({"x": 0.25}, 4)
    assert str(caught.value).startswith("simulation 4 (x=0.25): 'z' is NaN at sample 1, time 1 s")


def test_a_plant_that_fails_says_where():
    problem = Problem(VALLEY.spec, lambda **_: 1 / 0, {"x": Range(0, 1)})
    with pytest.raises(UsageError) as caught:
        problem.run({"x": 0.25})
    assert str(caught.value) == "simulation 0 (x=0.25): the plant failed: ZeroDivisionError: division by zero"


def test_a_plant_without_a_variable_of_the_requirement():
    problem = Problem(BALL.spec, lambda speed: iter([(0.0, {"heigth": speed})]), BALL.inputs)
    with pytest.raises(UsageError) as caught:
        problem.run({"speed": 2.0})
    assert str(caught.value) == (
        "simulation 0 (speed=2): the plant gave no 'height' at 0 s, which the requirement reads; did you mean 'heigth'?"
    )


@pytest.mark.parametrize(
    ("given", "told"), [(0.5, "0.5"), ((0.0, 2.0), "(0.0, 2.0)"), ((0.0, {}, 1), "(0.0, {}, 1)")]
)
def test_a_plant_that_yields_no_samples(given, told):
    problem = Problem(BALL.spec, lambda **_: iter([given]), BALL.inputs)
    with pytest.raises(UsageError) as caught:
        problem.run({"speed": 2.0})
    assert str(caught.value) == (
        f"simulation 0 (speed=2): the plant yielded {told}; a sample is (time, {{variable: value}}), such as "
        "(0.1, {'x': 2.5})"
    )


@pytest.mark.parametrize("seed", range(3))
def test_cma_finds_a_violation_that_lies_in_a_corner_alone(seed):
    corner = [(-1) ** k for k in range(12)]

    def plant(**inputs):
        return {"x": [sum(sign * value for sign, value in zip(corner, inputs.values(), strict=True))]}

    inputs = {f"u{k}": Range(-1, 1) for k in range(12)}
    problem = Problem(rtamt.parse("always(x < 11.9999)"), plant, inputs)
    found = falsify(problem, optimizer="cma", budget=300, seed=seed)
    assert found.falsified
    assert list(found.best.point.values()) == corner


def test_input_signals_reach_the_plant():
    spec = rtamt.parse("always[0:10](abs(command - position) <= 2)", period="10ms")
    problem = Problem(spec, follower, {"command": Pulse(amplitude=Range(1, 4), frequency=0.25)}, duration=10)
    assert list(problem.space) == ["command.amplitude"]
    assert problem.run({"command.amplitude": 1.0}).satisfied
    wrong = problem.run({"command.amplitude": 4.0})
    assert (wrong.satisfied, wrong.stopped) == (False, 0.0)


@pytest.mark.parametrize(
    ("inputs", "duration", "sentence"),
    [
        ({"x": 3}, None, "nothing can vary: give at least one Range, or an input signal with a Range"),
        ({"x": Pulse(Range(0, 1))}, None, "the input 'x' is a signal: give the duration of a simulation too"),
        ({"x": "3"}, None, "the input 'x' is '3'; give a Range, a number or an input signal"),
        ({"x": Range(0, 1)}, 0, "the duration is 0; give a positive number of seconds"),
    ],
)
def test_a_problem_that_is_none(inputs, duration, sentence):
    with pytest.raises(UsageError) as caught:
        Problem(VALLEY.spec, valley, inputs, duration)
    assert str(caught.value) == sentence


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        (
            {"optimizer": "cmaes"},
            "there is no optimizer 'cmaes'; did you mean 'cma'? (optimizers: cma, differential_evolution, "
            "dual_annealing, optuna, sobol, random)",
        ),
        ({"budget": 0}, "the budget is 0; give a whole number, 1 or more"),
        ({"workers": 0}, "the number of workers is 0; give a whole number, 1 or more"),
    ],
)
def test_settings_that_do_not_fit(settings, sentence):
    with pytest.raises(UsageError) as caught:
        falsify(VALLEY, **settings)
    assert str(caught.value) == sentence


def test_a_point_with_the_wrong_parameters():
    with pytest.raises(UsageError, match=r"there is no parameter 'sped'; did you mean 'speed'\?"):
        BALL.run({"sped": 3.0})
    with pytest.raises(UsageError, match="the parameter 'speed' has no value at this point"):
        BALL.run({})


def test_sensitivity_by_a_sequence_that_fills_the_space():
    found = sensitivity(VALLEY, samples=16, seed=1)
    xs = sorted(evaluation.point["x"] for evaluation in found.evaluations)
    assert [int(x * 16) for x in xs] == list(range(16))
    assert found.robustness.shape == (16,)
    assert found.best.robustness == found.robustness.min()


@pytest.mark.parametrize(
    ("how", "sentence"),
    [
        ({}, "give either grid= or samples="),
        ({"grid": {"x": 2}}, "the grid does not contain the parameter 'y': how many values shall it take?"),
        (
            {"grid": {"x": 2, "y": 1}},
            "the grid has 1 values of 'y'; give 2 or more, or the values themselves",
        ),
        ({"grid": {"x": 2, "z": 2}}, "there is no parameter 'z'"),
    ],
)
def test_a_sensitivity_of_nothing(how, sentence):
    with pytest.raises(UsageError) as caught:
        sensitivity(VALLEY, **how)
    assert str(caught.value) == sentence
