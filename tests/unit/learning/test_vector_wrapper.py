"""A vector environment has the rewards of its environments one by one, in every autoreset mode."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError, TraceError, UsageError
from rtamt.learning import RobustnessReward, VectorRobustnessReward
from tests.support.strategies import formulas
from tests.unit.learning.environments import SIGNALS, Replay

NUMBERS = st.integers(-8, 8).map(lambda k: k / 2)
EPISODE = st.lists(st.tuples(NUMBERS, NUMBERS), min_size=2, max_size=5)
EPISODES = st.lists(st.lists(EPISODE, min_size=1, max_size=3), min_size=1, max_size=3)
ACTION = {"x": ("observation", 0), "y": ("action",)}


def vector(episodes, mode, *, truncates=False):
    return SyncVectorEnv([lambda e=e: Replay(*e, truncates=truncates) for e in episodes], autoreset_mode=mode)


def one_by_one(episodes, mode, spec, signals, count, *, truncates=False, **more):
    """Return the rewards and ends of each environment, wrapped by itself."""
    columns = []
    for each in episodes:
        env = RobustnessReward(Replay(*each, truncates=truncates), spec, signals, **more)
        env.reset()
        found, ended = [], False
        for step in range(count):
            if ended and mode is AutoresetMode.NEXT_STEP:
                env.reset()
                found.append((0.0, False, False))
                ended = False
                continue
            if ended:
                env.reset()
            _, reward, terminated, truncated, _ = env.step(step % 2)
            found.append((reward, terminated, truncated))
            ended = terminated or truncated
        columns.append(found)
    return columns


@settings(max_examples=50)
@given(
    formulas(max_depth=3),
    EPISODES,
    st.sampled_from(list(AutoresetMode)),
    st.sampled_from([{"reward": "robustness"}, {"reward": "shaping", "gamma": 0.5}]),
    st.sampled_from([SIGNALS, ACTION]),
    st.booleans(),
)
def test_each_environment_has_the_rewards_that_it_has_alone(
    formula, episodes, mode, reward, signals, truncates
):
    spec = rtamt.parse(str(formula), period=1)
    try:
        expected = one_by_one(
            episodes, mode, spec, signals, 9, terminate=False, truncates=truncates, **reward
        )
        envs = VectorRobustnessReward(vector(episodes, mode, truncates=truncates), spec, signals, **reward)
        envs.reset()
        found = []
        for step in range(9):
            _, rewards, terminations, truncations, _ = envs.step(np.full(len(episodes), step % 2))
            found.append(list(zip(rewards, terminations, truncations, strict=True)))
            done = terminations | truncations
            if mode is AutoresetMode.DISABLED and done.any():
                envs.reset(options={"reset_mask": done})
    except EvaluationError:
        assume(False)
    assert [list(row) for row in zip(*found, strict=True)] == expected


@settings(max_examples=40)
@given(formulas(max_depth=3), EPISODES)
def test_without_autoreset_episodes_terminate_with_the_earliest_verdict(formula, episodes):
    spec = rtamt.parse(f"({formula}) or eventually[0:2](x > 1)", period=1)
    try:
        expected = one_by_one(episodes, AutoresetMode.DISABLED, spec, SIGNALS, 9)
        envs = VectorRobustnessReward(vector(episodes, AutoresetMode.DISABLED), spec, SIGNALS, terminate=True)
        envs.reset()
        found = []
        for _ in range(9):
            _, rewards, terminations, truncations, infos = envs.step(np.zeros(len(episodes), int))
            found.append(list(zip(rewards, terminations, truncations, strict=True)))
            assert (infos["_satisfied"] <= terminations).all()
            done = terminations | truncations
            if done.any():
                envs.reset(options={"reset_mask": done})
    except EvaluationError:
        assume(False)
    assert [list(row) for row in zip(*found, strict=True)] == expected


class Nested(gymnasium.Wrapper):
    """Observes a dict, whose entries are arrays and a tuple; the info is nested as well."""

    def __init__(self, env):
        super().__init__(env)
        box = gymnasium.spaces.Box(-1e9, 1e9, (1,), np.float64)
        self.observation_space = gymnasium.spaces.Dict({"a": box, "b": gymnasium.spaces.Tuple([box, box])})

    def _of(self, observation, info):
        x = observation[:1]
        return {"a": -x, "b": (x + 1, x)}, {"deep": {"y": info["y"]}}

    def reset(self, **settings):
        return self._of(*self.env.reset(**settings))

    def step(self, action):
        observation, reward, terminated, truncated, info = self.env.step(action)
        observation, info = self._of(observation, info)
        return observation, reward, terminated, truncated, info


@pytest.mark.parametrize("mode", [AutoresetMode.NEXT_STEP, AutoresetMode.SAME_STEP])
def test_observations_and_infos_may_be_nested(mode):
    spec = rtamt.parse("historically(x >= 3 and y <= 8)")
    episodes = [[[(5, 0), (4, 9), (2, 0)], [(7, 1), (8, 1)]], [[(6, 0), (9, 0)]]]
    plain = VectorRobustnessReward(vector(episodes, mode), spec, SIGNALS)
    nested = VectorRobustnessReward(
        SyncVectorEnv([lambda e=e: Nested(Replay(*e)) for e in episodes], autoreset_mode=mode),
        spec,
        {"x": ("observation", "b", 1, 0), "y": ("info", "deep", "y")},
    )
    plain.reset()
    nested.reset()
    for _ in range(7):
        assert plain.step([0, 0])[1].tolist() == nested.step([0, 0])[1].tolist()


def test_a_function_is_asked_for_the_samples_of_resets_without_an_action():
    spec, asked = rtamt.parse("historically(x >= 3)"), []

    def read(observations, actions, _):
        asked.append(actions is None)
        return {"x": observations[:, 0]}

    envs = VectorRobustnessReward(vector([[[(5, 0), (4, 0)]]], AutoresetMode.NEXT_STEP), spec, read)
    envs.reset()
    assert [envs.step([1])[1].tolist() for _ in range(3)] == [[1.0], [0.0], [1.0]]
    assert asked == [True, False, True, False]


def test_errors():
    episodes, spec = [[[(5, 0), (4, 0), (4, 0)]], [[(5, 0), (4, 0), (4, 0)]]], rtamt.parse("always(x >= 3)")
    envs = vector(episodes, AutoresetMode.NEXT_STEP)

    def message(call, *args, **more):
        with pytest.raises((EvaluationError, TraceError, UsageError)) as caught:
            call(*args, **more)
        return str(caught.value)

    assert message(VectorRobustnessReward, envs, spec, SIGNALS, reward="interval") == (
        "a fleet has no bounds of the robustness: for reward='interval', wrap each environment by RobustnessReward, "
        "such as gymnasium.make_vec(..., vectorization_mode='sync', wrappers=[...])"
    )
    assert message(VectorRobustnessReward, envs, spec, SIGNALS, terminate=True) == (
        "with autoreset mode NextStep a wrapper cannot end the episodes of the environments inside: wrap each by "
        "RobustnessReward, or make the vector environment with AutoresetMode.DISABLED"
    )
    wrapped = VectorRobustnessReward(envs, spec, SIGNALS)
    assert message(wrapped.step, [0, 0]) == "there is no episode: call reset() before step()"

    def stepped(signals, spec=spec):
        wrapped = VectorRobustnessReward(envs, spec, signals)
        wrapped.reset()
        wrapped.step([0, 0])

    assert message(stepped, lambda *_: {"x": [1.0]}) == (
        "the variable 'x' has values of shape (1,), expected one for each of the 2 environments"
    )
    assert message(stepped, lambda *_: {}) == (
        "signals returned no value for the variable 'x' of the requirement"
    )
    assert message(stepped, lambda o, a, _: {"x": o[:, 0] * (np.inf if a is not None else 1)}) == (
        "the robustness is inf at 1 s, and a reward must be finite: compare numbers instead of Booleans"
    )
    disabled = VectorRobustnessReward(vector(episodes, AutoresetMode.DISABLED), spec, SIGNALS)
    mask = np.array([True, False])
    assert message(disabled.reset, options={"reset_mask": mask}) == (
        "the first reset() resets all environments: leave out 'reset_mask'"
    )
    disabled.reset()
    disabled.step([0, 0])
    disabled.step([0, 0])
    disabled.reset(options={"reset_mask": mask})
    assert message(disabled.step, [0, 0]) == (
        "the episode of environment 1 has ended: reset it by options={'reset_mask': ...}"
    )
    stateless = vector(episodes, AutoresetMode.NEXT_STEP)
    stateless.metadata = {}
    assert message(VectorRobustnessReward, stateless, spec, SIGNALS) == (
        "the vector environment does not state its autoreset mode: set metadata['autoreset_mode'] to a member of "
        "gymnasium.vector.AutoresetMode"
    )


class SometimesSilent(Replay):
    """Leaves y out of the info from the second sample on."""

    def _now(self):
        observation, info = super()._now()
        return observation, {} if self.at and self.rows[0][0] == 1 else info


def test_an_info_that_an_environment_lacks_is_no_zero():
    envs = SyncVectorEnv([lambda x=x: SometimesSilent([(x, 5), (2, 6), (3, 7)]) for x in (0, 1)])
    wrapped = VectorRobustnessReward(envs, rtamt.parse("always(y >= 3)"), SIGNALS)
    wrapped.reset()
    with pytest.raises(TraceError) as caught:
        wrapped.step([0, 0])
    assert str(caught.value) == "the variable 'y' is missing: the info of environment 1 has no 'y'"
