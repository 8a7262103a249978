"""Queries of the monitors of early verdict modes, and the shared parts of the back ends that answer them.

Each back end offers an :class:`EarlySession` for an :class:`EarlyQuery`; ``early`` in the folder of a time domain
prepares them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compiler.causation import compile_causes
from rtamt.compiler.shared import Shape
from rtamt.engine.backend import Definition, Session
from rtamt.engine.native import core
from rtamt.errors import changed_state
from rtamt.language.parameters import with_values
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.tuples import NamedTuple
from rtamt.rewrite.desugar import written

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence

    from rtamt.compiler.causation import Causes
    from rtamt.compiler.graph import Graph
    from rtamt.language.formula import Formula
    from rtamt.signals.time_domain_interface import TimeDomain


@dataclass(frozen=True, slots=True, eq=False)
class EarlyQuery:
    """The query of a monitor that reports before the horizon.

    ``formulas``: the result first, then those that are watched. ``requirements``: the conjuncts of the result, each of
    which has its own trace in dense time. ``inputs``: what the formulas read. ``ranges``: of each input, what is known
    of it before it is seen. ``types``: of inputs, see ``coding.codes_of``. ``ignored``: other variables that an update
    may hold.
    """

    formulas: tuple[Formula, ...]
    requirements: tuple[Formula, ...]
    inputs: tuple[str, ...]
    ranges: Sequence[tuple[float, float]]
    types: Mapping[str, Any]
    ignored: Collection[str]
    #: Whether verdicts are reported; else bounds.
    verdicts: bool
    #: Whether causation is reported too.
    causes: bool
    #: Whether the bounds of the result at the start of the trace are.
    start: bool
    #: How many of the formulas, the first ones, are not reported at every instant.
    hidden: int
    #: The greatest lateness of a sample in steps; None if all arrive in order.
    late: int | None
    #: Whether samples may correct earlier ones.
    replays: bool

    @property
    def outputs(self) -> range:
        """The numbers of the formulas that are reported at every instant."""
        return range(len(self.formulas) - self.hidden)


class Group(NamedTuple):
    """Formulas over one trace: their graph, the references of what is reported, and the values of parameters."""

    graph: Graph
    outputs: list[int]
    causes: Causes | None
    values: Mapping[str, float]

    @staticmethod
    def of(
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        domain: TimeDomain,
        *,
        start: bool,
        hidden: int,
        causes: bool,
        apart: bool = False,
    ) -> Group:
        """Compile formulas; ``start``, ``hidden`` and ``causes`` as for :class:`EarlyQuery`.

        ``apart``: whether each predicate is a node of its own.
        """
        step = domain.step
        assert step is not None
        shape = Shape.of(formulas)
        graph = shape.graph(step, inputs, type(domain), start=start, apart=apart)
        found = compile_causes(graph, shape.expanded()[hidden:]) if causes else None
        graph = graph.with_parameters(shape.values)
        return Group(graph, graph.outputs[hidden:], found, shape.values)


class EarlySession(Session):
    """Formulas that a back end has prepared for reports before the horizon.

    ``places``: of each output, the groups and the numbers of their outputs of which it is the minimum. ``monitor``
    returns a monitor, from ``settings``.
    """

    def __init__(
        self,
        groups: Sequence[Group],
        places: Sequence[Sequence[tuple[int, int]]],
        monitor: Callable[..., Any],
        *settings: Any,
    ) -> None:
        self._groups, self._places = groups, places
        self._monitor, self._settings = monitor, settings

    def open(self) -> Any:
        """See :class:`Session`."""
        return self._monitor(*self._settings)

    def lag(self, output: int) -> int:
        """Return the number of steps after an instant until the value of an output is final."""
        horizons = (
            self._groups[group].graph.horizon(self._groups[group].outputs[place])
            for group, place in self._places[output]
        )
        return max(0, *horizons)

    @property
    def fingerprint(self) -> bytes:
        """See :class:`Session`."""
        return b"".join(group.graph.fingerprint() for group in self._groups)


class EarlyProgram(EarlySession):
    """Graphs that a monitor of the compiled core runs."""

    def __init__(
        self,
        formulas: Sequence[Formula],
        groups: Sequence[Group],
        places: Sequence[Sequence[tuple[int, int]]],
        monitor: Callable[..., Any],
        *settings: Any,
    ) -> None:
        super().__init__(groups, places, monitor, *settings)
        self._formulas = formulas
        self.refused = core().Refused
        self.undefined = (core().Undefined,)

    def culprit(self, error: Exception) -> Formula:
        """See :class:`Session`."""
        return written(self._origin(error.args[0]), self._formulas)

    def _origin(self, step: int) -> Formula:
        """Return the core formula that a step of the graphs computes."""
        for graph, _, _, values in self._groups:
            if step < len(graph.origins):
                return with_values([graph.origins[step]], values)[0]
            step -= len(graph.origins)
        raise changed_state()


class EarlyDefinition(EarlySession, Definition):
    """Formulas that are evaluated by definition; their graphs give lags, and refuse what has no bounds."""
