"""Tokens to a formula: recursive descent, with binding powers from the operator table.

::

    expression = operand , { infix operator , [ interval ] , expression | "in" , set }
    set        = "{" , expression , { "," , expression } , "}"
    operand    = number | name | atom | group | call | prefix | use of a template
    group      = "(" , expression , ")"
    call       = function , [ interval ] , "(" , expression , { "," , expression } , ")"
    prefix     = prefix operator , [ interval ] , expression
    interval   = "[" , bound , ( ":" | "," ) , bound , "]"
    bound      = ( number , [ "/" , number ] | constant ) , [ unit ] | "inf"
    name       = word , { "." , word } | topic | '"' , characters , '"'

Words such as ``always``, ``G`` or ``min`` are operators only where an operator can stand: a prefix
operator needs something after it that begins an operand or an interval, a function needs ``(``,
and an infix operator stands after an operand. Comparisons in one direction chain: ``1 <= x < 3`` is
``1 <= x and x < 3``; so ``x in {1, 2}`` is ``x == 1 or x == 2``, and ``in`` is a name where no ``{`` follows.
"""

from __future__ import annotations

from math import inf, isinf
from typing import TYPE_CHECKING

from rtamt.errors import NameInFormulaError, did_you_mean
from rtamt.language import diagnostics
from rtamt.language.formula import Apply, Const, Formula, Span
from rtamt.language.grammar import INFINITY, MAX_DEPTH, chains, is_number, is_predicate, passes_on
from rtamt.language.intervals import parse_interval
from rtamt.language.operators import STL, Bounds, Fixity, Language, Operator
from rtamt.language.scope import Scope
from rtamt.language.templates import Template, parse_use
from rtamt.language.typed_parser import TypedParser

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rtamt.errors import SpecificationError
    from rtamt.language.lexer import Token
    from rtamt.language.value_types import Enumeration, ValueType


class FormulaParser(TypedParser):
    """One method for each production of the grammar, in addition to those of names."""

    # ---- productions ---------------------------------------------------------------------------

    def formula(self) -> Formula:
        """Parse a top-level expression, whatever the depth of the caller's stack."""
        self._depth = 0
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
        start = self.tokens[self.index].start
        left = self.operand(power, under)
        last: tuple[Operator, Formula, Span] | None = None
        while True:
            token = self.tokens[self.index]
            op = self.language.infix(token.text)
            if op is None and self._begins_set(power):
                left = self.membership(left, Span(start, self.tokens[self.index - 1].end))
                last = None
                continue
            if op is None or op.power < power:
                break
            left_end = self.tokens[self.index - 1].end
            self.index += 1
            timed = op.bounds is not Bounds.NONE or self.tokens[self.index].text == "["
            interval = parse_interval(self, op, token) if timed else None
            right_start = self.token.start
            right = self.compared(op, left)
            end = self.tokens[self.index - 1].end
            if last is not None and is_predicate(op) and is_predicate(last[0]):
                _, middle, span = last
                both = self.language.get("and")
                if both is None or not chains(last[0], op):
                    whole, link = Span(start, end), Span(token.start, token.end)
                    raise self.error(diagnostics.no_chain(self.text, whole, span, link), whole)
                comparison = self.apply(op, (middle, right), (span, Span(right_start, end)))
                left = Apply(both, (left, comparison), None, Span(start, end))
            else:
                places = Span(start, left_end), Span(right_start, end)
                left = self.apply(op, (left, right), places, interval)
            last = (op, right, Span(right_start, end))
        self._depth -= 1
        return left

    def _right(self, op: Operator) -> Formula:
        """Parse the right operand of an infix operator."""
        return self.expression(op.power + 1 if op.fixity is Fixity.LEFT else op.power, op)

    def operand(self, power: int, under: Operator | None) -> Formula:
        """``operand = number | name | atom | group | call | prefix``."""
        token = self.tokens[self.index]
        if token.kind == "number":
            return self.number()
        op = self.language.opening(token.text)
        if op is not None:
            if op.fixity is Fixity.PREFIX and (token.kind != "name" or self._applies(self.index)):
                return self.prefix(op, power, under)
            if op.fixity is Fixity.FUNCTION and self.tokens[self.index + 1].text in ("(", "["):
                return self.call(op)
            if op.fixity is Fixity.ATOM:
                self.index += 1
                return Apply(op, (), None, token.span)
        if token.kind == "name" and self.tokens[self.index + 1].text == "(":
            template = self.scope.templates.get(token.text)
            if template is not None:
                return parse_use(self, template)
            hint = did_you_mean(token.text, self.scope.templates)
            if hint or token.text in self.scope.pending:
                message = self.scope.pending.get(token.text) or f"'{token.text}' is not a function{hint}"
                raise self.error(message, token.span, NameInFormulaError)
        if token.kind in ("name", "quoted"):
            return self.name()
        if token.text == "(":
            return self.group()
        if self._begins_topic(self.index):
            return self.name()
        raise self.error(*diagnostics.no_operand(self.tokens, self.index))

    def number(self) -> Const:
        """``number = decimal literal``."""
        token = self.next()
        value = float(token.text)
        if isinf(value):
            raise self.error(
                f"{token.text} is larger than every double; for infinity write {INFINITY}", token.span
            )
        return Const(value, token.span)

    def group(self) -> Formula:
        """``group = "(" , expression , ")"``."""
        opening = self.next()
        inner = self.expression()
        if not self.accept(")"):
            raise self.error(*diagnostics.no_close(self.language, self.tokens, self.index, opening))
        return inner

    def call(self, op: Operator) -> Formula:
        """``call = function , [ interval ] , "(" , expression , { "," , expression } , ")"``."""
        name = self.next()
        interval = parse_interval(self, op, name)
        opening = self.token
        if not self.accept("("):
            raise self.error(f"expected '(' after '{name.text}', got {opening}", opening.span)
        starts, operands = [self.token.start], [self.argument(op)]
        ends = [self.tokens[self.index - 1].end]
        while self.accept(","):
            starts.append(self.token.start)
            operands.append(self.argument(op))
            ends.append(self.tokens[self.index - 1].end)
        if not self.accept(")"):
            raise self.error(
                *diagnostics.no_close(self.language, self.tokens, self.index, opening, "',' or ')'")
            )
        span = Span(name.start, self.tokens[self.index - 1].end)
        count = len(op.operands)
        if len(operands) != count and not (op.folds and len(operands) > count):
            more = " or more" if op.folds else ""
            noun = "operand" if count == 1 and not op.folds else "operands"
            raise self.error(f"'{name.text}' takes {count}{more} {noun}, got {len(operands)}", span)
        places = list(map(Span, starts, ends))
        result = self.apply(op, tuple(operands[:count]), places[:count], interval, span)
        for operand, place in zip(operands[count:], places[count:], strict=True):
            result = self.apply(op, (result, operand), (span, place), interval, span)
        return result

    def argument(self, op: Operator) -> Formula:
        """Parse an operand of a function; strict functions take no formula for a number."""
        start = self.token.start
        operand = self.expression()
        if op.strict and not is_number(operand):
            end = self.tokens[self.index - 1].end
            raise self.error(
                f"'{op.spellings[0]}' takes a number, and '{self.text[start:end]}' is a formula, true or false; "
                f"write a signal or arithmetic",
                Span(start, end),
            )
        return operand

    def prefix(self, op: Operator, power: int, under: Operator | None) -> Formula:
        """``prefix = prefix operator , [ interval ] , expression``; a minus before a number is its sign."""
        token = self.next()
        if op is self._sign:
            value = self._signed(op)
            if value is not None:
                return Const(-value, Span(token.start, self.tokens[self.index - 1].end))
        interval = parse_interval(self, op, token)
        # Under `not`, which binds tighter, `always` extends no further than `not` itself would.
        start = self.token.start
        operand = self.expression(max(power, op.power), op)
        end = self.tokens[self.index - 1].end
        if op.power < power and not (under is not None and passes_on(under)):
            self._one_reading(op, token, under)
        return self.apply(op, (operand,), (Span(start, end),), interval, Span(token.start, end))

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

    # ---- looking ahead -------------------------------------------------------------------------

    def _applies(self, at: int) -> bool:
        """Return whether the word at this token, spelled like a prefix operator, is an operator."""
        after = self.tokens[at + 1]
        if after.text in ("[", "("):
            return True
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
        opens = (
            token.kind in ("name", "number", "quoted")
            or token.text == "("
            or (token.text == "[" and end > at)
            or (op is not None and op.fixity is Fixity.PREFIX)
            or self._begins_topic(end)
        )
        return opens == ((end - at) % 2 == 0)

    def _is_infix_word(self, at: int) -> bool:
        token = self.tokens[at]
        return token.kind == "name" and self.language.infix(token.text) is not None

    def _signed(self, op: Operator) -> float | None:
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
    unit: str = "s",
    parameters: Collection[str] = (),
    templates: Mapping[str, Template] | None = None,
) -> Formula:
    """Parse the text of a formula.

    ``language``: the operators. ``constants``: numbers by name, for operands and bounds.
    ``definitions``: formulas by name; their nodes are shared, not copied. ``variables``: the declared
    names; with None, every other name is a variable. ``types``: of those that are Booleans or of one of the
    ``enumerations``. ``unit``: the unit of bounds without one; a lower bound without a unit has that of the
    upper bound, as in RTAMT. ``parameters``: which of the constants are parameters. ``templates``: those of a
    document (:attr:`Document.templates`), by name.

    Raises :class:`ParseError`, :class:`NameInFormulaError` or :class:`BoundError`, each with a caret
    under the position, and :class:`UsageError` for an unknown unit. Source: the paper's
    section 2, and RTAMT's grammar.

    >>> print(parse_formula("G(req>=3 -> F[0:500ms] gnt>=3)"))
    always(req >= 3 -> eventually[0:500ms](gnt >= 3))
    >>> parse_formula("G >= 3 and s >= 1") == parse_formula("((G) >= 3) & (s >= 1.0)")
    True
    """
    scope = Scope(
        constants or {},
        definitions or {},
        variables,
        templates=templates or {},
        parameters=parameters,
        types=types or {},
        enumerations=enumerations or {},
    )
    parser = FormulaParser(text, language, unit, scope)
    formula = parser.formula()
    formula = parser.standing_alone(formula, Span(0, parser.tokens[parser.index - 1].end), named=True)
    if parser.token.kind != "end":
        raise parser.error(*diagnostics.no_operator(language, parser.tokens, parser.index))
    return formula
