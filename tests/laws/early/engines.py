"""The law of the two engines of bounds in discrete time: on samples in order they are the same in every respect."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError
from rtamt.signals.discrete import DISCRETE
from rtamt.verdicts.early.discrete_interval import DiscreteIntervalMonitor
from tests.laws.early.cases import ANYTHING, value
from tests.laws.early.laws import NothingToCheck, given

if TYPE_CHECKING:
    from random import Random

    from tests.laws.early.cases import Case

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


def _supposed(rng: Random, case: Case, name: str) -> Any:
    """Draw a prediction: of all later samples, or of the next ones."""
    limits = case.ranges.get(name, ANYTHING)
    pairs = [sorted((value(rng, *limits), value(rng, *limits))) for _ in range(rng.randint(1, 4))]
    if rng.random() < 0.5:
        return tuple(pairs[0])
    return [low for low, _ in pairs], [high for _, high in pairs]


def _same_results(both: list[DiscreteIntervalMonitor], call: Any) -> str:
    """Return what a call of both returns, or its error, as text: bit for bit."""
    first, second = (_text(call, each) for each in both)
    assert first == second
    return first


def _text(call: Any, monitor: DiscreteIntervalMonitor) -> str:
    try:
        return repr(call(monitor))
    except StlError as error:
        return f"{type(error).__name__}: {error}"
