"""The reports of online monitors during the replay of a recording."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, UsageError
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.play.downsampling import kept_in, number, numbers, parts
from rtamt.play.evaluation import (
    error_as_data,
    horizon_over,
    inner,
    name_of,
    parse_request,
    result_of,
    select_requirement,
)
from rtamt.plot.band import band
from rtamt.plot.x_axis import XAxis

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

    from rtamt.play.downsampling import View
    from rtamt.play.evaluation import Sources
    from rtamt.play.messages import Request
    from rtamt.plot.band import Band
    from rtamt.results import Result
    from rtamt.specification import Specification

    #: Begin and end, the verdict, and the position of the sample that decided it.
    Run = tuple[float, float, bool, float | None]

#: The longest recording that is replayed, in samples, and the most pending instants whose bounds are drawn.
MOST_SAMPLES, _MOST_PENDING = 20_000, 200


@dataclass(frozen=True, slots=True, eq=False)
class Replay:
    """The reports of monitors for a result, sample by sample; ``runs``: see :func:`_runs`."""

    result: Result
    watched: Specification
    band: Band
    runs: list[Run]


def replay_request(request: Request, sources: Sources) -> dict[str, Any]:
    """Return the bounds at the start after each sample, and when each instant was decided."""
    try:
        replay = sources.replays.keep(request, _replay(request, sources))
        return {"error": None, "formula": name_of(replay.watched), **_visible(replay, request, None)}
    except StlError as error:
        return {"error": error_as_data(error, sources)}


def redraw_replay(request: Request, sources: Sources) -> dict[str, Any]:
    """Return ``near``: the visible part of the last replay."""
    try:
        replay = sources.replays.of(request, lambda: _replay(request, sources))
        return {"error": None, "near": _visible(replay, request, request.view)}
    except StlError as error:
        return {"error": error_as_data(error, sources)}


def _replay(request: Request, sources: Sources) -> Replay:
    result = _result(request, sources)
    watched = inner(result.specification)
    return Replay(result, watched, band(result), _runs(watched, result, XAxis.of(result.trace)))


def _visible(replay: Replay, request: Request, view: View | None) -> dict[str, Any]:
    return {
        "view": view,
        "bounds": _bounds(replay.band, request.width, view),
        "runs": _merge_runs(_in_view(replay.runs, view), request.width),
    }


def known_at(request: Request, sources: Sources) -> dict[str, Any]:
    """Return the state of a monitor that has received the samples up to the cursor.

    ``bounds``: of the robustness at the start. ``open``: how many instants have no verdict yet. ``pending``: the bounds
    of the instants whose robustness is not final; None if they never are.
    """
    try:
        replay = sources.replays.of(request, lambda: _replay(request, sources))
        x_axis = XAxis.of(replay.result.trace)
        now = x_axis.end if request.at is None else request.at
        known = replay.band
        last = int(np.searchsorted(known.positions, now, "right")) - 1
        return {
            "error": None,
            "bounds": None if last < 0 else [numbers(each[[last]])[0] for each in (known.lower, known.upper)],
            "open": sum(
                begin <= now < (x_axis.end if decided is None else decided)
                for begin, _, _, decided in replay.runs
            ),
            "pending": _pending(replay, x_axis, now),
        }
    except StlError as error:
        return {"error": error_as_data(error, sources)}


def _pending(replay: Replay, x_axis: XAxis, now: float) -> list[list[Any]] | None:
    result, watched = replay.result, replay.watched
    horizon = horizon_over(watched, result.trace)
    if not isfinite(horizon):
        return None
    monitor = _monitor(watched, result, verdict="interval", at="every")
    instants = []
    for position, seconds, row in _rows(result, monitor.input_names, x_axis):
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


def _monitor(watched: Specification, result: Result, **settings: Any) -> Any:
    # Evaluations do not check declared ranges, so that a sample may lie outside.
    return watched.monitor(time=result.trace.domain, ranges=watched._unlimited, **settings)


def _result(request: Request, sources: Sources) -> Result:
    result = select_requirement(request, result_of(request, parse_request(request, sources), sources))[1]
    if result.trace.bounds:
        raise UsageError("a recording with missing samples is not replayed; evaluate it as a whole")
    if result.trace.size > MOST_SAMPLES:
        raise UsageError(
            f"a recording of more than {MOST_SAMPLES} samples is not replayed; it is evaluated as a whole"
        )
    return result


def _bounds(known: Band, width: int, view: View | None) -> dict[str, Any]:
    kept = kept_in(known.positions, (known.lower, known.upper), width, view)
    return {
        "x": known.positions[kept].tolist(),
        "lower": numbers(known.lower[kept]),
        "upper": numbers(known.upper[kept]),
        "decided": known.decided,
    }


def _rows(
    result: Result, names: tuple[str, ...], x_axis: XAxis
) -> Iterator[tuple[float, float, dict[str, float]]]:
    """Yield the samples in the order of time: the position, seconds since the start, and values by name."""
    columns = {name: x_axis.recorded(name) for name in names}
    start = x_axis.start
    period = result.trace.domain.period
    if period is not None:
        positions = next(iter(columns.values()))[0].tolist() if columns else []
        table = [values.tolist() for _, values in columns.values()]
        for i, (position, *row) in enumerate(zip(positions, *table, strict=True)):
            yield position, i * float(period), dict(zip(names, row, strict=True))
        return
    rows: dict[float, dict[str, float]] = {}
    for name, (positions, values) in columns.items():
        for position, value in zip(positions.tolist(), values.tolist(), strict=True):
            rows.setdefault(position, {})[name] = value
    for position in sorted(rows):
        yield position, round(position - start, 9), rows[position]


def _runs(watched: Specification, result: Result, x_axis: XAxis) -> list[Run]:
    """Return intervals with their verdict and the position of the sample that decided it; None: the end did."""
    domain = result.trace.domain
    monitor = _monitor(watched, result, verdict="eager")
    found: list[Run] = []
    start, dense = x_axis.start, domain.continuous
    period = float(domain.period or 0)

    def take(verdicts: list[Any], now: float | None) -> None:
        for each in verdicts:
            begin, end = (each.begin, each.end) if dense else (each.time, each.time + period)
            end = x_axis.end if end is None else start + float(end)
            found.append((start + float(begin), end, each.satisfied, now))

    for position, seconds, row in _rows(result, monitor.input_names, x_axis):
        take(monitor.update(seconds, **row), position)
    take(monitor.finish(), None)
    found.sort(key=lambda each: each[:2])
    return found


def _in_view(found: list[Run], view: View | None) -> list[Run]:
    if view is None:
        return found
    return [each for each in found if each[1] >= view[0] and each[0] <= view[1]]


def _merge_runs(found: list[Run], width: int) -> list[list[Any]]:
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
