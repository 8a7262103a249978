"""The lines that ``rtamt monitor`` prints for the robustness of each instant."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING, Any

from rtamt.cli.command import json_number, stamp_text
from rtamt.cli.terminal import say
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.cli.live_view import Live
    from rtamt.metrics import Metrics


@dataclass(frozen=True, slots=True)
class Output:
    """Prints new results, one JSON object per line; with ``verdicts`` also whether the formula holds.

    On a terminal the live view replaces the lines; into a pipe or a file, both are written. ``metrics``: what exporters
    read; ``name``: of the requirement, if it is the only one.
    """

    verdicts: bool
    live: Live | None = None
    metrics: Metrics | None = None
    name: str = ""

    def point(self, time: Any, robustness: float, parts: Mapping[str, float]) -> None:
        """Print the robustness at one instant; ``parts``: of each of several requirements."""
        if self.metrics is not None:
            for name, value in (parts or {self.name: robustness}).items():
                self.metrics.known(name, value)
        if self.live is not None:
            self.live.point(time, robustness)
            if sys.stdout.isatty():
                return
        # The time is formatted here: it may have more digits than a double.
        timestamp = f'"{stamp_text(time)}"' if isinstance(time, np.datetime64) else stamp_text(time)
        rest: dict[str, Any] = {"robustness": json_number(robustness)}
        if self.verdicts:
            rest["satisfied"] = robustness > 0
        if parts:
            rest["requirements"] = {name: json_number(value) for name, value in parts.items()}
        say(f'{{"time": {timestamp}, {json.dumps(rest)[1:]}', flush=True)
