"""The results of a batch: many traces in one array for each variable, evaluated together."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, overload

from rtamt.errors import BoundError, StlError, TraceError, placed
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.tuples import NamedTuple
from rtamt.results import Result
from rtamt.signals.outcomes import BoundedSignal

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from rtamt.engine import Query
    from rtamt.language.formula import Formula
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.rows import Rows
    from rtamt.signals.time_domain_interface import DomainTrace
    from rtamt.specification import Specification


class BatchResult(Sequence[Result]):
    """The results of many traces, as :meth:`Specification.evaluate_batch` returns them.

    ``batch[i]`` is the :class:`Result` of trace ``i``.

    >>> import rtamt
    >>> batch = rtamt.parse("always(x >= 3)").evaluate_batch({"x": [[5, 4, 7], [2, 6, 0]]}, lengths=[3, 2])
    >>> batch.robustness, batch.satisfied
    (array([ 1., -1.]), array([ True, False]))
    >>> batch.signals
    array([[ 1.,  1.,  4.],
           [-1.,  3., nan]])
    >>> batch[1]
    <result of always(x >= 3): robustness -1.0 at 0.0>
    """

    def __init__(
        self,
        signals: FloatArray,
        lengths: NDArray[np.int64],
        result: Callable[[int], Result],
        satisfied: Callable[[], NDArray[np.bool_]],
    ) -> None:
        self._signals = signals
        self._lengths = lengths
        self._result = result
        self._satisfied = satisfied

    @property
    def signals(self) -> FloatArray:
        """ρ at every sample: an array of shape (traces, samples), NaN after the end of a trace."""
        return self._signals

    @property
    def lengths(self) -> NDArray[np.int64]:
        """The number of samples of each trace."""
        return self._lengths

    @cached_property
    def robustness(self) -> FloatArray:
        """ρ at the first instant of each trace."""
        robustness: FloatArray = (
            self._signals[:, 0] + 0.0 if len(self) else np.empty(0)
        )  # no minus before a zero
        return robustness

    @cached_property
    def satisfied(self) -> NDArray[np.bool_]:
        """Whether the formula holds at the first instant of each trace, see :attr:`Result.satisfied`."""
        return self._satisfied()

    def __len__(self) -> int:
        return len(self._lengths)

    @overload
    def __getitem__(self, index: int) -> Result: ...

    @overload
    def __getitem__(self, index: slice) -> list[Result]: ...

    def __getitem__(self, index: int | slice) -> Result | list[Result]:
        numbers = range(len(self))[index]
        return self._result(numbers) if isinstance(numbers, int) else [self._result(i) for i in numbers]

    def __repr__(self) -> str:
        return f"<results of {len(self)} traces: {int(self.satisfied.sum())} satisfied>"


class _Group(NamedTuple):
    """Traces of the same length and period, and one of them."""

    rows: NDArray[np.intp]
    trace: DomainTrace


def evaluate_rows(
    spec: Specification, query: Query, rows: Rows, evaluate: Callable[[dict[str, Any]], Result]
) -> BatchResult:
    """Return the results of the rows: together if that is possible, else of each by ``evaluate``.

    Raises the error of ``evaluate`` for the first invalid trace, prefixed with its index.
    """
    groups = _groups_of(spec, query, rows)
    signals = _signals_of(spec, rows, groups, query.formulas)
    if signals is not None:
        together = _Together(spec, query, rows, groups, signals)
        return BatchResult(signals, rows.lengths, together.result, together.satisfied)
    apart = _Apart([_placed(i, evaluate, rows) for i in range(len(rows))])
    signals = np.full((len(rows), rows.width), np.nan)
    for i, result in enumerate(apart.results):
        if isinstance(result.signal, BoundedSignal):
            raise TraceError(
                f"trace {i}: samples are missing, which arrays of traces cannot express: use "
                f"rtamt.evaluate_batch(spec, traces)"
            )
        signals[i, : len(result.signal)] = result.signal.values
    return BatchResult(signals, rows.lengths, apart.result, apart.satisfied)


def _placed(number: int, evaluate: Callable[[dict[str, Any]], Result], rows: Rows) -> Result:
    try:
        return evaluate(rows.row(number))
    except StlError as error:
        raise placed(error, f"trace {number}") from None


@dataclass(frozen=True, eq=False)
class _Apart:
    """Traces that were evaluated one by one."""

    results: list[Result]

    def result(self, i: int) -> Result:
        """Return the result of one trace."""
        return self.results[i]

    def satisfied(self) -> NDArray[np.bool_]:
        """Return the verdict of each trace."""
        return np.array([result.satisfied for result in self.results], bool)


@dataclass(frozen=True, eq=False)
class _Together:
    """Traces that were evaluated together; each has a result when it is asked for."""

    spec: Specification
    query: Query
    rows: Rows
    groups: list[_Group]
    signals: FloatArray

    def result(self, i: int) -> Result:
        """Return the result of one trace."""
        spec, rows = self.spec, self.rows
        trace = self.query.record(rows.row(i), spec.input_names, spec.types)
        (signal,) = trace.signals([self.signals[i, : rows.lengths[i]]])
        return Result(spec, spec._with_units(trace), signal, self.query.semantics)

    def satisfied(self) -> NDArray[np.bool_]:
        """Return the verdict of each trace."""
        spec, rows = self.spec, self.rows
        truth = _signals_of(spec, rows, self.groups, (spec._outputs().truth,))
        if truth is not None:
            holds: NDArray[np.bool_] = truth[:, 0] > 0
            return holds
        return np.array([self.result(i).satisfied for i in range(len(rows))], bool)


def _groups_of(spec: Specification, query: Query, rows: Rows) -> list[_Group]:
    """Return the traces by length and period; none of them if one has to be converted or is invalid."""
    if spec.types or not rows.plain or not rows.lengths.all() or rows.has_nan:
        return []
    groups = []
    for length in sorted(set(rows.lengths.tolist())):
        alike = np.flatnonzero(rows.lengths == length)
        # One of them has the timestamps of all, unless each has its own.
        read = alike if rows.own_times else alike[:1]
        traces = [query.read(rows.row(int(i)), spec.input_names, spec.types) for i in read]
        by_period: dict[Any, list[int]] = {}
        for place, trace in enumerate(traces):
            if trace is None:
                return []
            by_period.setdefault(trace.step.as_integer_ratio(), []).append(place)
        for places in by_period.values():
            trace = traces[places[0]]
            assert trace is not None
            try:
                spec._check(query, trace)
            except BoundError:
                return []
            groups.append(_Group(alike[places] if rows.own_times else alike, trace))
    return groups


def _signals_of(
    spec: Specification, rows: Rows, groups: list[_Group], formulas: tuple[Formula]
) -> FloatArray | None:
    """Return the values of the formula in each trace; None where it has to be evaluated trace by trace."""
    if not groups:
        return None
    signals = spec._evaluators.new_rows(len(rows), rows.width)
    if (rows.lengths < rows.width).any():
        signals.fill(np.nan)
    for group in groups:
        if not spec._evaluators.rows(formulas, group.trace, rows.columns, group.rows, signals):
            return None
    return signals
