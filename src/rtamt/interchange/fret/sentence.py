"""Sentences of FRETish: scope, condition, component, timing and response.

``[scope] [condition] component shall [timing] satisfy response``, by the published grammar of FRET
(github.com/NASA-SW-VnV/fret, Requirement.g4).
"""

from __future__ import annotations

from fractions import Fraction
from typing import Literal

from rtamt.errors import SpecificationError
from rtamt.interchange.fret.expressions import KEYWORDS, Expression, ExpressionParser, conjunction
from rtamt.language.formula import Span
from rtamt.lazy.dataclasses import dataclass

#: Whether a condition triggers where it becomes true, or wherever it holds.
Condition = Literal["regular", "holding"]

#: Seconds of each unit of time; None: one sample.
TIME_UNITS: dict[str, Fraction | None] = {
    "tick": None,
    **dict.fromkeys(("microsec", "microsecond"), Fraction(1, 10**6)),
    **dict.fromkeys(("millisec", "millisecond"), Fraction(1, 1000)),
    **dict.fromkeys(("sec", "second"), Fraction(1)),
    "minute": Fraction(60),
    "hour": Fraction(3600),
}
_QUALIFIERS = ("when", "whenever", "if", "unless", "where", "upon")
_IN = ("in", "during")


@dataclass(frozen=True, slots=True)
class Duration:
    """A number of units of time; ``seconds``: those of one unit, None for samples."""

    count: Fraction
    unit: str
    seconds: Fraction | None
    span: Span


@dataclass(frozen=True, slots=True)
class Scope:
    """When a requirement applies: ``name`` is in, notin, before or after; ``only``: and must not be met elsewhere."""

    name: str
    mode: Expression
    only: bool = False


@dataclass(frozen=True, slots=True)
class Sentence:
    """The fields of a sentence; ``timing`` is one of ``formalize.TIMINGS``."""

    text: str
    component: str
    response: Expression
    timing: str = "eventually"
    scope: Scope | None = None
    condition: Expression | None = None
    trigger: Condition = "regular"
    stop: Expression | None = None
    duration: Duration | None = None


def parse_sentence(text: str) -> Sentence:
    """Parse a sentence of FRETish.

    Args:
        text: one sentence, with or without a final period.

    Returns:
        Its fields; without a timing the response must hold eventually, as in FRET.

    Raises:
        SpecificationError: the text is no sentence of FRETish; the message has the position.

    >>> sentence = parse_sentence("In cruise mode the car shall within 3 ticks satisfy speed > 20")
    >>> sentence.scope.name, sentence.component, sentence.timing, sentence.duration.count
    ('in', 'car', 'within', Fraction(3, 1))
    """
    if text.lstrip().startswith('"'):
        raise SpecificationError(
            "a text in quotes is not FRETish: it has no formula", text, Span(0, len(text))
        )
    return _SentenceParser(text).sentence()


class _SentenceParser(ExpressionParser):
    def sentence(self) -> Sentence:
        scope = self._scope()
        self.accept(",")
        trigger, condition = self._condition()
        component = self._component()
        self.accept(",")
        if self.token.word == "with":
            raise self.error("probabilities are not covered: robustness has none")
        timing, stop, duration = self._timing()
        self.accept(",")
        self.expect("satisfy", "before the response")
        response = self.expression()
        if self.token.kind != "end":
            raise self.error(f"expected the end of the sentence, found {self.token}")
        return Sentence(self.text, component, response, timing, scope, condition, trigger, stop, duration)

    # ---- scope -----------------------------------------------------------------------------------

    def _scope(self) -> Scope | None:
        first, second, third = (self._word(ahead) for ahead in range(3))
        if first in ("only", "except"):
            self.next()
            self._skip_qualifier()
            return self._excluded() if first == "except" else self._inside(only=True)
        if first in ("when", "if") and (second in _IN or (second == "not" and third in _IN)):
            self.next()
            if self.accept("not"):
                return self._excluded()
            return self._inside()
        if first == "unless" and second in _IN:
            self.next()
            return self._excluded()
        return self._inside() if first in (*_IN, "while", "before", "after") else None

    def _word(self, ahead: int) -> str:
        """Return the word that many tokens ahead."""
        return self.tokens[min(self.index + ahead, len(self.tokens) - 1)].word

    def _skip_qualifier(self) -> None:
        if self.token.word in ("when", "if"):
            self.next()

    def _excluded(self) -> Scope:
        if self.token.word not in (*_IN, "while"):
            raise self.error(f"expected 'in', 'during' or 'while', found {self.token}")
        return Scope("notin", self._inside().mode)

    def _inside(self, *, only: bool = False) -> Scope:
        word = self.next().word
        if word in _IN:
            return Scope("in", self._mode(), only)
        if word == "while":
            return Scope("in", self.expression(), only)
        if word not in ("before", "after"):
            self.index -= 1
            raise self.error(f"expected 'in', 'during', 'while', 'before' or 'after', found {self.token}")
        named = "mode" in (self._word(0), self._word(1))
        return Scope(word, self._mode() if named else self.expression(), only)

    def _mode(self) -> Expression:
        before = self.accept("mode")
        token = self.next()
        if token.kind != "word" or token.word in KEYWORDS:
            raise self.error(f"expected the name of a mode, found {token}", token.span)
        if not before:
            self.accept("mode")
        return Expression("name", token.text, (), token.span)

    # ---- condition -------------------------------------------------------------------------------

    def _condition(self) -> tuple[Condition, Expression | None]:
        self.accept("and")
        if self.token.word not in _QUALIFIERS:
            return "regular", None
        trigger: Condition = "holding" if self.token.word == "whenever" else "regular"
        parts = [("and", self._qualified())]
        while True:
            start = self.index
            self.accept(",")
            word = self.token.word if self.token.word in ("and", "or") else ""
            if word:
                self.next()
            if self.token.word not in _QUALIFIERS:
                self.index = start
                break
            if (self.token.word == "whenever") != (trigger == "holding"):
                raise self.error(
                    "'whenever' cannot be joined with conditions that trigger where they become true"
                )
            parts.append((word or "and", self._qualified()))
        self.accept(",")
        return trigger, conjunction(parts)

    def _qualified(self) -> Expression:
        negated = self.next().word == "unless"
        found = self.expression()
        if self.accept("is"):
            truth = self.next()
            if truth.word not in ("true", "false"):
                raise self.error(f"expected 'true' or 'false' after 'is', found {truth}", truth.span)
            negated ^= truth.word == "false"
        return Expression("operation", "not", (found,), found.span) if negated else found

    # ---- component and timing --------------------------------------------------------------------

    def _component(self) -> str:
        first = self.accept("shall")
        self.accept("the")
        token = self.next()
        if token.kind != "word" or token.word in KEYWORDS:
            raise self.error(f"expected the name of a component, found {token}", token.span)
        if not first:
            self.expect("shall", "after the component")
        return token.text

    def _timing(self) -> tuple[str, Expression | None, Duration | None]:
        token = self.token
        word = token.word
        if word in ("immediately", "eventually", "always", "never", "finally"):
            self.next()
            return word, None, None
        if word == "initially":
            self.next()
            return "immediately", None, None
        if word == "at":
            self.next()
            for each in ("the", "next", "timepoint"):
                self.expect(each, "in 'at the next timepoint'")
            return "next", None, None
        if word in ("within", "for", "after"):
            self.next()
            return word, None, self._duration()
        if word in ("until", "before"):
            self.next()
            return word, self.expression(), None
        return "eventually", None, None

    def _duration(self) -> Duration:
        number, unit = self.next(), self.next()
        span = Span(number.span.start, unit.span.end)
        if number.kind != "number":
            raise self.error(f"expected a number of units of time, found {number}", number.span)
        singular = unit.word.removesuffix("s") if unit.word != "s" else ""
        if singular not in TIME_UNITS:
            known = ", ".join(f"{each}s" for each in TIME_UNITS)
            raise self.error(f"expected a unit of time ({known}), found {unit}", unit.span)
        return Duration(Fraction(number.text), singular, TIME_UNITS[singular], span)
