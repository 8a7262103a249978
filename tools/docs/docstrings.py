"""How the reference shows docstrings: a griffe extension that makes sections out of their prose.

A role such as ``:func:`parse``` becomes a link where the reference shows its target, else plain code.
"""

from __future__ import annotations

import re
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import griffe

sys.path.insert(0, str(Path(__file__).parent))  # griffe loads this file by its path

import prose

if TYPE_CHECKING:
    from collections.abc import Iterator

_ROLE = re.compile(r":(?:attr|class|data|exc|func|meth|mod):`~?([^`]+)`")


class Prose(griffe.Extension):
    """Turns the docstrings of a package into sections."""

    def on_alias_instance(self, *, alias: griffe.Alias, **_: object) -> None:
        """Read our dataclasses as those of the standard library, which are type checked and documented alike."""
        alias.target_path = alias.target_path.replace("rtamt.lazy.dataclasses.", "dataclasses.")

    def on_package(self, *, pkg: griffe.Module, **_: object) -> None:
        """Replace the sections of every docstring once all modules are loaded."""
        for thing in _objects(pkg):
            if thing.docstring:
                thing.docstring.parsed = list(sections(thing))


def sections(thing: griffe.Object) -> Iterator[griffe.DocstringSection]:
    """Yield the sections of a docstring: prose, the table of the parameters, examples and what follows them."""
    assert thing.docstring
    parameters = {p.name: p for p in _parameters(thing)}
    texts, described = prose.parts_of(thing.docstring.value, parameters)
    parts = [_linked(text, thing) for text in texts]
    first = next((i for i, part in enumerate(parts) if part.startswith("```")), len(parts))
    if parts[:first]:
        yield griffe.DocstringSectionText("\n\n".join(parts[:first]))
    if parameters and (described or thing.is_function):
        yield griffe.DocstringSectionParameters(
            [
                griffe.DocstringParameter(
                    name=name,
                    annotation=parameter.annotation,
                    value=None if parameter.default is None else str(parameter.default),
                    description=_linked(described.get(name, ""), thing),
                )
                for name, parameter in parameters.items()
            ]
        )
    if parts[first:]:
        yield griffe.DocstringSectionText("\n\n".join(parts[first:]))


def _objects(module: griffe.Object) -> Iterator[griffe.Object]:
    yield module
    for member in module.members.values():
        if not member.is_alias:
            yield from _objects(member)


def _parameters(thing: griffe.Object) -> list[griffe.Parameter]:
    if not isinstance(thing, (griffe.Class, griffe.Function)):
        return []
    return [p for p in thing.parameters if p.name not in ("self", "cls") and not p.name.startswith("_")]


def _linked(text: str, thing: griffe.Object) -> str:
    """Return a text with its roles as links; outside of the reference they are plain code."""
    if text.startswith(("```", "    ")):
        return text
    return _ROLE.sub(lambda role: _link(role[1], thing), text).replace("``", "`")


def _link(name: str, thing: griffe.Object) -> str:
    owner = thing if thing.is_class or thing.is_module else thing.parent
    first = name.partition(".")[0]
    if first == "rtamt":
        target = name
    elif owner is not None and owner.is_class and first in owner.all_members:
        target = f"{owner.path}.{name}"
    elif first in thing.package.members:
        target = f"{thing.package.path}.{name}"
    else:
        target = f"{thing.module.path}.{name}"
    return f'<autoref identifier="{target}" optional><code>{name}</code></autoref>'
