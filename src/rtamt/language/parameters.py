"""Parameters: the values of leaves of formulas that are set without parsing the text again."""

from __future__ import annotations

from rtamt.language.formula import Apply, Formula, Parameter, folds, postorder
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.language.document import Document
    from rtamt.language.parsing.templates import Template


def with_values(formulas: Sequence[Formula], values: Mapping[str, float]) -> tuple[Formula, ...]:
    """Return formulas in which the parameters of these names have these values; what has none is shared.

    >>> from rtamt.language.parsing.parser import parse_formula
    >>> formula = parse_formula("always(x <= limit)", constants={"limit": 4}, parameters=["limit"])
    >>> print(*with_values([formula], {"limit": 3}))
    always(x <= 3)
    """

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Parameter):
            value = values.get(node.name, node.value)
            return node if value == node.value else replace(node, value=value)
        if not isinstance(node, Apply) or all(new is old for new, old in zip(args, node.args, strict=True)):
            return node
        return Apply(node.op, args, node.interval, node.span)

    return folds(formulas, step)


def assigned(document: Document, values: Mapping[str, float]) -> Document:
    """Return a document in which parameters that bound no interval have other values."""
    definitions = document.definitions
    formulas = _formulas(document)
    new = iter(with_values([*formulas, *definitions.values()], values))
    return replace(
        document,
        assertions=tuple([replace(part, formula=next(new)) for part in document.assertions]),
        requirements=tuple([replace(part, formula=next(new)) for part in document.requirements]),
        constants={**document.constants, **values},
        definitions=dict(zip(definitions, new, strict=True)),
        templates=_in_templates(document.templates, values, {}),
        origin=None if document.origin is None else assigned(document.origin, values),
    )


def bounding(document: Document) -> frozenset[str]:
    """Return the names of the constants and parameters that bound an interval."""
    return bounds_of(*_formulas(document), *document.definitions.values())


def bounds_of(*formulas: Formula) -> frozenset[str]:
    """Return the names of the constants and parameters that bound an interval of formulas."""
    intervals = [node.interval for node in postorder(*formulas) if isinstance(node, Apply)]
    return frozenset(name for interval in intervals if interval for name in interval.constants)


def _formulas(document: Document) -> list[Formula]:
    asserted = [assertion.formula for assertion in document.assertions]
    return asserted + [requirement.formula for requirement in document.requirements]


def _in_templates(
    templates: Mapping[str, Template], values: Mapping[str, float], done: dict[int, dict[str, Template]]
) -> dict[str, Template]:
    """Return templates in whose bounds parameters have these values; those in their formulas have them when read."""
    new = done.get(id(templates))
    if new is None:  # templates know one another
        new = done[id(templates)] = {}
        for name, template in templates.items():
            scope = template.scope
            own = {known: value for known, value in values.items() if known in scope.parameters}
            others = _in_templates(scope.templates, values, done)
            scope = replace(scope, constants={**scope.constants, **own}, templates=others)
            new[name] = replace(template, scope=scope)
    return new
