"""Lookahead for words that are an operator or a name, depending on the tokens after them."""

from __future__ import annotations

from itertools import islice, pairwise

from rtamt.language.operators import Fixity
from rtamt.language.parsing.grammar import THEN
from rtamt.language.parsing.typed_parser import TypedParser
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rtamt.language.parsing.lexer import Token


class LookaheadParser(TypedParser):
    """Lookahead of the formula parser; no method consumes a token."""

    #: The word of a choice that ends the operand here, which is no operand itself.
    _awaited: str | None = None

    def _applies(self, at: int) -> bool:
        """Return whether the word at this token, spelled like a prefix operator, is an operator."""
        after = self.tokens[at + 1]
        if after.kind == "symbol" and self.tokens[at].text in self.scope:
            # `G - 3` with a variable G is a difference; without one, always(-3).
            return self.language.infix(after.text) is None and self.opens(at + 1)
        return self.opens(at + 1)

    def opens(self, at: int) -> bool:
        """Return whether an operand can begin at this token.

        In a run of words spelled like infix operators, a word is an operator if the next token begins an operand,
        and a name otherwise: ``G U x`` is until, ``G U >= 3`` is always.
        """
        end = at
        while self._is_infix_word(end):
            end += 1
        token = self.tokens[end]
        op = self.language.opening(token.text)
        opens = token.text != self._awaited and (
            token.kind in ("name", "number", "quoted")
            or token.text == "("
            or (token.text == "[" and end > at)
            or (op is not None and op.fixity is Fixity.PREFIX)
            or self._begins_topic(end)
        )
        return opens == ((end - at) % 2 == 0)

    def _begins_choice(self, at: int) -> bool:
        """Return whether the ``if`` at this token begins a choice, for a variable of that name cannot stand there."""
        if self.tokens[at].text in self.scope:
            return False
        after = self.tokens[at + 1]
        if after.text == self._awaited:
            return False
        if self.language.infix(after.text) is None:
            return after.kind in ("name", "number", "quoted") or after.text == "(" or self.opens(at + 1)
        # `if - x then` has no other reading, for two operands are adjacent.
        if at in self._plain_words:
            return False
        depth, passed = 0, [at]
        for place, (before, text) in enumerate(pairwise(islice(self.texts, at + 1, None)), at + 1):
            depth += (before in ("(", "[")) - (before in (")", "]"))
            if depth < 0 or before in (";", "="):
                break
            if depth == 0 and text == THEN and self._ends_operand(self.tokens[place]):
                return True
            if depth == 0 and text == self.texts[at]:
                passed.append(place + 1)
        self._plain_words.update(passed)  # no `then` belongs to those in between, either
        return False

    def _ends_operand(self, token: Token) -> bool:
        if token.kind == "name":
            op = self.language.opening(token.text)
            name = op is None or op.fixity in (Fixity.ATOM, Fixity.FUNCTION)  # as no operand follows
            return name and self.language.infix(token.text) is None
        return token.kind in ("number", "quoted") or token.text in (")", "}")

    def _is_infix_word(self, at: int) -> bool:
        token = self.tokens[at]
        return token.kind == "name" and self.language.infix(token.text) is not None
