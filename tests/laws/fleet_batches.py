"""Fleets and batches of samples for the laws of fleets with a monitor for each key."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from hypothesis import assume
from hypothesis import strategies as st

import rtamt
from rtamt.errors import BoundError, SpecificationError
from rtamt.language.printing.printer import to_text
from tests.support.strategies import formulas

if TYPE_CHECKING:
    from collections.abc import Container, Sequence


class Mode(NamedTuple):
    """The settings of fleets; whether time is dense, samples are late, and values may be missing or uncertain."""

    dense: bool
    late: bool
    partial: bool
    settings: dict[str, Any]


MODES = {
    "delayed": Mode(False, False, False, {"time_unit": "s"}),
    "delayed dense": Mode(True, False, False, {}),
    "eager": Mode(False, False, True, {"verdict": "eager"}),
    "eager dense": Mode(True, False, True, {"verdict": "eager"}),
    "interval": Mode(False, False, True, {"verdict": "interval"}),
    "interval at the start": Mode(False, False, True, {"verdict": "interval", "at": "start"}),
    "interval with late samples": Mode(False, True, True, {"verdict": "interval", "lateness": 2}),
    "interval with corrections": Mode(
        False, True, False, {"verdict": "interval", "lateness": 3, "on_correction": "replay"}
    ),
    "interval dense": Mode(True, False, True, {"verdict": "interval", "ranges": {"x": (-9, 9)}}),
    "interval dense with late samples": Mode(True, True, True, {"verdict": "interval", "lateness": 2}),
    "causation": Mode(False, False, False, {"verdict": "causation"}),
    "causation dense": Mode(True, False, False, {"verdict": "causation"}),
}  # fmt: skip

#: The first timestamp and the sampling period in seconds, also of Unix time with periods below a second.
CLOCKS = ((0.0, 1.0), (1_700_000_000.0, 0.5), (1_700_000_000.1, 0.1))
NUMBERS = st.integers(-9, 8).map(lambda k: k / 2)


class Drawn(NamedTuple):
    """A specification, the settings of its fleets, and the clock of its samples."""

    spec: rtamt.Specification
    settings: dict[str, Any]
    mode: Mode
    start: float
    step: float


class Batch(NamedTuple):
    """Samples of keys; a sample lacks the variables that its row lacks. ``clocks``: the next time of each key."""

    keys: list[Any]
    times: list[float]
    rows: list[dict[str, Any]]
    clocks: dict[Any, float]


def draw_fleet(data: st.DataObject, mode: Mode) -> Drawn:
    """Draw a specification that has fleets of a mode."""
    formula = data.draw(formulas(max_depth=3, discrete=not mode.dense, arithmetic=not mode.partial))
    start, step = data.draw(st.sampled_from(CLOCKS))
    try:
        spec = rtamt.parse(to_text(formula), **({"time": "dense"} if mode.dense else {"period": step}))
    except BoundError:  # a share of another number of samples
        assume(False)
    assume(spec.input_names)
    settings = dict(mode.settings)
    if "ranges" in settings:
        settings["ranges"] = {
            name: bounds for name, bounds in settings["ranges"].items() if name in spec.input_names
        }
    try:
        spec.monitor(**settings)
    except SpecificationError:  # shares have no causation
        assume(False)
    return Drawn(spec, settings, mode, start, step)


def draw_batch(
    data: st.DataObject, drawn: Drawn, every: Sequence[Any], clocks: dict[Any, float], known: Container[Any]
) -> Batch:
    """Draw samples of some keys; sometimes the last one is NaN, or at a time that its key, if ``known``, rejects."""
    mode, names = drawn.mode, drawn.spec.input_names
    keys = data.draw(st.lists(st.sampled_from(every), min_size=1, max_size=8))
    times, rows, ahead = [], [], dict(clocks)
    for key in keys:
        times.append(ahead[key] - (data.draw(st.integers(0, 3)) * drawn.step if mode.late else 0))
        ahead[key] += (data.draw(st.sampled_from([0.5, 1.0, 2.25])) if mode.dense else 1.0) * drawn.step
        given = [name for name in names if not mode.dense or data.draw(st.integers(0, 3))]
        rows.append({name: draw_value(data, mode) for name in given})
    wrong = data.draw(st.sampled_from([None, None, None, "nan", "back"]))
    if wrong == "nan":
        rows[-1] = {**rows[-1], names[0]: np.nan}
    elif wrong == "back":
        times[-1] = drawn.start - 50.0 if keys[-1] in known or keys[-1] in keys[:-1] else np.inf
    return Batch(keys, times, rows, ahead)


def draw_value(data: st.DataObject, mode: Mode) -> Any:
    """Draw a value of a sample: a number or, where it may be, bounds or nothing."""
    number = data.draw(NUMBERS)
    kind = data.draw(st.integers(0, 5)) if mode.partial else 0
    return None if kind == 5 else (number, number + 1) if kind == 4 else number


def columns_of(names: tuple[str, ...], rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return a column for each variable; where a sample does not have it, masked."""
    found: dict[str, Any] = {}
    for name in names:
        values = np.empty(len(rows), object)
        for i, row in enumerate(rows):
            values[i] = row.get(name)
        absent = [name not in row for row in rows]
        found[name] = np.ma.array(values, mask=absent) if any(absent) else list(values)
    return found
