"""Expressions of FRETish as formulas, with the types of their variables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.interchange.fret.formalize import both, either, window
from rtamt.language.formula import Const, Parameter, Var
from rtamt.language.operators import STL, Fixity, Sort, Tense
from rtamt.language.unwritten import TRUTH
from rtamt.language.value_types import BOOLEAN

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from fractions import Fraction

    from rtamt.errors import SpecificationError
    from rtamt.interchange.fret.expressions import Expression
    from rtamt.language.formula import Formula, Span
    from rtamt.language.records import Operator

#: Operators of formulas, by their names in the operator table.
_LOGIC = frozenset({"not", "and", "or", "xor", "implies", "iff"})
#: Comparisons that Booleans have, too, and what they are then.
_EQUALITY = {"eq": "iff", "ne": "xor"}
#: Comparisons of numbers.
_COMPARISONS = frozenset({*_EQUALITY, "lt", "le", "gt", "ge"})

#: FRET's functions of numbers and the operators of the same meaning; other functions keep their names.
FUNCTIONS = {
    **dict.fromkeys(("absReal", "absInt"), "abs"),
    **dict.fromkeys(("maxReal", "maxInt"), "max"),
    **dict.fromkeys(("minReal", "minInt"), "min"),
}
#: FRET's temporal functions: what their arguments are ("c" a whole number).
_TEMPORAL = {
    "preBool": "ff",
    "preInt": "nn",
    "preReal": "nn",
    "persisted": "cf",
    "occurred": "cf",
    "persists": "cf",
    "occurs": "cf",
}
_FORMULAS = frozenset(_TEMPORAL) - {"preInt", "preReal"}


def is_function(operator: Operator) -> bool:
    """Return whether an operator is a function of numbers at one instant."""
    numbers = {*operator.operands, operator.result} == {Sort.NUMBER}
    return numbers and operator.fixity is Fixity.FUNCTION and operator.tense is Tense.NONE


def signature(call: Expression) -> tuple[str, str] | None:
    """Return what a function takes, one letter an argument, and what it gives; None if it is unknown."""
    if call.text in _TEMPORAL:
        return _TEMPORAL[call.text], "f" if call.text in _FORMULAS else "n"
    operator = STL.get(FUNCTIONS.get(call.text, call.text))
    if operator is None or not is_function(operator):
        return None
    return "n" * len(operator.operands), "n"


class Types:
    """The Boolean variables, inferred from their use in a set of expressions.

    A variable that is compared with a number or computed with is a number, whatever else is done with it. An equality
    of two variables says nothing but that both are of one type.
    """

    def __init__(self, booleans: Iterable[str], numbers: Iterable[str] = ()) -> None:
        self._booleans = set(booleans)
        self._numbers = set(numbers) - self._booleans

    def learn(self, expressions: Iterable[Expression]) -> None:
        """Find the types of variables; repeated until nothing is new, as equalities pass them on."""
        every = list(expressions)
        known = -1
        while known != len(self._booleans) + len(self._numbers):
            known = len(self._booleans) + len(self._numbers)
            for expression in every:
                self._visit(expression, "f")

    def is_boolean(self, expression: Expression) -> bool:
        """Return whether an expression is a formula, and not a number."""
        if expression.kind == "name":
            return expression.text in self._booleans and expression.text not in self._numbers
        if expression.kind == "operation":
            return expression.text in _LOGIC or expression.text in _COMPARISONS
        return expression.kind == "truth" or (expression.kind == "call" and expression.text in _FORMULAS)

    def _is_number(self, expression: Expression) -> bool:
        if expression.kind == "name":
            return expression.text in self._numbers
        return not self.is_boolean(expression)

    def _visit(self, expression: Expression, wanted: str) -> None:
        """Infer types from an expression that is used as a formula ("f"), a number ("n") or either ("")."""
        if expression.kind == "name":
            if wanted == "f":
                self._booleans.add(expression.text)
            elif wanted == "n":
                self._numbers.add(expression.text)
            return
        if expression.kind == "call":
            taken = signature(expression)
            kinds = taken[0] if taken is not None else ""
        elif expression.text in _EQUALITY:
            numbers = any(map(self._is_number, expression.args))
            booleans = any(map(self.is_boolean, expression.args))
            kinds = "nn" if numbers else "ff" if booleans else ""
        else:
            kinds = ("f" if expression.text in _LOGIC else "n") * len(expression.args)
        for argument, kind in zip(expression.args, kinds or " " * len(expression.args), strict=False):
            self._visit(argument, kind)


class Lowering:
    """Lower the expressions of one sentence to formulas.

    Args:
        types: which variables are Booleans.
        step: the sampling period in seconds.
        error: makes an error at a position of the sentence.
        constants: the names of constants, with their values.
        scope: the formula of the scope, within which temporal functions look; None for the whole trace.
    """

    def __init__(
        self,
        types: Types,
        step: Fraction,
        error: Callable[[str, Span], SpecificationError],
        constants: dict[str, float],
        scope: Formula | None = None,
    ) -> None:
        self._types = types
        self._step = step
        self._error = error
        self._constants = constants
        self._scope = scope

    def formula(self, expression: Expression) -> Formula:
        """Return the formula of a Boolean expression."""
        if not self._types.is_boolean(expression):
            what = f"'{expression.text}' is a number" if expression.kind == "name" else "this is a number"
            raise self._error(
                f"{what}, where a formula is needed: compare it, such as x > 0", expression.span
            )
        if expression.kind == "truth":
            return STL[expression.text]()
        if expression.kind == "name":
            return TRUTH(Var(expression.text, type=BOOLEAN))
        if expression.kind == "call":
            return self._temporal(expression)
        if expression.text in _LOGIC:
            return STL[expression.text](*map(self.formula, expression.args))
        name, args = expression.text, expression.args
        if name in _EQUALITY and any(map(self._types.is_boolean, args)):
            return STL[_EQUALITY[name]](*map(self.formula, args))
        return STL[name](*map(self.number, args))

    def number(self, expression: Expression) -> Formula:
        """Return the term of a numeric expression."""
        if self._types.is_boolean(expression):
            what = f"'{expression.text}'" if expression.kind == "name" else "this"
            raise self._error(f"{what} is true or false, where a number is needed", expression.span)
        if expression.kind == "number":
            return Const(float(expression.text))
        if expression.kind == "name":
            value = self._constants.get(expression.text)
            return Var(expression.text) if value is None else Parameter(value, name=expression.text)
        if expression.kind == "operation":
            args = tuple(map(self.number, expression.args))
            if expression.text == "neg" and isinstance(args[0], Const) and args[0].name is None:
                return Const(-args[0].value)
            return STL[expression.text](*args)
        kinds = self._kinds(expression)
        if expression.text in _TEMPORAL:
            initial, current = map(self.number, expression.args)
            return window("delay", self._step, self._step, current, initial)
        return STL[FUNCTIONS.get(expression.text, expression.text)](
            *(self.number(each) for each, _ in zip(expression.args, kinds, strict=True))
        )

    def _kinds(self, call: Expression) -> str:
        found = signature(call)
        if found is None:
            raise self._error(
                f"'{call.text}' is no function here; FRET's {', '.join(_TEMPORAL)}, {', '.join(FUNCTIONS)} and "
                "the mathematical functions of the language are",
                call.span,
            )
        if len(found[0]) != len(call.args):
            raise self._error(
                f"'{call.text}' takes {len(found[0])} arguments, not {len(call.args)}", call.span
            )
        return found[0]

    def _temporal(self, call: Expression) -> Formula:
        self._kinds(call)
        first, second = call.args
        p = self.formula(second)
        if call.text == "preBool":
            if first.kind == "truth":
                return STL["prev" if first.text == "true" else "s_prev"](p)
            return either(STL["s_prev"](p), both(STL["prev"](STL["false"]()), self.formula(first)))
        if first.kind != "number" or float(first.text) < 0 or not float(first.text).is_integer():
            raise self._error(f"'{call.text}' takes a whole number of samples first", first.span)
        n, zero = int(float(first.text)) * self._step, 0 * self._step
        in_scope = p if self._scope is None else both(p, self._scope)
        true = STL["true"]()
        # At the end and at the start of the trace "persists" and "persisted" fail: the samples are missing.
        if call.text == "persisted":
            return both(window("historically", zero, n, in_scope), window("once", n, n, true))
        if call.text == "persists":
            return both(window("always", zero, n, in_scope), window("eventually", n, n, true))
        if self._scope is None:
            return window("once" if call.text == "occurred" else "eventually", zero, n, p)
        return window("since" if call.text == "occurred" else "until", zero, n, self._scope, in_scope)
