"""Rewards and termination of one Gymnasium environment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.extras import library
from rtamt.learning.episode import ROBUSTNESS, Episode, settings_of
from rtamt.learning.signals import SignalReader

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.learning.signals import Source
    from rtamt.specification import Specification

_gymnasium = library("gymnasium", "RobustnessReward", "learning")


class RobustnessReward(_gymnasium.Wrapper, _gymnasium.utils.RecordConstructorArgs):  # type: ignore[misc, name-defined] # imported at run time
    """Rewards each step of a Gymnasium environment by a requirement.

    ``signals``: for each variable a path, such as ``("observation", 0)``, ``("info", "speed")`` or ``("action",)``, or
    a function of observation, action and info that returns a mapping from variable to value. The first sample is that
    of the reset, unless a path starts at the action or the function, whose action is then None, returns None. Samples
    are one sampling period of the specification apart.

    ``reward``: ``"robustness"``, the robustness that a step makes final, 0 while there is none, as
    ``spec.monitor()`` reports it; of ``always(f)``, the robustness of ``f`` at each step. ``"interval"``: by how much
    the middle of the bounds of the robustness of the episode changes; the rewards of an episode that terminates
    add up to its robustness, less the middle after the reset. It needs ``ranges``, as ``Specification.monitor``, or
    declared ranges. ``"shaping"``: the reward of the environment plus ``gamma`` times the new potential minus the
    old one. The potential is the last known robustness, 0 before there is one and when the episode terminates.

    ``terminate``: whether the episode terminates as soon as no later sample can change the verdict of the requirement
    at the first sample. ``info`` has ``"robustness"`` or ``"interval"``, and ``"satisfied"`` once the verdict is known.

    >>> import gymnasium, rtamt
    >>> from rtamt.learning import RobustnessReward
    >>> spec = rtamt.parse("always(abs(position) <= 2 and abs(angle) <= 0.1)")
    >>> signals = {"position": ("observation", 0), "angle": ("observation", 2)}
    >>> env = RobustnessReward(gymnasium.make("CartPole-v1"), spec, signals)
    >>> _ = env.reset(seed=1)
    >>> _, reward, terminated, truncated, info = env.step(0)
    >>> round(reward, 3), terminated, info["robustness"] == reward
    (0.065, False, True)
    """

    def __init__(
        self,
        env: Any,
        spec: Specification,
        signals: Source,
        *,
        reward: str = ROBUSTNESS,
        gamma: float | None = None,
        terminate: bool = True,
        ranges: Mapping[str, Any] | None = None,
    ) -> None:
        settings = settings_of(spec, reward, gamma, ranges, terminate=terminate)
        _gymnasium.utils.RecordConstructorArgs.__init__(
            self,
            spec=spec,
            signals=signals,
            reward=reward,
            gamma=gamma,
            terminate=terminate,
            ranges=ranges,
            _disable_deepcopy=True,
        )
        _gymnasium.Wrapper.__init__(self, env)
        self._episode = Episode(settings)
        self._read = SignalReader(signals, spec.input_names)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, Any]:
        """Reset the environment and start a trace."""
        observation, info = self.env.reset(seed=seed, options=options)
        return observation, {**info, **self._episode.start(self._read(observation, None, info))}

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Step the environment; return the reward of the requirement."""
        if not self._episode.running:
            raise UsageError("there is no episode: call reset() before step()")
        observation, reward, terminated, truncated, info = self.env.step(action)
        sample = self._read(observation, action, info)
        assert sample is not None
        terminated = self._episode.take(sample) is not None or bool(terminated)
        worth, more = self._episode.rate(float(reward), ends=terminated)
        self._episode.running = not (terminated or truncated)
        return observation, worth, terminated, bool(truncated), {**info, **more}
