"""The words that the paper's API uses for choices; values and ``str()`` are RTAMT's."""

from __future__ import annotations

from enum import Enum


class Semantics(Enum):
    """How a predicate is judged (the paper's interface-aware semantics)."""

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
