"""Find the symbol of each name that declares nothing."""

from __future__ import annotations

from collections import defaultdict
from functools import cached_property
from typing import TYPE_CHECKING

from rtamt.language.formula import Const, Span, postorder
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import is_name, is_quoted, unquoted
from rtamt.language.quantifiers import QUANTIFIERS
from rtamt.language.units.durations import UNITS
from rtamt.language.value_types import Enumeration
from rtamt.lsp.symbols import Symbol, is_local
from rtamt.lsp.tokens import TokenReader

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.language.document import Document
_WORDS = frozenset(("then", "else", "inf", "in", "where", "of", *QUANTIFIERS))


class UseReader(TokenReader):
    """The declarations of names, complete after all declarations have been read."""

    def __init__(self, text: str, document: Document | None = None) -> None:
        super().__init__(text)
        self.document = document
        self.named_arguments: list[tuple[int, str]] = []
        #: Names of the whole text, and those with a meaning in a part of it.
        self.names: dict[str, Symbol] = {}
        self.local: dict[str, list[Symbol]] = defaultdict(list)
        #: Fields, members of enumerations and parameters of templates, by what they belong to.
        self.parts: dict[tuple[str, str], Symbol] = {}

    def resolve(self) -> None:
        """Find the symbols of all names that declare nothing."""
        for symbol in self.found.symbols:
            if symbol.kind in ("argument", "member"):
                self.local[symbol.name].append(symbol)
            elif not is_local(symbol) and symbol.kind != "requirement":
                self.names.setdefault(symbol.name, symbol)
            if is_local(symbol):
                self.parts.setdefault((symbol.of, symbol.name), symbol)
        for at, template in self.named_arguments:
            called = self.parts.get((template, self.texts[at]))
            self.found.words[at] = "argument"
            if called is not None:
                self.found.uses[Span(self.starts[at], self.ends[at])] = called
        for at in self.type_uses:
            if self.texts[at] in self.names:
                self.found.uses[Span(self.starts[at], self.ends[at])] = self.names[self.texts[at]]
        slashes = max((name.count("/") for name in self.names), default=0)
        at = 0
        while at < self.count:
            text = self.texts[at]
            if at in self.taken or not (is_name(text) or is_quoted(text) or text == "/"):
                at += 1
                continue
            last = self.path(at) if slashes else at
            for end in range(last, at - 1, -1):
                name = unquoted(text) if is_quoted(text) else self.text[self.starts[at] : self.ends[end]]
                if self._use(at, name, path=end > at):
                    at = end
                    break
            else:
                if text != "/" and not self._is_operator(at):
                    name = unquoted(text) if is_quoted(text) else text
                    self.found.free[name].append(Span(self.starts[at], self.ends[at]))
            at += 1

    def _use(self, at: int, name: str, *, path: bool) -> bool:
        """Record the use of the longest declared name that a name begins with; return whether there is one."""
        start, inside = self.starts[at], is_quoted(self.texts[at])
        for part in [name] if path else _beginnings(name):
            inner = [each for each in self.local.get(part, ()) if each.scope.start <= start < each.scope.end]
            symbol = inner[-1] if inner else self.names.get(part)
            if symbol is None and part == name:
                symbol = self._value(name, start)
            if symbol is None:
                continue
            if inside and part == name:
                self.found.uses[Span(start, self.ends[at])] = symbol
                return True
            if inside and '"' in name:  # written twice in the text
                return False
            begin = start + inside
            self.found.uses[Span(begin, begin + len(part))] = symbol
            rest = name[len(part) + 1 :]
            below = self.parts.get((symbol.of if symbol.kind == "member" else symbol.name, rest))
            if below is not None and below.kind in ("field", "value"):
                end = begin + len(name)
                self.found.uses[Span(end - len(rest), end)] = below
            return True
        return False

    def _value(self, name: str, start: int) -> Symbol | None:
        """Return the enumeration member of a name; of several the one that applies at an offset."""
        having = self._values.get(name, ())
        of = self._types.get(start, "") if len(having) > 1 else ""
        return self.parts.get((of, name)) or next(iter(having), None)

    @cached_property
    def _values(self) -> dict[str, list[Symbol]]:
        """The members of enumerations, by name."""
        found: dict[str, list[Symbol]] = defaultdict(list)
        for symbol in self.found.symbols:
            if symbol.kind == "value":
                found[symbol.name].append(symbol)
        return found

    @cached_property
    def _types(self) -> dict[int, str]:
        """From the offsets of members of enumerations in formulas to their enumerations."""
        if self.document is None:
            return {}
        return {
            node.span.start: node.type.name
            for node in postorder(*(each.formula for each in self.document.assertions))
            if isinstance(node, Const) and isinstance(node.type, Enumeration) and node.span is not None
        }

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
