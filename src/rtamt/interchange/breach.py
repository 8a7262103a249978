"""Breach's files of signal temporal logic (``.stl``): read and written.

``signal`` declares signals, ``param`` parameters with values, and ``name := formula`` formulas over ``x[t]``. Facts:
the examples of Breach (github.com/decyphir/breach).
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from rtamt.errors import SpecificationError, UsageError
from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.dialect import PLAIN, Dialect, InexpressibleError, Word
from rtamt.interchange.written import Names, ReadRequirement, require_period, specification_text
from rtamt.language.formula import Formula, Parameter, Span, Var, postorder
from rtamt.language.operators import Fixity
from rtamt.language.value_types import Boolean, Enumeration
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from fractions import Fraction

    from rtamt.specification import Specification

_FUNCTIONS = ("abs", "sqrt", "exp", "min", "max", "sin", "cos", "tan", "floor", "ceil", "mod", "sign")

#: Its parser splits a formula at "or" first, then at "=>", and at the first of equal operators: a or b => c is
#: a or (b => c).
BREACH = Dialect(
    "Breach",
    (
        *(Word(name, name) for name in _FUNCTIONS),
        *PLAIN,
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
    tokens=r"\s+|[A-Za-z_]\w*|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?![\w.])|[<>=!]=|=>|/(?![/*])|-(?!>)|[][(),<>+*]",
    bounds=(r"(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|[A-Za-z_]\w*", "numbers or parameters"),
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
_SHIFTED = lazy_pattern(r"[A-Za-z_]\w*\[\s*t\s*[-+][^]]*\]")
_STATEMENT = lazy_pattern(
    r"^[ \t]*(?:(?P<kind>signal|param)\b|(?P<name>[A-Za-z_]\w*)[ \t]*:=|(?P<test>test)\b)", re.MULTILINE
)
_NAME = lazy_pattern(r"[A-Za-z_]\w*")
_VALUE = lazy_pattern(
    r"\s*(?P<name>[A-Za-z_]\w*)\s*=\s*(?P<value>[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*"
)
_NESTING = lazy_pattern(r"[()]|=>|\b(?:and|or|until)\b|\buntil_\[")
#: Operators without an interval have no underscore.
_UNBOUNDED = lazy_pattern(r"\b(alw|ev|once|hist|until)_(?!\[)")
_NOTE = (
    "Breach interpolates linearly between samples in continuous time; in discrete time only the samples count, in "
    "dense time (--time dense) each value holds until the next sample"
)
_END_NOTE = (
    "at the end of the trace Breach extends signals by their last values; here windows end with the trace"
)


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
    signals: list[str] = []
    values: dict[str, float] = {}
    sources: dict[str, str] = {}
    for kind, name, body in _statements(text):
        if kind == "signal":
            signals += _signals(body)
        elif kind == "param":
            for parameter, value in _parameters(body).items():
                if values.setdefault(parameter, value) != value:
                    raise UsageError(f"the parameter '{parameter}' has two values: remove one of them")
        elif name in sources:
            raise UsageError(f"'{name}' is the name of two formulas: rename one of them")
        else:
            sources[name] = body
    definitions: dict[str, Formula] = {}
    rejected: list[Rejection] = []
    for name, source in sources.items():
        try:
            definitions[name] = _formula(source, signals, values, definitions)
        except SpecificationError as error:  # noqa: PERF203 - one formula must not reject the others
            rejected.append(Rejection(name, str(error)))
    if not sources:
        raise UsageError("there is no formula in the text: Breach has them after ':='")
    used = {word for source in sources.values() for word in re.findall(r"[A-Za-z_]\w*(?!\w|\[t)", source)}
    written: list[ReadRequirement] = []
    for name, formula in definitions.items():
        if name in used:
            continue
        try:
            require_period(formula, period)
        except InexpressibleError as error:
            rejected.append(Rejection(name, str(error)))
        else:
            written.append(ReadRequirement(name, formula, f"{name} := {sources[name]}"))
    return Conversion(
        specification_text("Formulas of Breach.", written, Names(parameters=values), period),
        tuple(each.name for each in written),
        tuple(rejected),
        (_NOTE, _END_NOTE),
    )


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
    source: str, signals: list[str], values: dict[str, float], definitions: dict[str, Formula]
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
    try:
        return BREACH.read(
            plain, variables=variables, constants=values, parameters=set(values), definitions=definitions
        )
    except SpecificationError as error:
        raise SpecificationError(error.message, source, error.span) from None


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
    for requirement in spec.document.requirements:
        nodes = postorder(requirement.formula)
        signals = [node.name for node in nodes if isinstance(node, Var)]
        try:
            _require_numbers(nodes)
            text = _UNBOUNDED.sub(r"\1 ", BREACH.write(requirement.formula, parameters=True))
            if _mixes_untils(text):
                raise InexpressibleError("Breach reads 'until' and 'until_' in one chain in another order")
        except InexpressibleError as error:
            rejected.append(Rejection(requirement.name, str(error)))
            continue
        converted.append(requirement.name)
        if signals:
            text = re.sub(rf"\b({'|'.join(dict.fromkeys(signals))})\b", r"\1[t]", text)
        label = re.sub(r"\W", "_", requirement.name)
        lines.append(f"{label} := {text}")
        names |= dict.fromkeys(signals)
        values |= {node.name: node.value for node in nodes if isinstance(node, Parameter)}
    head = [f"signal {', '.join(names)}"] if names else []
    head += [f"param {', '.join(f'{name} = {value!r}' for name, value in values.items())}"] if values else []
    return Conversion(
        "\n".join([*head, "", *lines]) + "\n", tuple(converted), tuple(rejected), (_NOTE, _END_NOTE)
    )


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
