"""The laws of operations without a value in dense time, which the engine is compared with the Python back end for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError
from rtamt.rewrite.check import unbounded_future
from tests.laws.early.laws import given
from tests.laws.early.monitors import PYTHON

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from tests.laws.early.cases import Arrivals, DenseCase
    from tests.laws.early.definition import Implementation


def alike(case: DenseCase, made: Implementation) -> None:
    """The same updates fail as with the Python back end, and leave the bounds as they were."""
    for kind in ("dense_interval", "dense_eager"):
        both = [getattr(each, kind)(case.formula, case.names, case.ranges) for each in (made, PYTHON)]
        for t, row in case.updates:
            values = {name: given(known) for name, known in row.items()}
            before = [each.start() for each in both] if kind == "dense_interval" else None
            fails = [_fails(monitor, t, values) for monitor in both]
            assert fails[0] == fails[1]
            if fails[0]:
                assert before is None or before == [each.start() for each in both]
                break


def late_alike(case: DenseCase, made: Implementation, arrivals: Arrivals) -> None:
    """The same of bounds with samples in any order, also after one that failed, up to the bounds at the end."""
    lateness = arrivals.lateness
    both = [each.dense_interval(case.formula, case.names, case.ranges, lateness) for each in (made, PYTHON)]
    firsts: dict[str, int] = {}
    for t, name, known, mark in arrivals.samples:
        before = [each.start() for each in both]
        fails = [_fails(monitor, t, {name: given(known)}) for monitor in both]
        assert fails[0] == fails[1]
        if fails[0]:
            assert before == [each.start() for each in both]
        else:
            firsts[name] = min(t, firsts.get(name, t))
        if mark is not None:
            fails = [_raises(monitor.watermark, mark) for monitor in both]
            assert fails[0] == fails[1]
    if len(firsts) < len(case.names):
        return
    ends = [_raises(monitor.finish) for monitor in both]
    assert ends[0] == ends[1]
    if ends[0]:
        return
    assert both[0].start() == both[1].start()
    if unbounded_future(case.formula) is None:
        for t in range(max(firsts.values()), max(t for t, _ in case.updates) + 1):
            assert both[0].interval(t) == both[1].interval(t)


def _fails(monitor: Any, t: int, values: Mapping[str, Any]) -> bool:
    return _raises(monitor.update, t, **values)


def _raises(call: Callable[..., object], *args: Any, **values: Any) -> bool:
    try:
        call(*args, **values)
    except EvaluationError:
        return True
    return False
