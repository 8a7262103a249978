"""The laws of bounds and early verdicts in discrete time. Each takes a case and an implementation, and asserts.

``"bounds"`` are [L, U] of a formula at an instant, given what is known of the signals so far.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from rtamt.errors import EvaluationError, UsageError
from rtamt.language.formula import Apply, postorder
from rtamt.language.operators import STL
from rtamt.reference import discrete_bounds, eager_verdicts
from rtamt.reference import discrete_robustness as reference
from rtamt.reference.discrete_bounds import ANYTHING
from rtamt.reference.discrete_causation import NOTHING
from rtamt.rewrite.early import causeless, ends_differently, loose
from rtamt.rewrite.horizon import horizon
from rtamt.rewrite.semantics import boolean
from rtamt.signals.outcomes import Causation
from tests.laws.early.definition import DEFINITION, PERIOD
from tests.laws.early.monitors import PYTHON

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.language.formula import Formula
    from tests.laws.early.cases import Case
    from tests.laws.early.definition import Implementation


class NothingToCheck(Exception):  # noqa: N818 - no error
    """The case has no value to check: an operation in it has none, or it is outside the class of the law."""


def rho(formula: Formula, columns: Mapping[str, list[float]], n: int) -> list[float]:
    """Return the robustness over whole columns, whose end cuts windows."""
    arrays = {name: np.array(column[:n], float) for name, column in columns.items()}
    try:
        return reference.evaluate(formula, arrays, n, PERIOD).tolist()
    except EvaluationError:
        raise NothingToCheck from None


def whole_horizon(formula: Formula) -> int:
    depth = horizon(formula)
    assert depth is not None
    return int(depth)


def given(known: Any) -> Any:
    """Return what an update takes: a number where the bounds are one."""
    return known[0] if known is not None and known[0] == known[1] else known


def _monitors(case: Case, made: Implementation) -> Any:
    """Yield a monitor of the bounds of a case before the first and after every sample."""
    monitor = made.interval(case.formula, case.names, case.ranges, 0)
    yield 0, monitor
    for i, row in enumerate(case.samples):
        monitor.update(i, **{name: given(known) for name, known in row.items()})
        yield i + 1, monitor


def _all_bounds(case: Case, made: Implementation) -> list[list[tuple[float, float]]]:
    """Return the bounds at every sample of the whole trace: before the first and after every sample."""
    instants = range(len(next(iter(case.truth.values()))) - whole_horizon(case.formula))
    found = []
    try:
        for _, monitor in _monitors(case, made):
            each = [monitor.interval(t) for t in instants]
            found.append([(bounds.lower, bounds.upper) for bounds in each])
    except EvaluationError:
        raise NothingToCheck from None
    return found


def sound(case: Case, made: Implementation) -> None:
    """The robustness of the whole trace lies within the bounds, at every instant and from the beginning."""
    expected = rho(case.formula, case.truth, len(next(iter(case.truth.values()))))
    for bounds in _all_bounds(case, made):
        for (lower, upper), value in zip(bounds, expected, strict=False):
            assert lower <= value <= upper


def narrowing(case: Case, made: Implementation) -> None:
    """With every sample the bounds at every instant only become narrower."""
    for before, after in itertools.pairwise(_all_bounds(case, made)):
        for (wide_lower, wide_upper), (lower, upper) in zip(before, after, strict=True):
            assert wide_lower <= lower <= upper <= wide_upper


def delayed(case: Case, made: Implementation) -> None:
    """Of exact samples the bounds meet one horizon later, in the robustness."""
    assert case.exact
    expected = rho(case.formula, case.truth, len(next(iter(case.truth.values()))))
    for n, bounds in enumerate(_all_bounds(case, made)):
        for t in range(n - whole_horizon(case.formula)):
            assert bounds[t] == (expected[t], expected[t])


def finished(case: Case, made: Implementation) -> None:
    """At the end the bounds are the robustness of the samples, within all that was told before, outside one class."""
    assert case.exact
    expected = rho(case.formula, case.truth, case.n)
    before = _all_bounds(case, made)
    *_, (_, monitor) = _monitors(case, made)
    monitor.finish()
    narrow = ends_differently(case.formula, case.ranges) is None
    for t in range(case.n):
        final = monitor.interval(t)
        assert (final.lower, final.upper) == (expected[t], expected[t])
        for bounds in before if narrow else ():
            assert bounds[t][0] <= expected[t] <= bounds[t][1]


def accepted(case: Case, made: Implementation) -> None:
    """Samples of which every prefix has a value at every sample are accepted, and end as the whole trace."""
    assert case.exact
    n = 0
    expected: list[float] = []
    for k in range(1, case.n + 1):
        try:
            expected = rho(case.formula, case.truth, k)
        except NothingToCheck:
            break
        n = k
    if not n or ends_differently(case.formula, case.ranges) is not None:
        raise NothingToCheck
    bounds = made.interval(case.formula, case.names, case.ranges, 0)
    verdicts = made.eager(case.formula, case.names, case.ranges)
    for i, row in enumerate(case.samples[:n]):
        for monitor in (bounds, verdicts):
            monitor.update(i, **{name: given(known) for name, known in row.items()})
    bounds.finish()
    verdicts.finish()
    for t in range(n):
        final = bounds.interval(t)
        assert (final.lower, final.upper) == (expected[t], expected[t])


def as_defined(case: Case, made: Implementation) -> None:
    """After every sample and at the end, the bounds at every instant are those of the definition."""
    if made is DEFINITION:
        raise NothingToCheck
    assert _all_bounds(case, made) == _all_bounds(case, DEFINITION)


def any_order(case: Case, made: Implementation, order: list[int]) -> None:
    """Whatever the order in which samples come within the lateness, the final bounds are the same."""
    finals = []
    for arrival in (range(case.n), order):
        monitor = made.interval(case.formula, case.names, case.ranges, case.n)
        try:
            for i in arrival:
                monitor.update(i, **{name: given(known) for name, known in case.samples[i].items()})
            monitor.finish()
            finals.append([monitor.interval(t) for t in range(case.n)])
        except EvaluationError:
            raise NothingToCheck from None
    assert finals[0] == finals[1]


def late(case: Case, made: Implementation, order: list[int], lateness: int) -> None:
    """Bounds of samples in any order are as defined by those that have arrived, once no earlier one can arrive."""
    if made is DEFINITION:
        raise NothingToCheck
    monitor = made.interval(case.formula, case.names, case.ranges, lateness)
    definition = DEFINITION.interval(case.formula, case.names, case.ranges)
    try:
        for k, i in enumerate(order):
            for each in (monitor, definition):
                each.update(i, **{name: given(known) for name, known in case.samples[i].items()})
            came = order[: k + 1]
            if max(came) - min(came) < lateness:
                with pytest.raises(UsageError, match="the trace has not started"):
                    monitor.interval(i)
                continue
            for t in range(case.n):
                assert monitor.interval(t) == definition.interval(t)
    except EvaluationError:
        raise NothingToCheck from None


def fails_alike(case: Case, made: Implementation, order: list[int], lateness: int) -> None:
    """The same samples, in any order within the lateness, fail as with the Python back end; or the end does."""
    for kind in ("interval", "eager"):
        if kind == "eager" and lateness:
            continue
        arguments = (case.formula, case.names, case.ranges)
        both = [
            each.interval(*arguments, lateness) if kind == "interval" else each.eager(*arguments)
            for each in (made, PYTHON)
        ]
        for i in order:
            values = {name: given(known) for name, known in case.samples[i].items()}
            failed = [_fails(monitor.update, i, **values) for monitor in both]
            assert failed[0] == failed[1]
            if failed[0]:
                break
        else:
            failed = [_fails(monitor.finish) for monitor in both]
            assert failed[0] == failed[1]


def _fails(call: Callable[..., Any], *args: Any, **values: Any) -> str | None:
    try:
        call(*args, **values)
    except EvaluationError as error:
        return str(error)
    return None


def tight(case: Case, made: Implementation, most: int = 200) -> None:
    """Where the static check claims it, some trace that agrees with the samples attains each bound.

    Tried are all halves, at which arithmetic turns around unless a factor moves that place.
    """
    moved = any(isinstance(node, Apply) and node.op is STL["mul"] for node in postorder(case.formula))
    if moved or loose(case.formula, PERIOD) is not None:
        raise NothingToCheck
    length = len(next(iter(case.truth.values())))
    choices = []
    for name in case.names:
        for i in range(length):
            low, high = case.known(name, i) if i < case.n else case.ranges.get(name, ANYTHING)
            choices.append([k / 2 for k in range(round(2 * low), round(2 * high) + 1)])
    if math.prod(map(len, choices)) > most:
        raise NothingToCheck
    reached = [
        rho(
            case.formula,
            {name: list(row[k * length : (k + 1) * length]) for k, name in enumerate(case.names)},
            length,
        )
        for row in itertools.product(*choices)
    ]
    bounds = _all_bounds(case, made)[-1]
    for t, (lower, upper) in enumerate(bounds):
        assert min(values[t] for values in reached) == lower
        assert max(values[t] for values in reached) == upper


def eager(case: Case, made: Implementation) -> None:
    """Every verdict comes once, with the earliest sample that decides it; outside one class it is that of the end."""
    monitor = made.eager(case.formula, case.names, case.ranges)
    told = []
    try:
        for i, row in enumerate(case.samples):
            told.append(monitor.update(i, **{name: given(known) for name, known in row.items()}))
        told.append(monitor.finish())
        known = _definition(case)
        expected = eager_verdicts.verdicts(case.formula, known, PERIOD)
    except EvaluationError:
        raise NothingToCheck from None
    got = [[(each.time, each.satisfied, each.decided_at) for each in each_update] for each_update in told]
    assert got == [[tuple(each) for each in each_update] for each_update in expected]
    _settled_signs(case, got)


def _settled_signs(case: Case, got: list[list[tuple[int, bool, int]]]) -> None:
    """Check verdicts against the bounds of the definition, whose signs they are, and against the end."""
    truth = boolean(case.formula)
    known = _definition(case)
    stages = [discrete_bounds.bounds(truth, known.until(n), PERIOD) for n in range(1, case.n + 1)]
    stages.append(discrete_bounds.bounds(truth, known, PERIOD))
    seen = set()
    for k, news in enumerate(got):
        for t, satisfied, decided_at in news:
            assert t not in seen
            seen.add(t)
            settled = [
                j
                for j, stage in enumerate(stages)
                for i in [min(t, len(stage.lower) - 1)]
                if (stage.lower[i] > 0 if satisfied else stage.upper[i] < 0)
            ]
            first = min(settled[0], case.n - 1)
            assert decided_at == first
            assert k == (max(t, settled[0]) if settled[0] < case.n else case.n)
    if case.exact:
        assert seen == set(range(case.n))
        if ends_differently(truth, case.ranges) is None:
            final = rho(truth, case.truth, case.n)
            assert all(satisfied == (final[t] > 0) for news in got for t, satisfied, _ in news)


def _definition(case: Case) -> discrete_bounds.Knowledge:
    monitor = DEFINITION.interval(case.formula, case.names, case.ranges, 0)
    for i, row in enumerate(case.samples):
        monitor.update(i, **row)
    monitor.finish()
    return monitor.known


def causes(case: Case, made: Implementation) -> None:
    """With the bounds before any sample, the bounds are the extremes of the causation of all samples so far."""
    assert case.exact
    assert not case.ranges
    if causeless(case.formula) is not None:
        raise NothingToCheck
    instants = range(len(next(iter(case.truth.values()))) - whole_horizon(case.formula))
    expected = _all_bounds(case, DEFINITION)
    monitor = made.causation(case.formula)
    viol, sat = [[each[k] for each in expected[0]] for k in (1, 0)]
    for i, row in enumerate(case.samples):
        news = _causation(monitor, i, row, instants)
        for t in instants:
            viol[t], sat[t] = min(viol[t], news[t].violation), max(sat[t], news[t].satisfaction)
            assert (sat[t], viol[t]) == expected[i + 1][t]


def causation_as_defined(case: Case, made: Implementation) -> None:
    """What each sample causes, at the start of the trace and at every instant, is what the definition says."""
    if causeless(case.formula) is not None:
        raise NothingToCheck
    instants = range(case.n) if horizon(case.formula) is not None else None
    monitor, definition = made.causation(case.formula), DEFINITION.causation(case.formula)
    for i, row in enumerate(case.samples):
        expected = _causation(definition, i, row, instants)
        assert _causation(monitor, i, row, instants) == expected
        runs = monitor.runs() if instants else ()
        for t, each in enumerate(expected if instants else ()):
            here = [run for run in runs if run.begin <= t and (run.end is None or t <= run.end)]
            found = [Causation(run.violation, run.satisfaction) for run in here]
            assert found == ([] if each == NOTHING else [each])


def _causation(monitor: Any, i: int, row: Mapping[str, Any], instants: range | None) -> list[Causation]:
    """Return what a sample causes at instants, or else at the start of the trace."""
    try:
        start = monitor.update(i, **{name: given(known) for name, known in row.items()})
        every = [monitor.causation(t) for t in instants or ()]
    except EvaluationError:
        raise NothingToCheck from None
    assert not every or every[0] == start
    return every or [start]
