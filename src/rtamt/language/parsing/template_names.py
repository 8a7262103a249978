"""Names in the formula of a template: the arguments of its parameters.

A parameter is a formula, a signal whose fields are read, or the bound of an interval.
"""

from __future__ import annotations

from fractions import Fraction
from math import isinf

from rtamt.errors import BoundError
from rtamt.language.formula import Const, Var
from rtamt.language.units.durations import exact
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtamt.language.formula import Formula, Span
    from rtamt.language.parsing.names import NameParser
    from rtamt.language.parsing.parser import FormulaParser

#: The value of a parameter that bounds an interval, while its template is defined: any that makes no interval empty.
_LEAST, _GREATEST = Fraction(0), Fraction(10) ** 9


def meaning(parser: NameParser, name: str, span: Span) -> Formula | None:
    """Return the argument of a parameter, or a field of its signal; None for any other name."""
    arguments = parser.scope.arguments
    argument = arguments.get(name)
    head, _, rest = name.partition(".")
    if argument is None and head in arguments:
        signal = arguments[head].formula
        if not isinstance(signal, Var):
            raise parser.error(
                f"'{head}' is no signal here, and only signals have fields, such as {name}", span
            )
        return signal if arguments[head].unknown else parser.signal(f"{signal.name}.{rest}", span)
    if argument is None:
        return None
    if argument.formula is None:
        raise parser.error(f"'{name}' is a duration, which only bounds an interval, such as [0:{name}]", span)
    parser.borrowed.add(id(argument.formula))
    return argument.formula


def bound(parser: FormulaParser, name: str, span: Span) -> tuple[Fraction | None, str] | None:
    """Return the bound that a parameter stands for, and its unit; None for any other name. Infinity is None, too."""
    argument = parser.scope.arguments.get(name)
    if argument is None:
        return None
    if argument.unknown:
        return (_LEAST if _is_lower(parser) else _GREATEST), ""
    if argument.formula is None:
        return argument.length, argument.unit
    if not isinstance(argument.formula, Const):
        raise parser.error(
            f"'{name}' bounds an interval; give it a number or a duration, such as 5s", span, BoundError
        )
    value = argument.formula.value
    if isinf(value):
        return (None if value > 0 else Fraction(-1)), argument.unit
    return exact(str(value)), argument.unit


def _is_lower(parser: FormulaParser) -> bool:
    """Return whether the name just read is a lower bound: the first of two."""
    after = parser.tokens[parser.index : parser.index + 2]
    first = parser.tokens[parser.index - 2].text in ("[", "(")
    return first and any(token.text in (":", ",") for token in after)


def constants_of(parser: FormulaParser, names: Iterable[str]) -> tuple[str, ...]:
    """Return the constants among names in an interval, also those that parameters stand for."""
    found = []
    for name in names:
        argument = parser.scope.arguments.get(name)
        if argument is None and name in parser.scope.constants:
            found.append(name)
        elif (
            argument is not None and isinstance(argument.formula, Const) and argument.formula.name is not None
        ):
            # A constant of the use; the file of the template need not know it.
            found.append(argument.formula.name)
    return tuple(found)
