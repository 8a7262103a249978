"""The definition, executed: formula and samples to robustness in discrete time, slowly and plainly.

This is the reference for the engine and the Python back end. It applies the ``definition`` of each
operator of the table, bottom-up, over whole arrays; it shares nothing with the engine but the formula.
Online, :class:`ReferenceMonitor` keeps the stretch of trace that it needs and evaluates it again.

It trusts its caller: bounds are whole multiples of the period, inputs hold no NaN.
"""

from __future__ import annotations

from math import lcm
from typing import TYPE_CHECKING, TypeAlias

from rtamt.errors import UsageError
from rtamt.language.formula import Apply, Const, Formula, Var, fold, postorder
from rtamt.language.operators import Bounds, Sum, Tense
from rtamt.language.undefined_value import UndefinedAtSampleError
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.reference.definition_adapter import arguments_of, values_of, window_in_steps
from rtamt.rewrite.desugar import desugar, spelled_out
from rtamt.rewrite.ground import ground, grounds

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence
    from fractions import Fraction

    from numpy.typing import NDArray

    Array: TypeAlias = NDArray[np.float64]
    Exact: TypeAlias = Callable[[Formula], range]


def evaluate(
    formula: Formula, columns: Mapping[str, Array], n: int, period: Fraction, start: float = 0.0
) -> Array:
    """Return the robustness of a formula at every sample: the paper's Definition 2, literally.

    ``columns`` maps each variable to its ``n`` values, shape (n,); ``period`` and ``start``, the time
    of sample 0, are seconds. The result has shape (n,) and is the caller's to keep.

    Raises :class:`EvaluationError` if an operation has no value (0/0, the root of a negative
    number, inf - inf), wherever in the formula that is.

    >>> import numpy as np
    >>> from fractions import Fraction
    >>> from rtamt.reference.discrete_robustness import evaluate
    >>> from rtamt.language.formula import Interval, Var
    >>> from rtamt.language.operators import STL
    >>> lately = STL["once"](Var("x"), interval=Interval(Fraction(2), Fraction(2)))
    >>> evaluate(lately, {"x": np.array([1.0, 2.0, 3.0, 4.0])}, 4, Fraction(1))
    array([-inf, -inf,   1.,   2.])
    """
    return _evaluate(spelled_out(ground(formula, period)), _Stretch(columns, n, period, start))


def evaluate_all(
    formula: Formula, columns: Mapping[str, Array], n: int, period: Fraction, start: float = 0.0
) -> dict[Formula, Array]:
    """Return the robustness of every distinct sub-formula, the formula itself included.

    Arguments and errors are those of :func:`evaluate`; each array has shape (n,).
    """
    every: dict[Formula, Array] = {}
    _evaluate(spelled_out(ground(formula, period)), _Stretch(columns, n, period, start), every=every)
    return every


def history(formula: Formula, period: Fraction) -> int | None:
    """Return the number of samples behind t that the value at t can depend on; None if it is unbounded.

    A past operator without an interval (``prev``) reads one sample; one with an interval reads as far
    as its upper bound; future operators add nothing.

    >>> from fractions import Fraction
    >>> from rtamt.language.formula import Interval, Var
    >>> from rtamt.language.operators import STL
    >>> lately = STL["once"](Var("x"), interval=Interval(Fraction(0), Fraction(1, 2)))
    >>> history(STL["prev"](lately), Fraction(1, 10))
    6
    """
    formula = spelled_out(ground(formula, period))
    return _reaches(formula, period, Tense.PAST)[id(formula)]


class ReferenceMonitor:
    """Online monitor with the interface of the core's: samples in, newly known values out.

    ``formulas`` are the outputs, ``inputs`` the variables in the order of the columns that
    :meth:`push` takes, at least one: a formula without variables counts samples by it.
    Output k is known ``horizons[k]`` samples late. ``history`` is how many samples behind t any output
    can depend on (:func:`history`), None to keep the whole trace. ``period`` and ``start``, the time of
    sample 0, are seconds; ``start`` may be set until the first sample arrives.

    >>> import numpy as np
    >>> from fractions import Fraction
    >>> from rtamt.language.formula import Interval, Var
    >>> from rtamt.language.operators import STL
    >>> soon = STL["eventually"](Var("x"), interval=Interval(Fraction(0), Fraction(1)))
    >>> monitor = ReferenceMonitor([soon], ("x",), Fraction(1), horizons=[1], history=0)
    >>> monitor.push([np.array([1.0, 2.0, 0.0])]), monitor.finish()
    ([array([2., 2.])], [array([0.])])
    """

    def __init__(
        self,
        formulas: Sequence[Formula],
        inputs: tuple[str, ...],
        period: Fraction,
        horizons: Sequence[int],
        history: int | None,
        start: float = 0.0,
    ) -> None:
        self._formulas = tuple(spelled_out(each) for each in grounds(formulas, period))
        self._inputs = inputs
        self._period = period
        self._horizons = tuple(horizons)
        self.start = start
        self._exact = [_Exact(formula, period) for formula in self._formulas]
        # Values still to be reported lie up to a horizon back, and each reads `history` further.
        self._reach = None if history is None else history + max(self._horizons, default=0)
        # Sums are aligned to sample 0: what is dropped is a multiple of their windows.
        self._block = lcm(*(width for formula in self._formulas for width in _sum_widths(formula, period)))
        self.reset()

    @property
    def samples(self) -> int:
        """The number of samples so far."""
        return self._samples

    @property
    def state_bytes(self) -> int:
        """Bytes of signal kept; grows with the trace where ``history`` is None."""
        return sum(column.nbytes for column in self._kept)

    def reset(self) -> None:
        """Forget the trace: the next sample is sample 0."""
        self._samples = 0
        self._first = 0  # index of the first sample that is kept
        self._kept: list[Array] = [np.empty(0) for _ in self._inputs]
        self._finished = False

    def push(self, columns: Sequence[Array]) -> list[Array]:
        """Take new samples, one array of shape (m,) an input, m ≥ 0.

        Returns for every output the values that became known, in order: those at times s - horizon
        for each new sample s. Raises :class:`EvaluationError` as :func:`evaluate` does; the monitor is
        then as it was.
        """
        if self._finished:
            raise UsageError(
                "the trace is finished and takes no more samples; call reset() to begin a new one"
            )
        kept = [np.concatenate((old, new)) for old, new in zip(self._kept, columns, strict=True)]
        samples = self._samples + len(columns[0])
        known = self._news(kept, samples, final=False)
        drop = 0 if self._reach is None else max(0, samples - self._reach - self._first)
        drop -= drop % self._block
        self._kept = [column[drop:].copy() for column in kept]
        self._first += drop
        self._samples = samples
        return known

    def finish(self) -> list[Array]:
        """Return for every output the values that were still unknown, windows cut at the last sample.

        After this the monitor takes no more samples until :meth:`reset`.
        """
        if self._finished:
            return [np.empty(0) for _ in self._formulas]
        rest = self._news(self._kept, self._samples, final=True)
        self._finished = True
        return rest

    def _news(self, kept: list[Array], samples: int, *, final: bool) -> list[Array]:
        """Evaluate the stretch ``kept`` and return of each output what was not known before."""
        columns = dict(zip(self._inputs, kept, strict=True))
        first = self._first
        stretch = _Stretch(columns, samples - first, self._period, self.start, first)
        news = []
        for formula, horizon, exact in zip(self._formulas, self._horizons, self._exact, strict=True):
            values = _evaluate(formula, stretch, exact.within(first, samples, final=final))
            begin = max(0, self._samples - horizon)
            end = samples if final else max(0, samples - horizon)
            news.append(values[begin - first : end - first].copy())
        return news


@dataclass(frozen=True, slots=True)
class _Stretch:
    """The ``n`` samples from sample ``first`` of a trace that starts at ``start`` seconds."""

    columns: Mapping[str, Array]
    n: int
    period: Fraction
    start: float
    first: int = 0

    def time(self, i: int) -> float:
        return self.start + float((self.first + i) * self.period)


class _Exact:
    """Where in a stretch of a longer trace the values of each sub-formula are those of the whole trace.

    Elsewhere the stretch's ends show: a window is cut that should not be, and inf - inf means nothing.
    """

    def __init__(self, formula: Formula, period: Fraction) -> None:
        self._behind = _reaches(formula, period, Tense.PAST)
        self._ahead = _reaches(formula, period, Tense.FUTURE)

    def within(self, first: int, samples: int, *, final: bool) -> Exact:
        """Return the range of every sub-formula in the stretch from sample ``first`` to the last so far."""
        n = samples - first

        def exact(node: Formula) -> range:
            behind, ahead = self._behind[id(node)], self._ahead[id(node)]
            begin = 0 if first == 0 else n if behind is None else behind
            end = n if final else 0 if ahead is None else n - ahead
            return range(begin, max(begin, end))

        return exact


def _evaluate(
    formula: Formula,
    stretch: _Stretch,
    exact: Exact | None = None,
    every: dict[Formula, Array] | None = None,
) -> Array:
    """Fold the definitions over the formula; a NaN in a sub-formula's ``exact`` range is an error.

    ``exact=None`` means everywhere; ``every``, if given, collects each sub-formula's values.
    """

    def step(node: Formula, below: tuple[Array, ...]) -> Array:
        value = _apply(node, below, stretch)
        wrong = np.isnan(value)
        if wrong.any():
            for i in range(stretch.n) if exact is None else exact(node):
                if wrong[i]:
                    raise UndefinedAtSampleError(node, stretch.first + i, stretch.time(i))
        if every is not None:
            every[node] = value
        return value

    # Beyond a stretch's exact ranges NaN may meet any operator, and none of it is reported.
    with np.errstate(all="ignore"):
        return fold(formula, step)


def _apply(node: Formula, below: tuple[Array, ...], stretch: _Stretch) -> Array:
    """Return one sub-formula's values from those of its operands."""
    n = stretch.n
    if isinstance(node, Const):
        return np.full(n, node.value)
    if isinstance(node, Var):
        return np.array(stretch.columns[node.name], float)
    if not isinstance(node, Apply):
        raise TypeError(f"not a formula: {node!r}")
    return values_of(
        node, below, n, arguments_of(node, *window_in_steps(node, stretch.period), stretch.period), "sample"
    )


def _sum_widths(formula: Formula, period: Fraction) -> Iterator[int]:
    """Yield the width of the window of every bounded sum; the mean is one."""
    for node in postorder(desugar(formula)):
        if isinstance(node, Apply) and isinstance(node.op.kernel, Sum):
            begin, end = window_in_steps(node, period)
            if end is not None:
                yield end - begin + 1


def _reaches(formula: Formula, period: Fraction, tense: Tense) -> dict[int, int | None]:
    """Return, by identity of each sub-formula, how many samples away in ``tense`` it can read."""
    reaches: dict[int, int | None] = {}

    def step(node: Formula, below: tuple[int | None, ...]) -> int | None:
        own: int | None = 0
        if isinstance(node, Apply) and node.op.tense is tense:
            own = node.op.reach if node.op.bounds is Bounds.NONE else window_in_steps(node, period)[1]
            if own is not None:
                own += node.op.before
        deepest = None if None in below else max((b for b in below if b is not None), default=0)
        reaches[id(node)] = None if own is None or deepest is None else own + deepest
        return reaches[id(node)]

    fold(formula, step)
    return reaches
