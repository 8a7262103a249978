"""Bounds of the robustness at the start of a trace after each sample: a band that narrows to the robustness."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.plot.x_axis import XAxis
from rtamt.verdicts.early.at_start import StartMonitor
from rtamt.verdicts.early.dense import DenseEarlyMonitor, push_tick

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from rtamt.results import Result
    from rtamt.signals.arrays import FloatArray
    from rtamt.signals.dense import DenseTrace
    from rtamt.signals.time_domain_interface import DomainTrace


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """The bounds after each sample, at ``positions``: ``lower`` and ``upper``.

    ``steps``: the same positions in steps of the trace, which are exact. ``decided``: the position of the sample
    that decided the verdict; None if only the end did. ``robustness``: what it was in the end.
    """

    positions: FloatArray
    lower: FloatArray
    upper: FloatArray
    decided: float | None
    robustness: float
    steps: NDArray[np.int64]


#: Samples up to which reports and notebooks show bounds after each of them.
_SHORT = 8192


def short_band(result: Result) -> Band | None:
    """Return the bounds after each sample; None for long traces, and for operators that have none.

    >>> import rtamt
    >>> short_band(rtamt.parse("always(x >= 3)").evaluate({"x": [4] * 10_000})) is None
    True
    """
    if result.trace.samples > _SHORT:
        return None
    try:
        return band(result)
    except UsageError:  # a custom operator has no bounds
        return None


def band(result: Result) -> Band:
    """Return the bounds of a result's robustness at the start of its trace, as they were after each sample.

    In dense time a sample is that of any variable, once all variables have started. Raises :class:`UsageError` for
    operators that have no bounds.

    >>> import rtamt
    >>> found = band(rtamt.parse("eventually[0:2](x >= 3)").evaluate({"x": [1, 4, 2, 9]}))
    >>> found.lower.tolist(), found.upper.tolist(), found.decided
    ([-2.0, 1.0, 1.0, 1.0], [inf, inf, 1.0, 1.0], 1.0)
    """
    trace = result.trace
    replay = trace.domain.part("replay")
    if replay is None:
        raise UsageError(f"bounds are not drawn in {trace.domain.name} time; plot without them")
    spec = result.specification
    # Evaluations do not check declared ranges, so that a sample may lie outside.
    monitor = StartMonitor(spec, time=trace.domain, semantics=result.semantics, ranges=spec._unlimited)
    steps, lower, upper = [], [], []
    decided = None
    for step in replay(trace, monitor):
        known = monitor.interval()
        steps.append(step)
        lower.append(known.lower)
        upper.append(known.upper)
        if decided is None and monitor.satisfied is not None:
            decided = len(steps) - 1
    places = np.array(steps, np.int64)
    positions = XAxis.of(trace).positions(trace.times_at(places))
    return Band(
        positions,
        np.array(lower),
        np.array(upper),
        None if decided is None else float(positions[decided]),
        result.robustness,
        places,
    )


def replay_samples(trace: DomainTrace, monitor: StartMonitor) -> Iterator[int]:
    """Bring the samples of a recording to a monitor; yield the position of each."""
    columns = {name: trace.columns[name].tolist() for name in monitor.input_names}
    step = float(trace.step)
    for i in range(trace.samples):
        monitor.update(i * step, **{name: column[i] for name, column in columns.items()})
        yield i


def replay_ticks(trace: DenseTrace, monitor: StartMonitor) -> Iterator[int]:
    """Bring the samples of a recording in dense time to a monitor; yield positions from its start on."""
    rows: dict[int, dict[str, float]] = {}
    for name in monitor.input_names:
        ticks, values = trace.columns[name]
        for tick, value in zip(ticks.tolist(), values.tolist(), strict=True):
            rows.setdefault(tick, {})[name] = value
    for tick in sorted(rows):
        for each in (monitor.bounds, monitor.truth):
            assert isinstance(each, DenseEarlyMonitor)
            push_tick(each, tick, rows[tick])
        monitor.refresh(tick)
        if tick >= trace.start:
            yield tick - trace.start
