"""Groups of signals, such as the cars of a traffic scene, and quantifiers over their members.

::

    group      = [ "input" | "output" ] , "group" , word , "=" , '"' , pattern , '"' ,
                 [ "{" , { field , [ ";" ] } , "}" ] , [ ";" ]
    field      = type , name , [ "[" , unit , "]" ] , [ "=" , '"' , recorded , '"' ]
    quantifier = ( "forall" | "exists" | "count" ) , word , "in" , group , [ "where" , different ] , ":" , expression
    different  = word , "!=" , word , { "and" , word , "!=" , word }

The pattern has one star: ``group cars = "car_*"`` has a member for each recorded signal such as ``car_3.x``, whose
field is x. What follows the colon extends as far to the right as it can. Which members there are is known with the
data: ``rtamt.rewrite.quantifiers`` replaces quantifiers by conjunctions, disjunctions and sums over them.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from functools import lru_cache
from math import inf
from operator import add
from types import MappingProxyType

from rtamt.errors import NameInFormulaError, choices, did_you_mean
from rtamt.language.contents import leaves_of, operators_of
from rtamt.language.formula import Apply, Const, Formula, Span, Var, postorder
from rtamt.language.lazy_modules import rules as unit_rules
from rtamt.language.parsing.lexer import NAME, quoted
from rtamt.language.records import Fixity, Operator, Sort
from rtamt.language.rows import C, F, N, operator
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, ClassVar, Literal

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping

    from rtamt.errors import StlError
    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.names import NameParser
    from rtamt.language.parsing.parser import FormulaParser
    from rtamt.language.records import Expansion
    from rtamt.language.value_types import ValueType


@dataclass(frozen=True, slots=True)
class Field:
    """A declared field of the members of a group: its type as written, the type of its values, its unit.

    ``name``: as recorded. ``called``: in formulas, if that is another name.
    """

    name: str
    type: str = "float"
    values: ValueType | None = None
    unit: str = ""
    called: str = ""


@dataclass(frozen=True, slots=True)
class Group:
    """A pattern of recorded names, whose members have common fields.

    ``fields``: as declared; empty if formulas determine them. ``role``: of the fields of each member.
    """

    name: str
    pattern: str
    fields: tuple[Field, ...] = ()
    role: Literal["input", "output"] | None = None
    span: Span | None = field(default=None, compare=False, repr=False)

    @property
    def beginning(self) -> str:
        """The text with which the names of its members begin."""
        return self.pattern.partition("*")[0]

    def member(self, column: str) -> tuple[str, str] | None:
        """Return the member and the field of a recorded name; None for other names.

        >>> Group("cars", "car_*").member("car_3.pose.x")
        ('car_3', 'pose.x')
        """
        found = re.fullmatch(rf"({_expression(self.pattern)})\.(.+)", column)
        return None if found is None else (found[1], found[2])

    def matches(self, name: str) -> bool:
        """Return whether a recorded name without a field is that of a member."""
        return re.fullmatch(_expression(self.pattern), name) is not None

    def values(self, name: str) -> ValueType | None:
        """Return the type of the values of a field, None for numbers."""
        return next((each.values for each in self.fields if each.name == name), None)


@dataclass(frozen=True, slots=True)
class Declared(Collection[str]):
    """The variables that a text declares; it contains the names that belong to members of its ``groups``, too.

    >>> declared = Declared(frozenset({"ego"}), (Group("cars", "car_*"),))
    >>> [name in declared for name in ("ego", "car_1", "car_1.x", "truck_1.x")], list(declared)
    ([True, True, True, False], ['ego'])
    """

    variables: frozenset[str] = frozenset()
    groups: tuple[Group, ...] = ()

    def __contains__(self, name: object) -> bool:
        if name in self.variables:
            return True
        return isinstance(name, str) and any(each.matches(name) or each.member(name) for each in self.groups)

    def __iter__(self) -> Iterator[str]:
        return iter(self.variables)

    def __len__(self) -> int:
        return len(self.variables)


@lru_cache(maxsize=256)
def _expression(pattern: str) -> str:
    before, _, after = map(re.escape, pattern.partition("*"))
    return f"{before}[^.]+?{after}"


@dataclass(frozen=True, slots=True)
class Binder:
    """The variable of a quantifier, its group, and the pairs of variables bound to different members."""

    variable: str
    group: Group
    apart: tuple[tuple[str, str], ...] = ()

    def __str__(self) -> str:
        where = " and ".join(f"{one} != {other}" for one, other in self.apart)
        return f"{self.variable} in {self.group.name}{f' where {where}' if where else ''}"


@dataclass(frozen=True, slots=True, repr=False)
class FieldOf(Var):
    """A field of the member bound to a quantifier's variable, such as ``v.x``."""

    bound: ClassVar[bool] = True

    variable: str = ""
    field: str = ""
    group: Group | None = None


def _row(
    name: str, symbol: str, doc: str, sort: Sort, result: Sort, expansion: Expansion, phrase: str
) -> Operator:
    example = f"{name} v in cars: v.x >= 3"
    row = Operator(name, (name,), Fixity.QUANTIFIER, 5, (sort,), result, doc, example, symbol)
    return replace(row, expansion=expansion, phrase=phrase, units=unit_rules.plain if result is N else None)


#: The quantifiers by their words. Those of a formula have a binder, see :func:`quantified`.
QUANTIFIERS: Mapping[str, Operator] = MappingProxyType({
    "forall": _row("forall", r"\forall", "Every member that is present: the smallest value; +inf if there is none.",
                   F, F, lambda body, _i: body, "for every {B}, {0}"),
    "exists": _row("exists", r"\exists", "Some member that is present: the largest value; -inf if there is none.",
                   F, F, lambda body, _i: body, "for some {B}, {0}"),
    "count": _row("count", r"\#", "How many of the members that are present satisfy the formula, a number.",
                  C, N, lambda body, _i: operator("if")(body, Const(1.0), Const(0.0)),
                   "the number of {B} for which {0}"),
})  # fmt: skip


class Join(NamedTuple):
    """The combination of members by a quantifier: formulas, and the numbers that they evaluate to.

    ``guard``: the operator between the presence of a member and the body. ``formulas``: the operator between members.
    ``numbers``: the same of two numbers, ``columns`` (a function of numpy) of two arrays. ``none``: the value without
    members.
    """

    guard: str
    formulas: str
    numbers: Callable[[float, float], float]
    columns: str
    none: float


#: How each quantifier combines its members.
JOINS: Mapping[str, Join] = MappingProxyType({
    "forall": Join("implies", "and", min, "minimum", inf),
    "exists": Join("and", "or", max, "maximum", -inf),
    "count": Join("and", "add", add, "add", 0.0),
})  # fmt: skip

_QUANTIFIED: dict[tuple[str, Binder], Operator] = {}


def quantified(word: str, binder: Binder) -> Operator:
    """Return the quantifier of this word and binder; equal ones are the same operator."""
    key = word, binder
    made = _QUANTIFIED.get(key)
    if made is None:
        made = replace(QUANTIFIERS[word], binder=binder, maker=(quantified, key))
        made = _QUANTIFIED.setdefault(key, made)
    return made


# ---- the text ------------------------------------------------------------------------------------


def unquoted_pattern(parser: FormulaParser) -> Span | None:
    """Return the pattern in the declaration of a group here, if it lacks its quotes."""
    texts, starts, ends = parser.texts, parser.starts, parser.ends
    at = parser.index + (parser.texts[parser.index] in ("input", "output"))
    if texts[at : at + 3 : 2] != ["group", "="]:
        return None
    _, name, _, first, *_ = parser.tokens[at : at + 4]
    if name.kind != "name" or first.kind in ("quoted", "end"):
        return None
    last = at + 3
    while starts[last + 1] == ends[last] and texts[last + 1] not in ("", ";", "{"):
        last += 1
    return Span(first.start, ends[last])


def begins_quantifier(parser: FormulaParser) -> bool:
    """Return whether a quantifier begins here: an undeclared word, a name, ``in`` and a name.

    Also ``forall v, w in cars``, which no formula begins with either: it is an error with a hint of its own.
    """
    at = parser.index
    if parser.texts[at] not in QUANTIFIERS:
        return False
    first, variable, word, group, after = (*parser.tokens[at : at + 5], *[parser.tokens[-1]] * 4)[:5]
    if first.text in parser.scope:
        return False
    if variable.kind != "name" or word.text not in ("in", ",") or group.kind != "name":
        return False
    if word.text == ",":
        return after.text in ("in", ",")
    # `forall U in` is a formula, after which no name and no colon can follow.
    return parser.language.infix(variable.text) is None or after.text in (":", "where")


def parse_quantifier(parser: FormulaParser) -> Formula:
    """``quantifier = word , word , "in" , group , [ "where" , different ] , ":" , expression``."""
    first, variable, word, name = (parser.next() for _ in range(4))
    if word.text == ",":
        ahead = parser.tokens[parser.index : parser.index + 2]
        of = ahead[1].text if ahead[0].text == "in" and ahead[1].kind == "name" else "cars"
        raise _several(parser, first.text, (variable, of), (name, of))
    scope = parser.scope
    group = scope.groups.get(name.text)
    if group is None:
        hint = choices(name.text, scope.groups, "groups") if scope.groups else ""
        declare = "" if hint else f'; declare it before the formulas: group {name.text} = "{name.text}_*"'
        raise parser.error(f"there is no group '{name.text}'{hint}{declare}", name.span, NameInFormulaError)
    taken = (
        variable.text in scope.members or variable.text in scope or variable.text in _members_given(parser)
    )
    if taken or "." in variable.text:
        why = "has a dot" if "." in variable.text else "has a meaning already"
        raise parser.error(
            f"'{variable.text}' {why}; choose another word for the member of '{group.name}'", variable.span
        )
    parser.scope = replace(scope, members={**scope.members, variable.text: group})
    apart = _different(parser) if parser.accept("where") else ()
    if not parser.accept(":"):
        ahead = parser.tokens[parser.index : parser.index + 4]
        if [each.text for each in ahead[::2]] == [",", "in"] and ahead[1].kind == ahead[3].kind == "name":
            raise _several(parser, first.text, (variable, group.name), (ahead[1], ahead[3].text))
        expected = "':'" if apart else "':' or 'where'"
        raise parser.error(
            f"expected {expected} after '{first.text} {variable.text} in {group.name}', got {parser.token}",
            parser.token.span,
        )
    op = quantified(first.text, Binder(variable.text, group, apart))
    start = parser.token.start
    body = parser.expression()
    end = parser.tokens[parser.index - 1].end
    made = parser.apply(op, (body,), (Span(start, end),), None, Span(first.start, end))
    parser.scope = scope
    return made


def _several(parser: FormulaParser, word: str, one: tuple[Token, str], other: tuple[Token, str]) -> StlError:
    """Return the error for a quantifier with several variables: tokens and their groups."""
    nested = ": ".join(f"{word} {token.text} in {group}" for token, group in (one, other))
    return parser.error(
        f"'{word}' takes one variable; nest the quantifiers: {nested}: ...", Span(one[0].start, other[0].end)
    )


def _members_given(parser: FormulaParser) -> set[str]:
    """Return the variables of quantifiers around the use of a template, which its arguments may read."""
    formulas = [each.formula for each in parser.scope.arguments.values() if each.formula is not None]
    return {each.variable for each in fields_of(*formulas)}


def _different(parser: FormulaParser) -> tuple[tuple[str, str], ...]:
    """``different = word , "!=" , word , { "and" , word , "!=" , word }``."""
    found: list[tuple[str, str]] = []
    while not found or parser.accept("and"):
        one, sign, other = (parser.next() for _ in range(3))
        span = Span(one.start, other.end)
        newest = list(parser.scope.members)[-1]
        other_variable = next((name for name in reversed(list(parser.scope.members)) if name != newest), None)
        example = f"{newest} != {other_variable or ('w' if newest != 'w' else 'v')}"
        if sign.text not in ("!=", "!=="):
            raise parser.error(
                f"'where' takes two variables of quantifiers that stand for different members, such as "
                f"where {example}; put any other condition into the formula: {newest} in ...: condition -> ...",
                span,
            )
        for token in (one, other):
            if token.text not in parser.scope.members:
                raise parser.error(
                    f"'{token.text}' is not the variable of a quantifier"
                    f"{did_you_mean(token.text, parser.scope.members)}; 'where' takes two of them, such as "
                    f"where {example}",
                    token.span,
                )
        if one.text == other.text or newest not in (one.text, other.text):
            raise parser.error(
                f"'where' compares '{newest}' with the variable of a quantifier around this one, such as "
                f"where {example}",
                span,
            )
        found.append((one.text, other.text))
    return tuple(found)


def field_of(parser: NameParser, name: str, span: Span) -> Formula | None:
    """Return the meaning of a name that begins with the variable of a quantifier; None for any other name."""
    variable, _, path = name.partition(".")
    group = parser.scope.members.get(variable)
    if group is None:
        if name in parser.scope.groups and name not in parser.scope:
            raise parser.error(f"'{name}' is a group; quantify over it: forall v in {name}: ...", span)
        return None
    known = {each.called or each.name: each for each in group.fields}
    if not path:
        such = f"{name}.{next(iter(known), 'x')}"
        such = such if NAME.fullmatch(such) else quoted(such)
        raise parser.error(
            f"'{name}' is a member of '{group.name}'; name one of its fields, such as {such}", span
        )
    if known and path not in known:
        raise parser.error(
            f"'{path}' is not a field of '{group.name}'{choices(path, known, 'fields')}",
            span,
            NameInFormulaError,
        )
    recorded = known[path].name if known else path
    return FieldOf(name, span, group.values(recorded), variable, recorded, group)


def quantifiers(*formulas: Formula) -> tuple[Apply, ...]:
    """Return the quantifiers of formulas, those inside others first."""
    if all(op.binder is None for op in operators_of(*formulas)):
        return ()
    return tuple(
        node for node in postorder(*formulas) if isinstance(node, Apply) and node.op.binder is not None
    )


def fields_of(*formulas: Formula) -> tuple[FieldOf, ...]:
    """Return the fields of members that formulas read, in order of appearance."""
    return tuple([node for node in leaves_of(*formulas) if isinstance(node, FieldOf)])
