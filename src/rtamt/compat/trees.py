"""RTAMT's syntax trees, pastifiers and interpreters, as far as programs use them: ``spec.ast`` and its users.

A tree here is the canonical text of a formula; what visits RTAMT's nodes has no counterpart.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.compat.dense import StlDenseTimeOfflineSpecification, StlDenseTimeOnlineSpecification
from rtamt.compat.discrete import StlDiscreteTimeOfflineSpecification
from rtamt.compat.discrete_online import StlDiscreteTimeOnlineSpecification
from rtamt.compat.failures import raises_rtamt
from rtamt.compat.online import OnlineSpecification
from rtamt.errors import UsageError
from rtamt.language.units.durations import NANOSECOND
from rtamt.rewrite.check import TICKS, check_bounds
from rtamt.rewrite.horizon import horizon

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence
    from fractions import Fraction

    from rtamt.compat.declarations import Declarations
    from rtamt.compat.dense import DenseTimeSpecification
    from rtamt.compat.discrete import DiscreteTimeSpecification
    from rtamt.compat.formulas import Node
    from rtamt.language.formula import Formula


class StlAst(OnlineSpecification):
    """Declarations and the parsed formulas, without a time domain.

    >>> from rtamt.syntax.ast.parser.stl.specification_parser import StlAst
    >>> ast = StlAst()
    >>> ast.declare_var("x", "float")
    >>> ast.spec = "always[0:2](x >= 3)"
    >>> ast.parse()
    >>> [node.name for node in ast.specs]
    ['always[0,2]((x)>=(3.0))']
    """

    @property
    def _tick(self) -> Fraction:
        return NANOSECOND

    def _check(self, formula: Formula, text: str) -> None:
        check_bounds(formula, NANOSECOND, text, TICKS)


class StlPastifier:
    """Rewrites the formulas of a tree into past operators."""

    def pastify(self, ast: OnlineSpecification) -> OnlineSpecification:
        """Rewrite ``ast`` as its ``pastify`` does, and return it."""
        ast.pastify()
        return ast


class StlHorizon:
    """Computes how far ahead a formula reads."""

    def __init__(self) -> None:
        #: From each visited node to its horizon.
        self.horizons: dict[Node, float] = {}

    @raises_rtamt
    def visit(self, node: Node, *_: Any) -> float:
        """Return the horizon of a formula of ``ast.specs`` in the unit of the specification.

        Raises :class:`RTAMTException` for an operator with unbounded future.
        """
        seconds = horizon(node.formula, node.period)
        if seconds is None:
            raise UsageError(f"'{node.name}' has an unbounded future operator and hence no horizon")
        units = seconds / node.unit
        self.horizons[node] = int(units) if units.denominator == 1 else float(units)
        return self.horizons[node]


#: LTL is STL without bounds.
LtlAst, LtlPastifier, LtlHorizon = StlAst, StlPastifier, StlHorizon


# ---- interpreters: a time domain for a tree --------------------------------------------------------


class _Interpreter:
    """A specification of one class that takes its declarations and its text from a tree."""

    _spec: DiscreteTimeSpecification | DenseTimeSpecification

    def set_ast(self, ast: Declarations) -> None:
        """Read the specification of a parsed tree."""
        self._spec.read_as_in(ast)

    def set_sampling_period(self, *args: Any, **kwargs: Any) -> None:
        """Set the sampling period; see the specification classes."""
        self._spec.set_sampling_period(*args, **kwargs)


class StlDiscreteTimeOfflineInterpreter(_Interpreter):
    """Evaluates a tree on finished traces in discrete time."""

    def __init__(self) -> None:
        self._spec: StlDiscreteTimeOfflineSpecification = StlDiscreteTimeOfflineSpecification()

    def evaluate(self, dataset: Mapping[str, Any]) -> list[list[float]]:
        """Return the robustness at every sample; see :class:`StlDiscreteTimeOfflineSpecification`."""
        return self._spec.evaluate(dataset)


class StlDenseTimeOfflineInterpreter(_Interpreter):
    """Evaluates a tree on complete signals in dense time."""

    def __init__(self) -> None:
        self._spec: StlDenseTimeOfflineSpecification = StlDenseTimeOfflineSpecification()

    def evaluate(self, dataset: Sequence[Sequence[Any]]) -> list[list[float]]:
        """Return the robustness of a list of signals; see :class:`StlDenseTimeOfflineSpecification`."""
        return self._spec.evaluate(*dataset)


class StlDiscreteTimeOnlineInterpreter(_Interpreter):
    """Monitors a tree on samples in discrete time."""

    def __init__(self) -> None:
        self._spec: StlDiscreteTimeOnlineSpecification = StlDiscreteTimeOnlineSpecification()

    def update(self, timestamp: float, dataset: Iterable[tuple[str, Any]]) -> Any:
        """Take one sample and return the robustness; see :class:`StlDiscreteTimeOnlineSpecification`."""
        return self._spec.update(timestamp, dataset)

    def reset(self) -> None:
        """Forget the trace."""
        self._spec.reset()


class StlDenseTimeOnlineInterpreter(_Interpreter):
    """Monitors a tree on signals in dense time."""

    def __init__(self) -> None:
        self._spec: StlDenseTimeOnlineSpecification = StlDenseTimeOnlineSpecification()

    def update(self, dataset: Sequence[Sequence[Any]]) -> list[list[float]]:
        """Take the next samples of a list of signals; see :class:`StlDenseTimeOnlineSpecification`."""
        return self._spec.update(*dataset)

    def reset(self) -> None:
        """Forget the signals."""
        self._spec.reset()
