"""The templates of a classifier, and the tight value of each for each recording.

A recording satisfies a template whose threshold is at its tight value or easier. So a template with one parameter
turns a recording into one number, and a threshold between two numbers separates recordings.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from math import inf
from typing import TYPE_CHECKING, Any

from rtamt.errors import EvaluationError, StlError, TraceError, UsageError, shown
from rtamt.fleet.suite import Suite
from rtamt.language.formula import Var
from rtamt.language.units.durations import decimal
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.mining.direction import require, roles_of
from rtamt.mining.grid import hardest
from rtamt.mining.parameter_ranges import FARTHEST
from rtamt.mining.region import Region, number
from rtamt.specification import Specification
from rtamt.specification_loader import parse

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.mining.region import Budget

#: The parts of the shortest recording that windows last.
_PARTS = (Fraction(1, 10), Fraction(1, 4))
#: Magnitudes of tight values, from the easiest to the hardest, for a direction of 1.
_SIZES = (*(-(10.0**k) for k in range(15, -10, -1)), 0.0, *(10.0**k for k in range(-9, 16)))
#: The relative error of a tight value, which lies between those of two recordings.
_EXACT = 1e-15

#: Over one number and a threshold: larger thresholds are easier to satisfy, or smaller ones.
_LARGER = ("always({x} <= {p})", "eventually({x} <= {p})", "eventually(always({x} <= {p}))")
_SMALLER = ("always({x} >= {p})", "eventually({x} >= {p})", "eventually(always({x} >= {p}))")
#: Over a window, too.
_LARGER_WITHIN = (
    "always(eventually[0:{w}]({x} <= {p}))",
    "eventually(always[0:{w}]({x} <= {p}))",
    "always(diff[{w}]({x}) <= {p})",
)
_SMALLER_WITHIN = (
    "always(eventually[0:{w}]({x} >= {p}))",
    "eventually(always[0:{w}]({x} >= {p}))",
    "always(diff[{w}]({x}) >= {p})",
)
#: Over two numbers.
_LARGER_PAIR = ("always({x} - {y} <= {p})", "eventually({x} - {y} <= {p})")
_SMALLER_PAIR = ("always({x} - {y} >= {p})", "eventually({x} - {y} >= {p})")


@dataclass(frozen=True)
class Template:
    """A text with a threshold, whose place is ``{p}``; ``direction``: 1 if larger thresholds are easier to satisfy.

    ``own``: the specification and the name of its parameter, of a template that was given.
    """

    text: str
    direction: int
    own: tuple[Specification, str] | None = None

    def written(self, value: float) -> str:
        """Return the text with a threshold."""
        if self.own is not None:
            spec, name = self.own
            return str(spec.with_parameters(**{name: value}))
        return self.text.replace("{p}", number(value))


def builtin(names: Sequence[str], period: Fraction | None, shortest: Fraction) -> list[Template]:
    """Return the templates over these variables; ``period``: that of all recordings, None if they differ."""
    windows: list[str] = []
    if period is not None:
        lengths = {period * max(1, int(part * shortest / period)) for part in _PARTS}
        windows = [decimal(length) or str(length) for length in sorted(lengths)]
    found = []
    signals = [str(Var(name)) for name in names]
    for x in signals:
        for direction, plain, within in ((1, _LARGER, _LARGER_WITHIN), (-1, _SMALLER, _SMALLER_WITHIN)):
            found += [Template(_fill(text, x=x), direction) for text in plain]
            found += [Template(_fill(text, x=x, w=w), direction) for w in windows for text in within]
    for x, y in combinations(signals, 2):
        for direction, pair in ((1, _LARGER_PAIR), (-1, _SMALLER_PAIR)):
            found += [Template(_fill(text, x=x, y=y), direction) for text in pair]
    return found


def _fill(text: str, **parts: str) -> str:
    for name, part in parts.items():
        text = text.replace(f"{{{name}}}", part)
    return text


def own(given: Iterable[Any]) -> list[Template]:
    """Return templates from specifications, each with one threshold of known direction."""
    found = []
    for spec in given:
        if not isinstance(spec, Specification):
            raise UsageError(
                f"templates has {shown(spec)}; give specifications, from rtamt.parse or rtamt.load"
            )
        for one in spec.requirements.values():
            names = require(one, None)
            if len(names) > 1:
                raise UsageError(
                    f"the template '{one}' has the parameters {', '.join(names)}; a template of a classifier has one"
                )
            (role,) = roles_of(one, names, {})
            if role.direction is None or role.bound:
                what = "bounds an interval" if role.bound else "has no known direction"
                raise UsageError(
                    f"'{role.name}' of the template '{one}' {what}; give a template with a threshold"
                )
            if role.whole:  # thresholds lie between the values of two recordings
                raise UsageError(
                    f"'{role.name}' of the template '{one}' is declared as a whole number; declare it as float"
                )
            found.append(Template(str(one), role.direction, (one, role.name)))
    return found


def features(
    templates: Sequence[Template], recordings: Mapping[str, Any], reading: Mapping[str, Any], budget: Budget
) -> NDArray[np.float64]:
    """Return the tight value of each template (a column) for each recording (a row).

    A built-in template that has no value on some recording, such as the change of an infinite signal, has NaN there.
    """
    table = np.empty((len(recordings), len(templates)))
    plain = [column for column, each in enumerate(templates) if each.own is None]
    if plain:
        # Of the standard semantics, robustness is the distance of the threshold from its tight value.
        settings: Any = {**reading, "semantics": "standard"}
        specs = {column: parse(templates[column].written(0.0)) for column in plain}
        suite = Suite(
            {str(column): spec for column, spec in specs.items()}, select=["robustness"], **settings
        )
        undefined: set[int] = set()
        for row, (name, data) in enumerate(recordings.items()):
            budget.take()
            for column, found in zip(plain, suite.evaluate(data), strict=True):
                if found.robustness is not None:
                    table[row, column] = -templates[column].direction * found.robustness
                elif column in undefined or _is_undefined(specs[column], data, settings):
                    undefined.add(column)
                    table[row, column] = np.nan
                else:
                    raise TraceError(f"{name}: {found.error}")
    for column, template in enumerate(templates):
        if template.own is not None:
            spec, parameter = template.own
            for row, (name, data) in enumerate(recordings.items()):
                region = Region(spec, {name: data}, reading, budget)
                table[row, column] = _tight(region, parameter, template.direction)
    return table


def _is_undefined(spec: Specification, data: Any, settings: Mapping[str, Any]) -> bool:
    """Return whether a template cannot be evaluated because it has no value, and not because the data are wrong."""
    try:
        spec.evaluate(data, **settings)
    except StlError as error:
        return isinstance(error, EvaluationError)
    return False


def _tight(region: Region, parameter: str, direction: int) -> float:
    """Return the tight value of one recording; infinite where every value, or none, satisfies the template."""

    def holds(value: float) -> bool:
        return region.holds({parameter: value})

    if holds(-direction * FARTHEST):
        return -direction * inf
    if not holds(direction * FARTHEST):
        return direction * inf
    # Magnitudes first: a tight value is mostly far smaller than the ends.
    k = hardest(lambda k: holds(-direction * _SIZES[k]), len(_SIZES) - 1)
    easy, hard = -direction * _SIZES[k], -direction * _SIZES[k + 1]
    while abs(easy - hard) > _EXACT * max(abs(easy), abs(hard), 1e-6):
        middle = (easy + hard) / 2
        easy, hard = (middle, hard) if holds(middle) else (easy, middle)
    return easy
