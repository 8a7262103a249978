"""The robustness when the values of predicates move: how far it follows them, and whether the verdict falls."""

from __future__ import annotations

from functools import partial
from math import inf, ulp
from typing import TYPE_CHECKING, TypeAlias

from rtamt.explain.signals import clipped, has_share, near, spliced
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Formula, Var
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.rewrite.structure import NEGATION, NEVER, literal, opcode, reaches
from rtamt.signals.instants import Cells

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.engine import TimeAxis
    from rtamt.explain.intervals import Interval
    from rtamt.explain.signals import Signals
    from rtamt.rewrite.structure import Place, Structure
    from rtamt.signals.instants import StepFunction

    #: Values of predicates at places of each sign.
    _Values: TypeAlias = Mapping[tuple[str, int], StepFunction]

#: How many values of predicates the robustness is first expected not to pass when one of them moves.
_PASSED = 1000
#: Limits that leave of a number its sign.
_SIGNS = -ulp(0.0), ulp(0.0)


class Moves:
    """Experiments with a formula at a cell; ``leaves``: the values of its predicates.

    In dense time, where a signal costs by its changes, parts of bounded reach under operators of unbounded reach are
    evaluated around the places alone: elsewhere they are what they were. Shares cost less over fewer values, so that
    values are limited to where the robustness is known to lie, or expected; minimum and maximum commute with limits.
    """

    def __init__(
        self,
        structure: Structure,
        axis: TimeAxis,
        leaves: Mapping[str, StepFunction],
        signals: Signals,
        cell: int,
        *,
        dense: bool,
    ) -> None:
        self._structure = structure
        self._signals = signals
        self._cell = cell
        self._robustness = signals.at(structure.core, cell)
        self._reaches = reaches(structure.order, axis.period)
        self._fixed = {name: leaves[name] for name, leaf in structure.leaves.items() if leaf.fixed}
        #: Of each predicate and sign.
        self._values = {
            (name, sign): leaves[name] for name in leaves if name not in self._fixed for sign in (1, -1)
        }
        self._limits = has_share(structure.order)
        self._parts: dict[Place, Var] = {}
        self._bounded = max(self._reaches[structure.core]) < NEVER
        whole = structure.polar[structure.core, 1] if self._bounded or not dense else self._over_parts()
        read = variables(whole)
        self._rest = {each: steps for each, steps in self._values.items() if literal(*each) in read}
        self._run = axis.runner((whole,))
        self._run_parts = (
            axis.runner([structure.polar[place] for place in self._parts]) if self._parts else None
        )

    def _over_parts(self) -> Formula:
        """Return the formula over variables for its largest parts that have a bounded reach and known values."""
        order, core = self._structure.order, self._structure.core
        over: dict[Place, Formula] = {}
        asked = {(core, 1)}
        for node in reversed(order):
            for sign in (1, -1):
                if (node, sign) in asked and isinstance(node, Apply):
                    if max(self._reaches[node]) < NEVER and node in self._signals:
                        self._parts[node, sign] = over[node, sign] = Var(f"={len(self._parts)}")
                    else:
                        asked |= {(arg, _sign_below(node, sign)) for arg in node.args}
        for node in order:
            for sign in (1, -1):
                if (node, sign) in asked and (node, sign) not in over:
                    over[node, sign] = self._structure.polar[node, sign]
                    if isinstance(node, Apply):
                        below = _sign_below(node, sign)
                        over[node, sign] = replace(node, args=tuple(over[arg, below] for arg in node.args))
        return over[core, 1]

    def overturn(self, places: Sequence[Interval]) -> bool:
        """Return whether the verdict falls when the values at some places go against it."""
        if self._robustness > 0:
            return self._moved(places, -inf, _SIGNS) < 0
        return self._moved(places, inf, _SIGNS) > 0

    def extreme(self, place: Interval, toward: float) -> float:
        """Return the robustness when the values at a place go, up to sign, to -inf or to +inf."""
        if self._run_parts is not None:
            return self._over_parts_moved(place, toward)
        found = self._robustness
        for limit in dict.fromkeys((self._beyond(toward), toward)):  # once where they are equal
            low, high = sorted((self._robustness, limit))
            found = self._moved([place], toward, (low, high))
            if found != limit:
                break
        return found

    def _over_parts_moved(self, place: Interval, toward: float) -> float:
        """Return the same over parts. Of their values elsewhere, those beyond a band do not matter in general.

        They do not where the robustness is the same whether they are at the edge of the band or infinite.
        """
        low, high = sorted((self._robustness, toward))
        moved = self._parts_moved([place], toward, (low, high))
        signals = self._fixed | _changed(self._rest, [place], toward)

        def found(values: Callable[[Place], StepFunction]) -> float:
            robustness = self._run(signals | self._spliced(moved, values))[0].at(self._cell)
            return min(max(robustness, low), high)

        band = self._signals.band
        if band is not None and band.contains(self._robustness):
            edge = band.edge(self._robustness, toward)
            nearest, farthest = (
                found(partial(self._signals.beyond, edge, toward, value)) for value in (edge, toward)
            )
            if nearest == farthest:
                return nearest
        return found(lambda part: self._signals.of(part[0]))

    def _beyond(self, toward: float) -> float:
        """Return a value that many values of predicates are closer to the robustness than."""
        if not self._limits or not self._bounded:
            return toward
        way = 1 if toward > 0 else -1
        oriented = [way * sign * steps.values for (_, sign), steps in self._values.items()]
        beyond = np.concatenate([values[values > way * self._robustness] for values in oriented])
        return way * float(np.partition(beyond, _PASSED)[_PASSED]) if len(beyond) > _PASSED else toward

    def _moved(self, places: Sequence[Interval], toward: float, limits: tuple[float, float]) -> float:
        """Return the robustness, within limits, when the values at some places go, up to sign, to -inf or to +inf."""
        values = self._limited(self._rest, limits) if self._bounded else self._rest
        signals = self._fixed | _changed(values, places, toward)
        if self._run_parts is not None:
            moved = self._parts_moved(places, toward, limits)
            signals |= self._spliced(moved, lambda part: self._signals.of(part[0]))
        low, high = limits
        return min(max(self._run(signals)[0].at(self._cell), low), high)

    def _parts_moved(
        self, places: Sequence[Interval], toward: float, limits: tuple[float, float]
    ) -> tuple[int, int, list[StepFunction]]:
        """Return where the parts may read one of the places, [begin, end), and their values there, within limits."""
        assert self._run_parts is not None
        behind, ahead = (max(self._reaches[node][which] for node, _ in self._parts) for which in (0, 1))
        begin = min(place.start for place in places) - ahead
        end = max(place.end for place in places) + behind
        around = {each: near(steps, begin - behind, end + ahead) for each, steps in self._values.items()}
        found = self._run_parts(self._fixed | _changed(self._limited(around, limits), places, toward))
        return begin, end, found

    def _spliced(
        self, moved: tuple[int, int, list[StepFunction]], values: Callable[[Place], StepFunction]
    ) -> dict[str, StepFunction]:
        """Return the values of the parts: new ones where they read one of the places, elsewhere others."""
        begin, end, found = moved
        return {
            var.name: spliced(values(part), steps, begin, end)
            for (part, var), steps in zip(self._parts.items(), found, strict=True)
        }

    def _limited(self, values: _Values, limits: tuple[float, float]) -> _Values:
        """Return values of predicates within limits, up to sign, if that is worth it."""
        low, high = limits
        return {
            (name, sign): clipped(steps, *((low, high) if sign > 0 else (-high, -low)))
            if self._limits
            else steps
            for (name, sign), steps in values.items()
        }


def _sign_below(node: Apply, sign: int) -> int:
    return -sign if opcode(node) == NEGATION else sign


def _changed(values: _Values, places: Sequence[Interval], toward: float) -> dict[str, StepFunction]:
    """Return the values of predicates at places of each sign, changed at some places."""
    found = {}
    for (name, sign), steps in values.items():
        there = [(place.start, place.end) for place in places if (place.name, place.sign) == (name, sign)]
        found[literal(name, sign)] = steps.changed(Cells.of(there), sign * toward) if there else steps
    return found
