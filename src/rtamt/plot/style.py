"""Colours and signs that everybody can distinguish, in print too."""

from __future__ import annotations

from typing import Any

#: For signals, by Okabe and Ito: distinct for every kind of colour vision. Without the two of verdicts.
SIGNALS = ("#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9", "#5D4A9C")

HOLDS, FAILS = "#0072B2", "#D55E00"
#: Behind what an implicant rests on.
BECAUSE = "#F0E442"
#: Between bounds.
BAND = "#009E73"
INK, QUIET, FAINT = "#1f2328", "#6e7781", "#d1d9e0"

#: The marker of a verdict, in addition to its colour.
SIGNS = {True: "✓", False: "✗"}
INFINITE = {True: "+∞", False: "−∞"}


def number(value: float, digits: int = 4) -> str:
    """Return a number as it is written in a plot.

    >>> number(-2.5), number(float("inf")), number(1.2345, digits=3)
    ('−2.5', '+∞', '1.23')
    """
    if abs(value) == float("inf"):
        return INFINITE[value > 0]
    return f"{value + 0.0:.{digits}g}".replace("-", "−")


def apply_style(axes: Any) -> Any:
    """Apply the common style of all plots to matplotlib's axes, and return them."""
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(FAINT)
    axes.tick_params(labelsize=8, color=FAINT, labelcolor=QUIET, length=3)
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set(fontsize=9, color=QUIET)
    return axes
