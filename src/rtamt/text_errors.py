"""All errors of a text, for editors and ``rtamt lint``; ``parse`` and ``load`` raise the first one."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from rtamt.errors import BoundError, SpecificationError, StlError
from rtamt.language.formula import Apply, Const, postorder
from rtamt.language.operators import STL
from rtamt.language.parsing.imports import Library
from rtamt.language.parsing.recovery import all_errors
from rtamt.language.parsing.specfile import parse_document
from rtamt.lazy.dataclasses import replace
from rtamt.signals.discrete import Discrete
from rtamt.signals.time_domains import DEFAULT
from rtamt.specification_loader import domain_of

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula, Span
    from rtamt.settings import Settings
    from rtamt.signals.time_domain_interface import TimeDomain


def errors_of(
    text: str, first: StlError, *, folder: str | os.PathLike[str] | None = None, **settings: Unpack[Settings]
) -> list[StlError]:
    """Return the errors of a text. ``first``: the one that :func:`rtamt.parse` raised with the same settings.

    >>> import rtamt
    >>> try:
    ...     rtamt.parse("low = x < ; always(y > )")
    ... except rtamt.StlError as error:
    ...     print(*(each.message for each in errors_of("low = x < ; always(y > )", error)), sep="; ")
    expected an operand after '<', got ';'; expected an operand after '>', got ')'
    """
    if not isinstance(first, SpecificationError):
        return [first]
    language, unit, constants = (
        settings.get("language", STL),
        settings.get("unit", "s"),
        settings.get("constants"),
    )
    library = Library(None if folder is None else os.fsdecode(folder))
    found = all_errors(text, language=language, unit=unit, constants=constants, library=library)
    if found:
        return [*found]
    document = parse_document(text, language=language, unit=unit, constants=constants, library=library)
    return _wrong_bounds(document, first, settings)


def _wrong_bounds(document: Document, first: SpecificationError, settings: Settings) -> list[StlError]:
    """Return the errors of bounds that the sampling period or the tick does not allow: ``first``, then the others."""
    domain, period = domain_of(
        document, settings.get("time", DEFAULT), settings.get("period"), settings.get("resolution")
    )
    found: dict[Span | None, StlError] = {first.span: first}
    for each in dict.fromkeys((domain, Discrete(period))):
        for node in postorder(*(assertion.formula for assertion in document.assertions)):
            error = _wrong_bound(each, node, document.text)
            if error is not None:
                found.setdefault(error.span, error)
    return [*found.values()]


def _wrong_bound(domain: TimeDomain, node: Formula, text: str) -> BoundError | None:
    """Return the error of the interval of a node, whatever is wrong below it."""
    if not isinstance(node, Apply) or node.interval is None:
        return None
    try:
        domain.check(replace(node, args=(Const(0.0),) * len(node.args)), text)
    except BoundError as error:
        return error
    return None
