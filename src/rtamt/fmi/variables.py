"""The variables of an FMU, in the order of their value references.

The inputs from 0 on, then the outputs, of several requirements first those of all together, then the
parameters; core/fmi/component.hpp counts in the same way.
"""

from __future__ import annotations

import re
from math import inf
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.language.units.durations import format_duration
from rtamt.language.value_types import Enumeration
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.compiler.program import Program
    from rtamt.language.value_types import ValueType

#: The largest integer of a unit.
_LARGEST = 2**31 - 1

#: The grammar of the naming convention "structured": names with dots, or anything in single quotes.
_STRUCTURED = lazy_pattern(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)


#: Characters that no XML document contains.
_NO_XML = lazy_pattern(r"[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


@dataclass(frozen=True, slots=True)
class Variable:
    """One variable of a unit. ``type``: real, integer, boolean or enumeration; ``causality``: input, output, parameter.

    ``unit``: of the value, such as m/s; empty if none is declared. ``enumeration``: the declared one.
    """

    name: str
    reference: int
    type: str
    causality: str
    start: float
    description: str
    unit: str
    enumeration: Enumeration | None = None


def variables_of(
    program: Program, units: Mapping[str, str], types: Mapping[str, ValueType]
) -> tuple[Variable, ...]:
    """Return the variables of the FMU that carries a program; ``units`` and ``types``: the declared ones, by name.

    Raises :class:`UsageError` if two would have the same name.
    """
    metadata = program.metadata
    assert metadata is not None
    found: list[Variable] = []

    def add(name: str, kind: str, causality: str, start: float, description: str, unit: str) -> None:
        if wrong := _NO_XML.search(name):
            raise UsageError(
                f"the {causality} {name!a} contains {wrong[0]!a}, which XML cannot represent: rename it in "
                f"the specification"
            )
        other = next((v for v in found if v.name == name), None)
        if other is not None or name == "time":
            taken = "the time" if other is None else f"an {other.causality}"
            raise UsageError(
                f"the {causality} '{name}' has the name that {taken} of the unit has already: rename it in the "
                f"specification"
            )
        type_ = types.get(name) if causality != "output" else None
        if type_ is not None:
            kind = _kind(type_, start)
        listed = type_ if isinstance(type_, Enumeration) and kind == "enumeration" else None
        found.append(Variable(name, len(found), kind, causality, start, description, unit, listed))

    for name in program.inputs:
        add(name, "real", "input", 0.0, "a variable of the requirement", units.get(name, ""))
    for name, kind, start, unit, description in _BOUNDS if metadata.early else ():
        add(name, kind, "output", start, description, unit)
    outputs = () if metadata.early else metadata.outputs
    for output, lag in zip(outputs[::2], program.lags[: len(outputs) : 2], strict=True):
        requirement = output.removeprefix("robustness")
        for name, kind, unit, description in _outputs(format_duration(lag * program.period)):
            add(f"{name}{requirement}", kind, "output", 0.0, description, unit)
    for name, places in metadata.parameters.items():
        value = program.instructions[places[0]].x
        add(
            name,
            "real",
            "parameter",
            value,
            "a parameter or constant of the requirement",
            units.get(name, ""),
        )
    return tuple(found)


def _kind(type_: ValueType, start: float) -> str:
    """Return the type of a variable in a unit: the standard starts an enumeration with one of its items."""
    if not isinstance(type_, Enumeration):
        return "boolean"
    if any(abs(code) > _LARGEST for _, code in type_.members):
        return "real"
    return "integer" if type_.member(start) is None else "enumeration"


#: Of a program of bounds: names, types, start values, units and descriptions of its outputs.
_BOUNDS = (
    ("lower", "real", -inf, "", "lower bound of the robustness at the start, valid for every continuation"),
    ("upper", "real", inf, "", "upper bound of the robustness at the start, valid for every continuation"),
    ("verdict", "integer", 0.0, "", "1 satisfied, -1 violated at the start; 0 while that is open"),
    (
        "decided_since",
        "real",
        0.0,
        "s",
        "the time of the sample that decided the verdict; 0 while it is open",
    ),
)


def _outputs(late: str) -> tuple[tuple[str, str, str, str], ...]:
    """Return the names, types, units and descriptions of the outputs of one requirement; ``late``: its horizon."""
    return (
        (
            "robustness",
            "real",
            "",
            f"how far the behaviour is from violating the requirement at known_since ({late} before the last "
            f"sample); 0 while known is false",
        ),
        ("verdict", "integer", "", "1 satisfied, -1 violated at known_since; 0 while known is false"),
        (
            "known",
            "boolean",
            "",
            "whether the horizon has passed, so that robustness and verdict mean something",
        ),
        (
            "known_since",
            "real",
            "s",
            "the time in s that robustness and verdict are for; 0 while known is false",
        ),
    )


def convention(variables: tuple[Variable, ...]) -> str:
    """Return the naming convention that all names keep: ``structured`` where they do, else ``flat``.

    >>> x = Variable("req.value", 0, "real", "input", 0.0, "", "")
    >>> convention((x,)), convention((Variable("robot/speed", 0, "real", "input", 0.0, "", ""),))
    ('structured', 'flat')
    """
    return "structured" if all(_STRUCTURED.fullmatch(v.name) for v in variables) else "flat"
