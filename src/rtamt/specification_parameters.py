"""A specification with other values of its parameters.

Imported on use: most specifications keep the values of their text.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from rtamt.errors import UsageError
from rtamt.language.exact_number import is_same
from rtamt.language.parameters import assigned, bounding
from rtamt.language.parsing.imports import library_of
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.value_types import WHOLE
from rtamt.lazy.dataclasses import replace
from rtamt.settings import parameter_value, require_parameters

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.specification_text import SpecificationText

    _Text = TypeVar("_Text", bound=SpecificationText)


def with_values(spec: _Text, values: Mapping[str, Any]) -> _Text:
    """Return a specification with other values of its parameters; see :meth:`SpecificationText.with_parameters`."""
    current = spec.parameters
    require_parameters(values, current)
    types = spec.document.types
    whole = {each.name for each in spec.document.declarations if each.type in WHOLE}
    given = {
        name: parameter_value(name, value, types.get(name), whole=name in whole)
        for name, value in values.items()
    }
    new = {name: value for name, value in given.items() if not is_same(value, current[name])}
    if not new:
        return spec
    if new.keys() & bounding(spec.document):
        if spec.resolved is None:
            return _parsed_with(spec, {**current, **new})
        original, members = spec.resolved
        over: Any = with_values(original, {**current, **new}).over(members)
        selected: _Text = over if spec.document.selected is None else over.select(spec.document.selected)
        return selected
    doubles = {name: float(value) for name, value in new.items()}
    return replace(spec, document=assigned(spec.document, doubles))


def _parsed_with(spec: _Text, values: Mapping[str, float]) -> _Text:
    """Return a specification with values of parameters of which some bound an interval."""
    if spec.document.replaced:
        names = ", ".join(f"'{name}'" for name in sorted(bounding(spec.document) & values.keys()))
        raise UsageError(
            f"the formula was replaced, and {names} bounds an interval: set it before with_formula()"
        )
    document = parse_document(
        spec.text,
        language=spec.language,
        unit=spec.unit,
        constants=given_constants(spec),
        parameters=values,
        library=library_of(spec.document),
    )
    if spec.document.selected is not None:
        document = document.select(spec.document.selected)
    found = replace(spec, document=document)
    found._check_bounds()
    return found


def given_constants(spec: SpecificationText) -> dict[str, float]:
    """Return the constants that were given in addition to the text."""
    declared = {declaration.name for declaration in spec.document.declarations}
    return {name: v for name, v in spec.document.constants.items() if name not in declared}
