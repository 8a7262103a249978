"""The laws of the ways to compute bounds: they are the same in every respect.

Bounds of samples in order follow changes, or in discrete time are computed anew. Samples that may be late change
bounds once somebody reads them.
"""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError
from rtamt.rewrite.check import unbounded_future
from rtamt.signals.dense import Dense
from rtamt.signals.discrete import DISCRETE
from rtamt.verdicts.early.dense_interval import DenseIntervalMonitor
from rtamt.verdicts.early.discrete_interval import DiscreteIntervalMonitor
from tests.laws.early.cases import ANYTHING, DenseCase, value
from tests.laws.early.laws import NothingToCheck, given

if TYPE_CHECKING:
    from collections.abc import Sequence
    from random import Random

    from rtamt.verdicts.early.interval import IntervalMonitor
    from tests.laws.early.cases import Case, Known

#: Ticks a node with which all open instants are computed anew: never, or always where it is possible.
NEVER, ALWAYS = 0, 10_000


def forced(case: Case, zone: int) -> DiscreteIntervalMonitor:
    """Return a monitor whose engine follows changes, or computes all open instants anew."""
    ranges = {name: limits for name, limits in case.ranges.items() if name in case.names}
    monitor = DiscreteIntervalMonitor(case.formula, DISCRETE.online, at="every", ranges=ranges)
    monitor._session._settings = (*monitor._session._settings, zone)
    monitor.reset()
    return monitor


def agree(rng: Random, case: Case) -> None:
    """Both report the same text of changes, bounds, predictions, errors and ends; copies go on alike."""
    both = [forced(case, zone) for zone in (NEVER, ALWAYS)]
    if not both[1]._backend.computes_zone:
        raise NothingToCheck
    assert not both[0]._backend.computes_zone
    t = 0
    for row in case.samples:
        values = {name: given(known) for name, known in row.items()}
        failed = _same_results(both, lambda each, t=t, values=values: each.update(t, **values))
        _same_results(both, DiscreteIntervalMonitor.changes)
        if failed.startswith("EvaluationError"):
            return
        prediction = {name: _supposed(rng, case, name) for name in case.names if rng.random() < 0.5}
        for instant in (None, *range(t + 6)):
            _same_results(both, lambda each, at=instant: each.interval(at))
            if rng.random() < 0.2:
                _same_results(both, lambda each, at=instant, of=prediction: each.interval(at, prediction=of))
        if rng.random() < 0.3:
            both = [copy.copy(each) for each in both]
            assert [each._backend.computes_zone for each in both] == [False, True]
        t += 1
        if rng.random() < 0.2:  # samples that never come
            t += rng.choice((1, 3, 40))
            _same_results(both, lambda each, t=t: each.watermark(t - 1))
    _same_results(both, DiscreteIntervalMonitor.finish)
    for instant in (None, *range(max(0, t - 3), t)):
        _same_results(both, lambda each, at=instant: each.interval(at))


def read_seldom(rng: Random, case: Case) -> None:
    """A monitor with a lateness reports the same whether it is read after every sample or now and then."""
    ranges = {name: limits for name, limits in case.ranges.items() if name in case.names}
    lateness = rng.choice((1, 3, 10, 100))
    both = [
        DiscreteIntervalMonitor(
            case.formula,
            DISCRETE.online,
            at="every",
            ranges=ranges,
            lateness=lateness,
        )
        for _ in range(2)
    ]
    rows = [(t, case.samples[t % case.n]) for t in range(rng.choice((8, 30, 200)))]
    _read_seldom(rng, both, rows, case, lateness)


def dense_read_seldom(rng: Random, case: DenseCase) -> None:
    """The same in dense time, where every sample may be of some variables alone."""
    ranges = {name: limits for name, limits in case.ranges.items() if name in case.names}
    lateness = rng.choice((1, 3, 10, 100))
    start = unbounded_future(case.formula) is not None or rng.random() < 0.2
    both = [
        DenseIntervalMonitor(
            case.formula,
            Dense("1s"),
            at="start" if start else "every",
            ranges=ranges,
            lateness=lateness,
            on_correction=correction,
        )
        for correction in [rng.choice(("reject", "reject", "replay"))] * 2
    ]
    rows, t = [], rng.choice((0, -5, 7))
    for k in range(rng.choice((8, 30, 200))):
        t += rng.choice((1, 1, 2, 5, 40 if rng.random() < 0.1 else 1))
        rows.append((t, case.updates[k % len(case.updates)][1]))
    _read_seldom(rng, both, rows, case, lateness)


def _read_seldom(
    rng: Random,
    both: Sequence[IntervalMonitor],
    rows: list[tuple[int, dict[str, Known]]],
    case: Case | DenseCase,
    lateness: int,
) -> None:
    """Let samples come late, and read the first of two monitors after each of them."""
    rows = [(t, row) for t, row in rows if t == rows[0][0] or rng.random() < 0.95]
    # Variables of one sample may come one by one.
    rows += [(t, row) for t, row in rows if rng.random() < 0.3]
    rows.sort(key=lambda row: row[0] + rng.uniform(0, lateness + 0.5 * rng.randint(0, 1)))
    for t, row in rows:
        some = [name for name in row if len(row) == 1 or rng.random() < 0.7]
        values = {name: given(row[name]) for name in some}
        _same_results(both, lambda each, t=t, values=values: each.update(t, **values))
        both[0].changes() if both[0].at == "every" else both[0].interval()
        if rng.random() < 0.02:
            mark = t - rng.randint(-1, lateness)
            _same_results(both, lambda each, mark=mark: each.watermark(mark))
        if rng.random() < 0.3:
            asked = (None, *(t + rng.randint(-9, 3) for _ in range(3)))
            prediction = {name: _supposed(rng, case, name) for name in case.names if rng.random() < 0.5}
            for at in rng.sample(asked, rng.randint(0, 4)):
                _same_results(both, lambda each, at=at: each.interval(at))
                if rng.random() < 0.1:
                    _same_results(both, lambda each, at=at, of=prediction: each.interval(at, prediction=of))
            if rng.random() < 0.7:
                _same_results(both, lambda each: each.changes())
        if rng.random() < 0.02:
            both = [copy.copy(each) for each in both]
    _same_results(both, lambda each: each.finish())
    _same_results(both, lambda each: each.interval())


def _supposed(rng: Random, case: Case | DenseCase, name: str) -> Any:
    """Draw a prediction: of all later samples, or of the next ones."""
    limits = case.ranges.get(name, ANYTHING)
    pairs = [sorted((value(rng, *limits), value(rng, *limits))) for _ in range(rng.randint(1, 4))]
    if rng.random() < 0.5 or isinstance(case, DenseCase):
        return tuple(pairs[0])
    return [low for low, _ in pairs], [high for _, high in pairs]


def _same_results(both: Sequence[IntervalMonitor], call: Any) -> str:
    """Return what a call of both returns, or its error, as text: bit for bit."""
    first, second = (_text(call, each) for each in both)
    assert first == second
    return first


def _text(call: Any, monitor: IntervalMonitor) -> str:
    try:
        return repr(call(monitor))
    except StlError as error:
        return f"{type(error).__name__}: {error}"
