"""What the commands share about terminals: what they print, colour, aligned tables, a counter line for long work."""

from __future__ import annotations

import os
import re
import sys
import time
from typing import TYPE_CHECKING, TextIO

from rtamt.errors import UsageError, choices, escaped
from rtamt.language.printer import PAGE, to_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.language.formula import Formula

COLOR_MODES = ("auto", "always", "never")

#: What a cell of a table is about, to the code that a terminal takes for it.
_CODES = {"good": "32", "bad": "31", "error": "33", "head": "1"}


#: The codes that :func:`paint` writes.
_PAINTED = re.compile(rf"(\x1b\[(?:0|{'|'.join(_CODES.values())})m)")


def say(text: str = "", *, file: TextIO | None = None, color: bool = False, flush: bool = False) -> None:
    """Print a text; every command prints with this, so that no name in it drives the terminal.

    ``color``: whether there may be codes of :func:`paint` in it.
    """
    parts = _PAINTED.split(text) if color else [text]
    parts[::2] = [escaped(part) for part in parts[::2]]
    print("".join(parts), file=file, flush=flush)


def use_color(mode: str, stream: TextIO) -> bool:
    """Return whether to colour what goes to ``stream``; ``auto``: on a terminal, unless NO_COLOR is set."""
    if mode not in COLOR_MODES:
        raise UsageError(f"unknown colour mode '{mode}'{choices(mode, COLOR_MODES, 'modes')}")
    if mode != "auto":
        return mode == "always"
    return stream.isatty() and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"


def paint(text: str, kind: str, color: bool) -> str:
    """Return ``text`` in the colour of its kind (good, bad, error, head).

    >>> paint("ok", "good", False)
    'ok'
    """
    return f"\x1b[{_CODES[kind]}m{escaped(text)}\x1b[0m" if color and kind else text


def printed(formula: Formula) -> str:
    """Return a formula's text; of one that would fill pages, the beginning, and how large it is.

    Named sub-formulas that use each other may be small in a file and astronomical when written out.
    """
    return to_text(formula, limit=PAGE)


def table(
    rows: Sequence[Sequence[str]],
    right: Sequence[int] = (),
    kinds: Sequence[str] = (),
    color: bool = False,
) -> str:
    """Return rows of cells as aligned lines; the first row is the heading.

    ``right``: the columns (from 0) to align to the right, as numbers are. ``kinds``: for every row
    after the heading, the kind (see ``paint``) of its last cell.

    >>> print(table([("trace", "samples"), ("a.csv", "7")], right=[1]))
    trace  samples
    a.csv        7
    """
    rows = [[escaped(cell).replace("\n", "\\n") for cell in row] for row in rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = []
    for number, row in enumerate(rows):
        cells = [
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        ]
        kind = kinds[number - 1] if number and kinds else ""
        cells[-1] = paint(cells[-1].rstrip(), kind, color)
        line = "  ".join(cells).rstrip()
        lines.append(line if number else paint(line, "head", color))
    return "\n".join(lines)


class Progress:
    """A counter line on stderr while work takes long; nothing where stderr is no terminal.

    Use it as a context: the line is gone at the end, and before anything else is printed.
    """

    #: Seconds before the line appears, and between two changes of it.
    PAUSE = 0.25
    #: Characters of a bar.
    WIDTH = 24

    def __init__(self, stream: TextIO | None = None) -> None:
        self._stream = sys.stderr if stream is None else stream
        self._live = self._stream.isatty()
        self._next = time.monotonic() + self.PAUSE
        self._shown = False

    def show(self, text: str) -> None:
        """Show what is going on, at most a few times a second."""
        if self._live and time.monotonic() >= self._next:
            self._next = time.monotonic() + self.PAUSE
            self._shown = True
            self._stream.write(f"\r\x1b[K{escaped(text)}")
            self._stream.flush()

    def bar(self, done: int, total: int, text: str) -> None:
        """Show how much of the work is done."""
        filled = self.WIDTH * done // total
        self.show(f"[{'#' * filled}{'.' * (self.WIDTH - filled)}] {done}/{total} {text}")

    def clear(self) -> None:
        """Take the line away."""
        if self._shown:
            self._stream.write("\r\x1b[K")
            self._stream.flush()
            self._shown = False

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self.clear()
