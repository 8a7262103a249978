"""The search problem: a requirement, a plant, and the inputs that vary."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

from rtamt.batch import evaluate_requirements
from rtamt.errors import StlError, UsageError, did_you_mean, shown
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.search.inputs import Range
from rtamt.search.log import Evaluation
from rtamt.signals.arrays import TIME, is_number
from rtamt.verdicts.early.at_start import StartMonitor
from rtamt.verdicts.early.check import holds_at_end

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.search.inputs import Input
    from rtamt.signals.outcomes import Interval
    from rtamt.specification import Specification


@dataclass(frozen=True)
class Problem:
    """A requirement, a plant, and the inputs that a search may vary.

    ``plant`` is any callable: it is called with one keyword argument for each of ``inputs``, a number
    for a :class:`Range` (or a plain number), a function of time in seconds for an input signal. It
    returns a trace in any form that ``Specification.evaluate`` accepts, or yields samples
    ``(time, {variable: value})``; a plant that yields is stopped as soon as its verdict is final.
    ``duration``: the simulated time in seconds; optional if no input is a signal and the
    requirement's horizon is bounded.

    >>> import rtamt
    >>> from rtamt.search import Problem, Range
    >>> def ball(speed):
    ...     for k in range(21):
    ...         yield k / 10, {"height": speed * k / 10 - 4.9 * (k / 10) ** 2}
    >>> problem = Problem(rtamt.parse("always[0:2](height <= 6)", period="100ms"), ball, {"speed": Range(1, 12)}, 2)
    >>> evaluation = problem.run({"speed": 12.0})
    >>> evaluation.satisfied, evaluation.stopped
    (False, 0.8)
    """

    spec: Specification
    plant: Callable[..., Any]
    inputs: Mapping[str, Range | Input | float]
    duration: float | None = None
    #: The range of every parameter, by name.
    space: Mapping[str, Range] = field(init=False)

    def __post_init__(self) -> None:
        if self.duration is not None and not (is_number(self.duration) and 0 < self.duration < inf):
            raise UsageError(f"the duration is {shown(self.duration)}; give a positive number of seconds")
        space: dict[str, Range] = {}
        for name, given in self.inputs.items():
            if isinstance(given, Range):
                space[name] = given
            elif isinstance(given, (int, float)):
                continue
            elif not callable(getattr(given, "signal", None)):
                raise UsageError(
                    f"the input '{name}' is {shown(given)}; give a Range, a number or an input signal"
                )
            elif self.duration is None:
                raise UsageError(f"the input '{name}' is a signal: give the duration of a simulation too")
            else:
                space |= {f"{name}.{own}": part for own, part in given.parameters().items()}
        if not space:
            raise UsageError("nothing can vary: give at least one Range, or an input signal with a Range")
        object.__setattr__(self, "space", space)

    def arguments(self, point: Mapping[str, float]) -> dict[str, Any]:
        """Return the plant's arguments at a point (a value for each parameter)."""
        for name in point:
            if name not in self.space:
                raise UsageError(f"there is no parameter '{name}'{did_you_mean(name, tuple(self.space))}")
        for name in self.space:
            if name not in point:
                raise UsageError(f"the parameter '{name}' has no value at this point")
        arguments: dict[str, Any] = {}
        for name, given in self.inputs.items():
            if isinstance(given, Range):
                arguments[name] = float(point[name])
            elif isinstance(given, (int, float)):
                arguments[name] = given
            else:
                own = {key: float(point[f"{name}.{key}"]) for key in given.parameters()}
                arguments[name] = given.signal(own, self.duration or 0.0)
        return arguments

    def run(self, point: Mapping[str, float], number: int = 0, *, whole: bool = False) -> Evaluation:
        """Simulate at a point and evaluate the requirement.

        ``whole``: run to the end, even if the verdict is final earlier; otherwise the robustness of a
        plant that yields may be inexact. ``number`` appears in the evaluation and in messages.

        Raises :class:`UsageError` if the plant fails, and the errors of ``evaluate`` for wrong
        signals, with the point in the message.
        """
        arguments = self.arguments(point)
        try:
            try:
                made = self.plant(**arguments)
                if isinstance(made, Mapping) or hasattr(made, "columns") or not isinstance(made, Iterable):
                    return self._whole(made, point, number)
                return self._stepwise(made, point, number, whole)
            except StlError as error:
                raise type(error)(f"{_where(number, point)}: {error}") from error
        except StlError:
            raise
        except Exception as error:
            raise UsageError(
                f"{_where(number, point)}: the plant failed: {type(error).__name__}: {error}"
            ) from error

    def _whole(self, data: Any, point: Mapping[str, float], number: int) -> Evaluation:
        provided = data if isinstance(data, Mapping) else getattr(data, "columns", ())
        if all(name in provided for name in self.spec.input_names):  # a plant may return additional signals
            data = {name: data[name] for name in (TIME, *self.spec.input_names) if name in provided}
        results = evaluate_requirements(self.spec, data).values()
        robustness = min(result.robustness for result in results)
        return Evaluation(number, dict(point), robustness, all(result.satisfied for result in results))

    def _stepwise(
        self, samples: Iterable[Any], point: Mapping[str, float], number: int, whole: bool
    ) -> Evaluation:
        total = self._total
        start = None if whole else self._start_monitor()
        names = self.spec.input_names
        times: list[float] = []
        columns: dict[str, list[float]] = {name: [] for name in names}
        for sample in samples:
            time, values = _sample(sample)
            times.append(time)
            for name in names:
                if name not in values:
                    raise UsageError(
                        f"the plant gave no '{name}' at {time:g} s, which the requirement reads"
                        f"{did_you_mean(name, tuple(values))}"
                    )
                columns[name].append(values[name])
            if len(times) == total:
                break
            if start is not None:
                start.update(time, **{name: values[name] for name in names})
                if start.satisfied is not None:
                    known = start.interval() if total is None else self._bounds(times, columns, total)
                    return Evaluation(number, dict(point), _nearest(known), start.satisfied, time)
        close = getattr(samples, "close", None)
        if close is not None:
            close()
        return self._whole({TIME: times, **columns}, point, number)

    def _start_monitor(self) -> StartMonitor | None:
        """Return the monitor that decides the verdict during a simulation; None if only its end decides.

        This is the case if the end may cut decisive windows, and for custom operators.
        """
        spec = self.spec
        if not spec.domain.held_at_end:
            if self._total is None:
                return None
            period = spec.domain.period
            assert period is not None
            whole = spec.horizon <= float((self._total - 1) * period)
            if not whole and not holds_at_end(spec):
                return None
        try:
            return StartMonitor(spec, ranges=spec._unlimited)  # evaluations do not check declared ranges
        except UsageError:
            return None

    def _bounds(self, times: list[float], columns: Mapping[str, list[float]], total: int) -> Interval:
        """Return the bounds of the robustness of a simulation that ends after ``total`` samples."""
        period = self.spec.domain.period
        assert period is not None
        rest = range(1, total - len(times) + 1)
        data: dict[str, list[Any]] = {TIME: times + [times[-1] + float(k * period) for k in rest]}
        for name, column in columns.items():
            data[name] = column + [None] * len(rest)
        return self.spec.evaluate(data, ranges=self.spec._unlimited).interval

    @property
    def _total(self) -> int | None:
        """Return the number of samples of a simulation in discrete time; None if unknown."""
        period = self.spec.domain.period
        if period is None:
            return None
        duration = self.spec.horizon if self.duration is None else self.duration
        return None if duration == inf else round(duration / float(period)) + 1


def _sample(given: Any) -> tuple[float, Mapping[str, float]]:
    """Return the time and the values of a sample that the plant yielded."""
    if isinstance(given, tuple | list) and len(given) == 2:
        time, values = given
        if is_number(time) and isinstance(values, Mapping):
            return float(time), values
    raise UsageError(
        f"the plant yielded {shown(given)}; a sample is (time, {{variable: value}}), such as (0.1, {{'x': 2.5}})"
    )


def _nearest(known: Interval) -> float:
    """Return the robustness so far: the upper bound, or the lower one if only that is finite.

    The lower one alone would mislead an optimizer: a requirement that is just met is as low as one that was
    decided early.
    """
    return known.upper if isfinite(known.upper) else known.lower


def _where(number: int, point: Mapping[str, float]) -> str:
    return f"simulation {number} ({', '.join(f'{name}={value:.6g}' for name, value in point.items())})"
