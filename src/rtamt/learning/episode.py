"""One episode of one requirement: rewards, potentials, the earliest verdict."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError, UsageError, choices, no_specification, shown
from rtamt.language.formula import Apply
from rtamt.language.operators import STL
from rtamt.lazy.tuples import NamedTuple
from rtamt.specification import Specification

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.formula import Formula

ROBUSTNESS, INTERVAL, SHAPING = REWARDS = ("robustness", "interval", "shaping")


class Settings(NamedTuple):
    """The checked settings of a wrapper."""

    spec: Specification
    reward: str
    gamma: float
    terminate: bool
    ranges: Mapping[str, Any] | None

    @property
    def period(self) -> float:
        """The time between two samples, in seconds."""
        return 1.0 if self.spec.period is None else float(self.spec.period)

    @property
    def rated(self) -> Specification:
        """The specification whose robustness rates single steps."""
        return self.spec.with_formula(each_step(self.spec.formula))


class Outcome(NamedTuple):
    """The reward of a step, and its info."""

    reward: float
    info: dict[str, Any]


def settings_of(
    spec: Any, reward: str, gamma: float | None, ranges: Mapping[str, Any] | None, *, terminate: bool
) -> Settings:
    """Check the settings of a wrapper; raise :class:`UsageError` for those that do not fit."""
    if not isinstance(spec, Specification):
        raise no_specification(spec)
    if reward not in REWARDS:
        raise UsageError(f"reward is {shown(reward)}{choices(reward, REWARDS, 'rewards')}")
    if reward == SHAPING and (gamma is None or not 0 <= gamma <= 1):
        raise UsageError(
            f"gamma is {shown(gamma)}; reward='shaping' needs the discount factor of the learner, from 0 to 1"
        )
    if reward != SHAPING and gamma is not None:
        raise UsageError("gamma= is a setting of reward='shaping'")
    if reward != INTERVAL and ranges is not None:
        raise UsageError("ranges= is a setting of reward='interval'")
    if terminate and spec.horizon == 0:
        raise UsageError(
            f"the verdict of '{spec.formula}' is known with the first sample, so that every episode would end there: "
            f"write always({spec.formula}), or set terminate=False"
        )
    return Settings(spec, reward, 0.0 if gamma is None else float(gamma), terminate, ranges)


def each_step(formula: Formula) -> Formula:
    """Return the demand of a requirement on each step: for ``always(a) and always(b)``, ``a and b``.

    >>> import rtamt
    >>> str(each_step(rtamt.parse("always(x >= 3) and always(y >= 1)").formula))
    'x >= 3 and y >= 1'
    """
    parts = _invariants(formula)
    return formula if parts is None else parts


def _invariants(formula: Formula) -> Formula | None:
    if not isinstance(formula, Apply):
        return None
    if formula.op is STL["always"] and formula.interval is None:
        return formula.args[0]
    if formula.op is STL["and"]:
        parts = [_invariants(each) for each in formula.args]
        if all(part is not None for part in parts):
            return Apply(formula.op, tuple(part for part in parts if part is not None))
    return None


class Episode:
    """Rates the steps of one episode after another."""

    def __init__(self, settings: Settings) -> None:
        self._settings = settings
        spec = settings.spec
        if settings.reward == INTERVAL:
            self._rates: Any = spec.monitor(verdict="interval", at="start", ranges=settings.ranges)
        else:
            self._rates = settings.rated.monitor()
        # Where ``ranges`` replaces a declared range, a sample may lie outside the latter.
        replaced = {name: each for name, each in (settings.ranges or {}).items() if name in spec.ranges}
        self._judge: Any = spec.monitor(verdict="eager", ranges=replaced) if settings.terminate else None
        self.input_names: tuple[str, ...] = spec.input_names
        self.running = False
        #: Whether the reward of a step contains that of the environment.
        self.adds = settings.reward == SHAPING

    def start(self, sample: Mapping[str, Any] | None) -> dict[str, Any]:
        """Start an episode with the sample of the reset, if there is one; return its info."""
        self._rates.reset()
        if self._judge is not None:
            self._judge.reset()
        self._samples = 0
        self._potential: float | None = None
        self._satisfied: bool | None = None
        self.running = True
        if sample is None:
            return {}
        found = self._take(sample)
        self._potential = found
        return self._info(found)

    def take(self, sample: Mapping[str, Any]) -> bool | None:
        """Take the sample of a step; return the verdict of the requirement if it is known."""
        self._found = self._take(sample)
        return self._satisfied

    def rate(self, reward: float, *, ends: bool) -> Outcome:
        """Return the reward of the step; ``ends``: whether the episode terminates with it."""
        found, kind, before = self._found, self._settings.reward, self._potential
        if kind == ROBUSTNESS:
            worth = 0.0 if found is None else found
        elif kind == INTERVAL:
            if ends:
                self._rates.finish()
                found = self._middle()
            assert found is not None
            worth = 0.0 if before is None else found - before
            self._potential = found
        else:
            after = before if found is None else found
            self._potential = after
            worth = reward + (self._settings.gamma * (0.0 if ends else after or 0.0) - (before or 0.0))
        return Outcome(worth, self._info(found))

    def _take(self, sample: Mapping[str, Any]) -> float | None:
        time = self._samples * self._settings.period
        self._samples += 1
        values = {name: _number(sample, name) for name in self.input_names}
        found: float | None = self._rates.update(time, **values)
        if self._judge is not None and self._satisfied is None:
            self._satisfied = next(
                (v.satisfied for v in self._judge.update(time, **values) if v.time == 0), None
            )
        if self._settings.reward == INTERVAL:
            return self._middle()
        if found is not None and not isfinite(found):
            raise not_finite(found, time)
        return found

    def _bounds(self) -> tuple[float, float]:
        found = self._rates.interval()
        return found.lower, found.upper

    def _middle(self) -> float:
        lower, upper = self._bounds()
        middle = (lower + upper) / 2
        if lower == upper and not isfinite(lower):
            raise EvaluationError(
                f"the robustness of the episode is {lower}, and a reward must be finite: compare numbers instead of "
                "Booleans, and let no window start after the end of an episode"
            )
        if not isfinite(middle):
            raise EvaluationError(
                f"the robustness is between {lower} and {upper}, and a reward must be finite: give the range of each "
                f"variable, such as ranges={{'{next(iter(self.input_names), 'x')}': (0, 10)}}"
            )
        return float(middle)

    def _info(self, found: float | None) -> dict[str, Any]:
        info: dict[str, Any] = {}
        if self._settings.reward == INTERVAL:
            info["interval"] = self._bounds()
        elif found is not None:
            info["robustness"] = found
        if self._satisfied is not None:
            info["satisfied"] = self._satisfied
        return info


def not_finite(found: float, time: float) -> EvaluationError:
    """Return the error for a robustness that is no reward."""
    return EvaluationError(
        f"the robustness is {found} at {time:g} s, and a reward must be finite: compare numbers instead of Booleans"
    )


def _number(sample: Mapping[str, Any], name: str) -> Any:
    if name not in sample:
        raise UsageError(f"signals returned no value for the variable {shown(name)} of the requirement")
    value = sample[name]
    return value.item() if getattr(value, "size", 0) == 1 else value
