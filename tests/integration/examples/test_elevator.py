"""The elevators: logic of the faults, dynamics, the paper's experiments in short, and the monitor beside as an FMU."""

import re

import numpy as np
import pytest

import rtamt
from rtamt.search import Step
from tests.integration.examples.conftest import EXAMPLES


@pytest.fixture
def elevator(example):
    return example("elevator", "elevator")


def modes_of(elevator, faults, time=5.0):
    return {name: mode.value for name, mode in elevator.modes(faults, time).items()}


@pytest.mark.parametrize(
    ("faults", "expected"),
    [
        ({}, "LO Active, LI Standby, RI Standby, RO Active"),
        ({"H1": 1}, "LO Off, LI Active, RI Active, RO Standby"),
        ({"H3": 1}, "LO Standby, LI Active, RI Active, RO Off"),
        ({"H2": 1}, "LO Active, LI Off, RI Off, RO Active"),
        ({"LO": 1}, "LO Isolated, LI Active, RI Active, RO Standby"),
        ({"LI": 1}, "LO Active, LI Isolated, RI Standby, RO Active"),
        ({"LO": 1, "H1": 2}, "LO Isolated, LI Active, RI Active, RO Standby"),
        ({"LO": 1, "LI": 2}, "LO Isolated, LI Isolated, RI Standby, RO Active"),
        ({"H1": 4.95}, "LO Off, LI Passive, RI Passive, RO Standby"),
        ({"H1": 6}, "LO Active, LI Standby, RI Standby, RO Active"),
        ({"PFCU1": 1}, "LO Active, LI Standby, RI Standby, RO Active"),
        ({"PFCU1": 1, "PFCU2": 2}, "LO Off, LI Off, RI Off, RO Off"),
    ],
)
def test_modes_after_faults(elevator, faults, expected):
    assert ", ".join(f"{name} {mode}" for name, mode in modes_of(elevator, faults).items()) == expected


def test_every_single_fault_but_the_loss_of_a_control_unit_leaves_the_elevators_to_the_pilot(elevator):
    for fault in elevator.FAULTS:
        _, last = list(elevator.Elevators(4.0, {fault: 0.5})(Step(time=1.0, after=1.7)))[-1]
        reached = elevator.LIMITED if fault.startswith("PFCU") else 1.7
        assert abs(last["lep"] - reached) < 0.01, fault
        assert abs(last["rep"] - reached) < 0.01, fault


def test_an_elevator_that_nothing_moves_floats_to_the_middle(elevator):
    last = list(elevator.Elevators(6.0, {"LO": 2.0, "LI": 2.0})(Step(after=1.0)))[-1][1]
    assert abs(last["lep"]) < 0.1
    assert abs(last["rep"] - 1) < 0.01


def test_what_cannot_fail_is_refused(elevator):
    with pytest.raises(
        ValueError, match="'H4' cannot fail; these can: LO, LI, RI, RO, H1, H2, H3, PFCU1, PFCU2"
    ):
        elevator.Elevators(faults={"H4": 1})


@pytest.mark.parametrize("side", ["left", "right"])
def test_the_requirement_is_that_of_the_paper(side):
    spec = rtamt.load(EXAMPLES / f"elevator/{side}.stl", period="20ms")
    position = {"left": "lep", "right": "rep"}[side]
    assert spec.input_names == ("pc", position)
    assert spec.roles == {"pc": "input", position: "output"}
    assert spec.horizon == pytest.approx(10.0)


def test_a_fast_and_high_command_is_more_critical(example):
    run = example("elevator", "run")
    problem = run.problem("left")
    corners = [
        problem.run({"pc.frequency": frequency, "pc.amplitude": amplitude}, whole=True).robustness
        for frequency in (0.2, 1.0)
        for amplitude in (1.0, 1.75)
    ]
    # The README's table.
    np.testing.assert_allclose(corners, [0.199, 0.198, 0.131, 0.079], atol=0.0011)


def test_the_loss_of_a_circuit_makes_the_critical_corner_a_violation(example):
    run = example("elevator", "run")
    corner = {"pc.frequency": 1.0, "pc.amplitude": 1.75}
    assert run.problem("left").run(corner).satisfied
    faulty = run.problem("left", H1=2.0).run(corner)
    assert not faulty.satisfied
    assert faulty.stopped < 5


def test_the_unit_beside_the_plant_tells_what_the_monitor_in_python_tells(example, capsys):
    example("elevator", "beside_fmu").main()
    printed = capsys.readouterr().out
    assert re.fullmatch(
        r"351 values, each equal to that of the monitor in Python\nviolated by the step at \d+\.\d\d s\n",
        printed,
    )
