"""The options of the paper's API as enumerations with RTAMT's values and ``str()``; the sampling period."""

from __future__ import annotations

from enum import Enum
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.language.units.durations import duration
from rtamt.signals import arrays

if TYPE_CHECKING:
    from fractions import Fraction


class Semantics(Enum):
    """The semantics of predicates (the paper's interface-aware semantics).

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeSpecification(semantics=rtamt.Semantics.OUTPUT_ROBUSTNESS)
    >>> print(spec.semantics)
    output-robustness
    """

    STANDARD = "standard"
    OUTPUT_ROBUSTNESS = "output-robustness"
    INPUT_VACUITY = "input-vacuity"
    INPUT_ROBUSTNESS = "input-robustness"
    OUTPUT_VACUITY = "output-vacuity"

    def __str__(self) -> str:
        return self.value


class Language(Enum):
    """The back end in RTAMT; here both run the compiled core, and PYTHON also works without it.

    >>> import rtamt
    >>> spec = rtamt.StlDiscreteTimeSpecification(language=rtamt.Language.CPP)
    >>> print(rtamt.Language.CPP)
    C++
    """

    PYTHON = "python"
    CPP = "C++"

    def __str__(self) -> str:
        return self.value


class TimeInterpretation(Enum):
    """Whether a signal is defined only at its samples or also between them.

    >>> import rtamt
    >>> print(rtamt.TimeInterpretation.DENSE)
    dense-time
    """

    DISCRETE = "discrete_time"
    DENSE = "dense-time"

    def __str__(self) -> str:
        return self.value


class StlIOType(Enum):
    """The role of a variable: input or output.

    >>> import rtamt
    >>> rtamt.StlIOType.IN.name
    'IN'
    """

    IN = 0
    OUT = 1
    UNDEFINED = 2


class StlComparisonOperator(Enum):
    """The comparisons, under the names of RTAMT's two enumerations."""

    LESS = 0
    LEQ = 1
    EQ = 2
    EQUAL = 2  # noqa: PIE796 - the name in comp_op
    NEQ = 3
    GREATER = 4
    GEQ = 5


def sampling(period: float, unit: str, tolerance: float) -> tuple[Fraction, float]:
    """Return a sampling period in seconds, and the tolerance as a fraction of it."""
    seconds = duration(period, unit)
    if seconds == 0:
        raise UsageError(f"the sampling period is {period} {unit}; it must be positive")
    if not (arrays.is_number(tolerance) and 0 <= tolerance <= 1):
        raise UsageError(
            f"the sampling tolerance is {tolerance!r}; it is a fraction of the period, from 0 to 1"
        )
    return seconds, float(tolerance)
