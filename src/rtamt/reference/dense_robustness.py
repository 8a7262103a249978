"""The definition, executed in dense time: formula and step functions to robustness, slowly and plainly.

This is the reference for the dense engine and the Python back end. Bottom-up over the formula, every
operator in time is evaluated by its ``dense`` definition on the refined set of critical instants and the
open intervals between them, every other one value by value; it shares nothing with the engine but the
formula. Online, :class:`DenseReferenceMonitor` keeps the whole trace and evaluates it again.

It trusts its caller: times of a signal strictly increase, bounds are whole numbers of ticks, inputs hold
no NaN.
"""

from __future__ import annotations

from math import isnan

from rtamt.errors import UsageError
from rtamt.language.definitions.dense import QUARTERS, Steps, merged
from rtamt.language.formula import Apply, Const, Formula, Var, children, fold, postorder
from rtamt.language.operators import Bounds, Tense
from rtamt.language.undefined_value import UndefinedAtTickError
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any, TypeAlias
from rtamt.reference.definition_adapter import check_dense_meaning, signal_of, window_in_quarters
from rtamt.rewrite.check import check_dense
from rtamt.rewrite.desugar import spelled_out
from rtamt.rewrite.ground import ground
from rtamt.rewrite.horizon import horizons
from rtamt.rewrite.truth import rebuilt

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    Events: TypeAlias = tuple[Sequence[int] | NDArray[np.int64], Sequence[float] | NDArray[np.float64]]
    # Of each sub-formula, by identity, the last instant at which its value must exist; None: always.
    Limits: TypeAlias = Mapping[int, int | None]


class StepFunction(NamedTuple):
    """A signal: from each of ``times`` (ticks, strictly increasing) up to the next it has that value.

    Both arrays have shape (m,). Neighbouring values differ.
    """

    times: NDArray[np.int64]
    values: NDArray[np.float64]


class Known(NamedTuple):
    """The new values of one output.

    ``times`` and ``values``, both of shape (m,), are its changes after the last instant that was known
    before, up to and including ``until``; the very first is at t₀. ``until``, in ticks, is the last
    instant at which the output is known by now, None while there is none.
    """

    times: NDArray[np.int64]
    values: NDArray[np.float64]
    until: int | None


def evaluate(formula: Formula, signals: Mapping[str, Events], tick: Fraction) -> StepFunction:
    """Return the robustness of a formula at every instant of the trace: SEMANTICS' table, literally.

    ``signals`` maps each variable, at least one, to its times (whole ticks, shape (m,), m ≥ 1) and its
    values, shape (m,), each held until the next, the last for ever. ``tick`` is seconds. The result spans
    [t₀, tₙ], from the latest first time to the latest last time; its first event is at t₀.

    Raises :class:`EvaluationError` if an operation has no value (0/0, the root of a negative
    number, inf - inf), wherever in the formula that is, at any instant that the result can depend on.
    Raises :class:`SpecificationError` at an operator that only discrete time has.

    >>> from fractions import Fraction
    >>> from rtamt.reference.dense_robustness import evaluate
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> lately = parse_formula("once[1:2] x")
    >>> evaluate(lately, {"x": ([0, 20, 30, 60], [0.0, 6.0, 0.0, 0.0])}, Fraction(1, 10))
    StepFunction(times=array([ 0, 10, 30, 50]), values=array([-inf,   0.,   6.,   0.]))
    """
    formula = _with_dense_meaning(formula, tick)
    trace = _Trace.of(signals, tick)
    steps = _evaluate(formula, trace, last_read(formula, trace.last, tick))
    return _changes(steps, None, trace.last)


class DenseReferenceMonitor:
    """Online monitor with the interface of the core's: events in, newly known events out.

    ``formulas`` are the outputs, of bounded future; ``inputs`` the variables, at least one: a formula
    without variables lives as long as they do. ``tick`` is seconds.

    >>> from fractions import Fraction
    >>> from rtamt.reference.dense_robustness import DenseReferenceMonitor
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> monitor = DenseReferenceMonitor([parse_formula("eventually[0:2] x")], ("x",), Fraction(1))
    >>> monitor.push({"x": ([0, 5], [1.0, 3.0])})
    [Known(times=array([0, 3]), values=array([1., 3.]), until=3)]
    >>> monitor.finish()
    [Known(times=array([], dtype=int64), values=array([], dtype=float64), until=5)]
    """

    def __init__(self, formulas: Sequence[Formula], inputs: Sequence[str], tick: Fraction) -> None:
        self._formulas = [_with_dense_meaning(formula, tick) for formula in formulas]
        self._inputs = tuple(inputs)
        self._tick = tick
        self._depths = [_depths(formula, tick) for formula in self._formulas]
        self.reset()

    @property
    def state_bytes(self) -> int:
        """Bytes of signal kept; grows with the trace."""
        return sum(16 * len(times) for times, _ in self._kept.values())

    def reset(self) -> None:
        """Forget the trace."""
        self._kept: dict[str, tuple[list[int], list[float]]] = {}
        self._until: list[int | None] = [None for _ in self._formulas]
        self._finished = False

    @property
    def kept(self) -> Mapping[str, Events]:
        """The trace so far; never changed in place."""
        return self._kept

    def state(self) -> tuple[Any, ...]:
        """Return the state after the samples so far; none of it is ever changed in place."""
        return self._kept, self._until, self._finished

    def restore(self, state: tuple[Any, ...]) -> None:
        """Restore the state of a monitor that was made with the same arguments."""
        self._kept, self._until, self._finished = state

    def push(self, chunks: Mapping[str, Events]) -> list[Known]:
        """Take new events of some variables, each later than all previous ones of its variable.

        Returns for every output what became known: with K the earliest last time over all variables,
        the output is known up to and including K - H(φ), and nowhere while a variable has not appeared.
        Raises :class:`EvaluationError` as :func:`evaluate` does; the monitor is then as it was.
        """
        if self._finished:
            raise UsageError(
                "the trace is finished and takes no more samples; call reset() to begin a new one"
            )
        kept = dict(self._kept)
        for name, (times, values) in chunks.items():
            if len(times):
                old_times, old_values = kept.get(name, ([], []))
                kept[name] = ([*old_times, *map(int, times)], [*old_values, *map(float, values)])
        known, until = self._news(kept, final=False)
        self._kept, self._until = kept, until
        return known

    def finish(self) -> list[Known]:
        """Finish: return the rest of every output, up to the latest time of any variable.

        After this the monitor takes no more events until :meth:`reset`. If a variable never appeared there
        is no trace and nothing is known.
        """
        known, until = self._news(self._kept, final=True)
        self._until = until
        self._finished = True
        return known

    def _news(
        self, kept: Mapping[str, tuple[list[int], list[float]]], *, final: bool
    ) -> tuple[list[Known], list[int | None]]:
        """Evaluate what is kept; return what was not known before, and how far each output is known now."""
        nothing = Steps((), ())
        if len(kept) < len(self._inputs):
            return [Known(*_changes(nothing, None, 0), until) for until in self._until], self._until
        trace = _Trace.of(kept, self._tick)
        complete = min(times[-1] for times, _ in kept.values()) * QUARTERS
        known, untils = [], []
        for formula, depths, before in zip(self._formulas, self._depths, self._until, strict=True):
            limits: Limits
            if final:
                limits, end = last_read(formula, trace.last, self._tick), trace.last
            else:
                limits = {node: complete - depth for node, depth in depths.items()}
                end = complete - depths[id(formula)]
            steps = _evaluate(formula, trace, limits)
            until = before if end < trace.start else end // QUARTERS
            untils.append(until)
            news = nothing if until is None else steps
            known.append(Known(*_changes(news, before, end), until))
        return known, untils


class _Trace(NamedTuple):
    """All signals from the latest first time on, in quarters of a tick."""

    signals: Mapping[str, Steps]
    start: int
    last: int
    tick: Fraction

    @classmethod
    def of(cls, signals: Mapping[str, Events], tick: Fraction) -> _Trace:
        start = max(int(times[0]) for times, _ in signals.values()) * QUARTERS
        last = max(int(times[-1]) for times, _ in signals.values()) * QUARTERS
        steps = {}
        for name, (times, values) in signals.items():
            whole = Steps(tuple(int(t) * QUARTERS for t in times), tuple(float(v) for v in values))
            later = [(t, v) for t, v in zip(*whole, strict=True) if t > start]
            steps[name] = merged([start, *(t for t, _ in later)], [whole.at(start), *(v for _, v in later)])
        return cls(steps, start, last, tick)

    def seconds(self, t: int) -> float:
        return float(t * self.tick / QUARTERS)


def _changes(steps: Steps, after: int | None, last: int) -> StepFunction:
    """Return the events with ``after`` < time ≤ ``last``, the first in ticks and the second in quarters."""
    times: list[int] = []
    values: list[float] = []
    for time, value in zip(*steps, strict=True):
        if time <= last and (not values or value != values[-1]):
            times.append(time // QUARTERS)
            values.append(value)
    begin = 0 if after is None else sum(time <= after for time in times)
    return StepFunction(np.array(times[begin:], np.int64), np.array(values[begin:], np.float64))


def _evaluate(formula: Formula, trace: _Trace, limits: Limits) -> Steps:
    """Fold the definitions over the formula; a NaN in a sub-formula no later than its limit is an error."""

    def step(node: Formula, below: tuple[Steps, ...]) -> Steps:
        value = _apply(node, below, trace)
        limit = limits[id(node)]
        for time, v in zip(*value, strict=True):
            if isnan(v) and (limit is None or time <= limit):
                raise UndefinedAtTickError(node, time // QUARTERS, trace.seconds(time))
        return value

    # Later than the limits NaN may meet any operator, and none of it is reported.
    with np.errstate(all="ignore"):
        return fold(formula, step)


def _apply(node: Formula, below: tuple[Steps, ...], trace: _Trace) -> Steps:
    """Return one sub-formula's values from those of its operands."""
    if isinstance(node, Const):
        return Steps((trace.start,), (node.value,))
    if isinstance(node, Var):
        return trace.signals[node.name]
    if not isinstance(node, Apply):
        raise TypeError(f"not a formula: {node!r}")
    operands = below or (Steps((trace.start,), (0.0,)),)
    return signal_of(node, operands, *window_in_quarters(node, trace.tick), trace.tick)


def _with_dense_meaning(formula: Formula, tick: Fraction) -> Formula:
    """Replace the temporal operators that dense time defines only by their expansions (custom ones)."""
    check_dense(formula)
    formula = spelled_out(ground(formula, tick, continuous=True))

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        node = rebuilt(node, args)
        if node.op.tense is Tense.NONE or node.op.dense is not None:
            return node
        if node.op.expansion is None:
            check_dense_meaning(node.op)
            return node
        return _with_dense_meaning(node.op.expansion(*args, node.interval), tick)

    return fold(formula, step)


def _ahead(node: Formula, tick: Fraction) -> int | None:
    """Return how far ahead an operator itself reads its operands, in quarters of a tick; None: unboundedly."""
    if not isinstance(node, Apply) or node.op.tense is not Tense.FUTURE or node.op.bounds is Bounds.NONE:
        return 0
    return window_in_quarters(node, tick)[1]


def last_read(formula: Formula, last: int, tick: Fraction) -> Limits:
    """Return, by identity of each sub-formula, how far values up to ``last`` of the whole formula read it."""
    limits: dict[int, int | None] = {id(formula): last}
    for node in reversed(postorder(formula)):  # readers of a node precede it
        limit, ahead = limits[id(node)], _ahead(node, tick)
        reach = None if limit is None or ahead is None else limit + ahead
        for operand in children(node):
            other = limits.get(id(operand), last)
            limits[id(operand)] = None if reach is None or other is None else max(reach, other)
    return limits


def _depths(formula: Formula, tick: Fraction) -> dict[int, int]:
    """Return, by identity of each sub-formula, its horizon in quarters of a tick."""
    depths = {}
    for node, depth in horizons(formula, tick).items():
        assert depth is not None, "unbounded future is refused before"
        depths[node] = int(depth / tick) * QUARTERS
    return depths
