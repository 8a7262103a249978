"""The words and symbols of the language by their roles: what highlighting and completion read of the operator table."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rtamt.language.operators import STL, Fixity, Tense
from rtamt.language.parsing.grammar import ELSE, THEN
from rtamt.language.parsing.lexer import is_word
from rtamt.language.quantifiers import QUANTIFIERS

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language.records import Operator

__all__ = [
    "DECLARED_BY",
    "DECLARING",
    "QUANTIFYING",
    "functions",
    "kind_of",
    "logical",
    "meaning_of",
    "symbols",
    "temporal",
]

#: The keywords of specification files that are not operators, and what each is for.
DECLARED_BY = {
    "specification": "the name of the specification",
    "from": "import the class of a message",
    "import": "use definitions of another file",
    "optional": "declare a variable that recordings may lack",
    "input": "declare an input variable",
    "output": "declare an output variable",
    "const": "declare a constant",
    "enum": "declare an enumeration",
    "parameter": "declare a parameter with a default",
    "table": "declare a lookup table",
    "topic": "the topic of a variable",
    "require": "a requirement with a name",
    "severity": "the severity of a violation: error, warning or note",
    "def": "define a template",
    "sample": "the sampling rule",
    "group": "declare a group of signals",
}
DECLARING = tuple(DECLARED_BY)

#: The words of quantifiers, before a name and `in`.
QUANTIFYING = (*QUANTIFIERS, "where")


def kind_of(operator: Operator) -> str:
    """Return the role of an operator: "function", "temporal" or "logical".

    >>> kind_of(STL["always"]), kind_of(STL["abs"]), kind_of(STL["and"])
    ('temporal', 'function', 'logical')
    """
    if operator.fixity is Fixity.FUNCTION:
        return "function"
    return "temporal" if operator.tense is not Tense.NONE else "logical"


def meaning_of(operator: Operator) -> str:
    """Return the meaning of an operator on one line."""
    return re.sub(r"\s+", " ", operator.doc)


def temporal() -> list[str]:
    """Return the keywords of temporal operators.

    >>> "always" in temporal() and "G" in temporal() and "and" not in temporal()
    True
    """
    return _spell(lambda op: kind_of(op) == "temporal")


def functions() -> list[str]:
    """Return the names of functions.

    >>> functions()[:3]
    ['abs', 'acos', 'ahead']
    """
    return _spell(lambda op: kind_of(op) == "function")


def logical() -> list[str]:
    """Return the other keywords: connectives and truth values.

    >>> logical()
    ['and', 'else', 'false', 'if', 'iff', 'implies', 'not', 'or', 'then', 'true', 'xor']
    """
    words = {s for op in STL for s in op.spellings if is_word(s)} | {THEN, ELSE}
    return sorted(words - {*temporal(), *functions()})


def symbols() -> list[str]:
    """Return the operators that are symbols, the longest first.

    >>> symbols()[:2]
    ['!==', '<->']
    """
    found = {s for op in STL for s in op.spellings if not is_word(s)}
    return sorted(found, key=lambda s: (-len(s), s))


def _spell(chosen: Callable[[Operator], bool]) -> list[str]:
    return sorted(s for op in STL if chosen(op) for s in op.spellings if is_word(s))
