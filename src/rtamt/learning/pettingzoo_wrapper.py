"""Rewards and termination of the agents of a PettingZoo environment."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.extras import library
from rtamt.learning.episode import ROBUSTNESS, Episode, settings_of
from rtamt.learning.signals import SignalReader

if TYPE_CHECKING:
    from rtamt.learning.signals import Source
    from rtamt.specification import Specification

_wrappers = library("pettingzoo.utils.wrappers", "ParallelRobustnessReward", "learning")


class ParallelRobustnessReward(_wrappers.BaseParallelWrapper):  # type: ignore[misc, name-defined] # imported at run time
    """Rewards the agents of a parallel PettingZoo environment by one requirement of all, or by one of each.

    ``spec``: a specification that all agents share, whose rewards each of them receives; or a mapping from agent to its
    own specification, where agents without one keep the rewards of the environment. ``signals`` of a shared
    specification read the mappings from agent to observation, action and info: ``("observation", "agent_0", 2)``.
    Those of one for each agent read its own: ``("observation", 2)``.

    ``reward``, ``gamma``, ``terminate`` and ``ranges``: as for ``RobustnessReward``. A verdict ends the episode of all
    agents, since the environment cannot continue without one. A shared requirement terminates it for every agent.
    Of requirements of agents, the first that is violated ends it, or the last of which the verdict becomes known;
    agents whose own verdict is open are truncated, not terminated.
    """

    def __init__(
        self,
        env: Any,
        spec: Specification | Mapping[str, Specification],
        signals: Source,
        *,
        reward: str = ROBUSTNESS,
        gamma: float | None = None,
        terminate: bool = True,
        ranges: Mapping[str, Any] | None = None,
    ) -> None:
        super().__init__(env)
        own = isinstance(spec, Mapping)
        #: By agent, or by None for all.
        self._episodes: dict[Any, Episode] = {}
        self._readers: dict[Any, SignalReader] = {}
        if own and not spec:
            raise UsageError("there is no specification: give one, or a mapping from agent to specification")
        for agent, each in spec.items() if isinstance(spec, Mapping) else [(None, spec)]:
            if own and agent not in env.possible_agents:
                raise UsageError(f"the environment has no agent {shown(agent)}")
            self._episodes[agent] = Episode(settings_of(each, reward, gamma, ranges, terminate=terminate))
            self._readers[agent] = SignalReader(signals, each.input_names)
        self._verdicts: dict[Any, bool] = {}
        self._running = False

    @property
    def agents(self) -> list[Any]:
        """The agents whose episode has not ended."""
        return list(self.env.agents) if self._running else []

    def reset(self, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, Any]:
        """Reset the environment and start a trace for each requirement."""
        observations, infos = self.env.reset(seed=seed, options=options)
        infos = {agent: dict(infos.get(agent, {})) for agent in self.env.agents}
        self._running, self._verdicts = True, {}
        for agent, episode in self._episodes.items():
            episode.running = agent is None or agent in infos
            if not episode.running:
                continue
            read = self._readers[agent]
            if agent is None:
                more = episode.start(read(observations, None, infos))
            else:
                more = episode.start(read(observations[agent], None, infos[agent]))
            for each in infos if agent is None else [agent]:
                infos[each].update(more)
        return observations, infos

    def step(self, actions: dict[Any, Any]) -> tuple[Any, Any, Any, Any, Any]:
        """Step the environment; return the rewards of the requirements."""
        if not self._running:
            raise UsageError("there is no episode: call reset() before step()")
        observations, rewards, terminations, truncations, infos = self.env.step(actions)
        rewards, terminations, truncations = dict(rewards), dict(terminations), dict(truncations)
        infos = {agent: dict(infos.get(agent, {})) for agent in rewards}
        if None in self._episodes:
            self._step_all(observations, actions, rewards, terminations, infos)
        else:
            self._step_each(observations, actions, rewards, terminations, truncations, infos)
        self._running = bool(self.env.agents) and not (
            rewards and all(terminations[agent] or truncations[agent] for agent in rewards)
        )
        return observations, rewards, terminations, truncations, infos

    def _step_all(self, observations: Any, actions: Any, rewards: Any, terminations: Any, infos: Any) -> None:
        """Give every agent the reward of the shared requirement."""
        sample = self._readers[None](observations, actions, infos)
        assert sample is not None
        episode = self._episodes[None]
        known = episode.take(sample) is not None
        if known:
            terminations.update(dict.fromkeys(terminations, True))
        # The rewards of the environment differ from agent to agent; what is added to them does not.
        worth, info = episode.rate(0.0, ends=all(terminations.values()))
        for agent, own in rewards.items():
            rewards[agent] = worth + (float(own) if episode.adds else 0.0)
            infos[agent].update(info)

    def _step_each(
        self,
        observations: Any,
        actions: Any,
        rewards: Any,
        terminations: Any,
        truncations: Any,
        infos: Any,
    ) -> None:
        """Give each agent the reward of its own requirement."""
        rated = [agent for agent, each in self._episodes.items() if each.running and agent in rewards]
        for agent in rated:
            sample = self._readers[agent](observations[agent], actions[agent], infos[agent])
            assert sample is not None
            satisfied = self._episodes[agent].take(sample)
            if satisfied is not None:
                self._verdicts[agent] = satisfied
        over = {agent for agent in rewards if terminations[agent] or truncations[agent]}
        open_ = [agent for agent in rated if agent not in self._verdicts and agent not in over]
        if self._verdicts and (not all(self._verdicts.values()) or not open_):
            for agent in rewards:
                if agent in self._verdicts:
                    terminations[agent] = True
                elif not terminations[agent]:
                    truncations[agent] = True
        for agent in rated:
            episode = self._episodes[agent]
            rewards[agent], info = episode.rate(float(rewards[agent]), ends=bool(terminations[agent]))
            infos[agent].update(info)
            episode.running = not (terminations[agent] or truncations[agent])
