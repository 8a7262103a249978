"""Names and formulas as there is room for them in a figure."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING

from rtamt.errors import escaped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.plot.scene import Panel

#: Characters of a line of the formula.
_TEXT = 100

#: Characters of a signal's name in one line, and in each of two smaller ones.
_NAME, _SMALL = 16, 21


def in_lines(name: str) -> str:
    r"""Return a signal's name as there is room for it beside a panel: in one line, or smaller in two.

    >>> in_lines("speed [m/s]"), in_lines("vehicle_attitude.rollspeed")
    ('speed [m/s]', 'vehicle_attitude.\nrollspeed')
    """
    if len(name) <= _NAME:
        return name
    middle = len(name) // 2
    breaks = [i + 1 for i, character in enumerate(name[:-1]) if character in "._/ "] or [middle]
    dots = [i for i in breaks if name[i - 1] == "."]
    at = min(dots or breaks, key=lambda i: abs(i - middle))
    return f"{shorten(name[:at], _SMALL)}\n{shorten(name[at:], _SMALL)}"


def label_width(names: Sequence[str]) -> float:
    """Return the width of the label of a panel in inches."""
    return 0.26 if any("\n" in name for name in names) else 0.17


def names_height(panel: Panel) -> float:
    """Return the inches that the names of a panel's signals need."""
    names = [in_lines(line.label) for line in panel.lines]
    return label_width(names) * (len(names) + 0.5)


def wrap_formula(text: str) -> list[str]:
    """Return the lines of a formula, at most four."""
    lines = textwrap.wrap(text, _TEXT)
    return lines if len(lines) <= 4 else [*lines[:3], shorten(lines[3], _TEXT - 2) + " …"]


def literal(text: str) -> str:
    r"""Return a text as matplotlib draws it literally: dollars begin no mathematics, control characters are escaped.

    >>> print(literal("$x^{2$"), literal("a\x07\tb"))
    \$x^{2\$ a\x07 b
    """
    return escaped(text).replace("\t", " ").replace("$", r"\$")


def shorten(text: str, most: int) -> str:
    """Return a text abbreviated to at most ``most`` characters."""
    return text if len(text) <= most else text[: most - 1] + "…"
