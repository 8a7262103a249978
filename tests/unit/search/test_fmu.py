"""An FMU as a plant. The unit is one of our own: what a monitor tells is an output like any other."""

import pytest

import rtamt
from rtamt import fmi
from rtamt.errors import UsageError
from rtamt.search import Problem, Range, Sine, falsify
from rtamt.search.config import load_search
from rtamt.search.fmu import FmuPlant

BOTH = pytest.mark.parametrize("version", [2, 3])
AMPLIFIER = "const float gain = 2\nx * gain >= 0"  # its robustness: the input amplified, one step later


@pytest.fixture
def unit(tmp_path):
    def export(version=2, period="100ms"):
        path = tmp_path / f"amplifier{version}.fmu"
        fmi.export(rtamt.parse(AMPLIFIER, period=period), path, version=version)
        return path

    return export


@BOTH
def test_a_unit_is_stepped_with_its_inputs_and_parameters(unit, version):
    signal = Sine(amplitude=1, frequency=0.5)
    samples = list(FmuPlant(unit(version), duration=1, step=0.1)(x=signal, gain=3))
    assert [time for time, _ in samples] == [k * 0.1 for k in range(11)]
    assert [values["x"] for _, values in samples] == [signal(k * 0.1) for k in range(11)]
    assert [values["robustness"] for _, values in samples[1:]] == [3 * signal(k * 0.1) for k in range(10)]


@BOTH
def test_a_unit_is_falsified_and_stopped(unit, version):
    plant = FmuPlant(unit(version), duration=4, step=0.1)
    spec = rtamt.parse("always[0:4](robustness <= 3)", period="100ms")
    inputs = {"x": Sine(amplitude=Range(0, 1), frequency=0.25), "gain": Range(1, 4)}
    found = falsify(Problem(spec, plant, inputs, 4), optimizer="random", budget=60, seed=1)
    point = found.best.point
    assert found.falsified
    assert point["gain"] * point["x.amplitude"] > 3
    assert 0 < found.best.stopped < 4


def test_a_requirement_reads_inputs_and_outputs_of_a_unit(unit):
    spec = rtamt.parse("always(prev(false) or abs(robustness - (prev(2 * x))) <= 1e-9)", period="100ms")
    problem = Problem(spec, FmuPlant(unit(), 2, 0.1), {"x": Sine(amplitude=Range(1, 2))}, 2)
    assert problem.run({"x.amplitude": 1.5}).satisfied


def test_a_problem_file_names_a_unit(unit):
    path = unit().with_name("problem.toml")
    path.write_text(
        'formula = "always[0:2](robustness <= 3)"\nplant = "amplifier2.fmu"\nduration = 2\nperiod = "100ms"\n'
        "step = 0.1\n[inputs]\nx = { low = 0, high = 2 }\n[search]\nbudget = 30\n"
    )
    search = load_search(path)
    assert falsify(search.problem, **search.settings).best.point["x"] > 1.5


@pytest.mark.parametrize(
    ("settings", "inputs", "sentence"),
    [
        ({"duration": 1}, {"y": 1.0}, "'{path}' has no variable 'y'"),
        ({"duration": 1}, {"gian": 1.0}, "'{path}' has no variable 'gian'; did you mean 'gain'?"),
        ({"duration": None}, {}, "'{path}' does not say how long to simulate; give the duration"),
    ],
)
def test_a_unit_that_is_asked_for_what_it_has_not(unit, settings, inputs, sentence):
    path = unit()
    with pytest.raises(UsageError) as caught:
        next(FmuPlant(path, step=0.1, **settings)(**inputs))
    assert str(caught.value) == sentence.format(path=path)


def test_a_file_that_is_not_there_and_one_that_is_no_unit(tmp_path):
    (tmp_path / "text.fmu").write_text("no unit")
    for name, sentence in {
        "gone": "there is no unit '{path}'",
        "text": "'{path}' cannot be read as an FMU: File is not a zip file",
    }.items():
        path = tmp_path / f"{name}.fmu"
        with pytest.raises(UsageError) as caught:
            next(FmuPlant(str(path), duration=1, step=0.1)())
        assert str(caught.value) == sentence.format(path=path)


@BOTH
def test_a_step_that_the_unit_refuses_says_at_which_point(unit, version, capsys):
    spec = rtamt.parse("always(robustness <= 3)", period="150ms")
    path = unit(version)
    problem = Problem(spec, FmuPlant(path, 1, 0.15), {"x": Range(0, 1)}, 1)
    with pytest.raises(UsageError) as caught:
        problem.run({"x": 0.5}, 2)
    assert str(caught.value) == (
        f"simulation 2 (x=0.5): the unit '{path}' says: The communication point 0.15 s is no sampling instant: "
        "points must be 0 s plus a multiple of the period, 0.1 s."
    )
    assert capsys.readouterr().out == ""
