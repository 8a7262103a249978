"""The live view of ``rtamt monitor``: verdict, robustness as a moving line of blocks, the latest values."""

from __future__ import annotations

import sys
import time
from collections import deque
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

from rtamt.cli.command import short
from rtamt.cli.terminal import use_color
from rtamt.errors import escaped
from rtamt.extras import library
from rtamt.language.value_types import value_text
from rtamt.lazy.modules import np
from rtamt.signals.coding import NO_TYPES
from rtamt.signals.trace import in_seconds

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from typing import TextIO

    from rtamt.cli.json_lines import Known
    from rtamt.signals.coding import Types
    from rtamt.signals.outcomes import Interval

_BLOCKS = "▁▂▃▄▅▆▇█"
_SIGNS = {True: "✓", False: "✗"}
#: The names of the two lines of bounds.
_BAND = ("upper ", "lower ")


class Live:
    """Draws on a terminal with rich, at most some times a second; a context, at whose end the last view stays.

    ``units``: of variables, shown behind their values. ``types``: of those whose values have names. What is printed on
    stderr meanwhile goes above the view.
    """

    #: Seconds between two updates.
    PAUSE = 0.05
    #: Values that are kept: more columns than a terminal has.
    MOST = 1000

    def __init__(
        self,
        title: str,
        stream: TextIO | None = None,
        units: Mapping[str, str] | None = None,
        types: Types = NO_TYPES,
    ) -> None:
        stream = sys.stderr if stream is None else stream
        console, text, live = (
            library(f"rich.{name}", "--live", "cli") for name in ("console", "text", "live")
        )
        self._text = text.Text  # which reads no markup
        self._live = live.Live(
            self,
            console=console.Console(file=stream, no_color=not use_color("auto", stream)),
            auto_refresh=False,
            redirect_stdout=False,
        )
        self.units = dict(units or {})
        self._types = types
        self._title = title
        self._values: deque[float] = deque(maxlen=self.MOST)
        self._bounds: deque[Interval] = deque(maxlen=self.MOST)
        self._status: tuple[str, bool | None] = ("", None)
        self._latest: dict[str, float | tuple[float, float]] = {}
        self._known: Any = None
        self._lowest: tuple[float, Any] = (inf, None)
        self._samples = 0
        self._next = 0.0

    def __enter__(self) -> Live:
        self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def sample(self, values: Mapping[str, Known], *, whole: bool = False) -> None:
        """Take a sample that the monitor has taken; ``whole``: what it leaves out has no value any more."""
        self._samples += 1
        if whole:
            self._latest.clear()
        self._latest.update((name, value) for name, value in values.items() if value is not None)
        if time.monotonic() >= self._next:
            self._next = time.monotonic() + self.PAUSE
            self._live.refresh()

    def point(self, timestamp: Any, robustness: float) -> None:
        """Take a robustness that became known."""
        self._values.append(robustness)
        self._known = timestamp
        if robustness < self._lowest[0] or self._lowest[1] is None:
            self._lowest = (robustness, timestamp)

    def bounds(self, known: Interval, status: str, satisfied: bool | None) -> None:
        """Take the bounds and the verdict at the start of the trace, as known after a sample."""
        self._bounds.append(known)
        self._status = (status, satisfied)

    def instants(self, known: Sequence[Interval], status: str, satisfied: bool | None) -> None:
        """Take what is known of the robustness at the latest instants, the newest last, and the verdict there."""
        self._bounds = deque(known, maxlen=self.MOST)
        self._status = (status, satisfied)

    def __rich_console__(self, _: object, options: Any) -> Iterator[Any]:
        """Yield the lines, none wider than the terminal."""
        yield self._line(self._title, "bold")
        yield from self._band(options.max_width) if self._bounds else self._robustness(options.max_width)
        values = "  ".join(
            f"{name} = {self._shown(name, value)} {self.units.get(name, '')}".rstrip()
            for name, value in self._latest.items()
        )
        yield self._line(f"{self._samples} sample{'s' if self._samples != 1 else ''}  {values}")

    def _robustness(self, width: int) -> Iterator[Any]:
        seen = list(self._values)[-width:]
        yield self._line(self._verdict(), _color(seen[-1]) if seen else "")
        yield self._text.assemble(*zip(blocks(seen), map(_color, seen), strict=True))

    def _band(self, width: int) -> Iterator[Any]:
        """Yield the verdict, and the bounds as two lines on one scale, which meet in the robustness."""
        text, satisfied = self._status
        known = list(self._bounds)[-(width - len(_BAND[0])) :]
        style = "yellow" if satisfied is None else "green" if satisfied else "red"
        sign = "…" if satisfied is None else _SIGNS[satisfied]
        last = known[-1]
        yield self._line(
            f"{sign} {text}  (robustness from {short(last.lower)} to {short(last.upper)})", style
        )
        ends = [each.upper for each in known], [each.lower for each in known]
        drawn = blocks([*ends[0], *ends[1]])
        for name, part in zip(_BAND, (drawn[: len(known)], drawn[len(known) :]), strict=True):
            yield self._text.assemble((name, "dim"), (part, style))

    def _shown(self, name: str, value: float | tuple[float, float]) -> str:
        if isinstance(value, tuple):
            return f"{self._shown(name, value[0])} to {self._shown(name, value[1])}"
        return value_text(value, self._types.get(name)) or short(value)

    def _line(self, text: str, style: str = "") -> Any:
        return self._text(escaped(text).replace("\n", " "), style, no_wrap=True, overflow="ellipsis")

    def _verdict(self) -> str:
        if not self._values:
            return "… nothing is known yet"
        last = self._values[-1]
        sign = _SIGNS[last > 0] if last else "?"
        lowest = f"lowest {short(self._lowest[0])} at {format_time(self._lowest[1])}"
        return f"{sign} {short(last)} at {format_time(self._known)}  ({lowest})"


def format_time(timestamp: Any) -> str:
    """Return a time for display: to the millisecond, below a second to six digits.

    >>> format_time(12.300000000000001), format_time(1.25e-5), format_time(1700000000.1)
    ('12.3 s', '1.25e-05 s', '1700000000.1 s')
    >>> format_time(np.datetime64("2026-05-01T12:00:00.123456789")), format_time(np.timedelta64(1500, "ms"))
    ('2026-05-01T12:00:00.123', '1.5 s')
    """
    if isinstance(timestamp, np.datetime64):
        return str(timestamp.astype("datetime64[ms]"))
    seconds = float(in_seconds(np.array([timestamp]))[0])
    text = f"{seconds:.3f}".rstrip("0").rstrip(".") if abs(seconds) >= 1 else short(seconds)
    return f"{text} s"


def _color(robustness: float) -> str:
    return "green" if robustness > 0 else "red" if robustness < 0 else "yellow"


def blocks(values: Sequence[float]) -> str:
    """Return values as blocks from the lowest to the highest; infinities are arrows.

    >>> blocks([0, 3.5, 7, float("inf"), float("-inf")])
    '▁▅█↑↓'
    """
    finite = [value for value in values if isfinite(value)]
    low, high = min(finite, default=0.0), max(finite, default=0.0)
    scale = (len(_BLOCKS) - 1) / (high - low) if high > low else 0.0
    return "".join(
        _BLOCKS[int((value - low) * scale + 0.5)] if isfinite(value) else "↑" if value > 0 else "↓"
        for value in values
    )
