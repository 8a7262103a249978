"""The definition of causation in dense time: by how much the newest samples alone violate or satisfy a formula.

As in discrete time (``discrete_causation.py``), on step functions. An event is what arrives at once: samples of some
variables, a watermark or the end of the trace. A predicate has its bounds where the event has made a variable of it
known; one that reads several instants, where the event has moved them. The minimum of ``viol`` at an instant over the
events so far, and of the upper bound before any of them, is U; the maximum of ``sat``, and of that lower bound, is L.
For exact samples.
"""

from __future__ import annotations

from bisect import bisect_right
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.language.contents import variables
from rtamt.language.definitions import dense as dense_definitions
from rtamt.language.definitions.dense import QUARTERS, Steps, lifted, merged, pieces
from rtamt.language.formula import Apply, Formula, postorder
from rtamt.language.operators import Pointwise, Since, Tense, Until, Window
from rtamt.lazy.tuples import NamedTuple
from rtamt.reference.cores import core_of
from rtamt.reference.definition_adapter import window_in_quarters
from rtamt.reference.dense_bounds import DenseKnowledge, bounds_of_parts, by_part
from rtamt.rewrite.early import at_one_instant, connects
from rtamt.signals.outcomes import Causation

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from fractions import Fraction

    from rtamt.reference.dense_bounds import Parts, StepBounds

#: What has no part in anything.
NOTHING = -inf


class StepCauses(NamedTuple):
    """Causation over time: from each of ``times`` (ticks, strictly increasing) up to the next, the last for ever."""

    times: tuple[int, ...]
    causes: tuple[Causation, ...]
    #: The lower bound of the formula at these times.
    lower: tuple[float, ...]

    def at(self, tick: int) -> Causation:
        """Return the causation at a tick, not before the first of ``times``."""
        return self.causes[bisect_right(self.times, tick) - 1]


class _Side(NamedTuple):
    """One side of a formula: how good the event makes it, and its lower bound; of its negation the other side."""

    sat: Steps
    limit: Steps


_Sides = tuple[_Side, _Side]


def causation(
    formula: Formula,
    before: DenseKnowledge | None,
    now: DenseKnowledge,
    tick: Fraction,
    parts: tuple[Parts, Parts] | None = None,
) -> StepCauses:
    """Return the causation of the last event from the start of the trace on; ``tick`` is seconds.

    ``before``: what was known before the event; None for the event with which the trace starts. ``parts``: the bounds
    of all parts before and after the event, by default those of what was known; what was known of an operation that
    turned out to have no value is narrower.

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> from rtamt.reference.dense_bounds import DenseKnowledge
    >>> first, both = (DenseKnowledge({"x": s}) for s in [([0], [4], [4]), ([0, 3], [4, 1], [4, 1])])
    >>> found = causation(parse_formula("x >= 3"), first, both, Fraction(1))
    >>> found.times, [cause.violation for cause in found.causes]
    ((0, 1, 3, 4), [inf, 1.0, -2.0, inf])
    """
    core = core_of(formula, tick, continuous=True).formula
    start = now.start
    assert start is not None
    limits = bounds_of_parts(formula, now, tick) if parts is None else by_part(formula, parts[1], tick)
    was: dict[Formula, StepBounds] | None = None
    found: dict[Formula, _Sides] = {}
    for node in _parts(core):
        operands = [found[each] for each in _operands(node)]
        if operands:
            found[node] = _of_operator(node, operands, limits[node], tick)
        elif at_one_instant(node):
            found[node] = _known_by(_new(node, before, now), limits[node])
        else:
            if was is None and parts is not None and before is not None:
                was = by_part(formula, parts[0], tick)
            elif was is None:
                was = bounds_of_parts(formula, _unseen(now) if before is None else before, tick)
            found[node] = _moved(limits[node], was[node])
    good, bad = found[core]
    times = sorted({t for steps in (good.sat, bad.sat, good.limit) for t in steps.times})
    return StepCauses(
        tuple(t // QUARTERS for t in times),
        tuple(Causation(-bad.sat.at(t), good.sat.at(t)) for t in times),
        tuple(good.limit.at(t) for t in times),
    )


def least(parts: Sequence[StepCauses]) -> StepCauses:
    """Return the causation of a minimum: at each instant over those that have begun, each with its first time."""
    times = sorted({t for part in parts for t in part.times})
    causes, lower = [], []
    for t in times:
        begun = [part for part in parts if part.times[0] <= t]
        lower.append(min(Steps(part.times, part.lower).at(t) for part in begun))
        each = [part.at(t) for part in begun]
        sat = min(max(cause.satisfaction for cause in each), lower[-1])
        causes.append(Causation(min(cause.violation for cause in each), sat))
    return StepCauses(tuple(times), tuple(causes), tuple(lower))


def _operands(node: Formula) -> tuple[Formula, ...]:
    """Return the parts of a formula, none of a predicate."""
    return node.args if isinstance(node, Apply) and connects(node) else ()


def _parts(core: Formula) -> list[Formula]:
    """Return the formula and its parts, operands first."""
    wanted = {core}
    for node in reversed(postorder(core)):
        if node in wanted:
            wanted.update(_operands(node))
    return [node for node in dict.fromkeys(postorder(core)) if node in wanted]


def _known_by(new: Steps, found: StepBounds) -> _Sides:
    """Return the sides of a predicate of one instant, which the event has made known where ``new`` is 1."""
    good, bad = (_Side(_where(limit, lambda t, _: new.at(t) > 0, new), limit) for limit in _limits(found))
    return good, bad


def _moved(found: StepBounds, was: StepBounds) -> _Sides:
    """Return the sides of a predicate of several instants, from its bounds and those before the event."""
    pairs = zip(_limits(found), _limits(was), strict=True)
    good, bad = (_Side(_increase(limit, old), limit) for limit, old in pairs)
    return good, bad


def _of_operator(node: Formula, operands: list[_Sides], found: StepBounds, tick: Fraction) -> _Sides:
    assert isinstance(node, Apply)
    if isinstance(node.op.kernel, Pointwise) and node.op.kernel.opcode == "neg":
        return operands[0][1], operands[0][0]
    limits, window = _limits(found), window_in_quarters(node, tick)
    good, bad = (
        _Side(_cause_of(node, side, [each[side] for each in operands], limits[side], window), limits[side])
        for side in (0, 1)
    )
    return good, bad


def _limits(found: StepBounds) -> tuple[Steps, Steps]:
    """Return the lower bounds, and the negated upper ones."""
    times = [t * QUARTERS for t in found.times]
    return merged(times, found.lower), merged(times, [-high for high in found.upper])


def _new(node: Formula, before: DenseKnowledge | None, now: DenseKnowledge) -> Steps:
    """Return where the event has made a variable of a predicate known: 1 there, 0 elsewhere."""
    start = now.start
    assert start is not None
    ranges = []
    for name in variables(node):
        first = start if before is None else max(start, before.until(name) + 1)
        ranges.append((first, None if now.finished else now.until(name) + 1))
    times = sorted({start, *(t for each in ranges for t in each if t is not None and t > start)})
    inside = [any(a <= t and (b is None or t < b) for a, b in ranges) for t in times]
    return merged([t * QUARTERS for t in times], map(float, inside))


def _unseen(now: DenseKnowledge) -> DenseKnowledge:
    """Return the bounds when the trace starts, before any sample."""
    start = now.start
    assert start is not None
    return DenseKnowledge({name: ([start], [-inf], [inf]) for name in now.samples})


def _where(limit: Steps, moved: Callable[[int, float], bool], *others: Steps) -> Steps:
    """Return a bound where the event has a part in it, and nothing elsewhere."""
    times = sorted({t for steps in (limit, *others) for t in steps.times})
    return merged(times, [limit.at(t) if moved(t, limit.at(t)) else NOTHING for t in times])


def _increase(limit: Steps, before: Steps) -> Steps:
    """Return a bound where the event has raised it, and nothing elsewhere."""
    return _where(limit, lambda t, value: value > before.at(t), before)


def _cause_of(
    node: Apply, side: int, operands: list[_Side], limit: Steps, window: tuple[int, int | None]
) -> Steps:
    """Return the causation of an operator on one side, from that of its operands."""
    kernel, sats = node.op.kernel, tuple(each.sat for each in operands)
    if isinstance(kernel, Until | Since):
        # On the other side, what is best for the formula is worst: each part of any alternative is enough.
        limits = [each.limit if side == 0 else Steps(each.limit.times[:1], (inf,)) for each in operands]
        at = since if isinstance(kernel, Since) else precedes if node.op.tense is Tense.PAST else until
        result = lifted(at, (sats[0], limits[0], sats[1], limits[1]), *window)
        all_together = side == 1
    elif isinstance(kernel, Window):
        at = dense_definitions.once if node.op.tense is Tense.PAST else dense_definitions.eventually
        result = lifted(at, sats, *window)
        all_together = (kernel.reduce == "min") == (side == 0)
    else:
        assert isinstance(kernel, Pointwise)
        result = _join(max, *sats)
        all_together = (kernel.opcode == "min") == (side == 0)
    return _join(min, result, limit) if all_together else result


def _join(operation: Callable[..., float], *operands: Steps) -> Steps:
    times = sorted({t for steps in operands for t in steps.times})
    return merged(times, [operation(*(steps.at(t) for steps in operands)) for t in times])


# ---- two operands in time: all of an alternative are as good as their bounds, and one because of the event ------


def _reached(begin: int, first: int, last: int | None, *operands: Steps) -> float:
    """Sup over t' ∈ [first, last] of the best cause among ψ(t') and φ over [begin, t'), cut to all their bounds."""
    sat_x, x, sat_y, y = operands
    best, held, caused = -inf, inf, -inf
    for u, interval in pieces(begin, last, operands, cut=first):
        if interval:  # part of the interval precedes each t' inside it
            held, caused = min(held, x.at(u)), max(caused, sat_x.at(u))
        if u >= first:
            best = max(best, min(y.at(u), held, max(caused, sat_y.at(u))))
        if not interval:
            held, caused = min(held, x.at(u)), max(caused, sat_x.at(u))
    return best


def until(t: int, *given: Any) -> float:
    """``φ until[a,b] ψ``: t' ∈ [t+a, t+b], and φ over [t, t')."""
    *operands, a, b = given
    return _reached(t, t + a, None if b is None else t + b, *operands)


def precedes(t: int, *given: Any) -> float:
    """``φ precedes[a,b] ψ``: t' ∈ [t-b+a, t], and φ over [t-b, t'), from t₀ on."""
    *operands, a, b = given
    start = operands[0].times[0]
    return _reached(max(t - b, start), max(t - b + a, start), t, *operands)


def since(t: int, *given: Any) -> float:
    """``φ since[a,b] ψ``: t' ∈ [t-b, t-a] ∩ [t₀, ∞), and φ over (t', t]."""
    sat_x, x, sat_y, y, a, b = given
    start = x.times[0]
    best, held, caused = -inf, inf, -inf
    begin = start if b is None else max(t - b, start)
    for u, interval in reversed(pieces(begin, t, (sat_x, x, sat_y, y), cut=t - a)):
        if interval:  # part of the interval follows each t' inside it
            held, caused = min(held, x.at(u)), max(caused, sat_x.at(u))
        if u <= t - a:
            best = max(best, min(y.at(u), held, max(caused, sat_y.at(u))))
        if not interval:
            held, caused = min(held, x.at(u)), max(caused, sat_x.at(u))
    return best
