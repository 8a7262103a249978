"""Bounds of the robustness at the start of a trace after each sample: a band that narrows to the robustness."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rtamt.errors import UsageError
from rtamt.plot.clock import Clock
from rtamt.verdicts.at_start import StartMonitor

if TYPE_CHECKING:
    from rtamt.results import Result
    from rtamt.signals.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """What was known after each sample, at ``positions``: ``lower`` and ``upper``.

    ``decided``: the position of the sample that decided the verdict; None if only the end did. ``robustness``: what it
    was in the end.
    """

    positions: FloatArray
    lower: FloatArray
    upper: FloatArray
    decided: float | None
    robustness: float


def band(result: Result) -> Band:
    """Return the bounds of a result's robustness at the start of its trace, as they were after each sample.

    Raises :class:`UsageError` in dense time, and for operators that have no bounds.

    >>> import rtamt
    >>> found = band(rtamt.parse("eventually[0:2](x >= 3)").evaluate({"x": [1, 4, 2, 9]}))
    >>> found.lower.tolist(), found.upper.tolist(), found.decided
    ([-2.0, 1.0, 1.0, 1.0], [inf, inf, 1.0, 1.0], 1.0)
    """
    trace, spec = result.trace, result.specification
    period = trace.domain.period
    if period is None:
        raise UsageError(
            "bounds are drawn in discrete time only; plot without them, or evaluate in discrete time"
        )
    monitor = StartMonitor(spec, period=period, semantics=result.semantics)
    columns = {name: trace.columns[name].tolist() for name in monitor.input_names}
    clock = Clock.of(trace)
    positions = clock.positions(result.signal.times)
    lower, upper = np.empty(len(positions)), np.empty(len(positions))
    step = float(period)
    decided = None
    for i in range(len(positions)):
        monitor.update(i * step, **{name: column[i] for name, column in columns.items()})
        known = monitor.interval()
        lower[i], upper[i] = known.lower, known.upper
        if decided is None and monitor.satisfied is not None:
            decided = float(positions[i])
    return Band(positions, lower, upper, decided, result.robustness)
