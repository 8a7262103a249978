"""What online monitors report while the samples of a recording arrive."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, UsageError
from rtamt.lazy_numpy import np
from rtamt.play.evaluation import chosen, inner, name_of, parsed, result_of, told
from rtamt.play.reduced import extremes, number, numbers, parts
from rtamt.plot.band import band
from rtamt.plot.clock import Clock

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from rtamt.play.evaluation import Sources
    from rtamt.play.messages import Request
    from rtamt.results import Result
    from rtamt.specification import Specification

#: The longest recording that is replayed, in samples, and the most pending instants whose bounds are drawn.
MOST_SAMPLES, _MOST_PENDING = 20_000, 200


def replayed(request: Request, sources: Sources) -> dict[str, Any]:
    """Return what was known after each sample: bounds at the start, and when each instant was decided."""
    try:
        result = _result(request, sources)
        clock = Clock.of(result.trace)
        watched = inner(result.specification)
        return {
            "error": None,
            "formula": name_of(watched),
            "bounds": _bounds(result, request.width),
            "runs": _runs(watched, result, clock, request.width),
        }
    except StlError as error:
        return {"error": told(error, sources)}


def known_at(request: Request, sources: Sources) -> dict[str, Any]:
    """Return the bounds of the instants that are pending when the samples up to the cursor have come."""
    try:
        return {"error": None, "pending": _pending(request, sources)}
    except StlError as error:
        return {"error": told(error, sources)}


def _pending(request: Request, sources: Sources) -> list[list[Any]] | None:
    result = _result(request, sources)
    clock, watched = Clock.of(result.trace), inner(result.specification)
    now, horizon = clock.end if request.at is None else request.at, watched.horizon
    if not isfinite(horizon):
        return None
    monitor = watched.monitor(verdict="interval", at="every", time=result.trace.domain)
    instants = []
    for position, seconds, row in _rows(result, monitor.input_names, clock):
        if position > now:
            break
        monitor.update(seconds, **row)
        instants.append((position, seconds))
    pending = []
    for position, seconds in [each for each in instants if each[0] >= now - horizon][-_MOST_PENDING:]:
        try:
            known = monitor.interval(seconds)
        except UsageError:  # final, and no longer kept
            continue
        if known.lower != known.upper:
            pending.append([position, number(known.lower), number(known.upper)])
    return pending


def _result(request: Request, sources: Sources) -> Result:
    result = chosen(request, result_of(request, parsed(request, sources), sources))[1]
    if result.trace.bounds:
        raise UsageError("a recording with missing samples is not replayed; evaluate it as a whole")
    if result.trace.size > MOST_SAMPLES:
        raise UsageError(
            f"a recording of more than {MOST_SAMPLES} samples is not replayed; it is evaluated as a whole"
        )
    return result


def _bounds(result: Result, width: int) -> dict[str, Any]:
    known = band(result)
    positions, lower, upper = known.positions, known.lower, known.upper
    if len(positions) > 2 * width:
        both = [extremes(positions, each, width) for each in (lower, upper)]
        kept = np.flatnonzero(np.bincount(np.concatenate(both)))
        positions, lower, upper = positions[kept], lower[kept], upper[kept]
    return {
        "x": positions.tolist(),
        "lower": numbers(lower),
        "upper": numbers(upper),
        "decided": known.decided,
    }


def _rows(
    result: Result, names: tuple[str, ...], clock: Clock
) -> Iterator[tuple[float, float, dict[str, float]]]:
    """Yield the samples in the order of time: the position, seconds since the start, and values by name."""
    columns = {name: clock.recorded(name) for name in names}
    start = clock.start
    if not result.trace.domain.continuous:
        step = float(result.trace.step)
        positions = next(iter(columns.values()))[0].tolist() if columns else []
        table = [values.tolist() for _, values in columns.values()]
        for i, (position, *row) in enumerate(zip(positions, *table, strict=True)):
            yield position, i * step, dict(zip(names, row, strict=True))
        return
    rows: dict[float, dict[str, float]] = {}
    for name, (positions, values) in columns.items():
        for position, value in zip(positions.tolist(), values.tolist(), strict=True):
            rows.setdefault(position, {})[name] = value
    for position in sorted(rows):
        yield position, round(position - start, 9), rows[position]


def _runs(watched: Specification, result: Result, clock: Clock, width: int) -> list[list[Any]]:
    """Return intervals with their verdict and the position of the sample that decided it; None: the end did."""
    domain: Any = result.trace.domain
    monitor: Any = watched.monitor(verdict="eager", time=domain)
    found: list[tuple[float, float, bool, float | None]] = []
    start, dense = clock.start, result.trace.domain.continuous
    step = 0.0 if dense else float(result.trace.step)

    def take(verdicts: list[Any], now: float | None) -> None:
        for each in verdicts:
            begin, end = (each.begin, each.end) if dense else (each.time, each.time + step)
            end = clock.end if end is None else start + float(end)
            found.append((start + float(begin), end, each.satisfied, now))

    for position, seconds, row in _rows(result, monitor.input_names, clock):
        take(monitor.update(seconds, **row), position)
    take(monitor.finish(), None)
    found.sort(key=lambda each: each[:2])
    return _merged(found, width)


def _merged(found: list[tuple[float, float, bool, float | None]], width: int) -> list[list[Any]]:
    """Return few runs: of those in one pixel, whether all are satisfied, and when that was known."""
    if len(found) <= 2 * width:
        return [list(each) for each in found]
    begins: NDArray[np.float64] = np.array([each[0] for each in found])
    starts = parts(begins, width).tolist()
    merged = []
    for first, last in zip(starts, [*starts[1:], len(found)], strict=True):
        group = found[first:last]
        failing = [each[3] for each in group if not each[2]]
        moments = failing or [each[3] for each in group]
        known = [each for each in moments if each is not None]
        every = len(known) == len(moments)
        decided = min(known, default=None) if failing else max(known) if every else None
        merged.append([group[0][0], group[-1][1], not failing, decided])
    return merged
