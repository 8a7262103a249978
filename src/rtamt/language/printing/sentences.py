"""The sentences of a document: each requirement in English, and the meanings of its names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.formula import Apply, postorder
from rtamt.language.printing.english import begins_with_name, to_english
from rtamt.language.printing.writing import PAGE
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula


class Sentence(NamedTuple):
    """A requirement in English: ``text``, and the meaning of each name in it."""

    text: str
    names: Mapping[str, str]

    def __str__(self) -> str:
        return " ".join((self.text, *(f"Here, {name} means: {text}" for name, text in self.names.items())))


def sentences_of(document: Document) -> dict[str, Sentence]:
    """Return the sentence of each requirement, by its name."""
    units = {each.name: each.unit for each in document.declarations if each.unit}
    named = {id(known): name for name, known in document.definitions.items() if isinstance(known, Apply)}
    found = {}
    for requirement in document.requirements:
        formula = requirement.formula
        found[requirement.name] = Sentence(
            _sentence(formula, named, units),
            {
                named[id(part)]: _sentence(part, named, units)
                for part in reversed(postorder(formula))
                if id(part) in named and part is not formula
            },
        )
    return found


def _sentence(formula: Formula, names: Mapping[int, str], units: Mapping[str, str]) -> str:
    text = to_english(formula, names=names, units=units, limit=PAGE)
    # A name is written as it is.
    begins_with_word = text[:1].islower() and not begins_with_name(formula, names)
    return f"{text[:1].upper() + text[1:] if begins_with_word else text}."
