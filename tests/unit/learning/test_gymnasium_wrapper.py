"""Rewards of one environment: those of a plain monitor, potentials that cancel, the earliest verdict."""

from __future__ import annotations

import sys
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError, TraceError, UsageError
from rtamt.learning import RobustnessReward
from tests.support.strategies import formulas
from tests.unit.learning.environments import SIGNALS, Replay

NUMBERS = st.integers(-8, 8).map(lambda k: k / 2)
ROWS = st.lists(st.tuples(NUMBERS, NUMBERS), min_size=2, max_size=12)
RANGES = {"x": (-5, 5), "y": (-5, 5)}


def play(env, seed=None):
    """Return what the steps of an episode returned."""
    env.reset(seed=seed)
    found = []
    while not found or not (found[-1][2] or found[-1][3]):
        found.append(env.step(0))
    return found


def rewards(env):
    return [step[1] for step in play(env)]


def feed(monitor, rows):
    names = monitor.input_names
    return [
        monitor.update(float(t), **{n: v for n, v in zip("xy", row, strict=True) if n in names})
        for t, row in enumerate(rows)
    ]


def finite(spec, rows):
    """Return the values of a plain monitor, of traces on which they are finite."""
    try:
        values = feed(spec.monitor(), rows)
    except EvaluationError:
        assume(False)
    assume(all(value is None or np.isfinite(value) for value in values))
    return values


@settings(max_examples=40)
@given(formulas(max_depth=3), ROWS)
def test_rewards_are_those_of_a_plain_monitor(formula, rows):
    spec = rtamt.parse(str(formula), period=1)
    expected = [0.0 if value is None else value for value in finite(spec, rows)]
    env = RobustnessReward(Replay(rows), spec, SIGNALS, terminate=False)
    for _ in range(2):  # a second episode starts anew
        assert rewards(env) == expected[1:]


@settings(max_examples=40)
@given(formulas(max_depth=3), ROWS, st.booleans(), st.sampled_from([0.0, 0.5, 0.99, 1.0]))
def test_shaping_changes_the_return_by_a_number_that_no_policy_changes(formula, rows, truncates, gamma):
    spec = rtamt.parse(str(formula), period=1)
    values = finite(spec, rows)
    env = RobustnessReward(
        Replay(rows, truncates=truncates), spec, SIGNALS, reward="shaping", gamma=gamma, terminate=False
    )
    own = sum(gamma**k * (k + 1) for k in range(len(rows) - 1))
    found = sum(gamma**k * reward for k, reward in enumerate(rewards(env)))
    known = [value for value in values if value is not None]
    last = known[-1] if truncates and known else 0.0  # the value of the last state is the learner's to add
    first = values[0] or 0.0
    assert found == pytest.approx(own + gamma ** (len(rows) - 1) * last - first)


@settings(max_examples=40)
@given(formulas(max_depth=3, unbounded_future=True), ROWS)
def test_interval_rewards_of_a_terminated_episode_add_up_to_its_robustness(formula, rows):
    spec = rtamt.parse(str(formula), period=1)
    monitor = spec.monitor(verdict="interval", at="start", ranges={n: RANGES[n] for n in spec.input_names})
    try:
        feed(monitor, rows[:1])
    except EvaluationError:
        assume(False)
    first = monitor.interval()
    data = {"time": range(len(rows)), "x": [x for x, _ in rows], "y": [y for _, y in rows]}
    try:
        expected = spec.evaluate(data).robustness
    except EvaluationError:
        assume(False)
    ranges = {n: RANGES[n] for n in spec.input_names}
    env = RobustnessReward(Replay(rows), spec, SIGNALS, reward="interval", ranges=ranges, terminate=False)
    try:
        found = rewards(env)
    except EvaluationError:  # an operation has no value, or the bounds are infinite before the end
        assume(False)
    assert sum(found) == pytest.approx(expected - (first.lower + first.upper) / 2)


@settings(max_examples=40)
@given(
    formulas(max_depth=2, unbounded_future=True),
    st.sampled_from(["always({})", "eventually[0:2]({})", "(x <= 3) until[0:4] {}"]),
    ROWS,
)
def test_an_episode_terminates_with_the_earliest_verdict(formula, around, rows):
    # Bounded from both sides, the robustness is finite.
    text = around.format(f"((({formula}) and abs(x) <= 9) or abs(y) >= 9)")
    spec = rtamt.parse(text, period=1)
    monitor = spec.monitor(verdict="eager")
    try:
        settled = feed(monitor, rows)
        verdicts = {v.time: v for news in settled for v in news}
        ranges = {n: RANGES[n] for n in spec.input_names}
        env = RobustnessReward(Replay(rows, truncates=True), spec, SIGNALS, reward="interval", ranges=ranges)
        steps = play(env)
    except EvaluationError:
        assume(False)
    verdict = verdicts.get(0.0)
    if verdict is None:
        assert len(steps) == len(rows) - 1
        assert steps[-1][2:4] == (False, True)
        assert "satisfied" not in steps[-1][4]
    else:
        assert len(steps) == max(1, verdict.decided_at)  # a reset cannot terminate
        assert steps[-1][2]
        assert steps[-1][4]["satisfied"] == verdict.satisfied


def test_a_sample_outside_a_declared_range_that_ranges_replaces_was_an_error():
    spec = rtamt.parse("input float x in [0, 6]  always(x >= 3)")
    env = RobustnessReward(
        Replay([(5, 0), (9, 0), (2, 0), (4, 0)]), spec, SIGNALS, reward="interval", ranges={"x": (0, 10)}
    )
    steps = play(env)
    assert len(steps) == 2
    assert steps[-1][2]
    assert steps[-1][4]["satisfied"] is False


def test_of_always_each_step_is_rated_and_a_violation_terminates():
    env = RobustnessReward(
        Replay([(5, 0), (4, 0), (2, 0), (9, 0)]), rtamt.parse("always(x >= 3) and always(y <= 8)"), SIGNALS
    )
    steps = play(env)
    assert [(step[1], step[2], step[3]) for step in steps] == [(1, False, False), (-1, True, False)]
    assert steps[-1][4] == {"y": 0.0, "robustness": -1.0, "satisfied": False}


def test_truncation_stays_truncation():
    spec = rtamt.parse("always(x >= 3)")
    assert play(RobustnessReward(Replay([(5, 0), (4, 0)], truncates=True), spec, SIGNALS))[-1][2:4] == (
        False,
        True,
    )
    both = RobustnessReward(Replay([(5, 0), (2, 0)], truncates=True), spec, SIGNALS)
    assert play(both)[-1][2:4] == (True, True)


def test_a_trace_starts_with_the_first_step_if_a_variable_is_an_action():
    spec = rtamt.parse("x - 10 * u >= 3 and historically(x < 5)")
    env = Replay([(9, 0), (4, 0), (3.5, 0)])
    paths = {"x": ("observation", 0), "u": ("action",)}
    assert rewards(RobustnessReward(env, spec, paths, terminate=False)) == [1.0, 0.5]

    def read(observation, action, _):
        return None if action is None else {"x": observation[0], "u": action}

    assert rewards(RobustnessReward(env, spec, read, terminate=False)) == [1.0, 0.5]


def test_the_period_of_the_specification_is_the_time_between_steps():
    spec = rtamt.parse("always[0:200ms](x >= 3)", period="100ms")
    env = RobustnessReward(Replay([(5, 0), (4, 0), (6, 0), (7, 0)]), spec, SIGNALS, terminate=False)
    assert rewards(env) == [0.0, 1.0, 1.0]


def test_seeds_reach_the_environment():
    env = Replay([(5, 0), (4, 0)])
    play(RobustnessReward(env, rtamt.parse("always(x >= 3)"), SIGNALS), seed=3)
    assert env.seeds == [3]


@pytest.mark.parametrize(
    ("reward", "settings"),
    [("robustness", {}), ("shaping", {"gamma": 0.9}), ("interval", {"ranges": {"a": (-1, 1)}})],
)
def test_gymnasium_accepts_the_wrapped_environment(reward, settings):
    spec = rtamt.parse("always(abs(a) <= 0.2)")
    env = RobustnessReward(
        gymnasium.make("CartPole-v1", disable_env_checker=True).unwrapped, spec, {"a": ("observation", 2)},
        reward=reward, **settings,
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter(
            "ignore", UserWarning
        )  # on CartPole's unbounded observations, and on any wrapper
        check_env(env, skip_render_check=True)


def test_errors():
    env, always = Replay([(5, 0), (4, 0)]), rtamt.parse("always(x >= 3)")

    def message(kind, call, *args, **more):
        with pytest.raises(kind) as caught:
            call(*args, **more)
        return str(caught.value)

    def made(*args, **more):
        return message(UsageError, RobustnessReward, env, *args, **more)

    assert made("x >= 3", SIGNALS) == (
        "expected a specification, got 'x >= 3'; write rtamt.parse(...) or rtamt.load(...)"
    )
    assert made(always, SIGNALS, reward="robust") == (
        "reward is 'robust'; did you mean 'robustness'? (rewards: robustness, interval, shaping)"
    )
    assert made(always, SIGNALS, reward="shaping") == (
        "gamma is None; reward='shaping' needs the discount factor of the learner, from 0 to 1"
    )
    assert made(always, SIGNALS, gamma=0.9) == "gamma= is a setting of reward='shaping'"
    assert made(always, SIGNALS, ranges={}) == "ranges= is a setting of reward='interval'"
    assert made(rtamt.parse("x >= 3"), SIGNALS) == (
        "the verdict of 'x >= 3' is known with the first sample, so that every episode would end there: "
        "write always(x >= 3), or set terminate=False"
    )
    assert made(always, {"z": ("observation", 0)}) == (
        "signals has no entry for the variable 'x' of the requirement"
    )
    assert made(always, {"x": ("obs", 0)}) == (
        "the signal of 'x' is ('obs', 0), expected a path such as (\"observation\", 0)"
        "; first parts: observation, action, info"
    )
    assert made(always, 3) == (
        'signals is 3, expected a function of observation, action and info, or a path such as ("observation", 0) '
        "for each variable"
    )

    def run(spec, signals, **more):
        return message(
            (EvaluationError, TraceError, UsageError), play, RobustnessReward(env, spec, signals, **more)
        )

    assert run(always, {"x": ("info", "x")}) == "the variable 'x' is not at ('info', 'x'): there is no 'x'"
    assert run(always, lambda *_: None) == (
        "signals returned None for a step; only the sample of a reset may be left out"
    )
    assert run(always, lambda *_: 3) == "signals returned 3, expected a mapping from variable to value"
    assert run(always, lambda *_: {}) == "signals returned no value for the variable 'x' of the requirement"
    assert run(rtamt.parse("always(true or x > 3)"), SIGNALS) == (
        "the robustness is inf at 0 s, and a reward must be finite: compare numbers instead of Booleans"
    )
    assert run(always, SIGNALS, reward="interval") == (
        "the robustness is between -inf and 2.0, and a reward must be finite: give the range of each variable, such as "
        "ranges={'x': (0, 10)}"
    )
    late = rtamt.parse("eventually[2:3](x >= 3)")
    assert run(late, SIGNALS, reward="interval", ranges={"x": (0, 10)}) == (
        "the robustness of the episode is -inf, and a reward must be finite: compare numbers instead of Booleans, and "
        "let no window start after the end of an episode"
    )
    fresh = RobustnessReward(env, always, SIGNALS)
    assert message(UsageError, fresh.step, 0) == "there is no episode: call reset() before step()"
    play(fresh)
    assert message(UsageError, fresh.step, 0) == "there is no episode: call reset() before step()"


def test_without_gymnasium_the_extra_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "rtamt.learning.gymnasium_wrapper")
    monkeypatch.delitem(vars(rtamt.learning), "RobustnessReward", raising=False)
    with pytest.raises(UsageError) as caught:
        _ = rtamt.learning.RobustnessReward
    assert str(caught.value) == (
        "RobustnessReward needs the package 'gymnasium', which is not installed: pip install 'rtamt[learning]'"
    )
