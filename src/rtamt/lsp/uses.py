"""Find the symbol of each name that declares nothing."""

from __future__ import annotations

from collections import defaultdict
from typing import TYPE_CHECKING

from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import is_name, is_quoted, unquoted
from rtamt.language.quantifiers import QUANTIFIERS
from rtamt.language.units.durations import UNITS
from rtamt.lsp.symbols import Symbol, is_local
from rtamt.lsp.tokens import TokenReader

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_WORDS = frozenset(("then", "else", "inf", "in", "where", "of", *QUANTIFIERS))


class UseReader(TokenReader):
    """What is known of names once all declarations have been read."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self.values: dict[str, Symbol] = {}
        self.named_arguments: list[tuple[int, str]] = []

    def resolve(self) -> None:
        """Find the symbols of all names that declare nothing."""
        everywhere: dict[str, Symbol] = {}
        local: dict[str, list[Symbol]] = defaultdict(list)
        arguments: dict[tuple[str, str], Symbol] = {}
        for symbol in self.found.symbols:
            if symbol.kind in ("argument", "member"):
                local[symbol.name].append(symbol)
                arguments.setdefault((symbol.of, symbol.name), symbol)
            elif not is_local(symbol) and symbol.kind != "requirement":
                everywhere.setdefault(symbol.name, symbol)
        for at, template in self.named_arguments:
            called = arguments.get((template, self.texts[at]))
            self.found.words[at] = "argument"
            if called is not None:
                self.found.uses[Span(self.starts[at], self.ends[at])] = called
        slashes = max((name.count("/") for name in everywhere), default=0)
        at = 0
        while at < self.count:
            text = self.texts[at]
            if at in self.taken or not (is_name(text) or is_quoted(text) or text == "/"):
                at += 1
                continue
            last = self.path(at) if slashes else at
            for end in range(last, at - 1, -1):
                name = unquoted(text) if is_quoted(text) else self.text[self.starts[at] : self.ends[end]]
                if self._use(at, name, everywhere, local, whole=end > at or is_quoted(text)):
                    at = end
                    break
            else:
                if text != "/" and not self._is_operator(at):
                    name = unquoted(text) if is_quoted(text) else text
                    self.found.free[name].append(Span(self.starts[at], self.ends[at]))
            at += 1

    def _use(
        self,
        at: int,
        name: str,
        everywhere: Mapping[str, Symbol],
        local: Mapping[str, list[Symbol]],
        *,
        whole: bool,
    ) -> bool:
        """Record the use of the longest declared name that a name begins with; return whether there is one."""
        start = self.starts[at]
        for part in [name] if whole else _beginnings(name):
            inner = [each for each in local.get(part, ()) if each.scope.start <= start < each.scope.end]
            symbol = (
                inner[-1]
                if inner
                else everywhere.get(part) or (self.values.get(name) if part == name else None)
            )
            if symbol is not None:
                quotes = len(self.texts[at]) if is_quoted(self.texts[at]) else len(part)
                self.found.uses[Span(start, start + quotes)] = symbol
                return True
        return False

    def _is_operator(self, at: int) -> bool:
        text = self.texts[at]
        return is_name(text) and (
            STL.opening(text) is not None
            or STL.infix(text) is not None
            or text in _WORDS
            or self._is_unit(at)
        )

    def _is_unit(self, at: int) -> bool:
        before = self.texts[at - 1] if at else ""
        return self.texts[at] in UNITS and before[:1].isdigit()


def _beginnings(name: str) -> Iterator[str]:
    """Yield a name with dots, and what is left of it without its last words."""
    yield name
    while "." in name:
        name = name.rpartition(".")[0]
        yield name
