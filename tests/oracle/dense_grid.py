"""Truth and robustness in dense time by brute force: every tick, and every gap between two ticks.

Times and bounds of the tests are small whole numbers of ticks, so that nothing ever changes inside a
gap. A signal is a list: entry 2k is its value at tick k after the start of the trace, entry 2k+1 its
value on the open interval from tick k to the next. The list is so long that at its end all has settled:
its last entry stands for the rest of time. Written by hand, an entry an operator, and for truth and
robustness alike (``or`` is max of False and True), it shares no line with the definitions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.language.formula import Apply, Const, Formula, Var, fold, postorder
from rtamt.language.operators import Bounds, Sort
from tests.oracle import over_time
from tests.oracle.boolean import ATOMS, COMPARISONS, POINTWISE
from tests.oracle.interface import is_predicate

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from fractions import Fraction

    Gapped = list[Any]  # floats, or Booleans

BOTTOM, TOP = float("-inf"), float("inf")


def _held(p: Gapped, begin: int, t: int, *, closed: bool) -> Any:
    """The smallest of φ from ``begin`` up to t; an interval t other than ``begin`` is begun by then."""
    inside = p[begin:t] if not closed and t % 2 == 0 else p[begin : t + 1]
    return min(inside, default=TOP)


def _reached(p: Gapped, q: Gapped, begin: int, first: int, last: int) -> Any:
    end = len(p) - 1
    best: Any = BOTTOM
    for u in range(min(first, end), min(last, end) + 1):
        # With u = begin, t' = t comes before the rest of that instant's interval, if it is in the window.
        held = TOP if u == begin and first <= begin else _held(p, begin, u, closed=False)
        best = max(best, min(q[u], held))
    return best


def _ahead(p: Gapped, t: int, a: int, b: int) -> Gapped:
    end = len(p) - 1
    return p[min(t + a, end) : min(t + b, end) + 1]


def _behind(p: Gapped, t: int, a: int, b: int) -> Gapped:
    return p[max(t - b, 0) : max(t - a + 1, 0)]


def _until(p: Gapped, q: Gapped, t: int, a: int, b: int) -> Any:
    return _reached(p, q, t, t + a, t + b)


def _since(p: Gapped, q: Gapped, t: int, a: int, b: int) -> Any:
    best: Any = BOTTOM
    for u in range(max(t - b, 0), t - a + 1):
        after = u if u % 2 == 1 else u + 1
        held = TOP if u == t and a == 0 else _held(p, after, t, closed=True)
        best = max(best, min(q[u], held))
    return best


def _precedes(p: Gapped, q: Gapped, t: int, a: int, b: int) -> Any:
    begin = max(t - b, 0)
    return _reached(p, q, begin, max(t - b + a, 0), t)


IN_TIME: dict[str, Callable[..., Any]] = {
    "always": lambda p, t, a, b: min(_ahead(p, t, a, b)),
    "eventually": lambda p, t, a, b: max(_ahead(p, t, a, b)),
    "historically": lambda p, t, a, b: min(_behind(p, t, a, b), default=TOP),
    "once": lambda p, t, a, b: max(_behind(p, t, a, b), default=BOTTOM),
    "minimum": lambda p, t, a, b: min(_behind(p, t, a, b), default=TOP),
    "maximum": lambda p, t, a, b: max(_behind(p, t, a, b), default=BOTTOM),
    "until": _until,
    "since": _since,
    "precedes": _precedes,
    "unless": lambda p, q, t, a, b: max(min(_ahead(p, t, 0, b)), _until(p, q, t, a, b)),
}

SHARES = {"atleast", "wasatleast"}
EDGES = {"rise", "fall"}


def on_grid(
    formula: Formula,
    signals: Mapping[str, Any],
    tick: Fraction,
    *,
    truth: bool,
    case: Callable[[Formula], str] | None = None,
) -> tuple[int, Gapped]:
    """Return the first tick and, from there to the last, the value at each tick and in each gap.

    With ``truth`` a formula is satisfied or not, and a number is satisfied where it is positive. With
    ``case`` a predicate is worth 0 (``"zero"``), its truth, +inf or -inf, or its ordinary value.
    """
    start = max(int(times[0]) for times, _ in signals.values())
    last = max(int(times[-1]) for times, _ in signals.values())
    size = 2 * (last - start + 1) + 2 * sum(_longest(node, tick) for node in postorder(formula))
    numbers: dict[int, Gapped] = {}

    def number(node: Formula, below: tuple[Gapped, ...]) -> Gapped:
        if isinstance(node, Var):
            times, values = signals[node.name]
            at = [max(i for i, s in enumerate(times) if s <= start + k) for k in range(size // 2)]
            value: Gapped = [float(values[i]) for i in at for _ in range(2)]
        elif isinstance(node, Const):
            value = [node.value] * size
        else:
            assert isinstance(node, Apply)
            conditions = over_time.CONDITIONS.get(node.op.name, ())
            operands = tuple(fold(node.args[k], holds) if k in conditions else p for k, p in enumerate(below))
            value = _in_time(node, operands, tick) or _by_definition(node, operands, size)
        numbers[id(node)] = value
        return value

    def holds(node: Formula, below: tuple[Gapped, ...]) -> Gapped:
        if not isinstance(node, Apply) or node.op.result is Sort.NUMBER:
            return [v > 0 for v in numbers[id(node)]]
        name = node.op.name
        if name in COMPARISONS:
            operands = zip(*(numbers[id(operand)] for operand in node.args), strict=True)
            return [COMPARISONS[name](*values) for values in operands]
        if name in POINTWISE:
            return [POINTWISE[name](*values) for values in zip(*below, strict=True)]
        if name in ATOMS:
            return [ATOMS[name]] * size
        return [v > 0 for v in _in_time(node, below, tick)]

    def apply_semantics(node: Formula, below: tuple[Gapped, ...]) -> Gapped:
        assert case is not None
        if is_predicate(node):
            which = case(node)
            if which == "truth":
                return [TOP if v else BOTTOM for v in holds(node, ())]
            return [0.0] * size if which == "zero" else numbers[id(node)]
        assert isinstance(node, Apply)
        return _in_time(node, below, tick) or _by_definition(node, below, size)

    value = fold(formula, number)
    if truth:
        value = fold(formula, holds)
    if case is not None:
        value = fold(formula, apply_semantics)
    return start, value[: 2 * (last - start) + 1]


def _in_time(node: Apply, below: tuple[Gapped, ...], tick: Fraction) -> Gapped:
    """The values of an operator in time, [] of another; right-continuous by convention."""
    name = node.op.name
    size = len(below[0]) if below else 0
    begin, end = over_time.window_of(node.interval, tick)
    time = over_time.Time(tick, True, begin, end, node.interval)
    if name in over_time.NUMBERS:
        values = over_time.NUMBERS[name](time, *(p[1::2] for p in below))
    elif name in SHARES:
        cells, past = below[0][1::2], name == "wasatleast"
        bottom, top = (False, True) if isinstance(cells[0], bool) else (BOTTOM, TOP)
        values = [over_time.share_at(time, cells, t, bottom, top, past=past) for t in range(size // 2)]
    elif name in EDGES:
        values = [_edge(name, below[0], t) for t in range(1, size, 2)]
    elif name in IN_TIME:
        # An unbounded window reaches past the end of the list in any case.
        window = (2 * begin, max(2 * begin, size if end == TOP else 2 * int(end)))
        values = [IN_TIME[name](*below, t, *window) for t in range(1, size, 2)]
    else:
        return []
    return [v for v in values for _ in range(2)]


def _edge(name: str, p: Gapped, t: int) -> Any:
    """A pulse of one tick where φ begins or ends to hold; before the trace it was otherwise."""
    truth = isinstance(p[t], bool)
    now = p[t] if name == "rise" else _not(p[t])
    if t < 2:
        return now
    before = _not(p[t - 2]) if name == "rise" else p[t - 2]
    return now and before if truth else min(now, before)


def _not(value: Any) -> Any:
    return not value if isinstance(value, bool) else -value


def _by_definition(node: Apply, below: tuple[Gapped, ...], size: int) -> Gapped:
    with np.errstate(all="ignore"):
        columns = [np.array(p, float) for p in below]
        values: Gapped = node.op.definition(*(columns or (size,))).tolist()
    return values


def _longest(node: Formula, tick: Fraction) -> int:
    if not isinstance(node, Apply) or node.op.bounds is Bounds.NONE or node.interval is None:
        return 0
    last = node.interval.begin if node.interval.end is None else node.interval.end
    return int(last / tick)
