"""The text of a specification that is read from another format."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.interchange.dialect import InexpressibleError
from rtamt.language.formula import Apply, Const, Formula, Var, postorder
from rtamt.language.printing.printer import to_text
from rtamt.language.units.durations import decimal
from rtamt.language.value_types import BOOLEAN, Enumeration
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from fractions import Fraction

_ID = lazy_pattern(r"\w(?:[\w.-]*\w)?")


@dataclass(frozen=True, slots=True)
class ReadRequirement:
    """A requirement with its text in the other format, which becomes a comment, and a description."""

    name: str
    formula: Formula
    source: str
    description: str = ""


@dataclass(frozen=True, slots=True)
class Names:
    """The declarations of a text: roles of variables ("input", "output"), values of constants and parameters."""

    roles: Mapping[str, str] = field(default_factory=dict)
    constants: Mapping[str, float] = field(default_factory=dict)
    parameters: Mapping[str, float] = field(default_factory=dict)


def specification_text(
    title: str, requirements: Iterable[ReadRequirement], names: Names, step: Fraction | None = None
) -> str:
    """Return the text of a specification.

    Args:
        title: the first line, a comment.
        requirements: in the order of the source.
        names: what the formulas use.
        step: the sampling period in seconds; None for none.
    """
    written = list(requirements)
    nodes = postorder(*(each.formula for each in written))
    used = {node.name for node in nodes if isinstance(node, Const)}
    lines = [f"// {title}", ""]
    lines += [f"sample {decimal(step)}s", ""] if step is not None else []
    kinds = {id(node.type): node.type for node in nodes if isinstance(node, Var)}
    for kind in kinds.values():
        if isinstance(kind, Enumeration):
            members = ", ".join(f"{member} = {code}" for member, code in kind.members)
            lines.append(f"enum {kind.name} {{ {members} }}")
    for word, values in (("const", names.constants), ("parameter", names.parameters)):
        lines += [
            f"{word} float {quoted(name)} = {value!r}" for name, value in values.items() if name in used
        ]
    types = {node.name: _type(node) for node in nodes if isinstance(node, Var)}
    for name, kind_name in types.items():
        role = names.roles.get(name)
        lines.append(f"{role + ' ' if role else ''}{kind_name} {quoted(name)}")
    taken = {*types, *names.constants, *names.parameters}
    for each in written:
        name = each.name if each.name not in taken else f"REQ-{each.name}"
        about = f' "{_escape(each.description)}"' if each.description else ""
        lines += [
            "",
            f"// {' '.join(each.source.split())}",
            f"require {_id(name)}{about}:",
            f"    {to_text(each.formula, parameters=True)}",
        ]
    return "\n".join(lines) + "\n"


def require_new(name: str, written: Iterable[ReadRequirement]) -> None:
    """Raise :class:`InexpressibleError` where a requirement has this name already."""
    if any(each.name == name for each in written):
        raise InexpressibleError("there are two requirements of this name")


def require_period(formula: Formula, step: Fraction | None) -> None:
    """Raise :class:`InexpressibleError` for a bound that is not a multiple of a sampling period, None for no period."""
    if step is None:
        return
    for node in postorder(formula):
        interval = node.interval if isinstance(node, Apply) else None
        for bound in () if interval is None else (interval.begin, interval.end):
            if bound is not None and bound % step:
                raise InexpressibleError(
                    f"{decimal(bound) or bound} s in '{node}' is not a whole number of periods of {decimal(step)} s"
                )


def _type(variable: Var) -> str:
    kind = variable.type
    return "bool" if kind is BOOLEAN else kind.name if isinstance(kind, Enumeration) else "float"


def quoted(name: str) -> str:
    """Return a name as a specification has it, in quotes where it needs them."""
    return str(Var(name))


def _id(name: str) -> str:
    return name if _ID.fullmatch(name) else f'"{_escape(name)}"'


def _escape(text: str) -> str:
    return text.replace('"', '""')
