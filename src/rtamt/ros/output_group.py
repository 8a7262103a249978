"""Outputs that are monitored together: their pastified formulas, robustness and truth, in either time domain."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.engine.dense.monitor import points_of
from rtamt.errors import SpecificationError
from rtamt.language.contents import variables
from rtamt.rewrite.check import always_has_a_value
from rtamt.rewrite.horizon import horizon
from rtamt.ros.group import Group, MessageGroup, Robustness, SampledGroup, Verdict
from rtamt.verdicts.robustness_and_truth import outputs_under

if TYPE_CHECKING:
    from collections.abc import Container, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.ros.binding import Output
    from rtamt.ros.group import Record
    from rtamt.signals.dense import Dense
    from rtamt.signals.discrete import Discrete
    from rtamt.signals.time_domain_interface import TimeDomain
    from rtamt.specification import Specification
    from rtamt.verdicts.robustness_and_truth import Outputs


class Standing:
    """One output, as of the last :meth:`Group.refresh`: ``latest`` robustness, whether it was ``satisfied``.

    ``horizon``: seconds. ``lag``: the same in samples, in dense time in nanoseconds.
    """

    __slots__ = ("horizon", "lag", "latest", "output", "satisfied", "topic", "truth", "undecided", "verdicts")

    def __init__(self, output: Output, domain: TimeDomain) -> None:
        assert domain.step is not None
        depth = horizon(domain.ground(output.specification.formula)[0], domain.step)
        assert depth is not None, "unbounded future was refused"
        self.output = output
        self.topic = output.topic
        self.verdicts = output.verdicts
        self.horizon = float(depth)
        self.lag = int(depth / domain.step)
        self.forget()

    def forget(self) -> None:
        """Return to the state before the first sample."""
        self.latest: float | None = None
        self.satisfied: bool | None = None
        #: In dense time: the latest known truth; whether the first verdict is pending.
        self.truth = 0.0
        self.undecided = True

    @property
    def text(self) -> str:
        """The state of the verdict."""
        return "satisfied" if self.satisfied else "no verdict yet" if self.satisfied is None else "violated"

    @property
    def facts(self) -> tuple[tuple[str, str], ...]:
        """The text of the output for diagnostics."""
        return (
            ("robustness", "none" if self.latest is None else f"{self.latest:.6g}"),
            ("horizon", f"{self.horizon:.6g} s"),
        )


def group_outputs(outputs: Sequence[Output]) -> list[list[Output]]:
    """Return the outputs whose robustness is reported in groups that one program can monitor.

    The outputs of a group read the same numbers, so that they begin and end together. An output that may
    be undefined at a sample, such as the logarithm of -1, is a group by itself: it must not stop the others.
    """
    groups: dict[object, list[Output]] = {}
    for output in outputs:
        if output.early:
            continue
        formula = output.specification.formula
        key = frozenset(variables(formula)) if always_has_a_value(formula) else output.name
        groups.setdefault(key, []).append(output)
    return list(groups.values())


def _past(output: Output, period: Fraction | None) -> Outputs:
    """Return robustness and truth as formulas with past operators only, with equal values one horizon later."""
    spec = output.specification
    try:
        past = spec.pastified(period)
    except SpecificationError as error:
        raise type(error)(f"'{output.name}': {error.message}", error.text, error.span) from None
    return outputs_under(past, spec.semantics, spec.roles)


def _together(outputs: Sequence[Output], formulas: Sequence[Outputs]) -> tuple[Specification, list[Formula]]:
    """Return the specification of the first formula, and all formulas, which its monitor watches in one program."""
    every = [formula for both in formulas for formula in both]
    return outputs[0].specification.with_formula(every[0]), every


class _Reported(Group):
    """Outputs whose robustness one monitor computes."""

    _monitor: Any
    standings: tuple[Standing, ...]

    @property
    def samples(self) -> int:
        """The number of samples (in dense time, of numbers) since the beginning or the last reset."""
        return int(self._monitor.samples)

    def reset(self) -> None:
        """Forget all samples."""
        self._monitor.reset()
        for standing in self.standings:
            standing.forget()


class DiscreteGroup(_Reported, SampledGroup):
    """Outputs whose robustness is reported with every sample, from one program with shared sub-formulas."""

    def __init__(self, outputs: Sequence[Output], topic_of: Mapping[str, str], domain: Discrete) -> None:
        period = domain.period
        assert period is not None
        super().__init__(outputs, topic_of, period)
        self.formulas = tuple(_past(output, period) for output in outputs)
        self.standings = tuple(Standing(output, domain) for output in outputs)
        spec, every = _together(outputs, self.formulas)
        self._monitor = spec.monitor(time=domain, semantics="standard", watch=every)

    def take(
        self, stamp: int, values: Mapping[str, float], wanted: Container[str] | None = None
    ) -> list[Record]:
        """Take one sample, return records for the topics that are wanted (None: all).

        Raises :class:`StlError` if it cannot be used.
        """
        monitor = self._monitor
        monitor.step(*[values[name] for name in monitor.input_names])
        records: list[Record] = []
        for standing, (robustness, truth) in zip(self.standings, self.formulas, strict=True):
            if wanted is None or standing.topic in wanted:
                records.append(Robustness(standing.output, stamp, self._value(robustness)))
            if wanted is None or standing.verdicts in wanted:
                records.append(Verdict(standing.output, stamp, standing.horizon, self._held(standing, truth)))
        return records

    def _value(self, formula: Formula) -> float:
        value = self._monitor[formula]
        assert isinstance(value, float), "a formula of the past is known at once"
        return value

    def _held(self, standing: Standing, truth: Formula) -> bool | None:
        return self._value(truth) > 0 if self._monitor.samples > standing.lag else None

    def refresh(self) -> None:
        """Bring the standings up to date."""
        if not self._monitor.samples:
            return
        for standing, (robustness, truth) in zip(self.standings, self.formulas, strict=True):
            standing.latest = self._value(robustness)
            standing.satisfied = self._held(standing, truth)


class DenseGroup(_Reported, MessageGroup):
    """Samples at the times in the messages' headers, each topic on its own time base."""

    def __init__(self, outputs: Sequence[Output], topic_of: Mapping[str, str], domain: Dense) -> None:
        super().__init__(outputs, topic_of)
        formulas = tuple(_past(output, None) for output in outputs)
        self.standings = tuple(Standing(output, domain) for output in outputs)
        # Timestamps and ticks are both integer nanoseconds: results need no conversion.
        spec, every = _together(outputs, formulas)
        self._monitor = spec.monitor(time=domain, semantics="standard", watch=every, time_unit="ns")
        places = {formula: i for i, formula in enumerate(dict.fromkeys(every), 1)}
        #: Of each output the places of robustness and truth in what became known.
        self._places = [(places[both.robustness], places[both.truth]) for both in formulas]
        self._start: int | None = None
        #: The latest points of the result, and then of each watched formula.
        self._points: list[list[tuple[int, float]]] = []

    def take(
        self, stamp: int, values: Mapping[str, float], wanted: Container[str] | None = None
    ) -> list[Record]:
        """Take the numbers of one message, return records for the topics that are wanted (None: all).

        Raises :class:`StlError` if they cannot be used.
        """
        records: list[Record] = []
        while self._held:
            before, held = self._held.popleft()
            records += self._update(before, held, wanted)
        return records + self._update(stamp, self._mine(values), wanted)

    def _update(self, stamp: int, values: dict[str, float], wanted: Container[str] | None) -> list[Record]:
        # All outputs are known up to the same instant.
        if not len(self._monitor.update(stamp, **values)):
            return []
        self._points = points = points_of(self._monitor)
        if self._start is None:
            self._start = points[1][0][0]  # the first entry belongs to the result of update()
        records: list[Record] = []
        for standing, (robustness, truth) in zip(self.standings, self._places, strict=True):
            output, robust, truths = standing.output, points[robustness], points[truth]
            if wanted is None or standing.topic in wanted:
                records += [Robustness(output, at, value) for at, value in robust]
            heard = wanted is None or standing.verdicts in wanted
            if heard or standing.undecided:
                verdicts = self._verdicts(standing, truths)
                records += verdicts if heard else []
        return records

    def _verdicts(self, standing: Standing, truths: Sequence[tuple[int, float]]) -> list[Record]:
        """Return a verdict for each point, and one for the instant at which verdicts begin."""
        assert self._start is not None
        begin = self._start + standing.lag
        records: list[Record] = []
        for at, truth in truths:
            if standing.undecided and at >= begin:
                standing.undecided = False
                if at > begin:  # the previous verdict still holds
                    records.append(Verdict(standing.output, begin, standing.horizon, standing.truth > 0))
            standing.truth = truth
            records.append(
                Verdict(standing.output, at, standing.horizon, self._is_satisfied(standing, at, truth))
            )
        return records

    def _is_satisfied(self, standing: Standing, at: int, truth: float) -> bool | None:
        assert self._start is not None
        return truth > 0 if at >= self._start + standing.lag else None

    def refresh(self) -> None:
        """Bring the standings up to date."""
        if not self._points:
            return
        for standing, (robustness, truth) in zip(self.standings, self._places, strict=True):
            standing.latest = self._points[robustness][-1][1]
            standing.satisfied = self._is_satisfied(standing, *self._points[truth][-1])

    def reset(self) -> None:
        """Forget all samples."""
        super().reset()
        self._held.clear()
        self._points = []
        self._start = None
