"""Every operator, in both time domains and under every semantics, by quantifiers over single instants.

Written from the semantics alone, an entry an operator, so that it shares nothing with the definitions
that the library carries but the parser: the conformance corpus is derived a second time with it.

A signal is a list. In discrete time entry k is the value at sample k. In dense time it is the value on
the cell [k, k+1), counted in ticks from the start of the trace: times and bounds are whole ticks and
robustness is continuous from the right, so nothing ever changes inside a cell. The list of cells is so
long that at its end all has settled; its last entry stands for the rest of time.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, Var, fold, postorder
from tests.oracle import over_time
from tests.oracle.arithmetic import COMPARISONS, NUMBERS

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Mapping, Sequence
    from fractions import Fraction

    Values = list[Any]  # floats, or Booleans

inf = math.inf


class NoValueError(Exception):
    """An operation has no value: 0/0, the root of a negative number, inf - inf."""


class Algebra(NamedTuple):
    """What takes part in min and max: robustness or truth."""

    bottom: Any
    top: Any
    negate: Callable[[Any], Any]


ROBUSTNESS = Algebra(-inf, inf, lambda v: -v)
TRUTH = Algebra(bottom=False, top=True, negate=lambda v: not v)


# ---- formulas of one instant --------------------------------------------------------------------

POINTWISE: dict[str, Callable[..., Any]] = {
    "not": lambda alg, p: alg.negate(p),
    "and": lambda _alg, p, q: min(p, q),
    "or": lambda _alg, p, q: max(p, q),
    "implies": lambda alg, p, q: max(alg.negate(p), q),
    "iff": lambda alg, p, q: min(max(alg.negate(p), q), max(p, alg.negate(q))),
    "xor": lambda alg, p, q: max(min(p, alg.negate(q)), min(alg.negate(p), q)),
}


# ---- formulas in discrete time: t, u are samples, windows are cut to the trace ---------------------


def _window(p: Values, first: int, last: float) -> Values:
    return [p[u] for u in range(len(p)) if first <= u <= last]


def _until(alg: Algebra, p: Values, q: Values, t: int, a: int, b: float, start: int | None = None) -> Any:
    """Return sup over u in [start + a, start + b] of min(q(u), inf of p over [start, u))."""
    begin = t if start is None else start
    return max(
        (
            min([q[u], *_window(p, begin, u - 1)])
            for u in range(len(q))
            if begin + a <= u <= begin + b and (start is None or u <= t)
        ),
        default=alg.bottom,
    )


def _since(alg: Algebra, p: Values, q: Values, t: int, a: int, b: float) -> Any:
    return max(
        (min([q[u], *_window(p, u + 1, t)]) for u in range(len(q)) if t - b <= u <= t - a), default=alg.bottom
    )


def _sample(p: Values, t: int, outside: Any) -> Any:
    return p[t] if 0 <= t < len(p) else outside


DISCRETE: dict[str, Callable[..., Any]] = {
    "always": lambda alg, p, t, a, b: min(_window(p, t + a, t + b), default=alg.top),
    "eventually": lambda alg, p, t, a, b: max(_window(p, t + a, t + b), default=alg.bottom),
    "historically": lambda alg, p, t, a, b: min(_window(p, t - b, t - a), default=alg.top),
    "once": lambda alg, p, t, a, b: max(_window(p, t - b, t - a), default=alg.bottom),
    "until": _until,
    "since": _since,
    "precedes": lambda alg, p, q, t, a, b: _until(alg, p, q, t, a, b, t - b),
    "unless": lambda alg, p, q, t, a, b: max(
        min(_window(p, t, t + b), default=alg.top), _until(alg, p, q, t, a, b)
    ),
    "prev": lambda alg, p, t, _a, _b: _sample(p, t - 1, alg.top),
    "next": lambda alg, p, t, _a, _b: _sample(p, t + 1, alg.top),
    "s_prev": lambda alg, p, t, _a, _b: _sample(p, t - 1, alg.bottom),
    "s_next": lambda alg, p, t, _a, _b: _sample(p, t + 1, alg.bottom),
    "rise": lambda alg, p, t, _a, _b: min(_sample([alg.negate(v) for v in p], t - 1, alg.top), p[t]),
    "fall": lambda alg, p, t, _a, _b: min(_sample(p, t - 1, alg.top), alg.negate(p[t])),
}

EDGES = {name: DISCRETE[name] for name in ("rise", "fall")}

# ---- formulas in dense time: k, j are cells, t is any instant inside cell k ---------------------------


def _cells(p: Values, first: float, last: float) -> Values:
    """Return what a signal is on cells ``first`` to ``last``, those before the trace left out."""
    end = len(p) - 1
    return [p[j] for j in range(int(min(max(first, 0), end)), int(min(last, end)) + 1)] if last >= 0 else []


def _dense_until(alg: Algebra, p: Values, q: Values, begin: int, a: int, last: float) -> Any:
    """Return sup over t' from a after s up to cell ``last`` of min(q(t'), inf of p over [s, t')).

    s is an instant inside cell ``begin``, which may lie before the trace.
    """
    first, end = begin + a, len(q) - 1
    best = alg.bottom
    for j in range(max(first, 0), int(min(last, max(end, first))) + 1):
        # Of a later cell t' is best as the first instant; in the first cell t' = s + a is inside it.
        held = _cells(p, begin, j - 1) if j > first else _cells(p, begin, j) if a > 0 else []
        best = max(best, min([*_cells(q, j, j), *held]))
    return best


def _dense_since(alg: Algebra, p: Values, q: Values, k: int, a: int, b: float) -> Any:
    best = alg.bottom
    for j in range(int(max(k - b, 0)), k - a + 1):
        # t' < t leaves a part of its own cell between them; t' = t leaves nothing.
        best = max(best, q[j] if j == k else min(q[j], *_cells(p, j, k)))
    return best


DENSE: dict[str, Callable[..., Any]] = {
    "always": lambda _alg, p, k, a, b: min(_cells(p, k + a, k + b)),
    "eventually": lambda _alg, p, k, a, b: max(_cells(p, k + a, k + b)),
    "historically": lambda alg, p, k, a, b: min(_cells(p, k - b, k - a), default=alg.top),
    "once": lambda alg, p, k, a, b: max(_cells(p, k - b, k - a), default=alg.bottom),
    "until": lambda alg, p, q, k, a, b: _dense_until(alg, p, q, k, a, k + b),
    "since": _dense_since,
    "precedes": lambda alg, p, q, k, a, b: _dense_until(alg, p, q, k - b, a, k),
    "unless": lambda alg, p, q, k, a, b: max(min(_cells(p, k, k + b)), _dense_until(alg, p, q, k, a, k + b)),
    # A pulse of one tick: what was so a tick ago is what is so in the cell before.
    **EDGES,
}

ATOMS = {"true": True, "false": False}

# Numbers over time, each with the formula of the same window.
AGGREGATES = {"minimum": "historically", "maximum": "once"}

SHARES = {"atleast", "wasatleast"}

COVERED = {
    *NUMBERS,
    *COMPARISONS,
    *POINTWISE,
    *DISCRETE,
    *ATOMS,
    *AGGREGATES,
    *SHARES,
    *over_time.NUMBERS,
}

# ---- semantics: (U, V), of which change is measured and which are fixed ------------------------------

RELATIVE = {
    "output_robustness": ({"output"}, {"input"}),
    "input_vacuity": ({"input"}, set()),
    "input_robustness": ({"input"}, {"output"}),
    "output_vacuity": ({"output"}, set()),
}


def discrete(
    formula: Formula,
    columns: Mapping[str, Sequence[float]],
    n: int,
    period: Fraction,
    semantics: str = "standard",
    inputs: Collection[str] = (),
) -> Values:
    """Return the answer at every sample: floats, Booleans under the semantics ``boolean``."""
    signals = {name: list(map(float, column)) for name, column in columns.items()}
    return _evaluate(formula, signals, n, period, DISCRETE, semantics, inputs)


def dense(
    formula: Formula,
    signals: Mapping[str, Sequence[tuple[int, float]]],
    tick: Fraction,
    semantics: str = "standard",
    inputs: Collection[str] = (),
) -> tuple[int, Values]:
    """Return the first tick of the trace and the answer on each cell, from there to the last tick."""
    start = max(samples[0][0] for samples in signals.values())
    last = max(samples[-1][0] for samples in signals.values())
    size = last - start + 2 + sum(_longest(node, tick) for node in postorder(formula))
    cells = {
        name: [[v for t, v in samples if t <= start + k][-1] for k in range(size)]
        for name, samples in signals.items()
    }
    return start, _evaluate(formula, cells, size, tick, DENSE, semantics, inputs)[: last - start + 1]


def horizon(formula: Formula, step: Fraction) -> int | None:
    """Return how many samples or ticks after an instant its answer is known; None if never before the end."""

    def depth(node: Formula, below: tuple[int | None, ...]) -> int | None:
        if None in below:
            return None
        deepest = max((d for d in below if d is not None), default=0)
        if isinstance(node, Apply) and node.op.name in (
            "always",
            "eventually",
            "until",
            "unless",
            "ahead",
            *SHARES,
        ):
            end = over_time.window_of(node.interval, step)[1]
            if node.op.name == "ahead" and node.interval is None:
                end = 1
            if node.op.name == "wasatleast":
                end = 0
            return None if math.isinf(end) else int(end) + deepest
        return deepest + (isinstance(node, Apply) and node.op.name in ("next", "s_next"))

    return fold(formula, depth)


def _longest(node: Formula, tick: Fraction) -> int:
    if not isinstance(node, Apply) or node.interval is None:
        return 0
    last = node.interval.begin if node.interval.end is None else node.interval.end
    return int(last / tick)


def _evaluate(
    formula: Formula,
    signals: Mapping[str, Values],
    size: int,
    step: Fraction,
    in_time: Mapping[str, Callable[..., Any]],
    semantics: str,
    inputs: Collection[str],
) -> Values:
    alg = TRUTH if semantics == "boolean" else ROBUSTNESS

    dense = in_time is DENSE

    def truth(node: Formula) -> Values:
        return _evaluate(node, signals, size, step, in_time, "boolean", inputs)

    def window_of(node: Apply) -> over_time.Time:
        return over_time.Time(step, dense, *over_time.window_of(node.interval, step), node.interval)

    def apply(alg: Algebra, node: Apply, below: list[Values]) -> Values:
        """Return the values of an operator that makes a formula out of formulas."""
        name = node.op.name
        if name in ATOMS:
            return [alg.top if ATOMS[name] else alg.bottom] * size
        if name in POINTWISE:
            return [POINTWISE[name](alg, *values) for values in zip(*below, strict=True)]
        time = window_of(node)
        if name in SHARES:
            (values,) = below
            past = name == "wasatleast"
            return [over_time.share_at(time, values, t, alg.bottom, alg.top, past=past) for t in range(size)]
        return [in_time[AGGREGATES.get(name, name)](alg, *below, t, time.a, time.b) for t in range(size)]

    def over(node: Apply, below: Sequence[tuple[Values, Values]]) -> Values:
        """Return the values of a number over time; its conditions are read by their truth."""
        conditions = over_time.CONDITIONS.get(node.op.name, ())
        operands = [truth(arg) if k in conditions else below[k][0] for k, arg in enumerate(node.args)]
        return over_time.NUMBERS[node.op.name](window_of(node), *operands)

    known: dict[int, tuple[Values, Values]] = {}

    def evaluate(node: Formula) -> tuple[Values, Values]:
        """Return the values of a node read as a number, and read as a formula."""
        if id(node) not in known:
            known[id(node)] = computed(node)
        return known[id(node)]

    def computed(node: Formula) -> tuple[Values, Values]:
        if isinstance(node, Const):
            number = [node.value] * size
            return number, _apply_semantics(node, [], number, semantics, inputs)
        if isinstance(node, Var):
            return signals[node.name], _apply_semantics(node, [], signals[node.name], semantics, inputs)
        assert isinstance(node, Apply)
        name = node.op.name
        # A condition may have a truth where its robustness has no value, inf - inf.
        conditions = over_time.CONDITIONS.get(name, ())
        below = [([], []) if k in conditions else evaluate(arg) for k, arg in enumerate(node.args)]
        operands = [number for number, _ in below]
        pointwise = COMPARISONS[name][0] if name in COMPARISONS else NUMBERS.get(name)
        if name in over_time.NUMBERS:
            number = _defined(node, over(node, below))
        elif name in AGGREGATES:
            number = apply(ROBUSTNESS, node, operands)
        elif pointwise is None:
            formulas = [as_formula for _, as_formula in below]
            return apply(ROBUSTNESS, node, operands), apply(alg, node, formulas)
        else:
            number = [pointwise(*values) for values in zip(*operands, strict=True)]
        if name in NUMBERS:
            _defined(node, number)
        return number, _apply_semantics(node, operands, number, semantics, inputs)

    return evaluate(formula)[1]


def _defined(node: Formula, values: Values) -> Values:
    if any(map(math.isnan, values)):
        raise NoValueError(str(node))
    return values


def _apply_semantics(
    node: Formula, operands: list[Values], number: Values, semantics: str, inputs: Collection[str]
) -> Values:
    """Return what a predicate, a comparison or a number that stands for a formula, is worth."""
    if semantics == "standard":
        return _defined(node, number)
    if isinstance(node, Apply) and node.op.name in COMPARISONS:
        truth = [COMPARISONS[node.op.name][1](*values) for values in zip(*operands, strict=True)]
    else:
        truth = [v > 0 for v in number]
    if semantics == "boolean":
        return truth
    measured, fixed = RELATIVE[semantics]
    read = {"input" if name in inputs else "output" for name in variables(node)}
    if not read <= measured | fixed:
        return [0.0] * len(number)
    # A difference that has no value, inf - inf, is missed only where it is the answer.
    return [inf if holds else -inf for holds in truth] if read <= fixed else _defined(node, number)
