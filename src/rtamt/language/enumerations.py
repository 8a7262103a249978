"""Declarations of enumerations: ``enum Mode { MANUAL, AUTO = 4 }``.

::

    enumeration = "enum" , word , "{" , member , { "," , member } , [ "," ] , "}" , [ ";" ]
    member      = ( word | '"' , characters , '"' ) , [ "=" , [ "-" ] , integer ]
"""

from __future__ import annotations

from rtamt.language.formula import Span
from rtamt.language.value_types import Enumeration
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection

    from rtamt.language.parsing.names import NameParser

#: Codes that a double holds exactly.
_LARGEST_CODE = 2**53
_MOST_DIGITS = len(str(_LARGEST_CODE))


def parse_enumeration(parser: NameParser, types: Collection[str]) -> Enumeration:
    """``enumeration = "enum" , word , "{" , member , { "," , member } , [ "," ] , "}" , [ ";" ]``.

    ``types``: the names of other types.
    """
    parser.next()
    name, opening = parser.next(), parser.next()
    if "." in name.text:
        raise parser.error(f"the name of an enumeration is one word, and '{name.text}' has a dot", name.span)
    if name.text in types:
        raise parser.error(f"there is a type '{name.text}' already", name.span)
    members: dict[str, int] = {}
    named: dict[int, str] = {}
    while parser.token.text != "}":
        token = parser.next()
        if token.kind not in ("name", "quoted"):
            raise parser.error(f"expected the name of a member, got {token}", token.span)
        if token.name in members:
            raise parser.error(f"'{token.name}' is twice in {name.text}", token.span)
        code = _code(parser) if parser.accept("=") else next(reversed(members.values()), -1) + 1
        if code > _LARGEST_CODE:
            raise parser.error(
                f"the code of '{token.name}' would be {code}, more than {_LARGEST_CODE}; give it one",
                token.span,
            )
        taken = named.setdefault(code, token.name)
        if taken != token.name:
            raise parser.error(
                f"'{token.name}' and '{taken}' of {name.text} have the same code, {code}", token.span
            )
        members[token.name] = code
        if parser.token.kind == "end":
            raise parser.error("this '{' is never closed", opening.span)
        if not parser.accept(",") and parser.token.text != "}":
            raise parser.error(
                f"expected ',' or '}}' after the member '{token.name}', got {parser.token}", parser.token.span
            )
    if not members:
        raise parser.error(
            f"the enumeration '{name.text}' has no members", Span(opening.start, parser.token.end)
        )
    parser.next()
    parser.accept(";")
    return Enumeration(name.text, tuple(members.items()))


def _code(parser: NameParser) -> int:
    """``[ "-" ] , integer``."""
    minus = parser.accept("-")
    token = parser.next()
    digits = token.text.lstrip("0")
    too_large = len(digits) > _MOST_DIGITS or (digits.isdigit() and int(digits) > _LARGEST_CODE)
    if token.kind != "number" or not token.text.isdigit() or too_large:
        raise parser.error(
            f"the code of a member is a whole number, such as AUTO = 4; got {token}", token.span
        )
    return -int(token.text) if minus else int(token.text)
