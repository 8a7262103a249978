"""Booleans and enumerations in formulas: members by name, operators on them, ``x in {...}``."""

from __future__ import annotations

from functools import reduce

from rtamt.errors import NameInFormulaError, did_you_mean
from rtamt.language.formula import Apply, Const, Formula, Span, Var, span_of
from rtamt.language.operators import Sort
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.names import NameParser
from rtamt.language.parsing.type_rules import (
    MistypedError,
    ambiguous,
    as_formula,
    as_literal,
    no_formula,
    type_of,
    typed,
)
from rtamt.language.value_types import Ambiguous, Enumeration
from rtamt.lazy.typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.errors import SpecificationError
    from rtamt.language.formula import Interval
    from rtamt.language.operators import Operator

    #: A half-open range of characters; a :class:`Span` is one.
    Place: TypeAlias = tuple[int, int]

_CONDITION = Sort.CONDITION


class TypedParser(NameParser):
    """Names of members, and operators over operands that have types."""

    #: The enumeration to which the operand that is being read is compared.
    _against: Enumeration | None = None

    def apply(
        self,
        op: Operator,
        args: tuple[Formula, ...],
        places: Sequence[Place],
        interval: Interval | None = None,
        span: Place | None = None,
    ) -> Apply:
        """Apply an operator to operands as their types demand. ``places``: where the operands are written."""
        whole = span_of(span or (places[0][0], places[-1][1]))
        if op.presence and not isinstance(args[0], Var):
            raise self.error(
                f"'{op.spellings[0]}' takes a variable, whose samples may be missing; "
                f"'{self._written(places[0])}' is none",
                Span(*places[0]),
            )
        if self.scope.typed:
            try:
                op, args = typed(op, args, lambda k: self._written(places[k]), self.member_text)
            except MistypedError as error:
                place = whole if error.operand is None else Span(*places[error.operand])
                raise self.error(error.message, place) from None
        if _CONDITION in op.operands:
            self._check_conditions(op, args, places)
        return Apply(op, args, interval, whole)

    def _plain(self, op: Operator) -> bool:
        """Return whether :meth:`apply` has nothing to check of an operator, whatever its operands."""
        known = self._checked.get(op)
        if known is None:
            known = self._checked[op] = op.presence or _CONDITION in op.operands
        return not known and not self.scope.typed

    def _check_conditions(self, op: Operator, args: Sequence[Formula], places: Sequence[Place]) -> None:
        """Reject numbers where an operator takes a condition."""
        for sort, operand, place in zip(op.operands, args, places, strict=False):
            if sort is Sort.CONDITION and is_number(operand) and type_of(operand) is None:
                written = self._written(place)
                raise self.error(
                    f"'{written}' is a number, and '{op.spellings[0]}' needs a condition, which is true or false; "
                    f"compare it, such as {written} > 0",
                    Span(*place),
                )

    def standing_alone(self, formula: Formula, span: Span, *, named: bool = False) -> Formula:
        """Return a formula that is no operand: a Boolean is its truth there. ``named``: it may be one later on."""
        found = type_of(formula)
        if isinstance(found, Enumeration) and not named:
            raise self.error(no_formula(self._written(span), found, self.member_text), span)
        if isinstance(found, Ambiguous):
            assert isinstance(formula, Const)
            raise self.error(ambiguous(str(formula.name), found), span)
        return as_formula(formula)

    def _begins_set(self, power: int) -> bool:
        """Return whether ``{`` follows ``in``, which binds as ``==`` does; elsewhere ``in`` is a name."""
        equal = self.language.get("eq")
        braced = self.texts[self.index + 1] == "{"
        return braced and equal is not None and power <= equal.power

    def membership(self, left: Formula, place: Span) -> Formula:
        """``operand , "in" , "{" , expression , { "," , expression } , "}"``: equal to one of them."""
        equal, either = self.language["eq"], self.language["or"]
        word = self.next()
        opening = self.next()
        if not is_number(left):
            raise self.error(
                f"'in' compares a value, and '{self._written(place)}' is a formula; put parentheses around what is "
                f"compared",
                Span(place.start, word.end),
            )
        found: list[Formula] = []
        while not found or self.accept(","):
            if self.token.text == "}":
                raise self.error("expected a value between the braces, such as in {1, 2}", self.token.span)
            start = self.token.start
            right = self.compared(equal, left)
            there = Span(start, self.tokens[self.index - 1].end)
            found.append(self.apply(equal, (left, right), (place, there), span=Span(place.start, there.end)))
        if not self.accept("}"):
            if self.token.kind == "end":
                raise self.error("this '{' is never closed", opening.span)
            raise self.error(f"expected ',' or '}}' after a value, got {self.token}", self.token.span)
        whole = Span(place.start, self.tokens[self.index - 1].end)
        result = reduce(lambda a, b: Apply(either, (a, b), None, whole), found)
        assert isinstance(result, Apply)
        return Apply(result.op, result.args, result.interval, whole)

    def compared(self, op: Operator, left: Formula) -> Formula:
        """Parse the right operand of an infix operator; what is compared to an enumeration may be a member."""
        before = self._against
        found = type_of(left) if op.equates else None
        self._against = found if isinstance(found, Enumeration) else None
        right = self._right(op)
        self._against = before
        return right

    def kept(self, op: Operator, before: Sequence[Formula], power: int) -> Formula:
        """Parse an operand of an operator that keeps types; a member is one of their enumeration."""
        outer = self._against
        if len(before) not in op.keeps:
            self._against = None
            operand = self.expression(power)
        else:
            found = [type_of(before[k]) for k in op.keeps if k < len(before)]
            self._against = next((each for each in found if isinstance(each, Enumeration)), outer)
            operand = as_literal(self.expression(power))
        self._against = outer
        return operand

    def expression(self, power: int = 0, under: Operator | None = None) -> Formula:
        """Parse an expression whose operators bind more tightly than ``power``."""
        raise NotImplementedError

    def _right(self, op: Operator) -> Formula:
        raise NotImplementedError

    def _written(self, place: Place) -> str:
        start, end = place
        return self.text[start:end]

    # ---- names ---------------------------------------------------------------------------------

    def _member(self, name: str, span: Span) -> Const | None:
        """Return the member with this name: of the enumeration before a dot, or of any."""
        enumerations = self.scope.enumerations
        head, _, tail = name.rpartition(".")
        known = enumerations.get(head)
        if known is not None:
            code = known.code(tail)
            if code is None:
                raise self.error(known.lacks(tail), span, NameInFormulaError)
            return Const(float(code), span, name, known)
        having = tuple(each for each in enumerations.values() if each.code(name) is not None)
        if not having:
            return None
        if len(having) > 1:
            return Const(0.0, span, name, Ambiguous(having))
        (one,) = having
        return Const(float(one.code(name) or 0), span, name, one)

    def _undeclared(self, name: str, span: Span) -> SpecificationError:
        """Return the error for a name that means nothing."""
        from rtamt.language.parsing.diagnostics import is_function, no_operator

        if self._against is not None:
            return self.error(self._against.lacks(name), span, NameInFormulaError)
        if self.token.text == "(" and self.tokens[self.index - 1].text == name:
            no_function, _ = no_operator(self.language, self.tokens, self.index)
            return self.error(no_function, span, NameInFormulaError)
        scope = self.scope
        members = [member for each in scope.enumerations.values() for member in each.names]
        known = ", ".join(sorted(scope.names)[:8]) or "none"
        hint = did_you_mean(name, [*scope.names, *members]) or (
            f"; the operator is written {name}(...)"
            if is_function(self.language, name)
            else f"; declared names: {known}"
        )
        return self.error(f"'{name}' is not declared{hint}", span, NameInFormulaError)
