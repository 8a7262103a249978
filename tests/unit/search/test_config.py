import json
from pathlib import Path

import pytest

from rtamt.cli import main
from rtamt.errors import UsageError
from rtamt.search import Pulse, Range, falsify
from rtamt.search.config import load_search

PLANT = """
def throw(speed):
    for k in range(21):
        yield k / 10, {"height": speed * k / 10 - 4.9 * (k / 10) ** 2}
"""
PROBLEM = """
formula = "always[0:2](height <= 6)"
plant = "thrower:throw"
duration = 2
period = "100ms"
[inputs]
speed = { low = 1, high = 12 }
[search]
optimizer = "random"
budget = 50
seed = 1
"""


@pytest.fixture
def problem(tmp_path):
    (tmp_path / "thrower.py").write_text(PLANT)
    path = tmp_path / "problem.toml"
    path.write_text(PROBLEM)
    return path


def test_a_file_says_what_to_search(problem):
    search = load_search(problem)
    assert search.problem.space == {"speed": Range(1, 12)}
    assert falsify(search.problem, **search.settings).falsified


def test_the_requirement_may_be_a_file_beside_it(problem):
    (problem.parent / "high.stl").write_text("always[0:2](height <= 6)")
    problem.write_text(PROBLEM.replace('formula = "always[0:2](height <= 6)"', 'specification = "high.stl"'))
    assert str(load_search(problem).problem.spec) == "always[0:2](height <= 6)"


def test_inputs_of_every_kind(problem):
    problem.write_text(
        PROBLEM.replace(
            "speed = { low = 1, high = 12 }",
            'speed = { kind = "pulse", amplitude = { low = 1, high = 1.75 }, frequency = 0.2 }\n'
            'gear = 3\nthrottle = { kind = "piecewise_constant", points = 2, low = 0, high = 100 }',
        )
    )
    problem = load_search(problem).problem
    assert problem.inputs["speed"] == Pulse(amplitude=Range(1, 1.75), frequency=0.2)
    assert list(problem.space) == ["speed.amplitude", "throttle.0", "throttle.1"]


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        (
            "duration",
            "durration",
            "'durration' is not a setting; did you mean 'duration'? (settings: duration, ",
        ),
        (
            "budget",
            "buget",
            "'search.buget' is not a setting; did you mean 'budget'? (settings: budget, optimizer, ",
        ),
        (
            "thrower:throw",
            "thrower",
            "the plant is 'thrower'; write it as 'module:function', or name an FMU file",
        ),
        (
            "thrower:throw",
            "trower:throw",
            "the plant's module 'trower' cannot be imported: No module named 'trower'",
        ),
        (
            "thrower:throw",
            "thrower:trow",
            "the module 'thrower' has no function 'trow'; did you mean 'throw'?",
        ),
        ("low = 1,", "lo = 1,", "the input 'speed': got an unexpected keyword argument 'lo'"),
        ("low = 1,", 'kind = "ramp", low = 1,', "the input 'speed' is of kind 'ramp', not one of range, "),
        ('plant = "thrower:throw"', "", "give the plant: 'module:function', or an FMU file"),
        ("formula =", "#", "give either 'specification', a file, or 'formula', its text"),
        ("height <= 6", "height <=", "expected an operand after '<=', got ')'"),
        ('period = "100ms"', 'period = "100"ms', "Expected newline or end of document"),
    ],
)
def test_a_file_with_a_mistake(problem, old, new, sentence):
    problem.write_text(PROBLEM.replace(old, new))
    with pytest.raises(UsageError) as caught:
        load_search(problem)
    assert str(caught.value).startswith(f"{problem}: ")
    assert sentence in str(caught.value)


def test_a_file_that_is_nested_too_deeply(problem):
    problem.write_text("a = " + "[" * 100_000)
    with pytest.raises(UsageError) as caught:
        load_search(problem)
    assert str(caught.value) == f"{problem}: it is nested too deeply"


@pytest.mark.parametrize("part", ["a", '"a"', "'a b' ", "1"])
def test_a_file_with_a_key_of_very_many_parts(problem, part):
    """It took minutes: parsers of TOML take quadratic time."""
    problem.write_text(".".join([part] * 200_000) + " = 1")
    with pytest.raises(UsageError) as caught:
        load_search(problem)
    assert str(caught.value) == f"{problem}: it has a key of more than 64 parts"


def test_a_file_that_is_not_there():
    with pytest.raises(UsageError, match=r"cannot read 'none.toml': No such file or directory"):
        load_search("none.toml")


def test_the_command_finds_the_violation_and_draws_it(problem, capsys, tmp_path):
    picture = tmp_path / "run.png"
    code = main(["falsify", str(problem), "--plot", str(picture)])
    assert code == 1
    assert capsys.readouterr().out.startswith("violated in simulation ")
    assert picture.read_bytes().startswith(b"\x89PNG")


def test_the_command_without_a_violation(problem, capsys):
    problem.write_text(PROBLEM.replace("height <= 6", "height <= 60"))
    assert main(["falsify", str(problem), "--budget", "5"]) == 0
    assert capsys.readouterr().out.startswith("no violation in 5 simulations; the least robustness is ")


def test_the_command_prints_json_and_records(problem, capsys, tmp_path):
    record = tmp_path / "run.jsonl"
    main(["falsify", str(problem), "--json", "--record", str(record)])
    lines = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [line["simulation"] for line in lines] == list(range(len(lines)))
    assert [line["satisfied"] for line in lines] == [True] * (len(lines) - 1) + [False]
    assert len(record.read_text().splitlines()) == len(lines) + 1


def test_the_command_says_what_is_wrong(problem, capsys):
    assert main(["falsify", str(problem), "--optimizer", "magic"]) == 2
    assert capsys.readouterr().err.startswith("rtamt: there is no optimizer 'magic'; optimizers: cma, ")
    assert main(["falsify", str(problem), "--plot", str(Path("no") / "where.png")]) == 2
    assert "cannot write the plot 'no/where.png'" in capsys.readouterr().err


def test_parameters_of_the_requirement_are_set(problem, capsys):
    declared = PROBLEM.replace("always", "parameter float limit = 6 always").replace("<= 6", "<= limit")
    problem.write_text(declared + "[parameters]\nlimit = 7\n")
    assert str(load_search(problem).problem.spec) == "always[0:2](height <= 7)"
    assert main(["falsify", str(problem), "--set", "limit=9"]) == 0
    assert main(["falsify", str(problem), "--set", "limit=6"]) == 1
    assert main(["falsify", str(problem), "--set", "lim=6"]) == 2
    assert "there is no parameter 'lim'; did you mean 'limit'?" in capsys.readouterr().err


def test_members_and_booleans_of_the_requirement_are_set_by_name(problem):
    typed = "enum Mode { LOW, HIGH } parameter Mode mode = LOW parameter bool strict = true always"
    text = PROBLEM.replace("always", typed).replace("<= 6", "<= (if strict and mode == HIGH then 9 else 6)")
    problem.write_text(text + '[parameters]\nmode = "HIGH"\nstrict = true\n')
    assert main(["falsify", str(problem)]) == 0
    assert main(["falsify", str(problem), "--set", "mode=LOW"]) == 1
    assert main(["falsify", str(problem), "--set", "strict=false"]) == 1
