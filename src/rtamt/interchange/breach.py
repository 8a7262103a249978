"""Breach's files of signal temporal logic (``.stl``): read and written.

``signal`` declares signals, ``input signal`` and ``output signal`` those with a role, ``param`` parameters with values,
and ``name := formula`` formulas over ``x[t]``. Facts: the examples of Breach (github.com/decyphir/breach).
"""

from __future__ import annotations

import re
from fractions import Fraction
from math import isfinite
from operator import add, mul, neg, sub, truediv
from typing import TYPE_CHECKING

from rtamt.errors import SpecificationError, UsageError
from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.dialect import PLAIN, Dialect, InexpressibleError, Word
from rtamt.interchange.labels import label_of
from rtamt.interchange.written import Names, ReadRequirement, require_period, specification_text
from rtamt.language.formula import Apply, Const, Formula, Parameter, Span, Var, fold, postorder
from rtamt.language.operators import STL, Fixity
from rtamt.language.units.durations import decimal
from rtamt.language.value_types import Boolean, Enumeration
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Mapping

    from rtamt.specification import Specification

_FUNCTIONS = ("abs", "sqrt", "exp", "min", "max", "sin", "cos", "tan", "floor", "ceil", "mod", "sign")

#: Its parser splits a formula at "or" first, then at "=>", and at the first of equal operators: a or b => c is
#: a or (b => c).
BREACH = Dialect(
    "Breach",
    (
        *(Word(name, name) for name in _FUNCTIONS),
        *(word for word in PLAIN if word.name != "ne"),
        Word("not", "not"),
        Word("always", "alw_ alw always always_"),
        Word("eventually", "ev_ ev eventually eventually_"),
        Word("until", "until_ until", fixity=Fixity.RIGHT),
        Word("once", "once_ once"),
        Word("historically", "hist_ hist historically historically_"),
        Word("and", "and"),
        Word("or", "or", 10),
        Word("implies", "->"),
    ),
    characters={"=>": "->"},
    tokens=r"\s+|[A-Za-z_]\w*|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])|[<>=]=|=>|/(?![/*])|-(?!>)|[][(),<>+*]",
    bounds=(r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|\d+/\d+|[A-Za-z_]\w*", "numbers or parameters"),
)  # fmt: skip

#: What nothing can be called: its operators and functions, and the time.
_RESERVED = frozenset(
    [
        "t",
        "inf",
        "true",
        "false",
        "signal",
        "param",
        "test",
        *(s for word in BREACH.words for s in word.spellings.split()),
    ]
)

_COMMENT = lazy_pattern(r"[#%][^\n]*")
_AT = lazy_pattern(r"(?P<name>[A-Za-z_]\w*)\[t\]")
_WORD = lazy_pattern(r"[A-Za-z_]\w*(?!\w|\[t)")
_INTERVAL = lazy_pattern(r"\[([^][]*)\]")
_PLAIN_BOUND = lazy_pattern(r"\s*\d+\.?\d*[eE][-+]?\d+\s*|[^-+*/()]*")
_SHIFTED = lazy_pattern(r"[A-Za-z_]\w*\[\s*t\s*[-+][^]]*\]")
_STATEMENT = lazy_pattern(
    r"^[ \t]*(?:(?P<kind>(?:(?:in|out)put[ \t]+)?signal|param)\b|(?P<name>[A-Za-z_]\w*)[ \t]*:=|(?P<test>test)\b)",
    re.MULTILINE,
)
_NAME = lazy_pattern(r"[A-Za-z_]\w*")
_VALUE = lazy_pattern(
    r"\s*(?P<name>[A-Za-z_]\w*)\s*=\s*(?P<value>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*"
)
_NESTING = lazy_pattern(r"[()]|=>|\b(?:and|or|until)\b|\buntil_\[")
#: How bounds are computed, exactly.
_ARITHMETIC: Mapping[str, Callable[..., Fraction]] = {
    "add": add, "sub": sub, "mul": mul, "div": truediv, "neg": neg
}  # fmt: skip
#: Operators without an interval have no underscore.
_UNBOUNDED = lazy_pattern(r"\b(alw|ev|once|hist|until)_(?!\[)")
_NOTE = (
    "Breach interpolates linearly between samples in continuous time; in discrete time only the samples count, in "
    "dense time (--time dense) each value holds until the next sample"
)
_END_NOTE = (
    "at the end of the trace Breach extends signals by their last values; here windows end with the trace"
)
_EQUAL_NOTE = "Breach takes '==' as true within 1e-13, with a robustness of its own; here it is exact"


def _notes(formulas: Iterable[Formula]) -> tuple[str, ...]:
    equal = any(isinstance(node, Apply) and node.op.equates for node in postorder(*formulas))
    return (_NOTE, _END_NOTE, *((_EQUAL_NOTE,) if equal else ()))


def read_breach(text: str, period: Fraction | None = None) -> Conversion:
    r"""Convert a file of Breach to a specification.

    Args:
        text: the content of the file. Formulas that no other one uses become requirements.
        period: the sampling period in seconds that the specification declares; None for none.

    Returns:
        The specification, what it cannot express (signals at other times, such as ``x[t+dt]``), and where Breach
        differs.

    Raises:
        UsageError: the text has no formula.

    >>> text = "param vmax = 150\nphi := alw (speed[t] > 100 => ev_[0, 2] (speed[t] < vmax))"
    >>> print(read_breach(text).text.splitlines()[-1].strip())
    always(speed > 100 -> eventually[0:2](speed < vmax))
    """
    file = _read_file(text)
    definitions = {scope: _definitions(file, scope) for scope in dict.fromkeys(file.scopes.values())}
    used = {word for source in file.sources.values() for word in _words(source)}
    written: list[ReadRequirement] = []
    rejected: list[Rejection] = []
    for name, source in file.sources.items():
        formula = definitions[file.scopes[name]][name]
        try:
            if isinstance(formula, SpecificationError):
                raise formula
            if name in used:
                continue
            require_period(formula, period)
        except (SpecificationError, InexpressibleError) as error:
            rejected.append(Rejection(name, str(error)))
        else:
            written.append(ReadRequirement(name, formula, f"{name} := {source}"))
    names = Names(file.roles, parameters=file.parameters())
    return Conversion(
        specification_text("Formulas of Breach.", written, names, period),
        tuple(each.name for each in written),
        tuple(rejected),
        _notes(each.formula for each in written),
    )


@dataclass
class _File:
    """What a file declares.

    Attributes:
        roles: the roles of signals: "input" or "output", or "" for none.
        values: each state of the parameters, from the first to the last; a later ``param`` makes another one.
        sources: the text of each formula.
        scopes: which of ``values`` each formula has: Breach reads a formula, with those that it uses, where the next
            one begins.
    """

    roles: dict[str, str] = field(default_factory=dict)
    values: list[dict[str, float]] = field(default_factory=lambda: [{}])
    sources: dict[str, str] = field(default_factory=dict)
    scopes: dict[str, int] = field(default_factory=dict)

    def parameters(self) -> dict[str, float]:
        """Return the parameters that have one value in all formulas; the others are plain numbers."""
        last = self.values[-1]
        return {
            name: value
            for name, value in last.items()
            if all(v.get(name, value) == value for v in self.values)
        }


def _read_file(text: str) -> _File:
    file, latest = _File(), ""
    for kind, name, body in _statements(text):
        if kind == "param":
            file.values.append(file.values[-1] | _parameters(body))
        elif kind == "formula":
            if name in file.sources:
                raise UsageError(f"'{name}' is the name of two formulas: rename one of them")
            file.sources[name] = body
            latest = name
        else:
            role = kind.removesuffix("signal").strip()
            file.roles |= dict.fromkeys(_signals(body), role)
        if latest:
            file.scopes[latest] = len(file.values) - 1
    if not file.sources:
        raise UsageError("there is no formula in the text: Breach has them after ':='")
    return file


def _definitions(file: _File, scope: int) -> dict[str, Formula | SpecificationError]:
    """Return the formulas with a scope, and those that they use, or why one of them cannot be read."""
    needed: set[str] = set()
    for name, source in reversed(file.sources.items()):
        if name in needed or file.scopes[name] == scope:
            needed |= {name, *_words(source)}
    parameters = file.parameters().keys()
    definitions: dict[str, Formula] = {}
    found: dict[str, Formula | SpecificationError] = {}
    for name, source in file.sources.items():
        if name not in needed:
            continue
        try:
            found[name] = definitions[name] = _formula(
                source, file.roles, file.values[scope], parameters, definitions
            )
        except SpecificationError as error:
            found[name] = error
    return found


def _words(source: str) -> list[str]:
    """Return the names in the text of a formula that are no signals."""
    return _WORD.findall(source)


def _statements(text: str) -> Iterator[tuple[str, str, str]]:
    """Yield each statement: its kind, the name of a formula, and what follows."""
    plain = _COMMENT.sub(lambda match: " " * len(match[0]), text)
    found = list(_STATEMENT.finditer(plain))
    if plain[: found[0].start() if found else len(plain)].strip():
        raise UsageError("a file of Breach consists of 'signal', 'param' and 'name := formula'")
    ends = [*(each.start() for each in found), len(plain)][1:]
    for match, after in zip(found, ends, strict=True):
        if match["test"]:
            raise UsageError("tests of Breach are not covered: remove them from the file")
        yield match["kind"] or "formula", match["name"] or "", " ".join(plain[match.end() : after].split())


def _signals(body: str) -> list[str]:
    names = [each.strip() for each in body.split(",") if each.strip()]
    for name in names:
        if not _NAME.fullmatch(name):
            raise UsageError(f"'{name}' is no name of a signal: use letters, digits and underscores")
    return names


def _parameters(body: str) -> dict[str, float]:
    found: dict[str, float] = {}
    for each in body.strip(" ,").split(","):
        match = _VALUE.fullmatch(each)
        if match is None:
            raise UsageError(f"'{each.strip()}' is no parameter with a number, such as vmax = 150")
        found[match["name"]] = float(match["value"])
    return found


def _formula(
    source: str,
    signals: Iterable[str],
    values: Mapping[str, float],
    parameters: Collection[str],
    definitions: Mapping[str, Formula],
) -> Formula:
    shifted = _SHIFTED.search(source)
    if shifted is not None:
        raise SpecificationError(
            f"'{shifted[0]}' is a signal at another time, which is not covered: use x[t]",
            source,
            Span(*shifted.span()),
        )
    if _mixes_untils(source):
        raise SpecificationError(
            "Breach splits a formula at 'until' before 'until_': put one of them in parentheses", source, None
        )
    variables = {*signals, *(match["name"] for match in _AT.finditer(source))}
    plain = _AT.sub(lambda match: f"{match['name']}   ", source)
    plain = _INTERVAL.sub(lambda match: _computed(match, source, values), plain)
    try:
        return BREACH.read(
            plain,
            variables=variables,
            constants=values,
            parameters=parameters & values.keys(),
            definitions=definitions,
        )
    except SpecificationError as error:
        span = error.span if len(plain) == len(source) else None
        raise SpecificationError(error.message, source, span) from None


def _computed(interval: re.Match[str], source: str, values: Mapping[str, float]) -> str:
    """Return the text of an interval with its bounds computed, if possible with the same number of characters."""
    try:
        bounds = [_value(bound, values) for bound in interval[1].split(",")]
    except SpecificationError as error:
        span = Span(*interval.span())
        message = f"the interval {source[span.start : span.end]} cannot be computed: {error.message}"
        raise SpecificationError(message, source, span) from None
    return f"[{','.join(bounds)}]"


def _value(bound: str, values: Mapping[str, float]) -> str:
    """Return the text of a bound, with the value of one that is computed."""
    if _PLAIN_BOUND.fullmatch(bound):
        return bound

    def step(node: Formula, args: tuple[Fraction, ...]) -> Fraction:
        if isinstance(node, Const) and isfinite(node.value):
            return Fraction(repr(node.value))
        operation = _ARITHMETIC.get(node.op.name) if isinstance(node, Apply) else None
        if operation is None:
            raise SpecificationError(f"'{node}' is no arithmetic of numbers", bound, None)
        if operation is truediv and not args[1]:
            raise SpecificationError(f"'{node}' divides by 0", bound, None)
        return operation(*args)

    number = fold(BREACH.read(bound, condition=False, constants=values, variables=()), step)
    indent = bound[: -len(bound.lstrip())]
    return (indent + (decimal(number) or str(number))).ljust(len(bound))


def _mixes_untils(source: str) -> bool:
    """Return whether a chain has 'until' with and without an interval: one binds tighter than the other in Breach."""
    chains: list[set[str]] = [set()]
    for match in _NESTING.finditer(source):
        if match[0] == "(":
            chains.append(set())
        elif match[0] == ")":
            del chains[max(1, len(chains) - 1) :]
        elif match[0].startswith("until"):
            chains[-1].add(match[0])
            if len(chains[-1]) > 1:
                return True
        else:
            chains[-1].clear()
    return False


def write_breach(spec: Specification, _component: str | None = None) -> Conversion:
    """Convert the requirements of a specification to a file of Breach.

    Returns:
        The file, and the requirements that Breach cannot express.

    >>> import rtamt
    >>> print(write_breach(rtamt.parse("require R: always(x > 3 -> eventually[0:5](y > 3))")).text.strip())
    signal x, y
    <BLANKLINE>
    R := alw (x[t] > 3 => ev_[0,5](y[t] > 3))
    """
    lines: list[str] = []
    rejected: list[Rejection] = []
    names: dict[str, None] = {}
    values: dict[str, float] = {}
    converted: list[str] = []
    formulas: list[Formula] = []
    everything = postorder(*(each.formula for each in spec.document.requirements))
    taken = {*_RESERVED, *(node.name for node in everything if isinstance(node, Var | Parameter))}
    for requirement in spec.document.requirements:
        nodes = postorder(requirement.formula)
        signals = [node.name for node in nodes if isinstance(node, Var)]
        try:
            _require_numbers(nodes)
            text = _UNBOUNDED.sub(
                r"\1 ", BREACH.write(_without_unequal(requirement.formula), parameters=True)
            )
            if _mixes_untils(text):
                raise InexpressibleError("Breach reads 'until' and 'until_' in one chain in another order")
        except InexpressibleError as error:
            rejected.append(Rejection(requirement.name, str(error)))
            continue
        converted.append(requirement.name)
        formulas.append(requirement.formula)
        if signals:
            text = re.sub(rf"\b({'|'.join(dict.fromkeys(signals))})\b", r"\1[t]", text)
        label = label_of(requirement.name, taken)
        taken.add(label)
        lines.append(f"{label} := {text}")
        names |= dict.fromkeys(signals)
        values |= {node.name: node.value for node in nodes if isinstance(node, Parameter)}
    head = [f"signal {', '.join(names)}"] if names else []
    head += [f"param {', '.join(f'{name} = {value!r}' for name, value in values.items())}"] if values else []
    return Conversion(
        "\n".join([*head, "", *lines]) + "\n", tuple(converted), tuple(rejected), _notes(formulas)
    )


def _without_unequal(formula: Formula) -> Formula:
    """Return a formula with ``not (a == b)`` for ``a != b``, which Breach does not have."""

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        if node.op is STL["ne"]:
            return STL["not"](STL["eq"](*args))
        return node.op(*args, interval=node.interval)

    return fold(formula, step)


def _require_numbers(nodes: Iterable[Formula]) -> None:
    """Raise for variables that Breach does not have: Booleans, enumerations, and names that it would not read."""
    for node in nodes:
        if isinstance(node, Var) and isinstance(node.type, Boolean | Enumeration):
            kind = node.type.name
            raise InexpressibleError(
                f"Breach has signals of numbers only, and '{node.name}' is of the type {kind}"
            )
        if isinstance(node, Var) and not re.fullmatch(r"[A-Za-z]\w*", node.name, re.ASCII):
            raise InexpressibleError(
                f"'{node.name}' cannot be a signal of Breach: use letters, digits and underscores"
            )
        if isinstance(node, Var | Parameter) and node.name in _RESERVED:
            raise InexpressibleError(f"'{node.name}' cannot be a name of Breach, where it is a keyword")
