"""Parameters that are Booleans or members of enumerations."""

from __future__ import annotations

import copy
import enum
import pickle
from math import inf

import pytest

import rtamt
from rtamt.errors import SpecificationError, UsageError

TEXT = """
    enum Mode { MANUAL, AUTO = 4, "hold position" = 7 }
    enum Gear { MANUAL, AUTO }
    input Mode mode
    input float x
    parameter Mode start = AUTO
    parameter bool strict = true
    require MODE: mode == start
    require LOW: strict -> x <= 3
"""
DATA = {"mode": [0, 4, 7], "x": [1, 2, 5]}


class Other(enum.Enum):
    """Found by its name."""

    MANUAL = 99


@pytest.fixture(scope="module")
def spec():
    return rtamt.parse(TEXT)


def holds(spec, name):
    return [value > 0 for value in spec.select(name).evaluate(DATA).signal.values]


def test_members_have_the_value_of_the_text_until_they_are_set(spec):
    assert dict(spec.parameters) == {"start": 4.0, "strict": 1.0}
    assert holds(spec, "MODE") == [False, True, False]


@pytest.mark.parametrize("value", ["MANUAL", "Mode.MANUAL", Other.MANUAL, 0, 0.0])
def test_a_member_is_set_by_its_name_or_code(spec, value):
    manual = spec.with_parameters(start=value)
    assert holds(manual, "MODE") == [True, False, False]
    assert manual.parameters["start"] == 0.0


def test_the_text_of_a_formula_has_the_member_and_can_be_parsed_again(spec):
    hold = spec.with_parameters(start="hold position")
    text = str(hold.requirements["MODE"])
    assert text == 'mode == "Mode.hold position"'
    again = rtamt.parse(TEXT.partition("require")[0] + text)
    assert again.evaluate({"mode": [7, 4]}).signal.values.tolist() == [inf, -inf]
    assert "Mode.hold" in hold.select("MODE").formula.latex().replace("\\text", "").replace("~", " ")


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"start": "AUT"},
            "the parameter 'start' is 'AUT', which is no member of Mode; did you mean 'AUTO'?",
        ),
        (
            {"start": 1},
            "the parameter 'start' is 1, which is no member of Mode; its members are MANUAL, AUTO, hold position",
        ),
        (
            {"start": False},
            "the parameter 'start' is False, which is no member of Mode; its members are MANUAL, AUTO, hold position",
        ),
        ({"strict": "yes"}, "the parameter 'strict' is 'yes'; it is a bool, so give true or false"),
        ({"strict": 2}, "the parameter 'strict' is 2; it is a bool, so give true or false"),
    ],
)
def test_a_value_of_another_type_is_one_sentence(spec, values, message):
    monitor = spec.monitor()
    for call in (spec.with_parameters, monitor.reset):
        with pytest.raises(UsageError) as error:
            call(**values)
        assert str(error.value) == message


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize("verdict", ["delayed", "eager", "interval"])
def test_a_monitor_is_reset_to_another_member(verdict, backend):
    def replay_values(monitor):
        known = getattr(monitor, "changes", list)
        return [str((monitor.update(t, mode=mode), known())) for t, mode in enumerate(DATA["mode"])]

    spec = rtamt.parse(TEXT, backend=backend).select("MODE")
    monitor = spec.monitor(verdict=verdict)
    before = replay_values(monitor)
    monitor.reset(start="MANUAL")
    expected = replay_values(spec.with_parameters(start="MANUAL").monitor(verdict=verdict))
    assert replay_values(monitor) == expected != before
    for twin in (copy.copy(monitor), pickle.loads(pickle.dumps(monitor))):
        twin.reset()
        assert replay_values(twin) == expected


def test_a_compiled_program_has_typed_parameters(spec):
    program = spec.compile()
    assert list(program.metadata.parameters) == ["start", "strict"]
    assert set(program.metadata.meanings.values()) >= {"mode == start"}


def test_a_parameter_is_compared_to_values_of_its_enumeration_only():
    with pytest.raises(SpecificationError) as error:
        rtamt.parse("enum Mode { MANUAL, AUTO } input float x parameter Mode start = AUTO x == start")
    assert "'start' is of the enumeration Mode, and 'x' is none of its members" in str(error.value)
