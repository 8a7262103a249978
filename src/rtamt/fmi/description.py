"""A program to the model description of its unit: modelDescription.xml of FMI 2.0 and 3.0."""

from __future__ import annotations

import re
from math import isinf
from typing import TYPE_CHECKING
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from rtamt.fmi.variables import Variable, convention, variables_of
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from rtamt.compiler.program import Program
    from rtamt.language.value_types import ValueType

#: The log category by which a simulator filters; the runtime has no other.
_LOG = {
    "logStatusError": "what cannot go on",
    "logStatusDiscard": "what was refused; the unit is as it was",
}


@dataclass(frozen=True, slots=True)
class Unit:
    """The contents of a model description. ``token`` names the program, so that they cannot be mixed up.

    ``units`` and ``types``: those that are declared of inputs and parameters, by name.
    """

    program: Program
    name: str
    identifier: str
    token: str
    tool: str
    units: Mapping[str, str]
    types: Mapping[str, ValueType]

    @property
    def variables(self) -> tuple[Variable, ...]:
        """The variables of the unit."""
        return variables_of(self.program, self.units, self.types)


def identifier(name: str) -> str:
    """Return a C identifier that looks like a name: the file name of the library, by the standard.

    >>> identifier("request-grant"), identifier("2nd")
    ('request_grant', '_2nd')
    """
    clean = re.sub(r"\W", "_", name, flags=re.ASCII) or "monitor"
    return f"_{clean}" if clean[0].isdigit() else clean


def description(unit: Unit, version: int) -> bytes:
    """Return modelDescription.xml for FMI 2.0 (``version=2``) or 3.0 (``version=3``)."""
    root = _fmi2(unit) if version == 2 else _fmi3(unit)
    indent(root)
    text: bytes = tostring(root, "utf-8")
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + text + b"\n"


def _fmi2(unit: Unit) -> Element:
    variables = unit.variables
    root = _root(unit, "2.0", {"guid": unit.token, "numberOfEventIndicators": "0"})
    _add(
        root,
        "CoSimulation",
        modelIdentifier=unit.identifier,
        canHandleVariableCommunicationStepSize="true",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
    )
    _units(root, variables)
    _types(
        root,
        variables,
        lambda definitions, name: _add(_add(definitions, "SimpleType", name=name), "Enumeration"),
    )
    _logs(root)
    _experiment(root, unit)
    listed = _add(root, "ModelVariables")
    tags = {"real": "Real", "integer": "Integer", "boolean": "Boolean", "enumeration": "Enumeration"}
    for variable in variables:
        scalar = _add(listed, "ScalarVariable", **_common(variable))
        _add(scalar, tags[variable.type], **_declare(variable), start=_start(variable), **_unit(variable))
    outputs = _add(_add(root, "ModelStructure"), "Outputs")
    for variable in variables:
        if variable.causality == "output":  # counted from 1; nothing depends on an input directly
            _add(outputs, "Unknown", index=str(variable.reference + 1), dependencies="")
    return root


def _fmi3(unit: Unit) -> Element:
    variables = unit.variables
    root = _root(unit, "3.0", {"instantiationToken": unit.token})
    _add(
        root,
        "CoSimulation",
        modelIdentifier=unit.identifier,
        canHandleVariableCommunicationStepSize="true",
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
    )
    _units(root, variables)
    _types(root, variables, lambda definitions, name: _add(definitions, "EnumerationType", name=name))
    _logs(root)
    _experiment(root, unit)
    listed = _add(root, "ModelVariables")
    tags = {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "enumeration": "Enumeration"}
    for variable in variables:
        attributes = _common(variable) | _declare(variable) | {"start": _start(variable)} | _unit(variable)
        _add(listed, tags[variable.type], **attributes)
    reference = str(len(variables))
    _add(
        listed,
        "Float64",
        name="time",
        valueReference=reference,
        causality="independent",
        variability="continuous",
    )
    structure = _add(root, "ModelStructure")
    for variable in variables:
        if variable.causality == "output":
            _add(structure, "Output", valueReference=str(variable.reference), dependencies="")
    return root


def _root(unit: Unit, version: str, rest: Mapping[str, str]) -> Element:
    metadata = unit.program.metadata
    assert metadata is not None
    return Element(
        "fmiModelDescription",
        {
            "fmiVersion": version,
            "modelName": unit.name,
            "description": f"Monitor of {metadata.formula}",
            "generationTool": unit.tool,
            "variableNamingConvention": convention(unit.variables),
            **rest,
        },
    )


def _add(parent: Element, tag: str, **attributes: str) -> Element:
    return SubElement(parent, tag, attributes)


def _units(root: Element, variables: tuple[Variable, ...]) -> None:
    # As names only: what a unit is in base units is not declared.
    definitions = _add(root, "UnitDefinitions")
    for name in sorted({variable.unit for variable in variables} - {""}):
        _add(definitions, "Unit", name=name)


def _unit(variable: Variable) -> dict[str, str]:
    return {"unit": variable.unit} if variable.unit else {}


def _types(root: Element, variables: tuple[Variable, ...], define: Callable[[Element, str], Element]) -> None:
    """Declare the enumerations of variables; ``define`` adds one of a name, which takes its items."""
    used = dict.fromkeys(each.enumeration for each in variables if each.enumeration is not None)
    if not used:
        return
    definitions = _add(root, "TypeDefinitions")
    for known in used:
        items = define(definitions, known.name)
        for name, code in known.members:
            _add(items, "Item", name=name, value=str(code))


def _declare(variable: Variable) -> dict[str, str]:
    return {} if variable.enumeration is None else {"declaredType": variable.enumeration.name}


def _logs(root: Element) -> None:
    categories = _add(root, "LogCategories")
    for name, meaning in _LOG.items():
        _add(categories, "Category", name=name, description=meaning)


def _experiment(root: Element, unit: Unit) -> None:
    # Only a sampling period is a natural length of a step.
    step = {"stepSize": repr(float(unit.program.period))} if unit.program.domain.sampled else {}
    _add(root, "DefaultExperiment", startTime="0", **step)


def _common(variable: Variable) -> dict[str, str]:
    attributes = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": variable.causality,
        "variability": "fixed" if variable.causality == "parameter" else "discrete",
        "description": variable.description,
    }
    if variable.causality != "input":
        attributes["initial"] = "exact"
    return attributes


def _start(variable: Variable) -> str:
    if variable.type == "boolean":
        return "true" if variable.start else "false"
    if variable.type in ("integer", "enumeration"):
        return str(int(variable.start))
    if isinf(variable.start):
        return "INF" if variable.start > 0 else "-INF"
    return repr(variable.start)
