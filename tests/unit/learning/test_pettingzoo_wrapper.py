"""Agents with one requirement of all, or one of each."""

from __future__ import annotations

import warnings

import pytest
from pettingzoo.test import parallel_api_test

import rtamt
from rtamt.errors import UsageError
from rtamt.learning import ParallelRobustnessReward
from tests.unit.learning.environments import Pair

OWN = {"x": ("observation", 0)}
SHARED = {"x": ("observation", "ann", 0), "y": ("observation", "bo", 0)}


def play(env):
    env.reset(seed=1)
    found = []
    while env.agents:
        found.append(env.step(dict.fromkeys(env.agents, 0))[1:])
    return found


def test_all_agents_receive_the_rewards_of_a_shared_requirement_and_end_with_its_verdict():
    env = ParallelRobustnessReward(
        Pair(ann=[5, 6, 7, 8], bo=[1, 2, 9, 3]), rtamt.parse("always(x - y >= 0)"), SHARED
    )
    first, second = play(env)
    assert first[0] == {"ann": 4.0, "bo": 4.0}
    assert first[1] == first[2] == {"ann": False, "bo": False}
    assert second[0] == {"ann": -2.0, "bo": -2.0}
    assert second[1] == {"ann": True, "bo": True}
    assert second[3]["bo"] == {"robustness": -2.0, "satisfied": False}
    with pytest.raises(UsageError, match=r"^there is no episode: call reset\(\) before step\(\)$"):
        env.step({})


def test_a_violation_terminates_the_agent_and_truncates_the_others():
    specs = {"ann": rtamt.parse("always(x >= 3)"), "bo": rtamt.parse("always(x <= 4)")}
    first, second = play(ParallelRobustnessReward(Pair(ann=[5, 6, 7, 8], bo=[1, 2, 9, 3]), specs, OWN))
    assert first[0] == {"ann": 3.0, "bo": 2.0}
    assert second[0] == {"ann": 4.0, "bo": -5.0}
    assert second[1] == {"ann": False, "bo": True}
    assert second[2] == {"ann": True, "bo": False}


def test_an_episode_goes_on_until_all_requirements_are_satisfied():
    specs = {
        name: rtamt.parse(f"eventually[0:9](x >= {level})") for name, level in {"ann": 6, "bo": 9}.items()
    }
    ranges = {"x": (0, 10)}
    pair = Pair(ann=[5, 6, 7, 8], bo=[1, 2, 9, 3])
    steps = play(ParallelRobustnessReward(pair, specs, OWN, reward="interval", ranges=ranges))
    assert [step[1] for step in steps] == [{"ann": False, "bo": False}, {"ann": True, "bo": True}]
    sums = {name: sum(step[0][name] for step in steps) for name in specs}
    # The robustness of ann's trace is that of x = 7, from the middle of [-1, 4]; bo's is 0, from that of [-8, 1].
    assert sums == {"ann": 1 - 1.5, "bo": 0 + 3.5}


def test_an_agent_without_a_requirement_keeps_its_rewards():
    steps = play(
        ParallelRobustnessReward(Pair(ann=[5, 6], bo=[1, 2]), {"ann": rtamt.parse("always(x >= 3)")}, OWN)
    )
    assert steps[0][0] == {"ann": 3.0, "bo": 2.0}
    assert steps[0][2] == {"ann": True, "bo": True}


def test_shaping_adds_to_the_rewards_of_each_agent():
    spec = rtamt.parse("x + y >= 0")
    env = ParallelRobustnessReward(
        Pair(ann=[5, 6, 7], bo=[1, 2, 9]), spec, SHARED, reward="shaping", gamma=0.5, terminate=False
    )
    assert [step[0] for step in play(env)] == [
        {"ann": 3 + 4 - 6, "bo": 2 + 4 - 6},
        {"ann": 3 + 8 - 8, "bo": 2},
    ]


@pytest.mark.parametrize("spec", [{"ann": rtamt.parse("always(x <= 8)")}, rtamt.parse("always(x + y <= 9)")])
def test_pettingzoo_accepts_the_wrapped_environment(spec):
    env = ParallelRobustnessReward(
        Pair(ann=[5, 6, 7, 8], bo=[1, 2, 9, 3]), spec, OWN if isinstance(spec, dict) else SHARED
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)
        parallel_api_test(env, num_cycles=20)


def test_errors():
    pair, spec = Pair(ann=[1], bo=[1]), rtamt.parse("always(x >= 3)")
    with pytest.raises(UsageError) as caught:
        ParallelRobustnessReward(pair, {"cy": spec}, OWN)
    assert str(caught.value) == "the environment has no agent 'cy'"
    with pytest.raises(UsageError) as caught:
        ParallelRobustnessReward(pair, {}, OWN)
    assert (
        str(caught.value) == "there is no specification: give one, or a mapping from agent to specification"
    )
