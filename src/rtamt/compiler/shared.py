"""Programs that are compiled once for all values of parameters.

Formulas that differ in these values alone have the same instructions, apart from the constants.
"""

from __future__ import annotations

from functools import cached_property, lru_cache

from rtamt.compiler.order import is_lowerable
from rtamt.compiler.plan import Plan, compile_plan, compile_program
from rtamt.language.contents import leaves_of, operators_of
from rtamt.language.formula import Formula, Parameter
from rtamt.lazy.dataclasses import dataclass, replace
from rtamt.lazy.functions import Functions
from rtamt.lazy.typing import TYPE_CHECKING
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from rtamt.compiler.graph import Graph
    from rtamt.compiler.program import Program
    from rtamt.rewrite.merge import merged
    from rtamt.signals.time_domain_interface import TimeDomain
else:
    merged = Functions("rtamt.rewrite.merge").merged

#: How many programs and plans are kept for other values.
_KEPT = 64


@dataclass(frozen=True)
class Shape:
    """Formulas apart from the values of their parameters.

    ``formulas``: those with one value for all parameters, ``values``: the values in use. Formulas in which a parameter
    has several values, as those of several specifications may have, stay as they are: there are no ``values``.
    """

    formulas: tuple[Formula, ...]
    values: Mapping[str, float]

    @staticmethod
    def of(formulas: Sequence[Formula]) -> Shape:
        """Return the shape of formulas.

        >>> from fractions import Fraction
        >>> from rtamt.language.parameters import with_values
        >>> from rtamt.language.parsing.parser import parse_formula
        >>> formula = parse_formula("x <= limit", constants={"limit": 4}, parameters=["limit"])
        >>> shapes = [Shape.of(with_values([formula], {"limit": value})) for value in (4.0, 3.0)]
        >>> four, three = (shape.program(Fraction(1), ("x",)) for shape in shapes)
        >>> four.instructions[0].x, three.instructions[0].x, four.value_of is three.value_of
        (4.0, 3.0, True)
        """
        values: dict[str, float] = {}
        for node in leaves_of(*formulas):
            if isinstance(node, Parameter) and values.setdefault(node.name, node.value) != node.value:
                values = {}
                break
        if not values:
            return Shape(tuple(formulas), values)
        from rtamt.language.parameters import with_values

        return Shape(with_values(formulas, dict.fromkeys(values, 0.0)), values)

    def expanded(self) -> tuple[Formula, ...]:
        """Return the core formulas of these formulas."""
        return _kept(self.formulas) if self.values else self._merged

    @cached_property
    def _merged(self) -> tuple[Formula, ...]:
        return merged(self.formulas)

    def program(
        self,
        period: Fraction,
        inputs: tuple[str, ...],
        domain: type[TimeDomain] = Discrete,
        *,
        without: frozenset[str] = frozenset(),
    ) -> Program:
        """Compile the formulas for a monitor; arguments as for :func:`compile_program`."""
        if not self.values:
            return compile_program(_lowerable(self.formulas), period, inputs, domain=domain, without=without)
        return _program(self.formulas, period, inputs, domain, without).with_parameters(self.values)

    def plan(
        self,
        period: Fraction,
        clip: int | None = None,
        domain: type[TimeDomain] = Discrete,
        inputs: tuple[str, ...] = (),
    ) -> Plan:
        """Compile the formulas for an offline evaluation; arguments as for :func:`compile_plan`."""
        if not self.values:
            return compile_plan(self.expanded(), period, clip, domain, inputs)
        plan = _plan(self.formulas, period, clip, domain, inputs)
        stages = [replace(stage, program=stage.program.with_parameters(self.values)) for stage in plan.stages]
        return Plan(tuple(stages), plan.program.with_parameters(self.values))

    def graph(
        self,
        period: Fraction,
        inputs: tuple[str, ...],
        domain: type[TimeDomain] = Discrete,
        *,
        start: bool = False,
        apart: bool = False,
    ) -> Graph:
        """Compile the formulas for early verdicts, without their ``values``; arguments as for :func:`compile_graph`."""
        if not self.values:
            from rtamt.compiler.early import compile_graph  # only verdicts before the horizon need it

            return compile_graph(self.expanded(), period, inputs, domain, start=start, apart=apart)
        return _graph(self.formulas, period, inputs, domain, start, apart).copied()


_kept = lru_cache(_KEPT)(merged)


def _lowerable(formulas: tuple[Formula, ...]) -> tuple[Formula, ...]:
    """Return formulas that lowering can expand: the same ones unless an operator has to be expanded before."""
    operators = operators_of(*formulas)
    return formulas if all(map(is_lowerable, operators)) else merged(formulas)


@lru_cache(_KEPT)
def _program(
    formulas: tuple[Formula, ...],
    period: Fraction,
    inputs: tuple[str, ...],
    domain: type[TimeDomain],
    without: frozenset[str],
) -> Program:
    return compile_program(_lowerable(formulas), period, inputs, domain=domain, without=without)


@lru_cache(_KEPT)
def _plan(
    formulas: tuple[Formula, ...],
    period: Fraction,
    clip: int | None,
    domain: type[TimeDomain],
    inputs: tuple[str, ...],
) -> Plan:
    return compile_plan(_kept(formulas), period, clip, domain, inputs)


@lru_cache(_KEPT)
def _graph(
    formulas: tuple[Formula, ...],
    period: Fraction,
    inputs: tuple[str, ...],
    domain: type[TimeDomain],
    start: bool,
    apart: bool,
) -> Graph:
    from rtamt.compiler.early import compile_graph

    return compile_graph(_kept(formulas), period, inputs, domain, start=start, apart=apart)
