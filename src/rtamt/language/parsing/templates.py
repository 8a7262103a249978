"""Templates: ``def near(x, limit = 3) = abs(x) <= limit``, and their uses, such as ``near(speed, limit=5)``.

::

    template  = "def" , word , "(" , parameter , { "," , parameter } , ")" , "=" , expression
    parameter = word , [ "=" , argument ]
    use       = word , "(" , [ [ word , "=" ] , argument , { "," , [ word , "=" ] , argument } ] , ")"
    argument  = duration | expression
    duration  = number , [ "/" , number ] , unit of time

A use stands for the formula of the template, read again with what its parameters mean there: arguments are
shared, not copied, and so are equal uses. The formula itself has no reference to templates.
"""

from __future__ import annotations

from fractions import Fraction

from rtamt.errors import BoundError, NameInFormulaError, did_you_mean
from rtamt.language.formula import Apply, Const, Formula, Span, Var, children, located
from rtamt.language.units.durations import UNITS, exact
from rtamt.language.value_types import UNKNOWN
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.tuples import NamedTuple
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from rtamt.errors import SpecificationError
    from rtamt.language.parsing.lexer import Token, Tokens
    from rtamt.language.parsing.parser import FormulaParser
    from rtamt.language.parsing.scope import Scope

#: Tokens of templates that one text may read again: nested uses with different arguments multiply.
MOST_TOKENS = 100_000


class Argument(NamedTuple):
    """The argument of a parameter: a formula, or a duration of ``length`` units.

    ``unit``: of the duration, or the declared one of the constant that the formula is.

    ``unknown``: while the template is defined, a parameter stands for any formula or duration.
    """

    formula: Formula | None
    length: Fraction = Fraction(0)
    unit: str = ""
    unknown: bool = False


def anything(name: str) -> Argument:
    """Return the placeholder for any formula or duration."""
    return Argument(Var(name, type=UNKNOWN), unknown=True)


class Parameter(NamedTuple):
    """A parameter of a template, and its default."""

    name: str
    default: Argument | None


@dataclass(frozen=True, eq=False)
class Template:
    """A template: its parameters, the tokens of its formula, and the meaning of other names in them."""

    name: str
    parameters: tuple[Parameter, ...]
    text: str
    tokens: Tokens
    scope: Scope

    @property
    def signature(self) -> str:
        """The template as it is used: ``near(x, limit)``."""
        return f"{self.name}({', '.join(parameter.name for parameter in self.parameters)})"


class Use(NamedTuple):
    """Where the template is used whose formula is being read: errors in it point there."""

    text: str
    span: Span
    #: The templates on the way, the outermost first.
    names: tuple[str, ...]

    def error(self, message: str, kind: type[SpecificationError]) -> SpecificationError:
        """Return an error in the formula of the innermost template."""
        through = f", which '{self.names[0]}' uses" if len(self.names) > 1 else ""
        return kind(f"in '{self.names[-1]}'{through}: {message}", self.text, self.span)


@dataclass
class Uses:
    """The uses in a text so far: equal ones share their formula, and their size is limited."""

    formulas: dict[Any, Formula] = field(default_factory=dict)
    tokens: int = 0
    #: From the ID of a node to that of its class of equal nodes; the nodes are kept, so that IDs stay theirs.
    _classes: dict[int, tuple[int, Formula]] = field(default_factory=dict)
    _known: dict[Any, int] = field(default_factory=dict)

    def key(self, argument: Argument) -> Any:
        """Return the same for equal arguments, in which the same constants have names."""
        formula = argument.formula
        if formula is None:
            return argument
        return self._class_of(formula), argument.unit, argument.unknown

    def _class_of(self, formula: Formula) -> int:
        """Return the number of the class of a formula; parts that have one are not searched again."""
        classes, stack = self._classes, [formula]
        while stack:
            node = stack[-1]
            if id(node) not in classes:
                missing = [operand for operand in children(node) if id(operand) not in classes]
                if missing:
                    stack += missing
                    continue
                classes[id(node)] = (self._known.setdefault(self._shape(node), len(self._known)), node)
            stack.pop()
        return classes[id(formula)][0]

    def _shape(self, node: Formula) -> Any:
        if isinstance(node, Apply):
            below = tuple([self._classes[id(operand)][0] for operand in node.args])
            names = node.interval.constants if node.interval is not None else ()
            return node.op, below, node.interval, names
        return (repr(node.value), node.name) if isinstance(node, Const) else node


# ---- definitions ---------------------------------------------------------------------------------


def parse_template(parser: FormulaParser) -> Template:
    """``template = "def" , word , "(" , parameter , { "," , parameter } , ")" , "=" , expression``."""
    parser.next()
    name = parser.next()
    if parser.language.opening(name.text) is not None:
        raise parser.error(f"'{name.text}' is an operator; give the template another name", name.span)
    if name.text in parser.scope:
        raise parser.error(f"'{name.text}' is declared; give the template another name", name.span)
    parameters = _parameters(parser, name)
    if not parser.accept("="):
        raise parser.error(
            f"expected '=' and the formula of '{name.text}', got {parser.token}", parser.token.span
        )
    outer, begin = parser.scope, parser.index
    unknown = {parameter.name: anything(parameter.name) for parameter in parameters}
    parser.scope = replace(outer, arguments={**outer.arguments, **unknown})
    parser.formula()
    parser.scope = outer
    return Template(name.text, parameters, parser.text, parser.tokens.between(begin, parser.index), outer)


def _parameters(parser: FormulaParser, name: Token) -> tuple[Parameter, ...]:
    """``"(" , parameter , { "," , parameter } , ")"``."""
    opening = parser.next()
    found: dict[str, Parameter] = {}
    while True:
        token = parser.next()
        if token.kind != "name" or "." in token.text:
            raise parser.error(f"expected the name of a parameter of '{name.text}', got {token}", token.span)
        if token.text in found:
            raise parser.error(f"'{name.text}' has two parameters called '{token.text}'", token.span)
        default = parse_argument(parser) if parser.accept("=") else None
        if default is None and any(known.default for known in found.values()):
            raise parser.error(
                f"the parameter '{token.text}' has no default, but one before it has; move it up", token.span
            )
        found[token.text] = Parameter(token.text, default)
        if parser.accept(")"):
            return tuple(found.values())
        if not parser.accept(","):
            raise _unclosed_error(parser, opening)


# ---- uses ----------------------------------------------------------------------------------------


def parse_use(parser: FormulaParser, template: Template) -> Formula:
    """``use = word , "(" , [ [ word , "=" ] , argument , { "," , [ word , "=" ] , argument } ] , ")"``."""
    first = parser.next()
    given = _parse_arguments(parser, template, first)
    span = Span(first.start, parser.tokens[parser.index - 1].end)
    missing = [p.name for p in template.parameters if p.name not in given and p.default is None]
    if missing:
        names = " and ".join(f"'{name}'" for name in missing)
        raise parser.error(f"{names} of {template.signature} {_is(missing)} not given", span)
    defaults = {p.name: _placed(p.default, span) for p in template.parameters if p.default is not None}
    arguments = {**defaults, **given}
    return _instance(parser, template, {p.name: arguments[p.name] for p in template.parameters}, span)


def _placed(default: Argument, span: Span) -> Argument:
    return default if default.formula is None else default._replace(formula=placed(default.formula, span))


def _is(names: Sequence[str]) -> str:
    return "is" if len(names) == 1 else "are"


def _parse_arguments(parser: FormulaParser, template: Template, first: Token) -> dict[str, Argument]:
    """Return the arguments of a use, by parameter."""
    names = [parameter.name for parameter in template.parameters]
    opening = parser.next()
    given: dict[str, Argument] = {}
    named = False
    while parser.token.text != ")" or given:
        token, follows = parser.token, parser.tokens[min(parser.index + 1, len(parser.tokens) - 1)]
        if token.kind == "name" and follows.text == "=":
            named, name = True, token.text
            if name not in names:
                hint = did_you_mean(name, names) or f"; its parameters are {', '.join(names)}"
                raise parser.error(
                    f"'{first.text}' has no parameter '{name}'{hint}", token.span, NameInFormulaError
                )
            parser.index += 2
        elif named:
            raise parser.error(
                f"arguments without a name stand before those with one; write {template.signature}",
                token.span,
            )
        elif len(given) == len(names):
            count = f"{len(names)} argument{'s' * (len(names) != 1)}"
            raise parser.error(
                f"'{first.text}' takes {count}, got more; write {template.signature}", token.span
            )
        else:
            name = names[len(given)]
        if name in given:
            raise parser.error(f"'{name}' of {template.signature} is given twice", token.span)
        given[name] = parse_argument(parser)
        if not parser.accept(","):
            break
    if not parser.accept(")"):
        raise _unclosed_error(parser, opening)
    return given


def parse_argument(parser: FormulaParser) -> Argument:
    """``argument = duration | expression``; a parameter of the template around it is passed on."""
    ahead = [token.text for token in parser.tokens[parser.index : parser.index + 5]] + [""] * 5
    token = parser.token
    below = ahead[1] == "/"
    unit, after = ahead[3 if below else 1], ahead[4 if below else 2]
    if token.kind == "number" and unit in UNITS and after in (",", ")"):
        try:
            length = exact(token.text) / (exact(ahead[2]) if below else 1)
        except (ValueError, ZeroDivisionError):
            raise parser.error(
                "this is no duration; write for example 5s or 1/3s", token.span, BoundError
            ) from None
        parser.index += 4 if below else 2
        return Argument(None, length, unit)
    passed = parser.scope.arguments.get(token.name) if ahead[1] in (",", ")") else None
    if passed is not None and token.kind in ("name", "quoted"):
        parser.next()
        if passed.formula is not None:
            parser.borrowed.add(id(passed.formula))
        return passed
    formula = parser.expression()
    name = formula.name if isinstance(formula, Const) else None
    return Argument(formula, unit="" if name is None else parser.scope.units.get(name, ""))


def _unclosed_error(parser: FormulaParser, opening: Token) -> SpecificationError:
    if parser.token.kind == "end":
        return parser.error("this '(' is never closed", opening.span)
    return parser.error(f"expected ',' or ')', got {parser.token}", parser.token.span)


def _instance(
    parser: FormulaParser, template: Template, arguments: Mapping[str, Argument], span: Span
) -> Formula:
    """Return the formula of a template with its parameters replaced by arguments."""
    uses = parser.uses
    key = (id(template), *map(uses.key, arguments.values()))
    known = uses.formulas.get(key)
    if known is not None:
        parser.borrowed.add(id(known))
        return known
    uses.tokens += len(template.tokens)
    if uses.tokens > MOST_TOKENS:
        raise parser.error(
            f"the templates of this text make more than {MOST_TOKENS:,} words of it; "
            f"give what they are applied to again and again a name, and use the name",
            span,
        )
    use = parser.use
    inner = parser.twin()
    inner.use = (
        Use(parser.text, span, (template.name,))
        if use is None
        else Use(*use[:2], (*use.names, template.name))
    )
    inner.text = template.text
    inner.read(template.tokens)
    inner.scope = replace(template.scope, arguments={**template.scope.arguments, **arguments})
    inner.borrowed = {id(argument.formula) for argument in arguments.values()}
    formula = inner.expression()
    assert inner.token.kind == "end", "the definition was read to its end"
    made = placed(formula, inner.use.span, inner.borrowed)
    uses.formulas[key] = made
    parser.borrowed.add(id(made))
    return made


def placed(formula: Formula, span: Span, borrowed: set[int] | frozenset[int] = frozenset()) -> Formula:
    """Return a formula whose nodes all have one position, but for ``borrowed`` nodes (by ID) and what is below them."""
    return all_placed((formula,), span, borrowed)[0]


def all_placed(
    formulas: Iterable[Formula], span: Span, borrowed: set[int] | frozenset[int] = frozenset()
) -> list[Formula]:
    """Apply :func:`placed` to formulas that share nodes, and keep the sharing."""
    made: dict[int, Formula] = {}
    found = []
    for formula in formulas:
        stack: list[tuple[Formula, bool]] = [(formula, False)]
        while stack:
            node, ready = stack.pop()
            if id(node) in made:
                continue
            if id(node) in borrowed:
                made[id(node)] = node
            elif not isinstance(node, Apply):
                made[id(node)] = located(node, span)
            elif ready:
                args = tuple([made[id(operand)] for operand in node.args])
                interval = None if node.interval is None else replace(node.interval, span=span)
                made[id(node)] = Apply(node.op, args, interval, span)
            else:
                stack.append((node, True))
                stack.extend([(operand, False) for operand in node.args])
        found.append(made[id(formula)])
    return found
