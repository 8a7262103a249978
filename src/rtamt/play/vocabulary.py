"""The words that the page completes: the operators of the table, declarations and quantifiers."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rtamt.language.operators import STL, Fixity, Tense
from rtamt.language.parsing.lexer import is_word
from rtamt.language.quantifiers import QUANTIFIERS

if TYPE_CHECKING:
    from rtamt.language.operators import Operator

#: What else begins a declaration or a part of one, and what it is for.
DECLARING = {
    "specification": "the name of the specification",
    "import": "use definitions of another file",
    "input": "declare an input variable",
    "output": "declare an output variable",
    "const": "declare a constant",
    "enum": "declare an enumeration",
    "parameter": "declare a parameter with a default",
    "require": "a requirement with a name",
    "sample": "the sampling rule",
    "def": "define a template",
}


def vocabulary() -> list[dict[str, str]]:
    """Return each word with its kind, its meaning and an example.

    >>> next(word for word in vocabulary() if word["word"] == "always")["kind"]
    'temporal'
    """
    found = {word: {"kind": "declaration", "doc": doc, "example": ""} for word, doc in DECLARING.items()}
    for word in QUANTIFIERS:
        found[word] = {"kind": "quantifier", "doc": "over the members of a group", "example": ""}
    for operator in STL:
        for spelling in operator.spellings:
            if is_word(spelling):
                found.setdefault(spelling, _described(operator))
    return [{"word": word, **facts} for word, facts in sorted(found.items())]


def _described(operator: Operator) -> dict[str, str]:
    kind = (
        "function"
        if operator.fixity is Fixity.FUNCTION
        else "temporal"
        if operator.tense is not Tense.NONE
        else "logical"
    )
    return {"kind": kind, "doc": re.sub(r"\s+", " ", operator.doc), "example": operator.example}
