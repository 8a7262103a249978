"""Write requirements as a project of FRET: its JSON, with one sentence of FRETish for each requirement."""

from __future__ import annotations

import json
from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.dialect import InexpressibleError
from rtamt.interchange.fret.english import sentence_of, why_no_name
from rtamt.language.formula import Const, Var, postorder
from rtamt.language.units.durations import decimal
from rtamt.language.value_types import BOOLEAN, Enumeration

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtamt.language.formula import Formula
    from rtamt.specification import Specification

_ROLES = {"input": "Input", "output": "Output", None: "Internal"}
_END_NOTE = (
    "where the trace ends before a window of 'within' does, FRET requires nothing, and the requirement may be violated "
    "there: "
)


def write_fret(spec: Specification, component: str | None = None) -> Conversion:
    """Convert the requirements of a specification to a project of FRET.

    Args:
        spec: a specification in discrete time.
        component: the name of the component that all sentences are about, by default that of the specification.

    Returns:
        FRET's JSON, the requirements that FRETish cannot express, and where FRET differs.

    Raises:
        UsageError: the specification is in dense time.

    >>> import json, rtamt
    >>> spec = rtamt.parse("require R1: always(rise(c > 0) -> eventually[0:2](level > 3) or always[2:2] false)")
    >>> json.loads(write_fret(spec, "pump").text)["requirements"][0]["fulltext"]
    'When c > 0 the pump shall within 2 ticks satisfy level > 3'
    """
    if not spec.domain.sampled:
        raise UsageError("FRETish is about samples: read the specification in discrete time")
    component = component or spec.document.name or "system"
    reason = why_no_name(component)
    if reason:
        raise UsageError(f"'{component}' cannot be a component of FRETish{reason}")
    step = Fraction(1) if spec.period is None else Fraction(spec.period)
    requirements: list[dict[str, str]] = []
    rejected: list[Rejection] = []
    inexact: list[str] = []
    formulas: list[Formula] = []
    for requirement in spec.document.requirements:
        try:
            written = sentence_of(requirement.formula, component, step)
        except InexpressibleError as error:
            rejected.append(Rejection(requirement.name, str(error)))
            continue
        formulas.append(requirement.formula)
        if not written.exact:
            inexact.append(requirement.name)
        requirements.append(
            {
                "reqid": requirement.name,
                "parent_reqid": "",
                "project": component,
                "rationale": requirement.description,
                "comments": "",
                "fulltext": written.sentence,
            }
        )
    notes = [f"one tick is one sample of {decimal(step)} s"]
    if inexact:
        notes.append(_END_NOTE + ", ".join(inexact))
    content = {"requirements": requirements, "variables": _variables(spec, formulas, component)}
    names = tuple(each["reqid"] for each in requirements)
    return Conversion(
        json.dumps(content, indent=2, ensure_ascii=False) + "\n", names, tuple(rejected), tuple(notes)
    )


def _variables(spec: Specification, formulas: Iterable[Formula], component: str) -> list[dict[str, str]]:
    """Return the variables of the formulas, and their constants as internal ones with a value."""
    roles = {each.name: each.role for each in spec.document.declarations}
    found: dict[str, dict[str, str]] = {}
    for node in postorder(*formulas):
        if not isinstance(node, Var | Const) or not node.name or node.name in found:
            continue
        kind = (
            "boolean"
            if node.type is BOOLEAN
            else "integer"
            if isinstance(node.type, Enumeration)
            else "double"
        )
        value = node.value if isinstance(node, Const) else None
        if value is not None and kind != "double":
            assigned = str(bool(value)).lower() if kind == "boolean" else str(int(value))
        else:
            assigned = "" if value is None else repr(value)
        found[node.name] = {
            "project": component,
            "component_name": component,
            "variable_name": node.name,
            "idType": "Internal" if value is not None else _ROLES[roles.get(node.name)],
            "dataType": kind,
            "assignment": assigned,
        }
    return list(found.values())
