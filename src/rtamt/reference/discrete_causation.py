"""The definition of causation: by how much the newest sample alone violates or satisfies a formula.

Z. Zhang et al., "Online causation monitoring of signal temporal logic", CAV 2023. With b the newest sample
and [L, U] the bounds after it, the violation causation ``viol`` at t is how bad the newest sample makes the formula
at t, and ``sat`` how good. A predicate has its value at b; one that reads several samples (``sum``, ``ahead``) has
its upper bound as ``viol`` where b has lowered that, and its lower bound as ``sat`` where b has raised it. Elsewhere
the newest sample causes nothing, which is +inf and -inf. For a fixed t the minimum of ``viol`` over the samples so far,
and of the upper bound before any of them, is U; the maximum of ``sat``, and of that lower bound, is L.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, TypeAlias

from rtamt.language.formula import Apply, Formula, postorder
from rtamt.language.operators import Bounds, Pointwise, Shift, Since, Tense, Window
from rtamt.reference.cores import core_of
from rtamt.reference.definition_adapter import window_in_steps
from rtamt.reference.discrete_bounds import bounds
from rtamt.rewrite.early import at_one_instant, connects
from rtamt.signals.outcomes import Causation

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from fractions import Fraction

    from rtamt.language.definitions.enclosures import Enclosure
    from rtamt.reference.discrete_bounds import Knowledge

#: One operand at one sample.
_Part = tuple[Formula, int]


#: What a sample causes where it has no part.
NOTHING = Causation(inf, -inf)


#: The bounds of all parts of a formula before and after a sample.
Parts: TypeAlias = "tuple[Sequence[Enclosure], Sequence[Enclosure]]"


def causation(
    formula: Formula, known: Knowledge, period: Fraction, m: int | None = None, *, parts: Parts | None = None
) -> list[Causation]:
    """Return the causation of the last sample of ``known`` at samples 0 to m - 1.

    ``m``: by default so many that all later samples are affected as the last one. ``parts``: the bounds of all parts,
    by default those of ``known``; what was known of an operation that turned out to have no value is narrower.

    The formula must have causation: no share of a window (``rewrite.early.causeless``).

    >>> from fractions import Fraction
    >>> import numpy as np
    >>> from rtamt.language.definitions.enclosures import Enclosure
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> from rtamt.reference.discrete_bounds import Knowledge
    >>> x = np.array([4.0, 1.0, 2.0])
    >>> causation(parse_formula("always(x >= 3)"), Knowledge({"x": Enclosure(x, x)}, 3), Fraction(1), 1)
    [Causation(violation=-1.0, satisfaction=-inf)]
    """
    core = core_of(formula, period).formula
    reach = sum(_reach(node, period) + 1 for node in postorder(core))
    m = known.n + reach if m is None else m
    causes = _Causes(formula, known, period, m + known.n + reach, parts)
    return [causes.at(core, t) for t in range(m)]


class _Causes:
    """The recursion over sub-formulas and samples; ``end`` is a sample after all that can matter."""

    def __init__(
        self, formula: Formula, known: Knowledge, period: Fraction, end: int, parts: Parts | None
    ) -> None:
        self._formula, self._known = formula, known
        self._before = known.until(known.n - 1)
        self._period = period
        self._end = end
        self._found: dict[_Part, Causation] = {}
        #: Of all sub-formulas, after so many samples.
        self._bounds: dict[int, dict[Formula, list[tuple[float, float]]]] = {}
        for n, found in zip((self._before.n, known.n), parts or (), strict=False):
            self._bounds[n] = self._by_part(found)

    def at(self, node: Formula, t: int) -> Causation:
        found = self._found.get((node, t))
        if found is None:
            found = self._found[node, t] = self._cause(node, t)
        return found

    def _cause(self, node: Formula, t: int) -> Causation:
        lower, upper = self._limits(node, t)
        if at_one_instant(node):
            return Causation(upper, lower) if t == self._known.n - 1 else NOTHING
        assert isinstance(node, Apply)
        if not connects(node):
            before = self._limits(node, t, self._before)
            return Causation(upper if upper < before[1] else inf, lower if lower > before[0] else -inf)
        kernel, args = node.op.kernel, node.args
        if isinstance(kernel, Shift):
            there = t + (1 if node.op.tense is Tense.FUTURE else -1)
            return self.at(args[0], there) if there >= 0 else NOTHING
        if isinstance(kernel, Pointwise) and kernel.opcode == "neg":
            found = self.at(args[0], t)
            return Causation(-found.satisfaction, -found.violation)
        if isinstance(kernel, Pointwise | Window):
            inside = [(arg, u) for arg in args for u in self._window(node, t)]
            smallest = (kernel.opcode if isinstance(kernel, Pointwise) else kernel.reduce) == "min"
            alternatives = [inside] if smallest else [[part] for part in inside]
            if not inside:
                return NOTHING
        else:
            alternatives = [
                [(args[1], u), *((args[0], v) for v in held)] for u, held in self._targets(node, t)
            ]
            if not alternatives:
                return NOTHING
        # φ is the best of its alternatives, and each is as bad as the worst of its parts.
        viol = max(min(self.at(*part).violation for parts in alternatives for part in parts), upper)
        sat = max(self._all(parts) for parts in alternatives)
        return Causation(viol, sat)

    def _all(self, parts: list[_Part]) -> float:
        """Return the satisfaction causation of parts that must all hold."""
        return min(
            max(self.at(*part).satisfaction for part in parts), *(self._limits(*part)[0] for part in parts)
        )

    def _limits(self, node: Formula, t: int, known: Knowledge | None = None) -> tuple[float, float]:
        known = known or self._known
        if known.n not in self._bounds:
            parts: list[Enclosure] = []
            bounds(self._formula, known, self._period, parts=parts)
            self._bounds[known.n] = self._by_part(parts)
        every = self._bounds[known.n][node]
        return every[min(t, len(every) - 1)]

    def _by_part(self, parts: Sequence[Enclosure]) -> dict[Formula, list[tuple[float, float]]]:
        nodes = postorder(core_of(self._formula, self._period).formula)
        return {
            node: list(zip(found.lower.tolist(), found.upper.tolist(), strict=True))
            for node, found in zip(nodes, parts, strict=True)
        }

    def _window(self, node: Apply, t: int) -> Iterable[int]:
        if node.op.tense is Tense.NONE:
            return (t,)
        begin, end = window_in_steps(node, self._period)
        if node.op.tense is Tense.FUTURE:
            return range(t + begin, self._end if end is None else t + end + 1)
        return range(0 if end is None else max(t - end, 0), t - begin + 1)

    def _targets(self, node: Apply, t: int) -> Iterable[tuple[int, range]]:
        """Return the samples at which the second operand may hold, each with those at which the first must."""
        begin, end = window_in_steps(node, self._period)
        if isinstance(node.op.kernel, Since):
            return [(u, range(u + 1, t + 1)) for u in self._window(node, t)]
        if node.op.tense is Tense.FUTURE:
            return [(u, range(t, u)) for u in self._window(node, t)]
        assert end is not None, "the grammar asks for a bound"
        first = max(t - end, 0)
        return [(u, range(first, u)) for u in range(max(t - end + begin, 0), t + 1)]


def _in_time(node: Formula) -> bool:
    return isinstance(node, Apply) and node.op.tense is not Tense.NONE


def _reach(node: Formula, period: Fraction) -> int:
    """Return how far an operator reads at most, of unbounded ones how far it has to wait."""
    if not _in_time(node) or not isinstance(node, Apply) or node.op.bounds is Bounds.NONE:
        return 1
    begin, end = window_in_steps(node, period)
    return begin if end is None else end
