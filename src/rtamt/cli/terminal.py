"""Output of commands on terminals: text, colour, aligned tables, and the progress of long operations."""

from __future__ import annotations

import os
import sys
import time
from importlib import import_module
from io import StringIO
from typing import TYPE_CHECKING, Any, TextIO

from rtamt.errors import UsageError, choices, escaped
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.language.formula import Formula

COLOR_MODES = ("auto", "always", "never")

#: What a cell of a table is about, to the code that a terminal takes for it.
_CODES = {"good": "32", "bad": "31", "error": "33", "head": "1"}
#: Characters to which a column of text may be folded.
_NARROW = 12
#: The same as the codes, for rich.
_STYLES = {"good": "green", "bad": "red", "error": "yellow"}


#: The codes that :func:`paint` writes.
_PAINTED = lazy_pattern(rf"(\x1b\[(?:0|{'|'.join(_CODES.values())})m)")


def say(
    text: str = "",
    *,
    file: TextIO | None = None,
    color: bool = False,
    flush: bool = False,
    exact: bool = False,
) -> None:
    """Print a text; every command prints with this, so that no name in it drives the terminal.

    ``color``: whether there may be codes of :func:`paint` in it. ``exact``: whether the text is a file for programs, so
    that characters that the encoding of the output lacks are an error and not escaped.
    """
    parts = _PAINTED.split(text) if color else [text]
    parts[::2] = [escaped(part) for part in parts[::2]]
    text = "".join(parts)
    print(text if exact else encodable(text, file or sys.stdout), file=file, flush=flush)


def encodable(text: str, stream: TextIO) -> str:
    """Return a text with the characters that the encoding of a stream lacks as escapes."""
    if text.isascii() or stream.errors != "strict":
        return text
    return text.encode(stream.encoding, "backslashreplace").decode(stream.encoding)


def use_color(mode: str, stream: TextIO) -> bool:
    """Return whether output to ``stream`` is coloured; ``auto``: on a terminal, unless NO_COLOR is set."""
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
    from rtamt.language.printing.printer import to_text
    from rtamt.language.printing.writing import PAGE

    return to_text(formula, limit=PAGE)


def table(
    rows: Sequence[Sequence[str]],
    right: Sequence[int] = (),
    kinds: Sequence[str] = (),
    color: bool = False,
    width: int | None = None,
) -> str:
    """Return rows of cells as aligned lines; the first row is the heading.

    ``right``: the columns (from 0) to align to the right, as numbers are. ``kinds``: for every row
    after the heading, the kind (see ``paint``) of its last cell. ``width``: of the terminal; where lines are longer,
    cells of text are folded within their columns if rich is installed.

    >>> print(table([("trace", "samples"), ("a.csv", "7")], right=[1]))
    trace  samples
    a.csv        7
    """
    rows = [[escaped(cell).replace("\n", "\\n") for cell in row] for row in rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    space = 2 * (len(widths) - 1)
    if width is not None and sum(widths) + space > width and _rich("table") is not None:
        whole = {*right, *([len(widths) - 1] if kinds else [])}
        least = sum(own if i in whole else min(own, _NARROW) for i, own in enumerate(widths))
        if least + space <= width:
            return _fold(rows, right, kinds, color, width)
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


def width_of(stream: TextIO) -> int | None:
    """Return the number of columns of a terminal; None if the stream is not a terminal."""
    return terminal_width() if stream.isatty() else None


def terminal_width() -> int:
    """Return the columns of the terminal as :mod:`shutil` does, whose import loads libraries of compression."""
    try:
        chosen = int(os.environ["COLUMNS"])
    except (KeyError, ValueError):
        chosen = 0
    if chosen > 0:
        return chosen
    stream = sys.__stdout__
    if stream is None:
        return 80
    try:
        return os.get_terminal_size(stream.fileno()).columns or 80
    except (ValueError, OSError):  # closed, or no terminal
        return 80


def _rich(module: str) -> Any:
    """Return a module of rich; None where it is not installed."""
    try:
        return import_module(f"rich.{module}")
    except ImportError:
        return None


def _fold(
    rows: Sequence[Sequence[str]], right: Sequence[int], kinds: Sequence[str], color: bool, width: int
) -> str:
    """Return a table with cells folded within their columns, drawn by rich; its codes are those of ``paint``."""
    text = _rich("text").Text  # which reads no markup
    drawn = _rich("table").Table(box=None, pad_edge=False, padding=(0, 2, 0, 0), header_style="bold")
    last = len(rows[0]) - 1
    for i, name in enumerate(rows[0]):
        whole = i in right or (i == last and kinds)  # numbers and verdicts
        drawn.add_column(
            text(name), justify="right" if i in right else "left", overflow="fold", no_wrap=bool(whole)
        )
    for number, (*cells, end) in enumerate(rows[1:]):
        drawn.add_row(*map(text, cells), text(end, _STYLES.get(kinds[number], "") if kinds else ""))
    console = _rich("console").Console(
        file=StringIO(), width=width, force_terminal=color, color_system="standard" if color else None
    )
    console.print(drawn)
    return "\n".join(line.rstrip() for line in console.file.getvalue().rstrip().split("\n"))


class Progress:
    """A counter line on stderr while work takes long, drawn by rich if that is installed; nothing without a terminal.

    Use it as a context: the line is erased at the end, and before anything else is printed.
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
        self._rich: Any = None

    def show(self, text: str) -> None:
        """Show the progress, at most a few times per second."""
        self._show(text)

    def bar(self, done: int, total: int, text: str) -> None:
        """Show how much of the work is done."""
        self._show(text, (done, total))

    def _show(self, text: str, part: tuple[int, int] | None = None) -> None:
        if not self._live or time.monotonic() < self._next:
            return
        self._next = time.monotonic() + self.PAUSE
        self._shown = True
        progress = _rich("progress")
        if progress is not None:
            self._draw(progress, text, part)
            return
        if part is not None:
            done, total = part
            filled = self.WIDTH * done // total
            text = f"[{'#' * filled}{'.' * (self.WIDTH - filled)}] {done}/{total} {text}"
        self._stream.write(f"\r\x1b[K{escaped(text)}")
        self._stream.flush()

    def _draw(self, progress: Any, text: str, part: tuple[int, int] | None) -> None:
        """Draw a bar, the time so far and the text with rich."""
        done, total = part or (None, None)
        if self._rich is None:
            columns = (
                progress.BarColumn(self.WIDTH),
                progress.MofNCompleteColumn(),
                progress.TimeElapsedColumn(),
                progress.TextColumn("{task.description}", markup=False),
            )
            console = _rich("console").Console(
                file=self._stream, no_color=not use_color("auto", self._stream)
            )
            self._rich = progress.Progress(*columns, console=console, transient=True, auto_refresh=False)
            self._rich.add_task(escaped(text), total=total)
        self._rich.start()
        self._rich.update(0, description=escaped(text), completed=done, total=total, refresh=True)

    def clear(self) -> None:
        """Take the line away."""
        if not self._shown:
            return
        self._shown = False
        if self._rich is not None:
            self._rich.stop()
            return
        self._stream.write("\r\x1b[K")
        self._stream.flush()

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_: object) -> None:
        self.clear()
