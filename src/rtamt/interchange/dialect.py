"""A dialect: the operators of this language with the spellings and the precedence of another one.

Its formulas are parsed and printed by the parser and the printer of the language, with another operator table.
"""

from __future__ import annotations

import re
from functools import cached_property
from typing import TYPE_CHECKING, Any

from rtamt.errors import SpecificationError, StlError
from rtamt.language.formula import Apply, Const, Formula, Interval, Span, Var, fold, postorder
from rtamt.language.operators import STL, Fixity, Language, Sort, builtin
from rtamt.language.parsing.diagnostics import NO_CHAIN
from rtamt.language.parsing.grammar import is_chain, is_number
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.printing.printer import to_text
from rtamt.language.unwritten import TRUTH
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.dataclasses import replace as with_changes
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from fractions import Fraction

    from rtamt.language.records import Operator

_BOUNDS = lazy_pattern(r"\[([^][:]*):([^][:]*)\]")
#: Where an interval can be in a text: what follows an opening bracket.
_INTERVAL = lazy_pattern(r"\[([^][)]*)")
_BOUND = lazy_pattern(r"[^,]+")
_OUTSIDE = lazy_pattern(r"[\w.]+|.", re.DOTALL)


class InexpressibleError(StlError):
    """A formula that another language has no words for."""


@dataclass(frozen=True, slots=True)
class Word:
    """The spelling of an operator in a dialect.

    ``name``: that of the operator here. ``spellings``: of the dialect, the first one is written. ``power`` and
    ``fixity``: where they differ from those here.
    """

    name: str
    spellings: str
    power: int | None = None
    fixity: Fixity | None = None


#: What other languages write as this one does: constants, arithmetic and comparisons.
PLAIN = tuple(
    Word(name, STL[name].spellings[0])
    for name in ("true", "false", "neg", "mul", "div", "add", "sub", "ge", "gt", "le", "lt", "eq", "ne")
)


@dataclass(frozen=True)
class Dialect:
    """The operators of another language.

    Attributes:
        title: what messages call the language.
        words: its operators that are operators here.
        own: its operators that are not, each with the formula that it stands for.
        meanings: by the name of an operator here, the formula that the operator of the dialect stands for, where it
            differs for some operands or intervals.
        characters: characters of the same number to replace before parsing, as the lexer here reads others.
        tokens: an expression of its tokens and white space; the lexer here reads more, such as comments.
        bounds: an expression of a bound, and a description of bounds.
    """

    title: str
    words: Sequence[Word]
    tokens: str
    bounds: tuple[str, str]
    own: Sequence[tuple[Operator, Callable[..., Formula]]] = ()
    meanings: Mapping[str, Callable[..., Formula]] = field(default_factory=dict)
    characters: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def language(self) -> Language:
        """The operator table."""
        rows = [*map(_row, self.words), *(operator for operator, _ in self.own)]
        return Language.of(rows)

    @cached_property
    def _written(self) -> dict[str, Operator]:
        """The operators that formulas here are written with, by their names here."""
        return {word.name: self.language[word.name] for word in self.words}

    def read(self, text: str, *, condition: bool = True, **scope: Any) -> Formula:
        """Parse a formula.

        Args:
            text: the formula.
            condition: whether the whole must be true or false, not a number.
            scope: the other arguments of :func:`parse_formula`.

        Raises:
            SpecificationError: with the position in the text.
            InexpressibleError: an operator of the dialect has no meaning here.
        """
        replaced = text
        for found, other in self.characters.items():
            replaced = replaced.replace(found, other)
        self._require_tokens(text)
        self._require_bounds(replaced, text)
        try:
            formula = parse_formula(replaced, language=self.language, **scope)
        except SpecificationError as error:
            # No dialect has the colon that separates bounds here.
            message = error.message.replace("expected ':' or ','", "expected ','")
            if message.startswith(NO_CHAIN):
                message = self._no_chain
            raise SpecificationError(message, text, error.span) from None
        if condition and _is_plain_number(formula):
            raise SpecificationError(f"'{formula}' is a number, and a formula is needed", text, None)
        self._require_formulas(formula, text)
        return fold(formula, self._here)

    @property
    def _no_chain(self) -> str:
        both = self._written["and"].spellings[0]
        return (
            f"{self.title} has no chains of comparisons: use parentheses, or join two of them with '{both}'"
        )

    def _require_tokens(self, text: str) -> None:
        """Raise for what the lexer here reads and the dialect does not."""
        token, at = re.compile(self.tokens), 0
        while at < len(text):
            found = token.match(text, at)
            if found is None:
                outside = _OUTSIDE.match(text, at)
                assert outside is not None
                raise SpecificationError(f"{self.title} has no '{outside[0]}'", text, Span(*outside.span()))
            at = found.end()

    def _require_bounds(self, replaced: str, text: str) -> None:
        """Raise for bounds that the dialect does not have."""
        pattern, description = self.bounds
        bound = re.compile(rf"\s*(?:{pattern})\s*")
        for interval in _INTERVAL.finditer(replaced):
            for each in _BOUND.finditer(replaced, *interval.span(1)):
                if not bound.fullmatch(each[0]):
                    raise SpecificationError(
                        f"'{each[0].strip()}' is no bound of {self.title}, whose bounds are {description}",
                        text,
                        Span(*each.span()),
                    )

    def _require_formulas(self, formula: Formula, text: str) -> None:
        """Raise for a number where the dialect has a formula, an interval without its ends, and a chain."""
        for node in postorder(formula):
            if not isinstance(node, Apply) or node.op is TRUTH:
                continue
            if is_chain(node):
                raise SpecificationError(self._no_chain, text, node.span)
            if node.interval is not None and node.interval.is_open:
                raise SpecificationError(
                    f"{self.title} has closed intervals only, unlike '{node}'", text, None
                )
            for sort, operand in zip(node.op.operands, node.args, strict=False):
                if sort is not Sort.NUMBER and _is_plain_number(operand):
                    raise SpecificationError(
                        f"'{operand}' is a number, and a formula is needed in '{node}'", text, None
                    )

    def _here(self, node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        if node.op is TRUTH:
            return TRUTH(*args)
        own = next((expand for operator, expand in self.own if operator is node.op), None)
        if own is not None:
            return own(*args, node.interval)
        name = node.op.name
        if name in ("eq", "ne") and all(isinstance(a, Var) and a.type is BOOLEAN for a in args):
            return STL["iff" if name == "eq" else "xor"](*map(TRUTH, args))
        if name in self.meanings:
            return self.meanings[name](*args, node.interval)
        operator = STL[name] if node.op in self.language.operators else node.op
        return operator(*args, interval=node.interval)

    def write(self, formula: Formula, unit: Fraction | None = None, *, parameters: bool = False) -> str:
        """Return a formula in the dialect.

        Args:
            formula: a formula of the language.
            unit: the seconds of one unit of its bounds, if they are whole numbers; None for bounds in seconds.
            parameters: whether parameters are written by their names.

        Raises:
            InexpressibleError: the dialect has no such operator or bound.
        """
        text = to_text(self.translated(formula, unit), self.language, parameters=parameters)
        text = _BOUNDS.sub(r"[\1,\2]", text)
        for found, other in self.characters.items():
            text = text.replace(other, found)
        return text

    def translated(self, formula: Formula, unit: Fraction | None = None) -> Formula:
        """Return a formula with the operators of the dialect; arguments and errors are those of :meth:`write`."""

        def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
            if not isinstance(node, Apply):
                return node
            if node.op is TRUTH:
                return TRUTH(*args)
            # Equality of enumeration members is a different operator with the same symbol.
            operator = self._written.get(node.op.name.removeprefix("holds_"))
            if operator is None or node.op is not builtin(node.op.name):
                raise InexpressibleError(f"{self.title} has no '{node.op.spellings[0]}', as in '{node}'")
            if (
                operator.name in self.meanings
                and self.meanings[operator.name](*node.args, node.interval) != node
            ):
                raise InexpressibleError(f"{self.title} has another meaning for '{node}'")
            return operator(*args, interval=self._bounds(node, unit))

        return fold(formula, step)

    def _bounds(self, node: Apply, unit: Fraction | None) -> Interval | None:
        interval = node.interval
        if interval is None:
            return None
        if interval.is_open or interval.share is not None:
            raise InexpressibleError(f"{self.title} has closed intervals only, unlike '{node}'")
        begin, end = interval.begin, interval.end
        if unit is not None:
            begin, end = begin / unit, None if end is None else end / unit
            if begin.denominator != 1 or (end is not None and end.denominator != 1):
                raise InexpressibleError(f"a bound of '{node}' is not a whole number of sampling periods")
        return Interval(begin, end)


def _is_plain_number(formula: Formula) -> bool:
    """Return whether a formula is a number, and no Boolean."""
    return is_number(formula) and not (isinstance(formula, Const | Var) and formula.type is BOOLEAN)


def _row(word: Word) -> Operator:
    row = STL[word.name]
    changes: dict[str, Any] = {"spellings": tuple(word.spellings.split())}
    if word.power is not None:
        changes["power"] = word.power
    if word.fixity is not None:
        changes["fixity"] = word.fixity
    return with_changes(row, **changes)
