"""Monitors of quantifiers: members that come and go, one compilation, and what is wrong with an update."""

from __future__ import annotations

import copy
import pickle
import time
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest

import rtamt
from rtamt.compiler import lower
from rtamt.errors import EvaluationError, SpecificationError, TraceError, UsageError
from rtamt.language.formula import Const
from rtamt.language.operators import STL

inf = float("inf")
CARS = 'group cars = "car_*"; '


def spec(text: str, **settings) -> rtamt.Specification:
    return rtamt.parse(CARS + text, **settings)


def test_a_member_that_an_update_leaves_out_or_gives_as_none_is_absent():
    monitor = spec("forall v in cars: v.x > ego").monitor()
    assert monitor.update(0, ego=0.0, **{"car_1.x": 3.0}) == 3
    assert monitor.update(1, ego=1.0, **{"car_1.x": None, "car_2.x": 5.0}) == 4
    assert monitor.update(2, ego=1.0) == inf
    assert monitor.update(3, ego=1.0, car_2=None, car_3=SimpleNamespace(x=0.5)) == -0.5


def test_a_value_is_known_one_horizon_later_also_in_mixed_formulas():
    monitor = spec("(forall v in cars: eventually[0:1](v.x > 0)) or eventually[0:2](ego > 0)").monitor()
    assert monitor.horizon == 2
    given = [monitor.update(t, ego=-5.0, **{"car_1.x": float(-t)}) for t in range(4)]
    assert given == [None, None, 0, -1]
    assert monitor.finish().points() == [(2, -2), (3, -3)]


def test_a_new_member_compiles_nothing(monkeypatch):
    compiled = []
    original = lower.Lowering.program
    monkeypatch.setattr(lower.Lowering, "program", lambda *a: compiled.append(a) or original(*a))
    monitor = spec("forall v in cars: once[0:2](v.x > 0)").monitor()
    before = len(compiled)
    assert before > 0
    for t in range(20):
        monitor.update(t, **{f"car_{t}.x": 1.0})
    assert len(compiled) == before


def test_a_member_that_is_gone_is_dropped_when_it_cannot_matter_any_more():
    monitor = spec("forall v in cars: once[0:2](v.x > 0)").monitor()
    for t in range(20):
        monitor.update(t, **{f"car_{t}.x": 1.0})
    assert len(monitor.members) < 6
    unbounded = spec("forall v in cars: once(v.x > 0)").monitor()
    given = [unbounded.update(t, **({"car_1.x": 3.0 - t} if t in (0, 15) else {})) for t in range(16)]
    assert given[15] == 3


BODIES = [
    "forall v in cars: minimum[1:4](v.x) > 2",
    "forall v in cars: forall w in cars: once(v.x > 3)",
    "forall v in cars: exists w in cars: delay[1s](v.x) < w.x",
    "exists v in cars: (forall w in cars where v != w: historically[2:6](w.x > y)) or once[0:1](v.x > 0)",
    "(count v in cars: (count w in cars: eventually[0:2](held(v.x, w.x > y) > 1)) > 1) > 1",
]


@pytest.mark.parametrize("time_domain", ["discrete", "dense"])
@pytest.mark.parametrize("body", BODIES)
def test_a_member_that_returns_after_a_long_absence_still_has_what_matters(body, time_domain):
    rng = np.random.default_rng(17)
    formula = rtamt.parse(f"{CARS}({body}) and y > -50", time=time_domain, period="1s", resolution="1s")
    for _ in range(20):
        y = rng.integers(-3, 5, 24).astype(float).tolist()
        columns = {
            f"car_{k}.x": [
                x if here else None
                for x, here in zip(
                    rng.integers(-3, 5, 24).astype(float).tolist(),
                    np.repeat(rng.random(8) < 0.4, 3),
                    strict=True,
                )
            ]
            for k in range(2)
        }
        times, monitor, found = list(range(24)), formula.monitor(), []
        for begin, end in pairwise([0, *sorted(rng.choice(np.arange(1, 24), 6, replace=False)), 24]):
            part = {name: xs[begin:end] for name, xs in {"y": y, **columns}.items()}
            if time_domain == "dense":
                part = {name: (times[begin:end], xs) for name, xs in part.items()}
            found += monitor.update_many(part).points()
        found += monitor.finish().points()
        data = {"y": y, **columns}
        if time_domain == "dense":
            data = {name: (times, xs) for name, xs in data.items()}
        expected = formula.evaluate(data).signal
        values = dict(found)
        held = [values[max(at for at in values if at <= t)] for t in times]
        whole = dict(expected.points())
        assert held == [whole[max(at for at in whole if at <= t)] for t in times]


@pytest.mark.parametrize("time_domain", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (
            "(exists v in cars: exists w in cars: w.x <= 3) or (exists v in cars: exists w in cars: w.x > 9)",
            2,
        ),
        (
            "(forall v in cars: exists w in cars: w.x > 2) and (forall v in cars: exists w in cars: w.x < 9)",
            -1,
        ),
        (
            "(count v in cars: exists w in cars: w.x > 9) + "
            "(count v in cars: exists w in cars where v != w: w.x < 9) > 1",
            1,
        ),
    ],
)
def test_quantifiers_that_differ_only_in_the_ones_inside_them_are_two(body, expected, time_domain):
    formula = rtamt.parse(f"{CARS}({body}) and y > -50", time=time_domain)
    monitor = formula.monitor()
    given = monitor.update(0, y=0.0, **{"car_1.x": 1.0, "car_2.x": 1.0})
    assert (given if time_domain == "discrete" else given.points()[0][1]) == expected


def test_a_new_member_compiles_nothing_in_dense_time_either(monkeypatch):
    compiled = []
    original = lower.Lowering.program
    monkeypatch.setattr(lower.Lowering, "program", lambda *a: compiled.append(a) or original(*a))
    monitor = spec("forall v in cars: once[0:2](v.x > ego)", time="dense").monitor()
    before = len(compiled)
    assert before > 0
    for t in range(20):
        monitor.update(t, ego=0.0, **{f"car_{t}.x": 1.0, f"car_{t - 1}.x": None})
    assert len(compiled) == before
    assert len(monitor.members) < 6
    assert len(monitor._inputs.counts) < 6


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_copies_and_pickles_of_dense_monitors_go_on_on_their_own(backend):
    monitor = spec("forall v in cars: once[0:2](v.x > ego)", backend=backend, time="dense").monitor()
    monitor.update(0, ego=0.0, **{"car_1.x": 3.0})
    twins = [copy.copy(monitor), pickle.loads(pickle.dumps(monitor))]
    assert monitor.update(1, ego=9.0, **{"car_1.x": 3.0}).points() == [(1, 3)]
    for twin in twins:
        assert twin.update(1, ego=0.0, **{"car_1.x": 4.0, "car_2.x": 1.0}).points() == [(1, 1)]


def test_a_failed_update_of_a_dense_monitor_changes_nothing():
    monitor = spec("forall v in cars: once[0:1](1 / v.x + ego / ego > 0)", time="dense").monitor()
    twin = copy.copy(monitor)
    for t in range(70):
        sample = {"ego": 1.0, "car_1.x": 2.0 + t, "car_2.x": 1.0}
        with pytest.raises(EvaluationError) as error:
            monitor.update(t, **{**sample, "car_3.x": 1.0, "ego": 0.0})
        assert str(error.value).startswith("v is car_1: ")
        with pytest.raises(TraceError):
            monitor.update(t, **{**sample, "car_1.x": float("nan")})
        assert monitor.update(t, **sample).points() == twin.update(t, **sample).points()
    assert monitor.members == twin.members
    assert monitor.samples == twin.samples == 210


def test_a_member_in_dense_time_is_present_from_its_last_field_on_until_one_is_none():
    monitor = spec("count v in cars: v.x + v.y > ego", time="dense").monitor()
    assert monitor.update(0, ego=0.0, **{"car_1.x": 3.0}).points() == [(0, 0)]
    assert monitor.update(1, **{"car_1.y": 1.0}).points() == []
    assert monitor.update(2, ego=0.0, car_2=SimpleNamespace(x=1.0, y=2.0)).points() == [(1, 1), (2, 2)]
    assert monitor.update(3, ego=0.0, car_2=None).points() == [(3, 1)]
    assert monitor.update(4, ego=9.0, **{"car_1.y": None}).points() == [(4, 0)]
    assert monitor.finish().points() == []


def test_a_dense_monitor_without_other_variables_knows_all_up_to_the_latest_update():
    monitor = spec("forall v in cars: v.x > 0", time="dense").monitor()
    assert monitor.update(0).points() == []
    assert monitor.update(1, **{"car_1.x": 3.0}).points() == [(1, 3)]
    assert monitor.update(4).points() == [(4, 3)]
    assert monitor.update(5, **{"car_2.x": 1.0}).points() == [(5, 1)]


def test_watched_formulas_of_a_dense_monitor_end_with_the_trace():
    text = CARS + "require R1: forall v in cars: v.x > ego\nrequire R2: eventually[0:2](ego > 0)"
    parsed = rtamt.parse(text, time="dense")
    data = {"ego": [(0, 1.0), (3, 2.0), (5, 0.5)], "car_1.x": [(0, 4.0), (4, 2.0), (6, 9.0)]}
    monitor = parsed.monitor(watch=["R1", "R2"])
    found = {"R1": [], "R2": []}
    for step in (lambda: monitor.update_many(data), monitor.finish):
        step()
        for name in found:
            found[name] += monitor[name].points()
    for name, points in found.items():
        whole = parsed.requirements[name].evaluate(data).signal
        assert points[-1] == whole.points()[-1]
        assert dict(points).items() >= dict(whole.points()).items()
        assert [t for t, _ in points] == sorted({t for t, _ in points})


def test_dense_monitors_take_dates_units_and_semantics():
    data = {"ego": [(0, 2.0), (3000, 0.0)], "car_1.x": [(0, 1.0), (1000, None)], "car_2.x": [(2000, 2.0)]}
    text = "forall v in cars: v.x >= ego"
    monitor = spec(text, time="dense", semantics="boolean").monitor(time_unit="ms")
    assert monitor.update_many(data).points() == [(0, -inf), (1000, inf), (3000, inf)]
    dated = spec(text, time="dense").monitor()
    at = np.datetime64("2026-01-01T12:00:00")
    assert dated.update(at, ego=0.0, **{"car_1.x": 1.0}).times[0] == at
    assert dated.update(at + np.timedelta64(2, "s"), ego=2.0).points()[-1][1] == -1


def test_a_half_open_bound_of_a_member_is_known_as_early_as_any_other():
    monitor = spec("forall v in cars: eventually[0:2)(v.x > 0)").monitor()
    assert monitor.horizon == spec("forall v in cars: eventually[0:2)(v.x > 0)").horizon == 1


def test_a_sample_of_a_member_that_comes_too_late_is_one_sentence():
    monitor = spec("forall v in cars: v.x > ego", time="dense").monitor()
    monitor.update(1, ego=0.0)
    with pytest.raises(TraceError) as error:
        monitor.update(1, **{"car_1.x": 1.0})
    assert str(error.value) == (
        "'car_1.x' has a sample at 1 s, and the result is known up to 1 s already; give samples of members before "
        "those of the other variables, or with them"
    )


@pytest.mark.parametrize("backend", ["cpp", "python"])
def test_copies_and_pickles_go_on_on_their_own(backend):
    monitor = spec("forall v in cars: once[0:2](v.x > ego)", backend=backend).monitor()
    monitor.update(0, ego=0.0, **{"car_1.x": 3.0})
    twins = [copy.copy(monitor), pickle.loads(pickle.dumps(monitor))]
    assert monitor.update(1, ego=9.0, **{"car_1.x": 3.0}) == 3
    for twin in twins:
        assert twin.update(1, ego=0.0, **{"car_1.x": 4.0, "car_2.x": 1.0}) == 1


def test_a_monitor_whose_formula_shares_a_quantifier_comes_back_from_a_pickle():
    parsed = spec("exists v in cars: v.x > 0")
    shared = parsed.formula
    both = STL["and"](shared, STL["gt"](STL["if"](shared, Const(1.0), Const(0.0)), Const(0.5)))
    monitor = parsed.with_formula(both).monitor()
    monitor.update(0, **{"car_1.x": 3.0})
    twin = pickle.loads(pickle.dumps(monitor))
    assert twin.update(1, **{"car_1.x": 4.0}) == monitor.update(1, **{"car_1.x": 4.0}) == 0.5


def test_a_failed_update_changes_nothing():
    monitor = spec("forall v in cars: once[0:1](1 / v.x + ego / ego > 0)").monitor()
    twin = copy.copy(monitor)
    for t in range(100):
        sample = {"ego": 1.0, "car_1.x": 2.0 + t, "car_2.x": 1.0}
        with pytest.raises(EvaluationError) as error:
            monitor.update(t, **{**sample, "car_3.x": 1.0, "ego": 0.0})
        assert f"at sample {t}, time {t} s" in str(error.value)
        with pytest.raises(TraceError):
            monitor.update(t, **{**sample, "car_1.x": float("nan")})
        assert monitor.update(t, **sample) == twin.update(t, **sample)
    assert monitor.members == twin.members


def test_a_chunk_that_fails_changes_nothing():
    monitor = spec("forall v in cars: once(1 / v.x > 0)").monitor()
    monitor.update_many({"car_1.x": [1.0, 2.0]})
    with pytest.raises(EvaluationError):
        spec("forall v in cars: 0 * (1 / v.x) > 0").monitor().update_many({"car_1.x": [1.0, 0.0]})
    with pytest.raises(TraceError):
        monitor.update_many({"car_1.x": [1.0, float("nan")]})
    assert monitor.samples == 2


def test_a_chunk_may_have_no_members_and_reset_forgets_them():
    monitor = spec("count v in cars: v.x > 0").monitor(period=0.5)
    assert monitor.update_many({"time": [0, 0.5]}).points() == [(0, 0), (0.5, 0)]
    assert monitor.update_many({"time": [1.0], "car_1.x": [1]}).points() == [(1, 1)]
    monitor.reset()
    assert (monitor.samples, monitor.members) == (0, ())
    assert monitor.update(0.0, **{"car_1.x": 1.0}) == 1


def test_watched_formulas_and_parameters():
    text = (
        "parameter float gap = 5  " + CARS + "require R1: forall v in cars: v.x > gap\nrequire R2: ego > gap"
    )
    monitor = rtamt.parse(text).monitor(watch=["R1", "R2"])
    assert monitor.update(0, ego=6.0, **{"car_1.x": 8.0}) == 1
    assert (monitor["R1"], monitor["R2"]) == (3, 1)
    monitor.reset(gap=1)
    assert monitor.update(0, ego=6.0, **{"car_1.x": 8.0}) == 5


def test_watched_formulas_after_chunks_and_at_the_end_are_signals():
    text = (
        CARS + "require R1: forall v in cars: eventually[0:1](v.x > 0)\nrequire R2: eventually[0:2](ego > 0)"
    )
    parsed = rtamt.parse(text)
    data = {"ego": [1.0, 2.0, 3.0, 2.0], "car_1.x": [None, 5.0, 4.0, None]}
    monitor = parsed.monitor(watch=["R1", "R2"])
    monitor.update_many(data)
    known = {name: monitor[name].points() for name in ("R1", "R2")}
    monitor.finish()
    for name, points in known.items():
        whole = parsed.requirements[name].evaluate(data).signal.points()
        assert [*points, *monitor[name].points()] == whole


def test_semantics_and_roles_hold_for_members():
    text = "input float ego input " + CARS + "forall v in cars: once(v.x >= 3) -> ego >= 2"
    data = {"car_1.x": [5, None, 1], "ego": [1, 1, 1]}
    for semantics in ("standard", "boolean", "output_robustness", "input_vacuity", "input_robustness"):
        parsed = rtamt.parse(text)
        expected = parsed.evaluate(data, semantics=semantics).signal.values.tolist()
        assert parsed.monitor(semantics=semantics).update_many(data).values.tolist() == expected


@pytest.mark.parametrize(
    "body", ["y >= 0", "ahead[0](y) >= 0", "sum[0,0](y) >= 0", "held(y, true) >= 0", "delay[1](y, -2) >= 0"]
)
@pytest.mark.parametrize("role", ["input", "output"])
def test_the_presence_of_members_is_no_variable_of_a_predicate(body, role):
    group = f'{role} group cars = "car_*" {{ float x }}'
    text = f"input float u output float y {group} exists v in cars: {body}"
    whole, gone = ({"u": [1, 1], "y": [-2, -2], "car_1.x": x} for x in ([1, 1], [1, None]))
    for semantics, value in (
        ("output_robustness", -2), ("output_vacuity", -2), ("input_robustness", -inf), ("input_vacuity", 0),
    ):  # fmt: skip
        parsed = rtamt.parse(text, semantics=semantics)
        assert parsed.evaluate(whole).signal.values.tolist() == [value, value]
        assert parsed.evaluate(gone).signal.values.tolist() == [value, -inf]
        assert parsed.monitor().update_many(whole).values.tolist() == [value, value]
        assert parsed.monitor().update_many(gone).values.tolist() == [value, -inf]


def test_conditions_read_whether_a_quantifier_holds_and_not_its_robustness():
    text = "forall v in cars: (if (exists w in cars: forall u in cars: u.x >= 3) then 2 else 1) > v.x - 3"
    parsed = spec(text + " and (count t in cars: (forall s in cars: s.x >= 3)) >= 2")
    data = {"car_1.x": [3, 4, 2], "car_2.x": [5, 3, None]}
    assert parsed.monitor().update_many(data).values.tolist() == parsed.evaluate(data).signal.values.tolist()


def test_a_variable_that_the_pattern_matches_is_a_member_in_updates_and_chunks_alike():
    parsed = rtamt.parse("input float car_0.x " + CARS + "forall v in cars: v.x - car_0.x > 1")
    sample = {"car_0.x": 0.0, "car_1.x": 5.0}
    assert parsed.monitor().update(0.0, **sample) == -1.0
    assert parsed.monitor().update_many(
        {name: [value] for name, value in sample.items()}
    ).values.tolist() == [-1.0]


WRONG = [
    ({"ego": 1.0, "cra_1.x": 1.0}, "the formula has no variable 'cra_1.x'; variables: ego, car_*"),
    ({"car_1.x": 1.0, "car_1.v": 1.0}, "the data has no 'ego'; signals: car_1.x, car_1.v"),
    (
        {"ego": 1.0, "car_1.x": 1.0},
        "'car_1' has no 'v' at sample 0; give 'car_1.v', or leave out all fields of a member that is absent",
    ),
    ({"ego": 1.0, "car_1.x": "3", "car_1.v": 1.0}, "'car_1.x' is '3' at sample 0, expected a number"),
]


@pytest.mark.parametrize(("values", "message"), WRONG)
def test_what_is_wrong_with_an_update_is_one_sentence(values, message):
    monitor = spec("forall v in cars: v.x > v.v + ego").monitor()
    with pytest.raises(TraceError) as error:
        monitor.update(0, **values)
    assert str(error.value) == message
    assert monitor.samples == 0


def test_what_a_monitor_of_quantifiers_cannot_do_is_one_sentence():
    quantified = spec("forall v in cars: v.x > 0")
    with pytest.raises(UsageError) as error:
        quantified.monitor(verdict="eager")
    assert str(error.value) == (
        "a monitor of quantifiers has no verdict='eager' in discrete time; name the members, which must be present "
        "throughout: spec.over({'cars': [...]}).monitor(...)"
    )
    for settings in ({"time": "dense"}, {"lateness": 1}, {"ranges": {"car_1.x": (0, 1)}}):
        with pytest.raises(UsageError, match="a monitor of quantifiers has no"):
            quantified.monitor(verdict="interval", **settings)
    with pytest.raises(SpecificationError, match="without an upper bound"):
        spec("forall v in cars: eventually(v.x > 0)").monitor()
    eager = quantified.over({"cars": ["car_1"]}).monitor(verdict="eager")
    assert eager.input_names == ("car_1.x",)


def test_twenty_members_cost_at_most_twenty_times_one_member():
    text = "always[0:10] forall v in cars: eventually[0:5](v.x - ego > 5) or once[0:20](v.x > 3)"
    parsed = spec(text)

    def data(members: int) -> dict[str, np.ndarray]:
        return {"ego": np.zeros(1000), **{f"car_{k}.x": np.full(1000, float(k)) for k in range(members)}}

    def seconds(run, trace) -> float:
        begin = time.perf_counter()
        run(trace)
        return time.perf_counter() - begin

    for run in (parsed.evaluate, lambda trace: parsed.monitor().update_many(trace)):
        one, twenty = data(1), data(20)
        times = [(seconds(run, one), seconds(run, twenty)) for _ in range(5)]
        assert min(b for _, b in times) <= 20 * min(a for a, _ in times)


@pytest.mark.parametrize("members", [["car_1"], {"cars": "car_1"}, None])
def test_over_takes_a_list_for_each_group(members):
    with pytest.raises(UsageError, match="takes a list of members for each group, such as"):
        spec("forall v in cars: v.x > 3").over(members)


def test_a_count_of_two_members_under_boolean_semantics_is_no_nan():
    data = {"car_1.x": [1.0, None], "car_2.x": [0.0, 2.0]}
    parsed = spec("(count v in cars: v.x > 0) >= 1", semantics="boolean")
    assert parsed.monitor().update_many(data).values.tolist() == parsed.evaluate(data).signal.values.tolist()
