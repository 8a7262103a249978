"""The live view of ``rtamt monitor``: verdict, robustness as a moving line of blocks, the latest values."""

from __future__ import annotations

import shutil
import sys
import time
from collections import deque
from itertools import groupby
from math import inf, isfinite
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from rtamt.cli.command import short, stamp_text
from rtamt.cli.terminal import paint, use_color

if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import TextIO

_BLOCKS = "▁▂▃▄▅▆▇█"
_SIGNS = {True: "✓", False: "✗"}
#: Values that are kept: more columns than a terminal has.
_MOST = 1000


class Live:
    """Draws over its own last lines on a terminal, at most some times a second."""

    #: Seconds between two pictures.
    PAUSE = 0.05

    def __init__(self, title: str, stream: TextIO | None = None) -> None:
        self._title = title
        self._stream = sys.stderr if stream is None else stream
        self._color = use_color("auto", self._stream)
        self._values: deque[float] = deque(maxlen=_MOST)
        self._latest: dict[str, float] = {}
        self._known: Any = None
        self._lowest: tuple[float, Any] = (inf, None)
        self._samples = 0
        self._drawn = 0
        self._next = 0.0

    def sample(self, values: dict[str, float]) -> None:
        """Take a sample that the monitor has taken."""
        self._samples += 1
        self._latest.update(values)
        if time.monotonic() >= self._next:
            self.draw()

    def point(self, stamp: Any, robustness: float) -> None:
        """Take a robustness that became known."""
        self._values.append(robustness)
        self._known = stamp
        if robustness < self._lowest[0] or self._lowest[1] is None:
            self._lowest = (robustness, stamp)

    def draw(self) -> None:
        """Draw over what was drawn before."""
        self._next = time.monotonic() + self.PAUSE
        lines = self._lines(max(shutil.get_terminal_size().columns - 1, 20))
        self.clear()
        self._stream.write("".join(f"{line}\n" for line in lines))
        self._stream.flush()
        self._drawn = len(lines)

    def clear(self) -> None:
        """Take away what was drawn, before anything else is printed."""
        if self._drawn:
            self._stream.write(f"\x1b[{self._drawn}F\x1b[J")
            self._stream.flush()
            self._drawn = 0

    def _lines(self, width: int) -> list[str]:
        values = " ".join(f"{name}={short(value)}" for name, value in self._latest.items())
        lines = [self._title, self._verdict(), f"{self._samples} samples  {values}"]
        cut = [line if len(line) <= width else f"{line[: width - 1]}…" for line in lines]
        seen = list(self._values)[-width:]
        kind = _kind(seen[-1]) if seen else ""
        parts = groupby(zip(blocks(seen), map(_kind, seen), strict=True), key=itemgetter(1))
        line = "".join(paint("".join(block for block, _ in part), of, self._color) for of, part in parts)
        return [paint(cut[0], "head", self._color), paint(cut[1], kind, self._color), line, cut[2]]

    def _verdict(self) -> str:
        if not self._values:
            return "… nothing is known yet"
        last = self._values[-1]
        sign = _SIGNS[last > 0] if last else "?"
        lowest = f"lowest {short(self._lowest[0])} at {stamp_text(self._lowest[1])}"
        return f"{sign} {short(last)} at {stamp_text(self._known)}  ({lowest})"


def _kind(robustness: float) -> str:
    return "good" if robustness > 0 else "bad" if robustness < 0 else "error"


def blocks(values: Sequence[float]) -> str:
    """Return values as blocks from the lowest to the highest; what is infinite as arrows.

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
