"""An operator of which only the definition is known, in the shape in which the core calls operators.

:class:`DefinedSamples` and :class:`DefinedEvents` are to an operator with a definition what a user's own
classes are to one that was made fast (docs/how-to/extend.md): they keep the stretch of the operands that
the definition reads, and apply it to that again.
"""

from __future__ import annotations

import copy
from functools import partial

from rtamt.errors import EvaluationError, StlError, UsageError
from rtamt.language.definitions.dense import QUARTERS, Steps, lifted, merged
from rtamt.language.operators import Bounds, Tense
from rtamt.language.printing.printer import excerpt
from rtamt.language.shares import rank_arguments
from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    from rtamt.language.formula import Apply
    from rtamt.language.operators import Operator

    Array = NDArray[np.float64]
    Events = tuple[NDArray[np.int64], Array]


def values_of(node: Apply, operands: Sequence[Array], n: int, bounds: tuple[Any, ...], what: str) -> Array:
    """Apply an operator's definition to arrays of ``n`` values; ``what`` they are: a sample or an instant."""
    op = node.op
    assert op.definition is not None, "expanded before"
    try:
        values = numbers_of(node, op.definition(*(operands if op.operands else (n,)), *bounds))
    except StlError:
        raise
    except Exception as error:
        raise raised(node, error) from error
    if values.shape != (n,):
        raise UsageError(
            f"the definition of '{op.name}' returned an array of shape {values.shape} for {n} {what}s; "
            f"it must return one value {'a' if what == 'sample' else 'an'} {what}, shape ({n},)"
        )
    return values


def numbers_of(node: Apply, given: Any) -> Array:
    """Return the result of an operator's own code as doubles; numpy would drop imaginary parts and read text."""
    values = np.asarray(given)
    if values.dtype.kind not in "fiubO":
        raise EvaluationError(
            f"the operator '{node.op.name}' gave values of type {values.dtype} in '{excerpt(node)}', "
            f"expected real numbers; mend the operator"
        )
    return values.astype(np.float64)


def raised(node: Apply, error: Exception) -> EvaluationError:
    """Return the error for an operator whose own code raised one."""
    return EvaluationError(
        f"the operator '{node.op.name}' failed in '{excerpt(node)}': {type(error).__name__}: {error}; mend the operator"
    )


def check_dense_meaning(op: Operator) -> None:
    """Raise :class:`UsageError` for an operator that has a meaning in discrete time only."""
    if op.dense is None and op.tense is not Tense.NONE:
        raise UsageError(
            f"'{op.name}' has no meaning in dense time; give its record a dense definition "
            f"(dense=...) or an expansion, or use discrete time"
        )


def behind(node: Apply, end: int | None) -> int | None:
    """Return the number of steps that an operator reads behind the present one; None: all of them."""
    op = node.op
    if op.tense is not Tense.PAST:
        return 0
    if len(node.args) < len(op.operands):
        return None  # the default of an operand that is left out is a value at the start
    reach = op.reach if op.bounds is Bounds.NONE else end
    return None if reach is None else reach + op.before


def window_in_steps(node: Apply, step: Fraction) -> tuple[int, int | None]:
    """Return the bounds of a node's interval in whole steps of so many seconds; one that was left out is [0, inf).

    >>> from fractions import Fraction
    >>> from rtamt.language.parsing.parser import parse_formula
    >>> window_in_steps(parse_formula("once[0.2:1](x >= 3)"), Fraction(1, 10))
    (2, 10)
    """
    if node.interval is None:
        return 0, None
    end = node.interval.end
    return _whole(node.interval.begin, step), None if end is None else _whole(end, step)


def window_in_quarters(node: Apply, tick: Fraction) -> tuple[int, int | None]:
    """Return the same in quarters of a tick; what reads one tick without an interval has that."""
    if node.interval is None and node.op.one_tick:
        return QUARTERS, QUARTERS
    begin, end = window_in_steps(node, tick)
    return begin * QUARTERS, None if end is None else end * QUARTERS


def _whole(seconds: Fraction, step: Fraction) -> int:
    numerator, denominator = seconds.as_integer_ratio()
    above, below = step.as_integer_ratio()
    return numerator * below // (denominator * above)


def arguments_of(node: Apply, begin: int, end: int | None, period: Fraction) -> tuple[Any, ...]:
    """Return the arguments of an operator's definition after its operands in discrete time.

    These are the bounds in samples, the period of an operator that counts in seconds, and the rank of a share.
    """
    bounds = () if node.op.bounds is Bounds.NONE else (begin, end)
    seconds = (period,) if node.op.timed else ()
    return (*bounds, *seconds, *rank_arguments(node.interval, period, continuous=False))


class DefinedSamples:
    """The definition in discrete time, over blocks of samples."""

    def __init__(self, node: Apply, begin: int, end: int | None, ahead: int, period: Fraction) -> None:
        self._node = node
        self._arguments = arguments_of(node, begin, end, period)
        self._behind = behind(node, end)
        self._ahead = ahead
        self._first = 0  # the sample that the kept stretch begins with
        self._reported = 0
        self._kept: tuple[Array, ...] = (np.empty(0),) * max(len(node.args), 1)

    def push(self, *blocks: Array) -> Array:
        """Take new values of each operand; return the values that are known by now."""
        self._kept = tuple(np.concatenate(pair) for pair in zip(self._kept, blocks, strict=True))
        return self._news(self._first + len(self._kept[0]) - self._ahead)

    def finish(self) -> Array:
        """Return the values that the end of the trace makes known."""
        return self._news(self._first + len(self._kept[0]))

    def _news(self, end: int) -> Array:
        end = max(end, self._reported)
        n = len(self._kept[0])
        values = values_of(self._node, self._kept, n, self._arguments, "sample")
        news: Array = values[self._reported - self._first : end - self._first].copy()
        self._reported = end
        if self._behind is not None:
            drop = max(0, end - self._behind - self._first)
            self._kept = tuple(column[drop:] for column in self._kept)
            self._first += drop
        return news

    def __deepcopy__(self, _memo: dict[int, Any]) -> DefinedSamples:
        return copy.copy(self)  # arrays are replaced here, never written to


class DefinedEvents:
    """The definition in dense time, over stretches of events; times and bounds are ticks."""

    def __init__(self, node: Apply, begin: int, end: int | None, ahead: int, tick: Fraction) -> None:
        self._node = node
        self._tick = tick
        self._bounds = begin * QUARTERS, None if end is None else end * QUARTERS
        self._behind = behind(node, end)
        self._ahead = ahead
        self._reported: int | None = None  # up to when values were reported
        self._kept: tuple[Steps, ...] = (Steps((), ()),) * max(len(node.args), 1)

    def push(self, *events: Events, until: int) -> Events:
        """Take the operands' events up to ``until``; return those that are known by now."""
        self._kept = tuple(
            Steps((*old.times, *(t * QUARTERS for t in times.tolist())), (*old.values, *values.tolist()))
            for old, (times, values) in zip(self._kept, events, strict=True)
        )
        due = until - self._ahead
        result = signal_of(self._node, self._kept, *self._bounds, self._tick)
        news = [
            (t // QUARTERS, value)
            for t, value in zip(*result, strict=True)
            if t <= due * QUARTERS and (self._reported is None or t > self._reported * QUARTERS)
        ]
        if due * QUARTERS >= self._kept[0].times[0]:
            self._reported = due
            if self._behind is not None:
                self._kept = tuple(_from(x, (due - self._behind) * QUARTERS) for x in self._kept)
        return np.array([t for t, _ in news], np.int64), np.array([value for _, value in news], float)

    def __deepcopy__(self, _memo: dict[int, Any]) -> DefinedEvents:
        return copy.copy(self)  # tuples are replaced here, never written to


def signal_of(node: Apply, operands: tuple[Steps, ...], begin: int, end: int | None, tick: Fraction) -> Steps:
    """Return an operator's values at all instants; times and bounds in quarters of a tick, ``tick`` in seconds."""
    if node.op.dense is not None:
        at = partial(node.op.dense, period=tick / QUARTERS) if node.op.timed else node.op.dense
        try:
            rank = rank_arguments(node.interval, tick, continuous=True)
            return lifted(
                at, operands, begin, end, rank, past=node.op.tense is Tense.PAST, before=node.op.before
            )
        except Exception as error:
            raise raised(node, error) from error
    times = sorted({t for x in operands for t in x.times})
    columns = [np.array(x.over(times)) for x in operands]
    return merged(times, values_of(node, columns, len(times), (), "instant").tolist())


def _from(steps: Steps, start: int) -> Steps:
    """Return a step function from ``start`` on, if it begins before that."""
    if start <= steps.times[0]:
        return steps
    later = [(t, v) for t, v in zip(*steps, strict=True) if t > start]
    return Steps((start, *(t for t, _ in later)), (steps.at(start), *(v for _, v in later)))
