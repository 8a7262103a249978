"""Streams of groups: fields that a member never has, and members that no formula reads."""

from __future__ import annotations

import copy
from types import SimpleNamespace

import pytest

import rtamt
from rtamt.errors import TraceError

FIELDS = 'input float ego; group cars = "car_*" { float x; float y } '
NEVER = "'car_1' has no 'y' at any sample; give 'car_1.y', or leave out all fields of a member that is absent"


def cars(text: str, **settings) -> rtamt.Specification:
    return rtamt.parse(FIELDS + text, **settings)


@pytest.mark.parametrize("ends", [None, 2.0])
def test_a_member_that_never_gets_a_declared_field_is_an_error_at_the_end_of_a_dense_stream(ends):
    monitor = cars("forall v in cars: v.x > ego", time="dense").monitor()
    monitor.update(0, ego=0.0, car_2=SimpleNamespace(x=1.0, y=1.0), **{"car_1.x": -1.0})
    monitor.update(1, ego=0.0, car_2=None)
    monitor.update(2, ego=0.0, **{"car_1.x": None if ends else -2.0})  # its presence may end before
    for step in (monitor, copy.copy(monitor)):
        with pytest.raises(TraceError) as error:
            step.finish()
        assert (str(error.value), error.value.variable) == (NEVER, "car_1.y")
    monitor.update(3, ego=0.0, **{"car_1.x": -1.0, "car_1.y": 0.0})
    assert monitor.finish().points() == []


def test_a_member_of_a_dense_stream_whose_fields_have_never_had_a_number_lacks_none():
    monitor = cars("forall v in cars: v.x > ego", time="dense").monitor()
    monitor.update(0, ego=0.0, **{"car_1.x": None})
    monitor.update(1, ego=0.0)
    assert monitor.finish().points() == []


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("text", ["ego > 0", "(ego > 0) and forall t in trucks: t.x > 0"])
def test_a_stream_takes_members_of_a_declared_group_that_no_formula_reads(text, time):
    parsed = rtamt.parse(f'group trucks = "truck_*" {FIELDS} {text}', time=time)
    sample = {"ego": 1.0, "car_1.x": 2.0, "car_2": SimpleNamespace(x=1.0)}
    known = parsed.monitor().update(0, **sample)
    assert known == 1 or known.points() == [(0, 1)]
    chunk = {name: [(0, value)] if time == "dense" else [value] for name, value in sample.items()}
    assert parsed.monitor().update_many(chunk).points() == [(0, 1)]
    with pytest.raises(TraceError, match="has no variable 'cra_1'"):
        parsed.monitor().update(0, **sample, cra_1=1.0)


def test_bounds_of_a_condition_on_a_quantifier_inside_another_one_end_with_the_trace():
    part = "exists v in cars: next((exists w in cars where v != w: v.x >= ahead[1](w.x)) or -1)"
    parsed = cars(f"(if {part} then 1 else 0) >= 1 or (ego > 0 and ({part}))")
    monitor = parsed.monitor(verdict="interval", at="start")
    sample = {f"car_{k}.{field}": 0.0 for k in (1, 2) for field in "xy"}
    monitor.update(0, ego=0.0, **sample)
    monitor.finish()
    data = {name: [value] for name, value in {"ego": 0.0, **sample}.items()}
    robustness = parsed.evaluate(data).robustness
    assert monitor.interval() == rtamt.Interval(robustness, robustness)


@pytest.mark.parametrize("verdict", ["eager", "interval", "causation"])
@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_early_verdicts_take_members_of_a_declared_group_that_no_formula_reads(verdict, time):
    monitors = [cars("ego > 0", time=time).monitor(verdict=verdict) for _ in range(2)]
    monitors[0].update(0, **{"ego": 1.0, "car_1.x": 2.0})
    monitors[1].update(0, ego=1.0)
    first, second = (each.finish() for each in monitors)
    assert str(first) == str(second)
