"""Evaluate one requirement on many traces in parallel, or many requirements on one trace in one program."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Sized
from contextlib import contextmanager
from functools import lru_cache, partial
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, TraceError, UsageError, no_specification, placed, shown
from rtamt.results import Result, requirements_of
from rtamt.signals.arrays import is_number
from rtamt.signals.data_errors import refuse_one_recording
from rtamt.specification_data import over_data, require_times, sample
from rtamt.verdicts.offline import findings_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from typing_extensions import Unpack

    from rtamt.fleet.groups import Group
    from rtamt.settings import EvaluationSettings
    from rtamt.specification import Specification


#: The number of samples from which the core releases the GIL: `many` in core/python/arrays.hpp.
LONG = 4096

# ---- many recordings -----------------------------------------------------------------------------


def evaluate_batch(
    spec: Specification,
    traces: Iterable[Any],
    *,
    workers: int | None = None,
    tolerance: float | None = None,
    **reading: Unpack[EvaluationSettings],
) -> list[Result]:
    """Evaluate one requirement on many complete traces, in threads; return the results in the same order.

    ``traces``: each as for :meth:`Specification.evaluate`; so are the other arguments
    (``time=``, ``period=``, ...). The requirement is compiled once. The compiled core releases the GIL,
    so that long traces use all cores of the machine; for short traces the checks
    in Python dominate. An iterator is read one trace at a time, as threads become free.
    ``workers``: the number of threads; by default one per core as soon as a trace is long enough for the core to
    release the GIL.

    Raises the error of ``evaluate`` for the first invalid trace, prefixed with its index (from 0).

    >>> import rtamt
    >>> spec = rtamt.parse("always(x >= 3)")
    >>> results = rtamt.evaluate_batch(spec, [{"x": [5, 4]}, {"x": [2]}])
    >>> [result.robustness for result in results]
    [1.0, -1.0]
    >>> rtamt.evaluate_batch(spec, [{"x": [5, 4]}, {"x": [float("nan")]}])
    Traceback (most recent call last):
    rtamt.errors.TraceError: trace 1: 'x' is NaN at sample 0, time 0 s: fill the gap or leave the sample out
    """
    if workers is not None and (not is_number(workers) or not 1 <= workers < inf or workers != int(workers)):
        raise UsageError(f"workers is {shown(workers)}; give a number of threads, 1 or more")
    if not isinstance(traces, Iterable):
        raise UsageError(f"traces is {shown(traces)}; give a list of recordings")
    refuse_one_recording(
        traces, "traces", "; spec.evaluate_batch(data) takes a mapping to arrays of shape (traces, samples)"
    )
    if not hasattr(spec, "evaluate"):
        raise no_specification(spec)
    count = int(workers or os.cpu_count() or 1)
    if isinstance(traces, Sized):
        count = min(count, len(traces))
    work = _Work(partial(spec.evaluate, tolerance=tolerance, **reading), traces)
    if workers is None or count == 1:
        work.run(alone=count > 1)
    if count > 1:
        from concurrent.futures import ThreadPoolExecutor

        with ThreadPoolExecutor(count, "rtamt") as pool:
            try:
                for done in [pool.submit(work.run) for _ in range(count)]:
                    done.result()
            finally:
                work.stop()
    return work.results()


class _Work:
    """A queue of recordings that threads process until it is empty or a recording is invalid."""

    def __init__(self, evaluate: Callable[[Any], Result], traces: Iterable[Any]) -> None:
        self._evaluate = evaluate
        self._traces: Iterator[tuple[int, Any]] = enumerate(traces)
        self._lock = threading.Lock()
        self._results: dict[int, Result] = {}
        self._errors: dict[int, Exception] = {}

    def run(self, *, alone: bool = False) -> None:
        """Evaluate until the queue is empty; with ``alone``, return when more threads would pay off."""
        while True:
            with self._lock:
                item = None if self._errors else next(self._traces, None)
            if item is None:
                return
            number, trace = item
            try:
                result = self._results[number] = self._evaluate(trace)
            except Exception as error:  # noqa: BLE001 - kept for results(), which raises it
                self._errors[number] = error
                return
            if alone and result._size >= LONG:
                return

    def stop(self) -> None:
        """Stop all threads after their current recording."""
        with self._lock:
            self._traces = iter(())

    def results(self) -> list[Result]:
        """Return the results in order, or raise the first error."""
        for number in sorted(self._errors):
            error = self._errors[number]
            raise placed(error, f"trace {number}") if isinstance(error, StlError) else error
        return [self._results[number] for number in range(len(self._results))]


# ---- many requirements ---------------------------------------------------------------------------


def evaluate_all(
    specs: Sequence[Specification],
    data: Any,
    *,
    tolerance: float | None = None,
    uncertainty: Mapping[str, float] | None = None,
    ranges: Mapping[str, tuple[float, float]] | None = None,
    **reading: Unpack[EvaluationSettings],
) -> list[Result]:
    """Evaluate many requirements on one complete trace, in one program; return the results in the same order.

    ``data`` and the other arguments (``time=``, ``period=``, ...) are those of
    :meth:`Specification.evaluate`; ``data`` contains the variables of all requirements. Data are checked once,
    and common sub-formulas are computed once. Each result equals that of ``evaluate``. The programs of the last
    sets of specifications are kept for other data; for tables of many recordings see :class:`Suite`. With missing
    samples, ``uncertainty`` or ``ranges`` (of variables of any of the requirements), results have bounds, and each
    requirement is evaluated by itself.

    Raises the errors of ``evaluate``; errors in bounds are prefixed with the index (from 0) of the
    requirement.

    >>> import rtamt
    >>> specs = [rtamt.parse(text) for text in ("always(x >= 3)", "always(x >= 3 or y >= 1)")]
    >>> [result.robustness for result in rtamt.evaluate_all(specs, {"x": [5, 2], "y": [0, 2]})]
    [-1.0, 1.0]
    """
    if not isinstance(specs, Iterable):
        raise UsageError(f"specs is {shown(specs)}; give a list of specifications")
    specs = tuple(specs)
    for number, spec in enumerate(specs):
        if not hasattr(spec, "evaluate"):
            with _place(number):
                raise no_specification(spec)
    groups, apart = _group(specs, {"tolerance": tolerance, **reading})
    declared = _declared_for_each(specs, uncertainty, ranges)

    def alone(number: int) -> Result:
        errors, limits = declared[number]
        try:
            return specs[number].evaluate(
                data, tolerance=tolerance, uncertainty=errors, ranges=limits, **reading
            )
        except TraceError:  # wrong data are wrong for all
            raise
        except StlError as error:
            raise placed(error, f"specification {number}") from None

    if uncertainty is not None or ranges is not None:
        return [alone(number) for number in range(len(specs))]
    results = {number: alone(number) for number in apart}
    for group in groups:
        try:
            trace = group.recording(data)
        except TraceError as error:  # a missing sample has bounds, which common programs do not compute
            inexact = {number: alone(number) for number in group.asked}
            if not any(result.trace.bounds for result in inexact.values()):
                raise error from None
            results.update(inexact)
            continue
        for number, asking in group.asked.items():
            with _place(number):
                asking.spec._check(asking.query, trace)
        for number, signal in group.programs(trace.step).signals(trace):
            spec, query = group.asked[number].spec, group.asked[number].query
            own = spec._with_units(trace.select(spec.input_names))
            results[number] = Result(spec, own, signal, query.semantics)
    return [results[number] for number in range(len(specs))]


def _declared_for_each(
    specs: Sequence[Specification], uncertainty: Any, ranges: Any
) -> list[tuple[Any, Any]]:
    """Return, for each specification, the errors and ranges of the variables that it reads."""
    if uncertainty is None and ranges is None:
        return [(None, None)] * len(specs)
    from rtamt.signals.inexact import Uncertainty

    if any(spec.groups for spec in specs):  # the recording decides the names of members
        return [(uncertainty, ranges)] * len(specs)
    names = dict.fromkeys(name for spec in specs for name in spec.input_names)
    Uncertainty.of(uncertainty, ranges, tuple(names))

    def of(spec: Specification, declared: Any) -> Any:
        return {name: declared[name] for name in declared or () if name in spec.input_names} or None

    return [(of(spec, uncertainty), of(spec, ranges)) for spec in specs]


def _group(specs: Sequence[Specification], reading: dict[str, Any]) -> tuple[list[Group], Iterable[int]]:
    """Return the groups of specifications, and which have to be evaluated by themselves; kept for other data."""
    try:
        return _kept_groups(tuple(specs), tuple(reading.items()))
    except TypeError:  # a setting that cannot be hashed, such as one of a wrong type
        return _groups(tuple(specs), tuple(reading.items()))


def _groups(
    specs: tuple[Specification, ...], reading: tuple[tuple[str, Any], ...]
) -> tuple[list[Group], Iterable[int]]:
    from rtamt.fleet.groups import Asking, grouped

    asked, apart = {}, set()
    for number, spec in enumerate(specs):
        with _place(number):
            asked[number] = Asking(spec, spec._query(**dict(reading)))
        if len(spec.requirements) > 1 and asked[number].query.domain.own_time_bases:
            apart.add(number)  # each may start at a different time
    groups, others = grouped({number: each for number, each in asked.items() if number not in apart})
    return groups, sorted(apart | others.keys())


#: As many sets of specifications are remembered with their programs.
_kept_groups = lru_cache(8)(_groups)


def evaluate_requirements(spec: Specification, data: Any) -> Mapping[str, Result]:
    """Evaluate each requirement of a specification: robustness and verdicts of all from one program.

    ``data`` and errors as for :meth:`Specification.evaluate`, which computes verdicts when they are requested.
    """
    query = spec._query()
    if spec.groups:
        over, bound = over_data(spec, query, data)
        return evaluate_requirements(over, bound)
    sampled = sample(spec, query, spec.binding.applied(data))
    recording = spec._with_units(query.record(sampled, spec.input_names, spec.types))
    require_times(spec, query, sampled)
    if spec.resolved is not None:
        recording = recording.ended_by(spec.resolved[0].input_names)
    spec._check(query, recording)
    outputs = [one._outputs() for one in spec.requirements.values()]
    return requirements_of(spec, findings_of(outputs, recording, spec._signals_of), query.semantics)


@contextmanager
def _place(number: int) -> Iterator[None]:
    try:
        yield
    except StlError as error:
        raise placed(error, f"specification {number}") from None
