"""Errors of templates that are used before their definition, and of cycles among templates."""

from __future__ import annotations

from itertools import pairwise

from rtamt.language.parsing.lexer import places_of
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from rtamt.language.parsing.parser import FormulaParser

#: Names that the message about a cycle lists.
_LISTED = 8


def templates_to_come(parser: FormulaParser) -> dict[str, str]:
    """Return the templates that are defined further down, each with the error message for an earlier use."""
    if "def" not in parser.words:
        return {}
    words = parser.texts
    starts = [at for at in places_of("def", words, parser.index) if words[at + 2 : at + 3] == ["("]]
    names = {words[at + 1] for at in starts}
    uses = {
        words[at + 1]: {
            words[i]
            for i in range(at + 2, _end(parser, at + 3, until))
            if words[i] in names and words[i + 1] == "("
        }
        for at, until in pairwise([*starts, len(words) - 1])
    }
    found = {name: f"'{name}' is only defined further down; move its definition up" for name in names}
    for cycle in _cycles(uses):
        around = " -> ".join(
            [*cycle, cycle[0]] if len(cycle) < _LISTED else [*cycle[:_LISTED], "...", cycle[0]]
        )
        found.update(dict.fromkeys(cycle, f"templates cannot be recursive, but {around}"))
    return found


def _end(parser: FormulaParser, at: int, until: int) -> int:
    """Return about where a definition ends: at a semicolon, at the next one, or where a line does not continue it."""
    infix, opening = parser.language.infix, parser.language.opening
    while at < until and parser.texts[at] != ";":
        if "\n" in parser.text[parser.ends[at - 1] : parser.starts[at]]:
            before, token = parser.tokens[at - 1], parser.tokens[at]
            complete = before.text == ")" or (
                before.kind != "symbol" and not (infix(before.text) or opening(before.text))
            )
            if complete and token.kind == "name" and infix(token.text) is None:
                break
        at += 1
    return at


def _cycles(uses: Mapping[str, Iterable[str]]) -> Iterator[list[str]]:
    """Yield cycles of uses, at most one through each name."""
    seen: set[str] = set()
    for first in uses:
        path: dict[str, Iterator[str]] = {}
        below = [first] if first not in seen else []
        while below:
            name = below.pop()
            seen.add(name)
            path[name] = iter(sorted(uses[name]))
            while path:
                last = next(reversed(path))
                follows = next(path[last], None)
                if follows is None:
                    del path[last]
                elif follows in path:
                    names = list(path)
                    yield names[names.index(follows) :]
                    path.clear()
                elif follows not in seen:
                    below.append(follows)
                    break
