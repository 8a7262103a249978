"""The laws of bounds and early verdicts in dense time. Each takes a case and an implementation, and asserts.

``"bounds"`` are [L, U] of a formula at an instant, given what is known of the signals so far.
"""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt import Causation, Interval
from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, postorder
from rtamt.language.operators import STL
from rtamt.reference import dense_bounds, eager_verdicts
from rtamt.reference import dense_robustness as dense_reference
from rtamt.reference.dense_bounds import DenseKnowledge
from rtamt.rewrite.check import unbounded_future
from rtamt.rewrite.early import causeless, loose
from rtamt.rewrite.ground import ground
from rtamt.rewrite.semantics import boolean
from tests.laws.early.definition import DEFINITION, TICK
from tests.laws.early.laws import NothingToCheck, given, whole_horizon

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from random import Random

    from rtamt.language.formula import Formula
    from tests.laws.early.cases import Arrivals, DenseCase
    from tests.laws.early.definition import Implementation


def _span(case: DenseCase) -> tuple[int, int]:
    times = [t for t, _ in case.truth.values()]
    return max(t[0] for t in times), max(t[-1] for t in times)


def _dense_rho(formula: Formula, signals: Mapping[str, tuple[list[int], list[float]]]) -> Any:
    try:
        return dense_reference.evaluate(formula, signals, TICK)
    except EvaluationError:
        raise NothingToCheck from None


def _values(steps: Any, ticks: range) -> list[float]:
    return steps.values[np.searchsorted(steps.times, list(ticks), side="right") - 1].tolist()


def _dense_bounds(case: DenseCase, made: Implementation) -> list[list[tuple[float, float]]]:
    """Return the bounds at every tick of the trace, after every update from the first on that starts it."""
    monitor = made.dense_interval(case.formula, case.names, case.ranges)
    ticks = range(_span(case)[0], _span(case)[1] + 1)
    missing = set(case.names)
    found = []
    try:
        for t, row in case.updates:
            monitor.update(t, **{name: given(known) for name, known in row.items()})
            missing -= set(row)
            if not missing:
                each = [monitor.interval(k) for k in ticks]
                found.append([(bounds.lower, bounds.upper) for bounds in each])
        monitor.finish()  # an operation may turn out to have no value
        monitor.start()
    except EvaluationError:
        raise NothingToCheck from None
    return found


def sound(case: DenseCase, made: Implementation) -> None:
    """The robustness of the signals with all later samples lies within the bounds."""
    ticks = range(_span(case)[0], _span(case)[1] + 1)
    expected = _values(_dense_rho(case.formula, case.truth), ticks)
    for bounds in _dense_bounds(case, made):
        for (lower, upper), value in zip(bounds, expected, strict=True):
            assert lower <= value <= upper


def narrowing(case: DenseCase, made: Implementation) -> None:
    """With every update the bounds at every instant only become narrower."""
    for before, after in itertools.pairwise(_dense_bounds(case, made)):
        for (wide_lower, wide_upper), (lower, upper) in zip(before, after, strict=True):
            assert wide_lower <= lower <= upper <= wide_upper


def finished(case: DenseCase, made: Implementation) -> None:
    """At the end the bounds are the robustness of the samples, within all that was told before."""
    assert case.exact
    came: dict[str, tuple[list[int], list[float]]] = {name: ([], []) for name in case.names}
    for t, row in case.updates:
        for name, known in row.items():
            came[name][0].append(t)
            came[name][1].append(known[0])
    start, end = max(t[0] for t, _ in came.values()), max(t[-1] for t, _ in came.values())
    expected = _values(_dense_rho(case.formula, came), range(start, end + 1))
    before = _dense_bounds(case, made)
    monitor = made.dense_interval(case.formula, case.names, case.ranges)
    for t, row in case.updates:
        monitor.update(t, **{name: given(known) for name, known in row.items()})
    monitor.finish()
    final = [monitor.interval(t) for t in range(start, end + 1)]
    assert [(each.lower, each.upper) for each in final] == [(value, value) for value in expected]
    for bounds in before:
        for (lower, upper), value in zip(bounds, expected, strict=False):
            assert lower <= value <= upper


def accepted(case: DenseCase, made: Implementation) -> None:
    """Samples of which every prefix has a value at every instant are accepted, and end as the signals."""
    assert case.exact
    came: dict[str, tuple[list[int], list[float]]] = {name: ([], []) for name in case.names}
    n, steps = 0, None
    for k, (t, row) in enumerate(case.updates):
        for name, known in row.items():
            came[name][0].append(t)
            came[name][1].append(known[0])
        if not all(times for times, _ in came.values()):
            continue
        try:
            steps = _dense_rho(case.formula, came)
        except NothingToCheck:
            break
        n = k + 1
        start, end = max(t[0] for t, _ in came.values()), max(t[-1] for t, _ in came.values())
    if steps is None:
        raise NothingToCheck
    bounds = made.dense_interval(case.formula, case.names, case.ranges)
    verdicts = made.dense_eager(case.formula, case.names, case.ranges)
    for t, row in case.updates[:n]:
        for monitor in (bounds, verdicts):
            monitor.update(t, **{name: given(known) for name, known in row.items()})
    bounds.finish()
    verdicts.finish()
    final = [bounds.interval(t) for t in range(start, end + 1)]
    assert [(each.lower, each.upper) for each in final] == [
        (v, v) for v in _values(steps, range(start, end + 1))
    ]


def as_defined(case: DenseCase, made: Implementation) -> None:
    """After every update the bounds at every tick are those of the definition."""
    if made is DEFINITION:
        raise NothingToCheck
    assert _dense_bounds(case, made) == _dense_bounds(case, DEFINITION)


def start(case: DenseCase, made: Implementation) -> None:
    """Before the first and after every update and at the end, the bounds at the start are those of the definition."""
    if made is DEFINITION:
        raise NothingToCheck
    found = []
    try:
        for each in (made, DEFINITION):
            monitor = each.dense_interval(case.formula, case.names, case.ranges)
            starts = [monitor.start()]
            for t, row in case.updates:
                monitor.update(t, **{name: given(known) for name, known in row.items()})
                starts.append(monitor.start())
            monitor.finish()
            found.append([*starts, monitor.start()])
    except EvaluationError:
        raise NothingToCheck from None
    assert found[0] == found[1]


def late(case: DenseCase, made: Implementation, arrivals: Arrivals) -> None:
    """Samples in any order within the lateness, watermarks between them: as defined, sound and narrowing throughout."""
    ticks = range(_span(case)[0], _span(case)[1] + 1)
    truth = _values(_dense_rho(case.formula, arrivals.truth), ticks)
    both = [
        each.dense_interval(case.formula, case.names, case.ranges, arrivals.lateness)
        for each in (made, DEFINITION)
    ]
    starts: list[tuple[Interval, Interval]] = []
    found: list[list[list[Interval]]] = []

    def look() -> None:
        starts.append((both[0].start(), both[1].start()))
        if both[1].started:
            found.append([[monitor.interval(t) for t in ticks] for monitor in both])

    try:
        for t, name, known, mark in arrivals.samples:
            for monitor in both:
                monitor.update(t, **{name: given(known)})
            look()
            if mark is not None:
                for monitor in both:
                    monitor.watermark(mark)
                look()
        ordered = made.dense_interval(case.formula, case.names, case.ranges)
        for t, row in sorted(case.updates, key=lambda update: update[0]):
            ordered.update(t, **{name: given(known) for name, known in row.items()})
        for monitor in (*both, ordered):
            monitor.finish()
    except EvaluationError:
        raise NothingToCheck from None
    assert all(one == other for one, other in starts)
    widest = [Interval(-math.inf, math.inf)] * len(ticks)
    for now, expected in found:
        assert now == expected
        for before, bounds, value in zip(widest, now, truth, strict=True):
            assert before.lower <= bounds.lower <= value <= bounds.upper <= before.upper
        widest = now
    first, second, third = ([monitor.interval(t) for t in ticks] for monitor in (*both, ordered))
    assert first == second == third


def corrected(case: DenseCase, made: Implementation, wrong: Mapping[tuple[int, str], float]) -> None:
    """With corrections the bounds are those of the corrected samples, as if the wrong ones had never come."""
    span = max(t for t, _ in case.updates) - min(t for t, _ in case.updates)
    ticks = range(_span(case)[0], _span(case)[1] + 1)
    both = [
        each.dense_interval(case.formula, case.names, case.ranges, span, replay=True)
        for each in (made, DEFINITION)
    ]
    try:
        for t, row in case.updates:
            for name, known in row.items():
                value = wrong.get((t, name), given(known))
                for monitor in both:
                    monitor.update(t, **{name: value})
        for t, row in case.updates:
            for name, known in row.items():
                if (t, name) in wrong:
                    for monitor in both:
                        monitor.update(t, **{name: given(known)})
                    assert both[0].start() == both[1].start()
        for monitor in both:
            monitor.finish()
    except EvaluationError:
        raise NothingToCheck from None
    first, second = ([monitor.interval(t) for t in ticks] for monitor in both)
    assert first == second


def tight(case: DenseCase, made: Implementation, most: int = 300) -> None:
    """Both bounds at every instant are attained by some signals, if every sample enters with one polarity."""
    moved = any(isinstance(node, Apply) and node.op is STL["mul"] for node in postorder(case.formula))
    if moved or loose(ground(case.formula, TICK, continuous=True), None) is not None:
        raise NothingToCheck
    start = max(times[0] for times, _ in case.truth.values())
    end = max(t for t, _ in case.updates)
    far = end + 1 + whole_horizon(case.formula)
    cells = []  # (name, tick, choices)
    for name in case.names:
        own = {t: row[name] for t, row in case.updates if name in row}
        for t in [*own, *range(max(own) + 1, far + 1)]:
            low, high = own.get(t) or case.ranges[name]
            cells.append((name, t, [k / 2 for k in range(round(2 * low), round(2 * high) + 1)]))
    if math.prod(len(choices) for _, _, choices in cells) > most:
        raise NothingToCheck
    reached = []
    for values in itertools.product(*(choices for _, _, choices in cells)):
        signals: dict[str, tuple[list[int], list[float]]] = {name: ([], []) for name in case.names}
        for (name, t, _), v in zip(cells, values, strict=True):
            signals[name][0].append(t)
            signals[name][1].append(v)
        reached.append(_values(_dense_rho(case.formula, signals), range(start, end + 1)))
    found = _dense_bounds(case, made)[-1]
    for i, (lower, upper) in enumerate(found[: end - start + 1]):
        assert min(values[i] for values in reached) == lower
        assert max(values[i] for values in reached) == upper


def eager(case: DenseCase, made: Implementation) -> None:
    """Every tick has its verdict once, from the earliest update that decides it; that of the end agrees."""
    monitor = made.dense_eager(case.formula, case.names, case.ranges)
    told = []
    try:
        for t, row in case.updates:
            told.append(monitor.update(t, **{name: given(known) for name, known in row.items()}))
        told.append(monitor.finish())
        expected = eager_verdicts.dense_verdicts(
            case.formula, case.bounded(len(case.updates)), case.names, TICK, case.ranges, finished=True
        )
    except EvaluationError:
        raise NothingToCheck from None
    got = [
        {t: (run.satisfied, run.decided_at) for run in news for t in range(run.begin, run.end)}
        for news in told
    ]
    assert [sum(run.end - run.begin for run in news) for news in told] == [len(each) for each in got]
    assert got == [{t: (satisfied, at) for t, satisfied, at in news} for news in expected]
    if case.exact:
        _dense_signs(case, got)


def _dense_signs(case: DenseCase, got: list[dict[int, tuple[bool, int]]]) -> None:
    """Check verdicts of exact samples against the truth at the end, and that none is missing or comes twice."""
    known = eager_verdicts.after(case.bounded(len(case.updates)), case.names, case.ranges, finished=True)
    assert known.start is not None
    end = max(t for t, _ in case.updates)
    signals = {name: (list(times), list(lower)) for name, (times, lower, _) in known.samples.items()}
    final = _values(_dense_rho(boolean(case.formula), signals), range(known.start, end + 1))
    assert sorted(t for news in got for t in news) == list(range(known.start, end + 1))
    for news in got:
        for t, (satisfied, _) in news.items():
            assert satisfied == (final[t - known.start] > 0)


def _events(case: DenseCase, rng: Random) -> Iterator[tuple[str, int, dict[str, Any]]]:
    """Yield the updates of a case, watermarks between some of them that are as late as they can be, and the end."""
    for k, (t, row) in enumerate(case.updates):
        yield "update", t, {name: given(known) for name, known in row.items()}
        mark = min([later - 1 for later, _ in case.updates[k + 1 :]], default=t + 2)
        if rng.random() < 0.2:
            yield "watermark", mark, {}
    yield "finish", 0, {}


def _caused(monitor: Any, event: tuple[str, int, dict[str, Any]]) -> Causation:
    kind, t, row = event
    caused: Causation = monitor.finish() if kind == "finish" else getattr(monitor, kind)(t, **row)
    return caused


def causes(case: DenseCase, made: Implementation, rng: Random) -> None:
    """With the bounds before any event, the bounds are the extremes of the causation of all events so far."""
    assert case.exact
    if causeless(case.formula) is not None:
        raise NothingToCheck
    try:
        _add_up(case, made, rng)
    except EvaluationError:
        raise NothingToCheck from None


def _add_up(case: DenseCase, made: Implementation, rng: Random) -> None:
    every = unbounded_future(case.formula) is None
    monitor = made.dense_causation(case.formula)
    bounds = DEFINITION.dense_interval(case.formula, case.names, {})
    first = bounds.start()
    start, end = _span(case)
    found = dict.fromkeys(range(start, end + 4), first)
    pairs: list[tuple[Interval, Interval]] = []
    began = False
    for event in _events(case, rng):
        caused = _caused(monitor, event)
        kind, t, row = event
        _ = bounds.finish() if kind == "finish" else getattr(bounds, kind)(t, **row)
        if not bounds.started:
            assert caused == Causation(math.inf, -math.inf)
            continue
        if not began:  # what is known before anything is seen, from this instant on
            unseen = DenseKnowledge({name: ([start], [-math.inf], [math.inf]) for name in case.names})
            steps = dense_bounds.bounds(case.formula, unseen, TICK)
            found = {t: Interval(*steps.at(t)) for t in found}
            began = True
        for t in found if every else [start]:
            now = monitor.causation(t) if every else caused
            assert t != start or now == caused
            lower, upper = max(found[t].lower, now.satisfaction), min(found[t].upper, now.violation)
            found[t] = Interval(lower, upper)
            pairs.append((found[t], bounds.interval(t)))
    # An operation may have turned out to have no value, of which nothing was known until then.
    assert all(one == other for one, other in pairs)


def causation_as_defined(case: DenseCase, made: Implementation, rng: Random) -> None:
    """What each event causes, at the start of the trace and at every instant, is what the definition says."""
    if causeless(case.formula) is not None:
        raise NothingToCheck
    try:
        _compare(case, made, rng)
    except EvaluationError:
        raise NothingToCheck from None


def _compare(case: DenseCase, made: Implementation, rng: Random) -> None:
    every = unbounded_future(case.formula) is None
    monitor, definition = made.dense_causation(case.formula), DEFINITION.dense_causation(case.formula)
    start, end = _span(case)
    missing = set(case.names)
    for event in _events(case, rng):
        assert _caused(monitor, event) == _caused(definition, event)
        missing -= set(event[2])
        for t in range(start, end + 8) if every and not missing else ():
            assert monitor.causation(t) == definition.causation(t)
