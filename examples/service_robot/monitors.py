"""The four monitors of the `.stl` files, and the component whose specification was violated first."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import rtamt
from sim import PERIOD

if TYPE_CHECKING:
    from collections.abc import Mapping

SPECS = Path(__file__).parent / "specs"
COMPONENTS = ("perception", "planner", "controller")
NAMES = ("system", *COMPONENTS)


class Monitors:
    """Takes the signals sample by sample; ``robustness`` holds a list for each specification.

    Bounded future is pastified: the value at t refers to the instant one horizon ago. None till then.
    """

    def __init__(self) -> None:
        self._specs = {name: rtamt.load(SPECS / f"{name}.stl", period=PERIOD) for name in NAMES}
        self._monitors = {
            name: rtamt.parse(str(spec.pastified()), period=PERIOD).monitor()
            for name, spec in self._specs.items()
        }
        self.times: list[float] = []
        self.robustness: dict[str, list[float | None]] = {name: [] for name in NAMES}

    def update(self, time: float, signals: Mapping[str, float]) -> None:
        """Take the signals at a time (s)."""
        self.times.append(time)
        for name, monitor in self._monitors.items():
            values = {field: signals[field.partition(".")[0]] for field in monitor.input_names}
            value = monitor.update(time, **values)
            self.robustness[name].append(value if time >= self._specs[name].horizon - 1e-9 else None)

    def fell(self, name: str) -> float | None:
        """Return when a specification was first seen violated (s); None if it never was."""
        values = zip(self.times, self.robustness[name], strict=True)
        return next((time for time, value in values if value is not None and value < 0), None)

    def culprit(self) -> str | None:
        """Return the component whose specification was violated first; None if none did."""
        fallen = {name: at for name in COMPONENTS if (at := self.fell(name)) is not None}
        return min(fallen, key=fallen.__getitem__, default=None)
