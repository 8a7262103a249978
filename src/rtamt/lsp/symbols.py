"""Declared names, and where they are used: what :func:`rtamt.lsp.outline.outline` returns."""

from __future__ import annotations

from bisect import bisect_right
from collections import defaultdict
from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass, field

if TYPE_CHECKING:
    from rtamt.language.formula import Span


@dataclass(frozen=True, slots=True, eq=False)
class Symbol:
    """A declared name: its kind, where the name is written, and the stretch of text in which it has this meaning.

    ``kind``: "variable", "constant", "parameter", "formula" (a named formula), "requirement", "template", "argument" (a
    parameter of a template), "member" (the variable of a quantifier), "group", "field", "table", "enumeration", "value"
    (of an enumeration), "class" (an imported one). ``whole``: the declaration. ``of``: the name of the template,
    enumeration or group that it belongs to.
    """

    name: str
    kind: str
    span: Span
    whole: Span
    scope: Span
    of: str = ""


@dataclass(slots=True)
class Outline:
    """The names of a text.

    ``symbols``: in the order of the text. ``uses``: from the span of a name to its symbol, declarations included.
    ``free``: names without a declaration, with the spans where they are used. ``texts``: quoted texts that are
    no names. ``words``: from the index of a token to what it is: "keyword", "type", "unit", "topic", "class" or
    "argument".
    """

    symbols: list[Symbol] = field(default_factory=list)
    uses: dict[Span, Symbol] = field(default_factory=dict)
    free: dict[str, list[Span]] = field(default_factory=lambda: defaultdict(list))
    texts: dict[Span, str] = field(default_factory=dict)
    words: dict[int, str] = field(default_factory=dict)
    #: Where declarations of variables end, to which a recorded name can be added; none for those that have one.
    ends: dict[Symbol, int] = field(default_factory=dict)

    def at(self, offset: int) -> tuple[Span, Symbol] | None:
        """Return the name at an offset, or directly before it."""
        spans = self._sorted
        found = bisect_right(spans, (offset, offset)) - 1
        for span in spans[max(found, 0) : found + 2]:
            if span.start <= offset <= span.end:
                return span, self.uses[span]
        before = spans[found - 1] if found > 0 else None
        return (before, self.uses[before]) if before and before.start <= offset <= before.end else None

    @property
    def _sorted(self) -> list[Span]:
        return sorted(self.uses)

    def named(self, name: str) -> Symbol | None:
        """Return the symbol of the whole text with this name."""
        return next((each for each in self.symbols if each.name == name and not is_local(each)), None)

    def uses_of(self, symbol: Symbol) -> list[Span]:
        """Return where a symbol is written, in the order of the text."""
        return sorted(span for span, each in self.uses.items() if each is symbol)


def is_local(symbol: Symbol) -> bool:
    """Return whether a name has its meaning in a part of the text only, or only after another name."""
    return symbol.kind in ("argument", "member", "field", "value")
