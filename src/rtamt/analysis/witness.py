"""A trace that the solver found, as samples that the engine evaluates, and what the engine finds on it."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.language.formula import Formula
    from rtamt.results import Result
    from rtamt.specification import Specification


class Goal(NamedTuple):
    """A formula over the names of a specification, and whether a trace is to satisfy or to violate it."""

    spec: Specification
    formula: Formula
    holds: bool

    def specification(self) -> Specification:
        """Return the specification of the formula."""
        return self.spec if self.formula is self.spec.formula else self.spec.with_formula(self.formula)


@dataclass(frozen=True, eq=False)
class Witness:
    """A trace that the solver found, with the goals that it fulfils.

    ``columns``: from each variable to its samples, shape (n,). ``period``: of sampling, in seconds. ``samples``: n.
    """

    columns: Mapping[str, NDArray[np.float64]]
    period: Fraction
    goals: tuple[Goal, ...]
    samples: int

    @property
    def data(self) -> dict[str, NDArray[np.float64]]:
        """The trace as ``evaluate`` takes it, with timestamps in seconds."""
        times = np.arange(self.samples, dtype=np.float64) * float(self.period)
        return {"time": times, **self.columns}

    @cached_property
    def results(self) -> tuple[Result, ...]:
        """The results of the engine on the trace, for each goal."""
        return tuple(goal.specification().evaluate(self.data, period=self.period) for goal in self.goals)

    @cached_property
    def confirmed(self) -> bool:
        """Whether the engine agrees with the solver."""
        try:
            found = zip(self.goals, self.results, strict=True)
            return all(result.satisfied is goal.holds for goal, result in found)
        except EvaluationError:
            return False

    @property
    def margin(self) -> float:
        """The smallest distance of a robustness from 0."""
        return min(abs(result.robustness) for result in self.results)

    def plot(self, figure: Any = None) -> Any:
        """Plot the signals, and the robustness of the last goal, as :meth:`rtamt.Result.plot`."""
        return self.results[-1].plot(figure=figure)
