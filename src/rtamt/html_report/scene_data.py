"""A scene as JSON data; its arrays go to the store of the page."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from rtamt.html_report.store import Store
    from rtamt.plot.band import Band
    from rtamt.plot.lines import Line, Range
    from rtamt.plot.scene import Panel, Scene
    from rtamt.signals.arrays import FloatArray

#: Points from which on a line has an overview, and parts of the time that an overview has.
_LARGE, _PARTS = 8192, 1500
#: Ranges that are written out; more of them are an array.
_FEW = 64

_EPOCH, _MILLISECOND = np.datetime64(0, "ms"), np.timedelta64(1, "ms")


def data_of(scene: Scene, store: Store) -> dict[str, Any]:
    """Return the data that the script of a page draws; positions are seconds after ``origin``.

    Of a line with many points the page always holds the range of the values in each part of the time, and all of
    the points as long as there is room; a violated requirement may use all of the room, a satisfied one half.
    """
    origin = scene.x_axis.origin
    share = 0.5 if scene.explanation.satisfied else 0.0
    return {
        # Milliseconds are what browsers count dates in.
        "origin": (origin - _EPOCH) / _MILLISECOND if isinstance(origin, np.datetime64) else origin,
        "dated": isinstance(origin, np.datetime64),
        "dense": scene.dense,
        "start": scene.x_axis.start,
        "end": scene.x_axis.end,
        "at": scene.at,
        "critical": None if scene.critical is None else {"node": scene.critical[0], "x": scene.critical[1]},
        "panels": [_panel(panel, store, share) for panel in scene.panels],
        "nodes": [_node(number, scene, store, share) for number in range(len(scene.nodes))],
        "valuesAt": scene.x_axis.text(scene.shown_at(-1)),
        "open": list(scene.chosen(6)),
        "bounds": None if scene.band is None else _bounds(scene.band, scene, store),
    }


def _bounds(band: Band, scene: Scene, store: Store) -> dict[str, Any]:
    """Return the band of what was known after each sample, as a line that is a range everywhere."""
    both = np.concatenate([band.lower, band.upper])
    finite = both[np.isfinite(both)]
    return {
        "decided": None if band.decided is None else scene.x_axis.text(band.decided),
        "robustness": _number(band.robustness),
        "line": {
            "name": "robustness at the start",
            "band": True,
            "points": len(band.positions),
            "low": float(finite.min()) if len(finite) else None,
            "high": float(finite.max()) if len(finite) else None,
            "ends": [bool((both == end).any()) for end in (-np.inf, np.inf)],
            "overview": {
                "at": store.put(band.positions),
                "low": store.put(band.lower),
                "high": store.put(band.upper),
            },
        },
    }


def _panel(panel: Panel, store: Store, share: float) -> dict[str, Any]:
    return {
        "lines": [line_data(line, store, share) for line in panel.lines],
        "thresholds": [limit for limit in panel.thresholds if isfinite(limit)],
        "because": _ranges(panel.because, store),
    }


def _node(number: int, scene: Scene, store: Store, share: float) -> dict[str, Any]:
    node, at = scene.nodes[number], scene.shown_at(number)
    return {
        "text": node.text,
        "name": node.name,
        "line": line_data(node.line, store, share, scene.panels if not node.children else ()),
        "fails": _ranges(node.fails, store),
        "because": _ranges(node.because, store),
        "children": node.children,
        "hidden": node.hidden,
        "value": _number(node.line.at(at)),
        "failing": node.fails_at(at),
    }


def line_data(line: Line, store: Store, share: float, panels: Iterable[Panel] = ()) -> dict[str, Any]:
    """Return a line: its points, of a long one an overview, and its points if the share of room allows."""
    finite = line.values[np.isfinite(line.values)]
    data: dict[str, Any] = {
        "name": line.label,
        "points": len(line.values),
        "low": float(finite.min()) if len(finite) else None,
        "high": float(finite.max()) if len(finite) else None,
        "ends": [bool((line.values == end).any()) for end in (-np.inf, np.inf)],
    }
    if line.names:
        data["names"] = {f"{value:.0f}": name for value, name in line.names.items()}
    if len(line.values) <= _LARGE:
        return data | {"x": _times(line.positions, store, None), "y": _values(line, store, None, panels)}
    data["overview"] = _overview(line, store)
    x, y = _times(line.positions, store, share), _values(line, store, share, panels)
    return data if x is None or y is None else data | {"x": x, "y": y}


def _times(positions: FloatArray, store: Store, share: float | None) -> Any:
    """Return positions as a rule where one gives exactly these, else as an array."""
    count = len(positions)
    start, end = float(positions[0]), float(positions[-1])
    if count > 1 and end > start:
        steps = np.arange(count, dtype=float)
        step = float(f"{(end - start) / (count - 1):.12g}")
        rate = float(f"{(count - 1) / (end - start):.12g}")
        if (start + steps * step == positions).all():
            return {"start": start, "step": step}
        if (start + steps / rate == positions).all():
            return {"start": start, "rate": rate}
    number = store.put(positions, share)
    return None if number is None else {"blob": number}


def _values(line: Line, store: Store, share: float | None, panels: Iterable[Panel]) -> Any:
    """Return values: as a signal moved by a threshold, which a comparison mostly is, else as an array."""
    for panel in panels:
        for signal in panel.lines:
            if len(signal.values) == len(line.values):
                for limit in panel.thresholds:
                    for sign in (1, -1):
                        with np.errstate(over="ignore"):
                            moved = sign * signal.values - sign * limit
                        if (moved == line.values).all():
                            number = store.put(signal.values, share)
                            return None if number is None else {"blob": number, "sign": sign, "limit": limit}
    number = store.put(line.values, share)
    return None if number is None else {"blob": number}


def _overview(line: Line, store: Store) -> dict[str, Any]:
    """Return where each part of the time that has points begins, and its lowest and highest value."""
    starts = line.columns(_PARTS)
    low, high = (reduce.reduceat(line.values, starts) for reduce in (np.minimum, np.maximum))
    if np.abs(line.values[np.isfinite(line.values)]).max(initial=0) < np.finfo(np.float32).max:
        # Rounded outwards: the range holds every value.
        low, high = _single(low, -np.inf), _single(high, np.inf)
    return {"at": store.put(line.positions[starts]), "low": store.put(low), "high": store.put(high)}


def _single(values: FloatArray, towards: float) -> Any:
    rounded = values.astype(np.float32)
    short = rounded > values if towards < 0 else rounded < values
    return np.where(short, np.nextafter(rounded, np.float32(towards)), rounded)


def _ranges(stretches: Sequence[Range], store: Store) -> Any:
    """Return stretches in order; many as the number of an array of their ends."""
    ordered = sorted(stretches)
    if len(ordered) <= _FEW:
        return ordered
    return store.put(np.array(ordered).ravel())


def _number(value: float) -> float | str:
    return value if isfinite(value) else str(value)
