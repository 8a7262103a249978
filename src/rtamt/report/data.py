"""A scene as what JSON can hold, small enough for a page."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.plot.lines import Line, Range
    from rtamt.plot.scene import Scene

#: Columns of points that a line has room for: more than a screen is wide, so that there is something to zoom.
COLUMNS = 2000

_EPOCH, _MILLISECOND = np.datetime64(0, "ms"), np.timedelta64(1, "ms")


def data_of(scene: Scene) -> dict[str, Any]:
    """Return what the script of a page draws; positions are seconds after ``origin``."""
    origin = scene.clock.origin
    start, end = scene.clock.start, scene.clock.end
    close = (end - start) / (2 * COLUMNS)
    return {
        # Milliseconds are what browsers count dates in.
        "origin": (origin - _EPOCH) / _MILLISECOND if isinstance(origin, np.datetime64) else origin,
        "dated": isinstance(origin, np.datetime64),
        "dense": scene.dense,
        "start": start,
        "end": end,
        "at": scene.at,
        "critical": None if scene.critical is None else {"node": scene.critical[0], "x": scene.critical[1]},
        "panels": [
            {
                "lines": [_line(line) for line in panel.lines],
                "thresholds": [limit for limit in panel.thresholds if isfinite(limit)],
                "because": _joined(panel.because, 0.0),
            }
            for panel in scene.panels
        ],
        "nodes": [
            {
                "line": _line(node.line),
                "fails": _joined(node.fails, close),
                "because": _joined(node.because, 0.0),
            }
            for node in scene.nodes
        ],
    }


def _line(line: Line) -> dict[str, Any]:
    small = line.decimated(COLUMNS)
    return {
        "name": line.label,
        "points": len(line.positions),
        "x": [float(f"{x:.12g}") for x in small.positions.tolist()],
        "y": [float(f"{y:.7g}") if isfinite(y) else str(y) for y in small.values.tolist()],
    }


def _joined(stretches: Sequence[Range], close: float) -> list[list[float]]:
    """Return stretches in order, those as one that are too close to each other to be told apart."""
    found: list[list[float]] = []
    for start, end in sorted(stretches):
        if found and start - found[-1][1] <= close:
            found[-1][1] = max(found[-1][1], end)
        else:
            found.append([start, end])
    return found
