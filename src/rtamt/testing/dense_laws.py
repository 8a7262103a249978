"""The dense-time laws of :mod:`rtamt.testing.laws`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hypothesis import assume

from rtamt.engine import BACKENDS, Evaluators, engine_of
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.operators import Tense
from rtamt.lazy.modules import np
from rtamt.reference import dense_robustness as dense_reference
from rtamt.signals.dense import Dense, record_dense
from rtamt.testing.case import NAMES, ONE, Case, check_own_code
from rtamt.testing.strategies import dense_chunkings, dense_traces

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.formula import Formula
    from rtamt.language.operators import Operator


def has_dense_meaning(op: Operator) -> bool:
    """Return whether an operator is also defined in dense time."""
    return op.dense is not None or op.expansion is not None or op.tense is Tense.NONE


def _trace(case: Case, draw: Callable[[Any], Any], formula: Formula) -> dict[str, Any]:
    trace = draw(dense_traces(NAMES, max_size=8, infinite=case.infinite))
    return {name: trace[name] for name in variables(formula)}


def _changes_of(times: Any, values: Any) -> tuple[list[int], list[float]]:
    """Return the changes of a step function."""
    changes: list[tuple[int, float]] = []
    for time, value in zip(times, values, strict=True):
        if not changes or changes[-1][1] != value:
            changes.append((int(time), float(value)))
    return [t for t, _ in changes], [v for _, v in changes]


def _densely_defined(formula: Formula, trace: dict[str, Any]) -> tuple[list[int], list[float]] | None:
    try:
        steps = dense_reference.evaluate(formula, trace, ONE)
    except EvaluationError as error:
        check_own_code(error)
        return None
    return _changes_of(steps.times, steps.values)


def _same_steps(case: Case, got: Any, expected: Any) -> bool:
    if got is None or expected is None:
        return got is expected
    # Values that differ by less than the tolerance may be merged in one result and not in the other.
    instants = sorted({*got[0], *expected[0]})
    return case.equal(_at(got, instants), _at(expected, instants))


def _at(steps: tuple[list[int], list[float]], instants: list[int]) -> list[float]:
    places = np.searchsorted(steps[0], instants, side="right") - 1
    return [steps[1][place] if place >= 0 else np.nan for place in places]


def _ticks(trace: dict[str, Any]) -> dict[str, Any]:
    return {name: (np.asarray(t, np.int64), values) for name, (t, values) in trace.items()}


def _fast_is_the_dense_definition(case: Case, draw: Callable[[Any], Any]) -> None:
    formula = case.formula(draw, dense=True, unbounded=True)
    assume(variables(formula))
    trace = _trace(case, draw, formula)
    expected = _densely_defined(formula, trace)
    recording = record_dense(_ticks(trace), variables(formula), ONE)
    got: Any
    try:
        signal = Evaluators(BACKENDS[0])((formula,), recording)[0]
        got = _changes_of(signal.times, signal.values)
    except EvaluationError as error:
        check_own_code(error)
        got = None
    # A value that is undefined after the end and never read may go unnoticed in one of them.
    assume(expected is not None and got is not None)
    if not _same_steps(case, got, expected):
        raise case.broken("fast is the definition, in dense time", formula, trace, expected, got)


def _dense_online_is_offline(case: Case, draw: Callable[[Any], Any]) -> None:
    formula = case.formula(draw, dense=True)
    assume(variables(formula))
    trace = _trace(case, draw, formula)
    expected = _densely_defined(formula, trace)
    assume(expected is not None)
    updates = draw(dense_chunkings(trace))
    domain = Dense(ONE)
    for backend in BACKENDS:
        monitor: Any = engine_of(domain).monitor(formula, domain, backend=backend)
        for _ in range(2):  # a reset monitor acts like a new one
            times: list[int] = []
            values: list[float] = []
            try:
                signals = [monitor.update_many(_ticks(update)) for update in updates] + [monitor.finish()]
            except EvaluationError as error:
                check_own_code(error)
                assume(False)
                raise
            for signal in signals:
                times += signal.times.astype(np.int64).tolist()
                values += signal.values.tolist()
            if times != sorted(set(times)) or not _same_steps(case, _changes_of(times, values), expected):
                law = f"online and finish is offline, in dense time ({backend})"
                raise case.broken(law, formula, trace, expected, (times, values))
            monitor.reset()


#: Each law is a function of a case and of hypothesis' draw function.
DENSE_LAWS = (_fast_is_the_dense_definition, _dense_online_is_offline)
