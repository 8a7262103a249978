"""Which recording kills which mutant: as each mutant's own evaluation has it."""

import numpy as np
import pytest

import rtamt
from rtamt.errors import TraceError, UsageError
from rtamt.mutation import mutate

SPEC = """
enum Mode { OFF, ON }
input Mode mode
input float x
parameter float low = 2
require HIGH: always(mode == ON -> x >= low)
require SOON: eventually[0:3](x > 4 or once[1:2](mode == OFF))
"""
DRIVES = {
    "calm": {"time": [0, 1, 2, 3], "mode": ["ON", "ON", "ON", "ON"], "x": [3, 3, 3, 2.5]},
    "edge": {"time": [0, 1, 2, 3], "mode": ["ON", "OFF", "ON", "ON"], "x": [2, 1, 2, 5]},
    "wrong": {"time": [0, 1, 2, 3], "mode": ["OFF", "ON", "ON", "ON"], "x": [0, 1, 9, 4]},
}


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_mutant_is_killed_where_its_verdict_differs(time):
    spec = rtamt.parse(SPEC, time=time)
    found = mutate(spec, DRIVES)
    assert {mutant.kind for mutant in found.mutants} == {"operator", "threshold", "bound"}
    for mutant in found.mutants:
        for column, (_, data) in enumerate(DRIVES.items()):
            own = spec.requirements[mutant.requirement].evaluate(data).satisfied
            differs = mutant.specification.evaluate(data).satisfied != own
            assert found.killed[mutant.number - 1, column] == differs, mutant
    assert found.score == np.mean(found.killed.any(axis=1))
    assert set(found.survivors) == {m for m in found.mutants if not found.killers(m)}
    assert sum(found.alone.values()) == sum(found.killed.sum(axis=1) == 1)


def test_the_result_is_the_same_each_time():
    assert mutate(rtamt.parse(SPEC), DRIVES).to_dict() == mutate(rtamt.parse(SPEC), DRIVES).to_dict()


def test_recordings_with_different_periods_have_common_bounds():
    spec = rtamt.parse("eventually[0:6](x > 4)")
    found = mutate(spec, [{"time": [0, 2, 4], "x": [1, 2, 3]}, {"time": [0, 3, 6], "x": [1, 2, 5]}])
    assert "eventually[0:6](x > 4) → eventually[0:12](x > 4)" in [mutant.change for mutant in found.mutants]


def test_members_of_groups():
    spec = rtamt.parse('group cars = "car_*"; always forall c in cars: c.x > 3')
    found = mutate(spec, {"one": {"car_1.x": [4, 5], "car_2.x": [4, 2]}})
    killed = [mutant.change for mutant in found.mutants if found.killers(mutant)]
    assert "forall c in cars: c.x > 3 → exists c in cars: c.x > 3" in killed


def test_a_mutant_that_cannot_be_evaluated_is_killed():
    found = mutate(rtamt.parse("sqrt(x - 1) >= 0"), [{"x": [1.0, 2.0]}])
    changes = {mutant.change: found.killers(mutant) for mutant in found.mutants}
    assert changes["x - 1 → x - 1.1"] == ("0",)


def test_an_optional_signal_that_is_missing_kills_nothing():
    spec = rtamt.parse("optional float y; float x; require A: x > 1; require B: y > 2")
    found = mutate(spec, {"short": {"x": [3]}})
    assert {found.killers(m) for m in found.mutants if m.requirement == "B"} == {()}
    assert any(found.killers(m) for m in found.mutants if m.requirement == "A")


def test_what_is_wrong_is_said():
    spec = rtamt.parse("sqrt(x) >= 0")
    with pytest.raises(TraceError) as failure:
        mutate(spec, {"bad": {"x": [-1.0]}})
    assert str(failure.value).startswith("bad: ")
    with pytest.raises(UsageError, match="there is no recording"):
        mutate(spec, {})
    with pytest.raises(
        UsageError, match=r"recordings is 'log\.csv'; give a list of recordings, or a mapping from names"
    ):
        mutate(spec, "log.csv")
    with pytest.raises(UsageError, match="mutate takes a specification"):
        mutate("x > 3", [{"x": [1]}])


def test_the_matrix_is_plotted():
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("agg")
    found = mutate(rtamt.parse("x >= 3"), {"logs/low": {"x": [5]}, "logs/high": {"x": [2]}})
    axes = found.plot()
    assert [label.get_text() for label in axes.get_xticklabels()] == ["low", "high"]
    assert [label.get_text().split()[-1] for label in axes.get_yticklabels()] == [
        m.name for m in found.mutants
    ]
    assert axes.get_title(loc="right") == "2 of 5 mutants killed (40%); ✗ survives"
