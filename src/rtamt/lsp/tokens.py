"""A position in the tokens of a text, and what is known of them."""

from __future__ import annotations

from bisect import bisect_right

from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import is_name, is_quoted, tokenize, unquoted
from rtamt.lsp.symbols import Outline, Symbol

OPENING, CLOSING = frozenset("([{"), frozenset(")]}")


class TokenReader:
    """The tokens of a text, and the outline that is made of them."""

    def __init__(self, text: str) -> None:
        self.text = text
        tokens = tokenize(text, STL)
        self.texts, self.starts, self.ends = tokens.texts, tokens.starts, tokens.ends
        self.count = len(self.texts) - 1
        self.found = Outline()
        self.taken: set[int] = set()  # tokens whose meaning is known
        self.everywhere = Span(0, len(text))
        self.type_uses: list[int] = []

    def text_at(self, at: int) -> str:
        """Return the characters of a token, "" behind the last one."""
        return self.texts[at] if at < self.count else ""

    def path(self, at: int) -> int:
        """Return the index of the last token of a name with slashes."""
        last = at if self.text_at(at) != "/" else at - 1
        while (
            self.text_at(last + 1) == "/"
            and is_name(self.text_at(last + 2))
            and self.ends[last + 1] == self.starts[last + 2]
            and (last < at or self.ends[last] == self.starts[last + 1])
        ):
            last += 2
        return max(last, at)

    def closing(self, at: int) -> int:
        """Return the index of the token that closes what this one opens."""
        depth = 0
        for inside in range(at, self.count):
            depth += (self.texts[inside] in OPENING) - (self.texts[inside] in CLOSING)
            if depth == 0:
                return inside
        return self.count - 1

    def token_before(self, end: int) -> int:
        """Return the index of the last token that ends at an offset, or before it."""
        return max(bisect_right(self.ends, end, 0, self.count) - 1, 0)

    def begins_line(self, at: int) -> bool:
        """Return whether a token is the first of its line."""
        between = self.text[self.ends[at - 1] : self.starts[at]] if at else "\n"
        return "\n" in between or "\r" in between

    def defines(self, at: int) -> bool:
        """Return whether an assertion may begin at a token before "="."""
        last = self.path(at)
        return self.text_at(last + 1) == "=" and (
            at == 0 or self.texts[at - 1] == ";" or self.begins_line(at)
        )

    def mark(self, at: int, kind: str) -> None:
        """Record what a token is."""
        if at < self.count:
            self.found.words[at] = kind
            self.taken.add(at)

    def mark_type(self, at: int) -> None:
        """Record that a token is the type of what is declared."""
        self.mark(at, "type")
        self.type_uses.append(at)

    def quote(self, at: int, kind: str) -> None:
        """Record that a quoted token is a text, and of which kind."""
        self.found.texts[Span(self.starts[at], self.ends[at])] = kind
        self.taken.add(at)

    def declare(
        self,
        first: int,
        last: int,
        kind: str,
        begin: int,
        end: int,
        *,
        scope: Span | None = None,
        of: str = "",
    ) -> Symbol:
        """Add the symbol that the tokens from ``first`` to ``last`` name; ``begin`` and ``end``: its declaration."""
        span = Span(self.starts[first], self.ends[last])
        text = self.text[span.start : span.end]
        name = unquoted(text) if is_quoted(text) else text
        self.taken.update(range(first, last + 1))
        whole = Span(self.starts[begin], self.ends[min(end, self.count)])
        return self.add(Symbol(name, kind, span, whole, scope or self.everywhere, of))

    def add(self, symbol: Symbol) -> Symbol:
        """Add a symbol."""
        self.found.symbols.append(symbol)
        self.found.uses[symbol.span] = symbol
        return symbol
