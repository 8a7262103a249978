"""Rewards and termination of a vector environment: its environments are the keys of a fleet."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, shown
from rtamt.extras import library
from rtamt.fleet.fleet import Fleet
from rtamt.lazy.modules import np
from rtamt.learning.episode import INTERVAL, ROBUSTNESS, SHAPING, not_finite, settings_of
from rtamt.learning.signals import SignalReader

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from rtamt.learning.signals import Source
    from rtamt.specification import Specification

_gymnasium = library("gymnasium", "VectorRobustnessReward", "learning")
_vector = library("gymnasium.vector", "VectorRobustnessReward", "learning")

#: In infos, what belongs to the last step of the episodes that ended with it.
_FINAL = ("final_obs", "final_info")


class VectorRobustnessReward(_vector.VectorWrapper):  # type: ignore[misc, name-defined] # imported at run time
    """Rewards each step of a vector environment by a requirement, as ``RobustnessReward`` does for one environment.

    One ``rtamt.Fleet`` monitors all environments, in every autoreset mode of Gymnasium. ``signals``: paths or a
    function, as for one environment, to arrays with a row for each environment. ``reward``: ``"robustness"`` or
    ``"shaping"``. ``terminate``: for vector environments without autoreset (``AutoresetMode.DISABLED``), which the
    caller resets; it monitors verdicts apart for each environment. In other modes a wrapper cannot end an
    episode of the environments inside: wrap each by ``RobustnessReward``.

    >>> import gymnasium, rtamt
    >>> import numpy as np
    >>> from rtamt.learning import VectorRobustnessReward
    >>> spec = rtamt.parse("always(abs(angle) <= 0.1)")
    >>> envs = VectorRobustnessReward(gymnasium.make_vec("CartPole-v1", 3), spec, {"angle": ("observation", 2)})
    >>> _ = envs.reset(seed=1)
    >>> _, rewards, _, _, infos = envs.step(np.array([0, 0, 1]))
    >>> rewards.round(3), bool((rewards == infos["robustness"]).all())
    (array([0.068, 0.091, 0.095]), True)
    """

    def __init__(
        self,
        env: Any,
        spec: Specification,
        signals: Source,
        *,
        reward: str = ROBUSTNESS,
        gamma: float | None = None,
        terminate: bool = False,
    ) -> None:
        if reward == INTERVAL:
            raise UsageError(
                "a fleet has no bounds of the robustness: for reward='interval', wrap each environment by "
                "RobustnessReward, such as gymnasium.make_vec(..., vectorization_mode='sync', wrappers=[...])"
            )
        self._settings = settings_of(spec, reward, gamma, None, terminate=terminate)
        super().__init__(env)
        modes = _vector.AutoresetMode
        mode = env.metadata.get("autoreset_mode")
        if mode is None:
            raise UsageError(
                "the vector environment does not state its autoreset mode: set metadata['autoreset_mode'] to a member "
                "of gymnasium.vector.AutoresetMode"
            )
        mode = modes(mode)
        self._same_step, self._next_step = mode is modes.SAME_STEP, mode is modes.NEXT_STEP
        if terminate and mode is not modes.DISABLED:
            raise UsageError(
                f"with autoreset mode {mode.value} a wrapper cannot end the episodes of the environments inside: "
                "wrap each by RobustnessReward, or make the vector environment with AutoresetMode.DISABLED"
            )
        count = self._count = int(env.num_envs)
        self._every = np.arange(count)
        self._fleet = Fleet(self._settings.rated, count)
        self._judges: list[Any] = [spec.monitor(verdict="eager") for _ in range(count)] if terminate else []
        self._names = spec.input_names
        self._period = self._settings.period
        self._read = SignalReader(signals, self._names, batched=True)
        self._samples = np.zeros(count)
        self._potentials = np.zeros(count)
        #: The verdict of each environment, NaN while it is not known.
        self._satisfied = np.full(count, np.nan)
        self._ended: NDArray[np.bool_] | None = None

    def reset(self, *, seed: Any = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Reset all environments, or those of ``options["reset_mask"]``, and start their traces."""
        mask = None if options is None else options.get("reset_mask")
        rows = self._every if mask is None else np.flatnonzero(mask)
        if self._ended is None and len(rows) < self._count:
            raise UsageError("the first reset() resets all environments: leave out 'reset_mask'")
        observations, infos = self.env.reset(seed=seed, options=options)
        if self._ended is None:
            self._ended = np.zeros(self._count, bool)
        self._ended[rows] = False
        self._start(rows, observations, infos)
        return observations, infos

    def step(self, actions: Any) -> tuple[Any, NDArray[np.float64], Any, Any, dict[str, Any]]:
        """Step all environments; return the rewards of the requirement."""
        if self._ended is None:
            raise UsageError("there is no episode: call reset() before step()")
        before = self._ended
        some_ended = np.count_nonzero(before) > 0
        if some_ended and not self._next_step:
            raise UsageError(
                f"the episode of environment {int(before.argmax())} has ended: reset it by "
                "options={'reset_mask': ...}"
            )
        observations, rewards, terminations, truncations, infos = self.env.step(actions)
        done = np.logical_or(terminations, truncations)
        some_done = np.count_nonzero(done) > 0
        last, details = observations, infos
        if self._same_step and some_done:
            last, details = _before_reset(observations, infos, np.flatnonzero(done))
        rows = np.flatnonzero(~before) if some_ended else self._every
        found, reported = self._found_in(rows, last, actions, details)
        if self._judges:
            known = ~np.isnan(self._satisfied)
            infos = {**infos, "satisfied": self._satisfied > 0, "_satisfied": known}
            terminations = np.logical_or(terminations, known)
            done = np.logical_or(done, known)
            some_done = np.count_nonzero(done) > 0
        worth = self._worth(found, reported, rewards, terminations, before if some_ended else None)
        infos = {**infos, "robustness": found, "_robustness": reported}
        if some_ended:
            self._start(np.flatnonzero(before), observations, infos)
        if self._same_step and some_done:
            self._start(np.flatnonzero(done), observations, infos)
            self._ended = np.zeros(self._count, bool)
        else:
            self._ended = done
        return observations, worth, terminations, truncations, infos

    def _found_in(
        self, rows: NDArray[Any], observations: Any, actions: Any, infos: Any
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Take the samples of a step; return the robustness that became known of each environment, or 0, and where."""
        if len(rows) < self._count:
            found, reported = np.zeros(self._count), np.zeros(self._count, bool)
            if len(rows):
                found[rows], reported[rows] = self._take(
                    rows, self._sample(rows, observations, actions, infos)
                )
            return found, reported
        return self._take(rows, self._sample(rows, observations, actions, infos))

    def _sample(self, rows: NDArray[Any], observations: Any, actions: Any, infos: Any) -> Mapping[str, Any]:
        sample = self._read(observations, actions, infos, rows)
        assert sample is not None
        return sample

    def _worth(
        self,
        found: NDArray[np.float64],
        reported: NDArray[np.bool_],
        rewards: Any,
        terminations: Any,
        restarted: NDArray[np.bool_] | None,
    ) -> NDArray[np.float64]:
        """Return the rewards of a step; ``restarted``: the environments that were reset instead, None without any."""
        after: NDArray[np.float64] = found.copy()
        if self._settings.reward != SHAPING:
            return after
        if np.count_nonzero(reported) < self._count:
            after = np.where(reported, found, self._potentials)
        ahead = np.where(terminations, 0.0, after) if np.count_nonzero(terminations) else after
        shaping = self._settings.gamma * ahead - self._potentials
        self._potentials = after
        if restarted is not None:
            shaping[restarted] = 0.0
        worth: NDArray[np.float64] = np.asarray(rewards, float) + shaping
        return worth

    def _start(self, rows: NDArray[Any], observations: Any, infos: Mapping[str, Any]) -> None:
        """Start the traces of environments with the samples of their resets, if there are any."""
        self._fleet.drop(rows[self._samples[rows] > 0])
        self._samples[rows] = 0
        self._potentials[rows] = 0.0
        if self._judges:
            self._satisfied[rows] = np.nan
            for row in rows:
                self._judges[row].reset()
        sample = self._read(observations, None, infos, rows)
        if sample is not None:
            self._potentials[rows], _ = self._take(rows, sample)

    def _take(
        self, rows: NDArray[Any], sample: Mapping[str, Any]
    ) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
        """Take a sample of each environment; return the robustness that it made final, 0 where none, and where."""
        every = len(rows) == self._count
        times = (self._samples if every else self._samples[rows]) * self._period
        columns = {}
        for name in self._names:
            if name not in sample:
                raise UsageError(
                    f"signals returned no value for the variable {shown(name)} of the requirement"
                )
            column = np.asarray(sample[name])
            if column.shape != (self._count,):
                raise TraceError(
                    f"the variable {shown(name)} has values of shape {column.shape}, expected one for each of the "
                    f"{self._count} environments",
                    variable=name,
                )
            columns[name] = column if every else column[rows]
        update = self._fleet.update_many(rows, times, columns)
        if every:
            self._samples += 1
        else:
            self._samples[rows] += 1
        if self._judges:
            self._judge(rows, times, columns)
        values, known = update.values, update.known
        if np.count_nonzero(known) < len(rows):
            values = np.where(known, values, 0.0)
        finite = np.isfinite(values)
        if np.count_nonzero(finite) < len(rows):
            first = int(finite.argmin())
            raise not_finite(float(values[first]), float(times[first]))
        return values, known

    def _judge(self, rows: NDArray[Any], times: NDArray[np.float64], columns: Mapping[str, Any]) -> None:
        """Take the same samples for the verdicts that are open."""
        for place, row in enumerate(rows):
            if np.isnan(self._satisfied[row]):
                values = {name: column[place].item() for name, column in columns.items()}
                for verdict in self._judges[row].update(float(times[place]), **values):
                    if verdict.time == 0:
                        self._satisfied[row] = verdict.satisfied


def _before_reset(
    observations: Any, infos: Mapping[str, Any], rows: NDArray[Any]
) -> tuple[Any, dict[str, Any]]:
    """Return observations and infos of the last step, where the environment has already been reset after it."""
    final = {int(row): _row(infos["final_obs"], row) for row in rows}
    return _replace_rows(observations, final), _merge_infos(infos, infos.get("final_info", {}), rows)


def _row(batch: Any, row: int) -> Any:
    if isinstance(batch, Mapping):
        return {name: _row(part, row) for name, part in batch.items() if not name.startswith("_")}
    return batch[row]


def _replace_rows(batch: Any, final: Mapping[int, Any]) -> Any:
    """Return a batch of observations with some rows replaced."""
    if isinstance(batch, Mapping):
        return {
            name: _replace_rows(part, {row: one[name] for row, one in final.items()})
            for name, part in batch.items()
        }
    if isinstance(batch, tuple):
        parts = enumerate(batch)
        return tuple(_replace_rows(part, {row: one[at] for row, one in final.items()}) for at, part in parts)
    found = np.array(batch)
    for row, one in final.items():
        found[row] = one
    return found


def _merge_infos(infos: Mapping[str, Any], final: Mapping[str, Any], rows: NDArray[Any]) -> dict[str, Any]:
    """Return infos with some rows replaced, and which environments have each entry."""
    merged: dict[str, Any] = {}
    for name in {*infos, *final}:
        if name.startswith("_") or name in _FINAL:
            continue
        given, last = infos.get(name), final.get(name)
        if isinstance(given, Mapping) or isinstance(last, Mapping):
            merged[name] = _merge_infos(given or {}, last or {}, rows)
            continue
        some = np.asarray(last if given is None else given)
        present = np.array(infos.get(f"_{name}", np.full(len(some), given is not None)))
        present[rows] = False
        if last is not None:
            last = np.asarray(last)
            some = some.astype(np.result_type(some, last))
            some[rows] = last[rows]
            present[rows] = np.asarray(final.get(f"_{name}", np.ones(len(some), bool)))[rows]
        merged[name], merged[f"_{name}"] = some, present
    return merged
