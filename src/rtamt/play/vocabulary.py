"""The words that the page completes: the operators of the table, declarations and quantifiers."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import is_word
from rtamt.language.quantifiers import QUANTIFIERS
from rtamt.language.words import DECLARED_BY, kind_of, meaning_of

if TYPE_CHECKING:
    from rtamt.language.operators import Operator


def vocabulary() -> list[dict[str, str]]:
    """Return each word with its kind, its meaning and an example.

    >>> next(word for word in vocabulary() if word["word"] == "always")["kind"]
    'temporal'
    """
    found = {word: {"kind": "declaration", "doc": doc, "example": ""} for word, doc in DECLARED_BY.items()}
    for word in QUANTIFIERS:
        found[word] = {"kind": "quantifier", "doc": "over the members of a group", "example": ""}
    for operator in STL:
        for spelling in operator.spellings:
            if is_word(spelling):
                found.setdefault(spelling, _describe(operator))
    return [{"word": word, **facts} for word, facts in sorted(found.items())]


def _describe(operator: Operator) -> dict[str, str]:
    return {"kind": kind_of(operator), "doc": meaning_of(operator), "example": operator.example}
