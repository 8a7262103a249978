"""Tokens to a formula: recursive descent, with binding powers from the operator table.

::

    expression = operand , { infix operator , [ interval ] , expression | "in" , set }
    set        = "{" , expression , { "," , expression } , "}"
    operand    = number | name | atom | group | call | prefix | choice | use of a template | quantifier
    group      = "(" , expression , ")"
    call       = function , [ interval ] , "(" , [ share , "," ] , expression , { "," , expression } , ")"
    share      = number , [ "/" , number ] , [ "%" | unit ]
    prefix     = prefix operator , [ interval ] , expression
    choice     = "if" , expression , "then" , expression , "else" , expression
    interval   = ( "[" | "(" ) , bound , [ ( ":" | "," ) , bound ] , ( "]" | ")" )
    bound      = ( number , [ "/" , number ] | constant ) , [ unit ] | "inf"
    name       = word , { "." , word } | topic | '"' , characters , '"'

Words such as ``always``, ``G`` or ``min`` are operators only where an operator can stand: a prefix
operator needs something after it that begins an operand or an interval, a function needs ``(``,
and an infix operator stands after an operand. ``if`` is one where a variable could not stand, unless it is
declared; what follows ``else`` extends as far as arithmetic does. Comparisons in one direction chain: ``1 <= x < 3``
is ``1 <= x and x < 3``; so ``x in {1, 2}`` is ``x == 1 or x == 2``, and ``in`` is a name where no ``{`` follows.
"""

from __future__ import annotations

from math import inf, isinf

from rtamt.errors import NameInFormulaError, did_you_mean
from rtamt.language.formula import Apply, Const, Formula, Span, Var, span_of
from rtamt.language.lazy_modules import diagnostics, shares, templates
from rtamt.language.operators import STL, Bounds, Fixity, Language, Operator, Sort
from rtamt.language.parsing.grammar import (
    ELSE,
    INFINITY,
    MAX_DEPTH,
    THEN,
    chains,
    is_number,
    is_predicate,
    passes_on,
)
from rtamt.language.parsing.intervals import parse_interval
from rtamt.language.parsing.lexer import is_name, is_numeral, is_quoted
from rtamt.language.parsing.lookahead import LookaheadParser
from rtamt.language.parsing.scope import Scope
from rtamt.language.parsing.type_rules import takes_number
from rtamt.language.quantifiers import QUANTIFIERS, begins_quantifier, parse_quantifier
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping, Sequence

    from rtamt.errors import SpecificationError
    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.templates import Template
    from rtamt.language.parsing.typed_parser import Place
    from rtamt.language.quantifiers import Group
    from rtamt.language.value_types import Enumeration, ValueType


#: What a token can be where an operand begins; a name that is also a word of the language is another token.
_OTHER, _NUMBER, _GROUP, _NAME = range(4)
#: What follows a name that is more than a variable: a table, the use of a template, or a name with slashes.
_AFTER_OTHERS = frozenset("([/")
_UNTIMED, _LEFT = Bounds.NONE, Fixity.LEFT
#: In which nothing is declared.
_FREE = Scope()
#: What follows an operator, a function, a table or the use of a template.
_OPENING = frozenset("([")


class FormulaParser(LookaheadParser):
    """One method for each production of the grammar, in addition to those of names."""

    # ---- productions ---------------------------------------------------------------------------

    def formula(self) -> Formula:
        """Parse a top-level expression, whatever the depth of the caller's stack."""
        self._depth, self._awaited = 0, None
        try:
            return self.expression()
        except RecursionError:
            raise self._too_deep() from None

    def expression(self, power: int = 0, under: Operator | None = None) -> Formula:
        """``expression = operand , { infix operator , [ interval ] , expression }``.

        Operators that bind more weakly than ``power`` are left to the caller; ``under`` is the
        operator whose operand this is.
        """
        if self._depth >= MAX_DEPTH:
            raise self._too_deep()
        self._depth += 1
        texts, starts, ends = self.texts, self.starts, self.ends
        start = starts[self.index]
        left = self.operand(power, under)
        last: tuple[Operator, Formula, Place] | None = None
        while True:
            at = self.index
            op = self._infix(texts[at])
            if op is None and texts[at] == "in" and self._begins_set(power):
                left = self.membership(left, Span(start, ends[at - 1]))
                last = None
                continue
            if op is None or op.power < power:
                break
            left_end = ends[at - 1]
            self.index = at + 1
            timed = op.bounds is not _UNTIMED or texts[at + 1] == "["
            interval = parse_interval(self, op, at) if timed else None
            right_start = starts[self.index]
            if self.scope.enumerations:
                right = self.compared(op, left)
            else:  # as _right() does
                right = self.expression(op.power + (op.fixity is _LEFT), op)
            end = ends[self.index - 1]
            place = right_start, end
            if last is not None and is_predicate(op) and is_predicate(last[0]):
                _, middle, between = last
                both = self.language.get("and")
                if both is None or not chains(last[0], op):
                    whole, link = Span(start, end), Span(starts[at], ends[at])
                    raise self.error(diagnostics.no_chain(self.text, whole, Span(*between), link), whole)
                comparison = self.apply(op, (middle, right), (between, place))
                left = Apply(both, (left, comparison), None, Span(start, end))
            elif self._plain(op):
                left = Apply(op, (left, right), interval, span_of((start, end)))
            else:
                left = self.apply(op, (left, right), ((start, left_end), place), interval)
            last = (op, right, place)
        self._depth -= 1
        return left

    def _right(self, op: Operator) -> Formula:
        """Parse the right operand of an infix operator."""
        return self.expression(op.power + (op.fixity is _LEFT), op)

    def operand(self, power: int, under: Operator | None) -> Formula:
        """``operand = number | name | atom | group | call | prefix | choice``."""
        at = self.index
        text = self.texts[at]
        kind = self._kinds.get(text)
        if kind is None:
            kind = self._kinds[text] = self._kind(text)
        if kind == _NUMBER:
            return self.number()
        if kind == _GROUP:
            return self.group(under)
        if kind == _NAME:
            after = self.texts[at + 1]
            if self.scope.free and after not in _AFTER_OTHERS:
                self.index = at + 1
                return Var(text, span_of((self.starts[at], self.ends[at])))
            return (self._parse_application(at) if after in _OPENING else None) or self.name()
        if text in QUANTIFIERS and begins_quantifier(self):
            return parse_quantifier(self)
        after = self.texts[at + 1] if text else ""
        op = self._opening(text)
        if op is not None:
            if op.fixity is Fixity.PREFIX and (after in _OPENING or not is_name(text) or self._applies(at)):
                return self.prefix(op, power, under)
            if op.fixity is Fixity.FUNCTION and after in _OPENING:
                return self.call(op)
            if op.fixity is Fixity.ATOM:
                self.index += 1
                return Apply(op, (), None, Span(self.starts[at], self.ends[at]))
            if op.fixity is Fixity.CONDITIONAL and self._begins_choice(at):
                return self.choice(op, power, under)
        if is_name(text) or is_quoted(text):
            return (self._parse_application(at) if after in _OPENING else None) or self.name()
        if self._begins_topic(at):
            return self.name()
        raise self.error(*diagnostics.no_operand(self.tokens, at))

    def _kind(self, text: str) -> int:
        """Return the role of a token at the beginning of an operand."""
        if is_numeral(text):
            return _NUMBER
        if text == "(":
            return _GROUP
        word = self._opening(text) is not None or self._infix(text) is not None
        return _NAME if is_name(text) and not (word or text in QUANTIFIERS or text == INFINITY) else _OTHER

    def _parse_application(self, at: int) -> Formula | None:
        """Parse what a bracket or parenthesis follows: a table, or the use of a template."""
        token, scope = self.tokens[at], self.scope
        table = scope.tables.get(token.name)
        if table is not None:
            return self.call(table)
        if token.kind == "quoted" or self.texts[at + 1] != "(":
            return None
        template = scope.templates.get(token.text)
        if template is not None:
            return templates.parse_use(self, template)
        hint = did_you_mean(token.text, (*scope.templates, *scope.tables))
        if hint or token.text in scope.pending:
            message = scope.pending.get(token.text) or f"'{token.text}' is not a function{hint}"
            raise self.error(message, token.span, NameInFormulaError)
        return None

    def number(self) -> Const:
        """``number = decimal literal``."""
        at = self.index
        self.index += 1
        value = float(self.texts[at])
        span = span_of((self.starts[at], self.ends[at]))
        if isinf(value):
            raise self.error(
                f"{self.texts[at]} is larger than every double; for infinity write {INFINITY}", span
            )
        return Const(value, span)

    def group(self, under: Operator | None = None) -> Formula:
        """``group = "(" , expression , ")"``; with the prefix operator before it, ``under``, it is one level."""
        opening = self.index
        self.index += 1
        same = under is not None and under.fixity is Fixity.PREFIX
        self._depth -= same
        inner = self.expression()
        self._depth += same
        if not self.accept(")"):
            raise self.error(
                *diagnostics.no_close(self.language, self.tokens, self.index, self.tokens[opening])
            )
        return inner

    def call(self, op: Operator) -> Formula:
        """``call = function , [ interval ] , "(" , [ share , "," ] , expression , { "," , expression } , ")"``."""
        name = self.next()
        interval = parse_interval(self, op, self.index - 1)
        opening = self.token
        if not self.accept("("):
            raise self.error(f"expected '(' after '{name.text}', got {opening}", opening.span)
        if op.share:
            assert interval is not None
            interval = replace(interval, share=shares.parse_share(self, name.text))
        operands: list[Formula] = []
        places: list[Place] = []
        while not operands or self.accept(","):
            start = self.starts[self.index]
            operands.append(self.argument(op, operands))
            places.append((start, self.ends[self.index - 1]))
        if not self.accept(")"):
            raise self.error(
                *diagnostics.no_close(self.language, self.tokens, self.index, opening, "',' or ')'")
            )
        span = Span(name.start, self.tokens[self.index - 1].end)
        count = len(op.operands)
        least = count - op.optional
        if not (least <= len(operands) <= count or (op.folds and len(operands) > count)):
            number = f"{least} or {count}" if op.optional else f"{count} or more" if op.folds else str(count)
            noun = "operand" if number == "1" else "operands"
            raise self.error(f"'{name.text}' takes {number} {noun}, got {len(operands)}", span)
        result = self.apply(op, tuple(operands[:count]), places[:count], interval, span)
        for operand, place in zip(operands[count:], places[count:], strict=True):
            result = self.apply(op, (result, operand), (span, place), interval, span)
        return result

    def argument(self, op: Operator, before: Sequence[Formula], power: int = 0) -> Formula:
        """Parse an operand of an operator after those ``before`` it; strict ones take no formula for a number."""
        start, position = self.starts[self.index], len(before)
        keeps = op.keeps and self.scope.typed
        operand = self.kept(op, before, power) if keeps else self.expression(power)
        sort = op.operands[min(position, len(op.operands) - 1)]
        if op.strict and sort is Sort.NUMBER and not is_number(operand):
            end = self.tokens[self.index - 1].end
            raise self.error(takes_number(op, self.text[start:end]), Span(start, end))
        return operand

    def choice(self, op: Operator, power: int, under: Operator | None) -> Formula:
        """``choice = "if" , expression , "then" , expression , "else" , expression``."""
        first = self.next()
        if power > op.power:  # it could end before the next operator, or after it
            by = "" if under is None else under.spellings[0]
            raise self.error(
                f"'{first.text}' binds more weakly than the '{by}' before it; "
                f"put parentheses around it: {by} ({first.text} ...)",
                first.span,
            )
        operands: list[Formula] = []
        places, outer = [], self._awaited
        for word in (THEN, ELSE, None):
            self._awaited = word or outer
            start = self.token.start
            operands.append(self.argument(op, operands, 0 if word else op.power))
            places.append(Span(start, self.tokens[self.index - 1].end))
            if word and not self.accept(word):
                raise self.error(*diagnostics.no_word(self.tokens, self.index, word))
        span = Span(first.start, self.tokens[self.index - 1].end)
        return self.apply(op, tuple(operands), places, None, span)

    def prefix(self, op: Operator, power: int, under: Operator | None) -> Formula:
        """``prefix = prefix operator , [ interval ] , expression``; a minus before a number is its sign."""
        at = self.index
        self.index += 1
        starts, ends = self.starts, self.ends
        if op is self._sign:
            value = self._parse_signed(op)
            if value is not None:
                return Const(-value, Span(starts[at], ends[self.index - 1]))
        interval = parse_interval(self, op, at)
        # Under `not`, which binds tighter, `always` extends no further than `not` itself would.
        start = starts[self.index]
        operand = self.expression(max(power, op.power), op)
        end = ends[self.index - 1]
        if op.power < power and not (under is not None and passes_on(under)):
            self._one_reading(op, self.tokens[at], under)
        if self._plain(op):
            return Apply(op, (operand,), interval, span_of((starts[at], end)))
        return self.apply(op, (operand,), ((start, end),), interval, (starts[at], end))

    def _one_reading(self, op: Operator, token: Token, under: Operator | None) -> None:
        """Reject an operand whose extent is ambiguous: a weaker prefix operator after a stronger operator.

        ``x >= once y`` has one reading; ``x - prev x >= 1`` could mean ``(x - prev x) >= 1`` or, as RTAMT
        reads it, ``x - prev(x >= 1)``.
        """
        follows = self.language.infix(self.tokens[self.index].text)
        if follows is not None and follows.power >= op.power:
            by = "" if under is None else under.spellings[0]
            raise self.error(
                f"'{token.text}' binds more weakly than the '{by}' before it; "
                f"put parentheses around it: {by} ({token.text} ...)",
                token.span,
            )

    def _parse_signed(self, op: Operator) -> float | None:
        """Consume and return the number whose sign is the minus just read, if there is one."""
        token = self.tokens[self.index]
        if token.kind != "number" and (token.text != INFINITY or INFINITY in self.scope):
            return None
        after = self.language.infix(self.tokens[self.index + 1].text)
        if after is not None and after.power > op.power:
            return None
        if token.kind == "number":
            return self.number().value
        self.index += 1
        return inf

    # ---- errors --------------------------------------------------------------------------------

    def _too_deep(self) -> SpecificationError:
        return self.error(
            f"nested too deeply: at most {MAX_DEPTH} formulas may stand inside one another; "
            f"give an inner one a name and use the name",
            self.token.span,
        )


def parse_formula(
    text: str,
    *,
    language: Language = STL,
    constants: Mapping[str, float] | None = None,
    definitions: Mapping[str, Formula] | None = None,
    variables: Collection[str] | None = None,
    types: Mapping[str, ValueType] | None = None,
    enumerations: Mapping[str, Enumeration] | None = None,
    tables: Mapping[str, Operator] | None = None,
    unit: str = "s",
    parameters: Collection[str] = (),
    templates: Mapping[str, Template] | None = None,
    groups: Mapping[str, Group] | None = None,
    units: Mapping[str, str] | None = None,
) -> Formula:
    """Parse the text of a formula.

    ``language``: the operators. ``constants``: numbers by name, for operands and bounds.
    ``definitions``: formulas by name; their nodes are shared, not copied. ``variables``: the declared
    names; with None, every other name is a variable. ``types``: of those that are Booleans or of one of the
    ``enumerations``. ``unit``: the unit of bounds without one; a lower bound without a unit has that of the
    upper bound, as in RTAMT. ``parameters``: which of the constants are parameters. ``templates``: those of a
    document (:attr:`Document.templates`), by name. ``groups``: those of a document, by name. ``units``: the declared
    units of constants, which are those of bounds.

    Raises :class:`ParseError`, :class:`NameInFormulaError` or :class:`BoundError`, each with a caret
    under the position, and :class:`UsageError` for an unknown unit. Source: the paper's
    section 2, and RTAMT's grammar.

    >>> print(parse_formula("G(req>=3 -> F[0:500ms] gnt>=3)"))
    always(req >= 3 -> eventually[0:500ms](gnt >= 3))
    >>> parse_formula("G >= 3 and s >= 1") == parse_formula("((G) >= 3) & (s >= 1.0)")
    True
    """
    scope = _FREE
    declared = constants or definitions or templates or types or enumerations or tables or groups
    if variables is not None or declared:
        scope = Scope(
            constants or {},
            definitions or {},
            variables,
            templates=templates or {},
            parameters=parameters,
            types=types or {},
            enumerations=enumerations or {},
            tables=tables or {},
            groups=groups or {},
            units=units or {},
        )
    parser = FormulaParser(text, language, unit, scope)
    formula = parser.formula()
    formula = parser.standing_alone(formula, Span(0, parser.tokens[parser.index - 1].end), named=True)
    if parser.token.kind != "end":
        raise parser.error(*diagnostics.no_operator(language, parser.tokens, parser.index))
    return formula
