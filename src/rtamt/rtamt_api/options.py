"""The words that the paper's API uses for choices, whose values and ``str()`` are RTAMT's; how time is sampled."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.language.units import duration
from rtamt.signals import arrays

if TYPE_CHECKING:
    from fractions import Fraction


class Semantics(Enum):
    """How a predicate is applied (the paper's interface-aware semantics)."""

    STANDARD = "standard"
    OUTPUT_ROBUSTNESS = "output-robustness"
    INPUT_VACUITY = "input-vacuity"
    INPUT_ROBUSTNESS = "input-robustness"
    OUTPUT_VACUITY = "output-vacuity"

    def __str__(self) -> str:
        return self.value


class Language(Enum):
    """Which back end RTAMT ran; here both run the compiled core, and PYTHON can do without it."""

    PYTHON = "python"
    CPP = "C++"

    def __str__(self) -> str:
        return self.value


class TimeInterpretation(Enum):
    """Whether a signal exists at its samples only or holds between them."""

    DISCRETE = "discrete_time"
    DENSE = "dense-time"

    def __str__(self) -> str:
        return self.value


class StlIOType(Enum):
    """Which side of the interface a variable is on."""

    IN = 0
    OUT = 1
    UNDEFINED = 2


def sampling(period: float, unit: str, tolerance: float) -> tuple[Fraction, float]:
    """Return a sampling period in seconds, and the fraction of it by which a gap may miss it."""
    seconds = duration(period, unit)
    if seconds == 0:
        raise UsageError(f"the sampling period is {period} {unit}; it must be positive")
    if not (arrays.is_number(tolerance) and 0 <= tolerance <= 1):
        raise UsageError(
            f"the sampling tolerance is {tolerance!r}; it is a fraction of the period, from 0 to 1"
        )
    return seconds, float(tolerance)
