"""Boolean and numeric expressions of FRETish: tokens, and a parser by precedence.

The grammar is the published one of FRET (github.com/NASA-SW-VnV/fret, Requirement.g4), with these precedences,
from loose to tight: ``->`` and ``<->``, ``|`` and ``xor``, ``&``, ``!``, comparisons, sums, products, minus, ``^``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from rtamt.errors import SpecificationError
from rtamt.language.formula import Span
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Collection

Kind = Literal["name", "number", "truth", "call", "operation"]

_TOKEN = lazy_pattern(
    r"\s*(?:(?P<number>\d+(?:\.\d+)?(?:[Ee][+-]?\d+)?)|(?P<word>[A-Za-z][\w.%]*)"
    r"|(?P<symbol><->|<=>|->|=>|<=|>=|!=|[-=<>!~&|(),+*/^])|(?P<unknown>\S))"
)
#: How deep parentheses may nest.
_DEPTH = 100
#: How many infix operators a sentence may have: those in a row nest, too.
_OPERATORS = 500

#: Each infix operator: how tightly it binds, and its name in the operator table.
INFIX: dict[str, tuple[int, str]] = {
    "->": (1, "implies"), "=>": (1, "implies"), "<->": (1, "iff"), "<=>": (1, "iff"),
    "|": (2, "or"), "xor": (2, "xor"), "&": (3, "and"),
    "=": (5, "eq"), "!=": (5, "ne"), "<": (5, "lt"), "<=": (5, "le"), ">": (5, "gt"), ">=": (5, "ge"),
    "+": (6, "add"), "-": (6, "sub"), "*": (7, "mul"), "/": (7, "div"), "mod": (7, "mod"), "^": (9, "pow"),
}  # fmt: skip
_NOT, _COMPARISON, _MINUS = 4, 5, 8
#: Words of sentences, which no expression contains.
KEYWORDS = frozenset(
    "after always and at before during eventually except finally for if immediately in initially is mode never not "
    "only or satisfy shall the then unless until upon when whenever where while within".split()
)


@dataclass(frozen=True, slots=True)
class Token:
    """A word, number or symbol, and its position; an empty one is the end of the sentence."""

    kind: str
    text: str
    span: Span

    @property
    def word(self) -> str:
        """The word in lower case, as keywords are written in any case; empty for other tokens."""
        return self.text.lower() if self.kind == "word" else ""

    def __str__(self) -> str:
        return f"'{self.text}'" if self.text else "the end of the sentence"


@dataclass(frozen=True, slots=True)
class Expression:
    """A node: ``text`` is a name, a number, a function or the name of an operator in the operator table."""

    kind: Kind
    text: str
    args: tuple[Expression, ...]
    span: Span


def tokens_of(text: str) -> list[Token]:
    """Return the tokens of a sentence, without its final period, and an end."""
    stripped = text.rstrip()
    end = len(stripped[:-1].rstrip()) if stripped.endswith(".") else len(stripped)
    found: list[Token] = []
    for match in _TOKEN.finditer(text, 0, end):
        kind = match.lastgroup or ""
        span = Span(*match.span(kind))
        if kind == "unknown":
            raise SpecificationError(f"'{match[kind]}' is not part of FRETish", text, span)
        found.append(Token(kind, match[kind], span))
    return [*found, Token("end", "", Span(end, end))]


class ExpressionParser:
    """Parses expressions from the tokens of a sentence; the position is that of the next token."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.tokens = tokens_of(text)
        self.index = 0
        self._depth = 0
        self._operators = 0

    @property
    def token(self) -> Token:
        """The next token."""
        return self.tokens[self.index]

    def next(self) -> Token:
        """Return the next token and move past it."""
        token = self.token
        self.index += token.kind != "end"
        return token

    def accept(self, *words: str) -> bool:
        """Move past the next token if it is one of these words or symbols, in any case."""
        found = self.token.text.lower() in words and self.token.kind != "end"
        self.index += found
        return found

    def expect(self, word: str, where: str) -> None:
        """Move past a word or symbol, or raise."""
        if not self.accept(word):
            raise self.error(f"expected '{word}' {where}, found {self.token}")

    def error(self, message: str, span: Span | None = None) -> SpecificationError:
        """Return an error at a position, by default at the next token."""
        return SpecificationError(message, self.text, span or self.token.span)

    def expression(self, tightness: int = 0) -> Expression:
        """Parse an expression whose operators bind at least so tightly."""
        self._depth += 1
        if self._depth > _DEPTH:
            raise self.error(f"expressions may nest {_DEPTH} deep")
        left = self._operand(tightness)
        while (infix := INFIX.get(self.token.text.lower())) is not None and infix[0] >= tightness:
            strength, name = infix
            self._operators += 1
            if self._operators > _OPERATORS:
                raise self.error(f"a sentence may have {_OPERATORS} operators: split the requirement")
            operator = self.next()
            right = self.expression(strength + 1)
            left = Expression("operation", name, (left, right), Span(left.span.start, right.span.end))
            if strength == _COMPARISON and (INFIX.get(self.token.text.lower()) or (0,))[0] == _COMPARISON:
                raise self.error(f"{self.token} cannot follow {operator}: join two comparisons by '&'")
        self._depth -= 1
        return left

    def _operand(self, tightness: int) -> Expression:
        token = self.token
        start = token.span.start
        if token.word == "if":
            self.next()
            condition = self.expression()
            self.expect("then", "after the condition of 'if'")
            result = self.expression()
            return Expression("operation", "implies", (condition, result), Span(start, result.span.end))
        if token.text in ("!", "~"):
            if tightness > _NOT:
                raise self.error(f"{token} negates a formula, not a number")
            return self._prefix("not", _NOT)
        if token.text == "-":
            digits = self.tokens[self.index + 1]
            if digits.kind == "number" and digits.span.start == token.span.end:
                # The sign belongs to the number: -3 ^ 2 is 9.
                self.index += 2
                return Expression("number", f"-{digits.text}", (), Span(start, digits.span.end))
            return self._prefix("neg", _MINUS)
        if token.text == "(":
            self.next()
            inner = self.expression()
            self.expect(")", "to close the parenthesis")
            return Expression(
                inner.kind, inner.text, inner.args, Span(start, self.tokens[self.index - 1].span.end)
            )
        if token.kind == "number":
            self.next()
            return Expression("number", token.text, (), token.span)
        if token.kind != "word" or token.word in KEYWORDS or token.word in INFIX:
            raise self.error(f"expected a variable, a number or an expression, found {token}")
        self.next()
        if token.word in ("true", "false"):
            return Expression("truth", token.word, (), token.span)
        if self.token.text == "(":
            self.next()
            args = self._arguments()
            return Expression("call", token.text, args, Span(start, self.tokens[self.index - 1].span.end))
        return Expression("name", token.text, (), token.span)

    def _prefix(self, name: str, strength: int) -> Expression:
        start = self.next().span.start
        operand = self.expression(strength)
        return Expression("operation", name, (operand,), Span(start, operand.span.end))

    def _arguments(self) -> tuple[Expression, ...]:
        found: list[Expression] = []
        while not self.accept(")"):
            if found:
                self.expect(",", "or ')' after an argument")
            found.append(self.expression())
        return tuple(found)


def conjunction(parts: Collection[tuple[str, Expression]]) -> Expression:
    """Join conditions from left to right; each has the word that joins it to those before it, "and" or "or"."""
    (_, joined), *rest = parts
    for word, part in rest:
        joined = Expression("operation", word, (joined, part), Span(joined.span.start, part.span.end))
    return joined
