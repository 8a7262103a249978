"""C2PO, the specification language of R2U2: its operators, and its files read.

Its formulas are mission-time linear temporal logic (MLTL): bounds are whole numbers of samples. Facts: R2U2,
compiler/docs/user/language.md, and the precedence of its parser.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.errors import SpecificationError, UsageError
from rtamt.interchange.c2po_types import resolved, with_numerals
from rtamt.interchange.c_integers import remainder
from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.dialect import PLAIN, Dialect, InexpressibleError, Word
from rtamt.interchange.written import Names, ReadRequirement, require_new, specification_text
from rtamt.language.formula import Apply, Formula, Interval, Span, fold, postorder, size
from rtamt.language.operators import STL, Fixity, Tense
from rtamt.language.rows import function, infix
from rtamt.language.value_types import BOOLEAN, Enumeration
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.language.value_types import ValueType

_SECTIONS = ("STRUCT", "ENUM", "INPUT", "DEFINE", "FTSPEC", "PTSPEC")
_MARK = lazy_pattern(r"[A-Za-z_]\w*|[{};]")
_COMMENT = lazy_pattern(r"--[^\n]*")
_NAME = lazy_pattern(r"[A-Za-z_]\w*")
_ENUMERATION = lazy_pattern(r"(?P<name>[A-Za-z_]\w*)\s*:\s*\{(?P<members>[^{}]*)\}")
_MEMBER = lazy_pattern(r"\s*(?P<label>[A-Za-z_]\w*)\s*(?::\s*(?P<code>\d+)\s*)?")
#: An interval without its lower bound, which is 0.
_UPPER_BOUND = lazy_pattern(r"\b([GFHOURST]\s*)\[\s*(\d+)\s*\]")
#: Limits beyond any file that is written by hand.
_LONGEST = 2_000_000
_LARGEST = 20_000


def _release(a: Formula, b: Formula, interval: Interval | None) -> Formula:
    return STL["not"](_until(STL["not"](a), STL["not"](b), interval))


def _until(a: Formula, b: Formula, interval: Interval | None) -> Formula:
    """Return ``a U[l,u] b`` of MLTL, where a need not hold before the interval begins."""
    if interval is None or interval.end is None or interval.begin == 0:
        return STL["until"](a, b, interval=interval)
    begin, rest = interval.begin, interval.end - interval.begin
    inner = STL["until"](a, b, interval=Interval(0 * begin, rest))
    return STL["eventually"](inner, interval=Interval(begin, begin))


def _since(a: Formula, b: Formula, interval: Interval | None) -> Formula:
    if interval is not None and interval.begin > 0:
        raise InexpressibleError("'S' or 'T' with a lower bound above 0 is not covered: write 'O' and 'H'")
    return STL["since"](a, b, interval=interval)


def _trigger(a: Formula, b: Formula, interval: Interval | None) -> Formula:
    return STL["not"](_since(STL["not"](a), STL["not"](b), interval))


def _previous(initial: Formula, a: Formula, _interval: Interval | None) -> Formula:
    return STL["delay"](a, initial, interval=Interval(Fraction(1), Fraction(1)))


#: A formula's tokens. Numbers have digits and at most one point.
_TOKENS = (
    r"\s+|[A-Za-z_]\w*|(?:\d+\.?\d*|\.\d+)(?![\w.])|<->|->|==|!=|>=|<=|&&|\|\||/(?![/*])|[][(),<>!+*%.-]"
)

#: Operators bind as in its parser: unary and temporal prefix operators tighter than arithmetic.
C2PO = Dialect(
    "C2PO",
    (
        Word("abs", "abs"),
        Word("sqrt", "sqrt"),
        *PLAIN,
        Word("not", "!", 120),
        Word("always", "G", 120),
        Word("eventually", "F", 120),
        Word("historically", "H", 120),
        Word("once", "O", 120),
        Word("until", "U", 60),
        Word("since", "S", 60),
        Word("and", "&&"),
        Word("or", "||"),
        Word("implies", "->", 20, Fixity.LEFT),
        Word("iff", "<->", 20),
        Word("xor", "xor", 20),
    ),
    own=(
        (infix("release", "R", 60, "", "a R[0:5] b", bounds=STL["until"].bounds, tense=Tense.FUTURE,
               definition=STL["until"].definition), _release),
        (infix("trigger", "T", 60, "", "a T[0:5] b", bounds=STL["since"].bounds, tense=Tense.PAST,
               definition=STL["since"].definition), _trigger),
        (infix("power", "pow", 110, "", "x pow 2", operands=STL["mul"].operands, result=STL["mul"].result,
               definition=STL["pow"].definition), lambda a, b, _i: STL["pow"](a, b)),
        (infix("remainder", "\ue000", 110, "", "x % 2", operands=STL["mul"].operands, result=STL["mul"].result,
               definition=STL["mod"].definition), lambda a, b, _i: remainder(a, b)),
        (function("prev", 2, "", "prev(0, x)", definition=STL["add"].definition, keeps=(0, 1)), _previous),
    ),
    meanings={"until": _until, "since": _since},
    characters={"%": "\ue000"},
    tokens=_TOKENS,
    bounds=(r"\d+", "whole numbers of samples"),
)  # fmt: skip

#: Other characters that its lexer reads as operators.
_SYMBOLS = str.maketrans({
    "¬": "!", "∧": "&&", "∨": "||", "→": "->", "↔": "<->", "≠": "!=", "≥": ">=", "≤": "<=",
    "•": "*", "⋅": "*", "÷": "/",
})  # fmt: skip
_BITWISE = lazy_pattern(r"(?<!&)&(?!&)|(?<!\|)\|(?!\|)|[~^]|<<|>>")
#: Its keywords that are not covered.
_UNKNOWN = {
    "TAU": "the time of a sample",
    "M": "the mission time",
    "rate": "a rate of change",
    **dict.fromkeys(
        ("foreach", "forsome", "forexactly", "foratleast", "foratmost"), "an aggregation over a set"
    ),
}

_STREAM_NOTE = (
    "R2U2 reports a verdict for every instant; a requirement is satisfied if all of them are true, so that each "
    "specification is read as 'always'"
)
END_NOTE = "R2U2 reports nothing for instants whose windows reach beyond the trace; here they end with it"
_EQUAL_NOTE = "R2U2 compares floats with a tolerance that its build fixes; here '==' is exact"


@dataclass
class _File:
    """The parts of the file read so far."""

    types: dict[str, ValueType] = field(default_factory=dict)
    numbers: list[str] = field(default_factory=list)
    integers: set[str] = field(default_factory=set)
    enumerations: dict[str, Enumeration] = field(default_factory=dict)
    definitions: dict[str, Formula] = field(default_factory=dict)
    unknown: dict[str, str] = field(default_factory=lambda: dict(_UNKNOWN))
    requirements: list[ReadRequirement] = field(default_factory=list)
    rejected: list[Rejection] = field(default_factory=list)


def read_c2po(text: str, period: Fraction | None = None) -> Conversion:
    """Convert a C2PO file to a specification.

    Args:
        text: the content of the file.
        period: the sampling period in seconds, by default 1: bounds of C2PO are numbers of samples.

    Returns:
        The specification, what it cannot express (structures, arrays, bitwise operators, the mission time), and where
        R2U2 differs.

    Raises:
        UsageError: the text has no specification.

    >>> print(read_c2po("INPUT a: bool; x: float; FTSPEC S1: a -> F[0,5](x > 3);").text.splitlines()[-1].strip())
    always(a -> eventually[0:5](x > 3))
    """
    if len(text) > _LONGEST:
        raise UsageError("the text is longer than 2 000 000 characters: split the file")
    file, step = _File(), period or Fraction(1)
    for section, statement in _statements(text):
        _READERS[section](file, statement, step)
    if not file.requirements and not file.rejected:
        raise UsageError("there is no specification in the text: C2PO has them after FTSPEC or PTSPEC")
    notes = [_STREAM_NOTE, END_NOTE]
    if any(
        isinstance(n, Apply) and n.op.equates
        for n in postorder(*(each.formula for each in file.requirements))
    ):
        notes.append(_EQUAL_NOTE)
    roles = dict.fromkeys((*file.types, *file.numbers), "input")
    return Conversion(
        specification_text("Specifications of R2U2.", file.requirements, Names(roles), step),
        tuple(each.name for each in file.requirements),
        tuple(file.rejected),
        tuple(notes),
    )


def _statements(text: str) -> Iterator[tuple[str, str]]:
    """Yield each statement with its section."""
    plain = _COMMENT.sub("", text)
    section, start, depth = "", 0, 0
    for match in _MARK.finditer(plain):
        mark = match[0]
        depth += (mark == "{") - (mark == "}")
        if mark in _SECTIONS and not plain[start : match.start()].strip():
            section, start = mark, match.end()
        elif mark == ";" and depth <= 0:
            statement, start, depth = plain[start : match.start()].strip(), match.end(), 0
            if not section:
                raise UsageError(f"a file of C2PO begins with one of {', '.join(_SECTIONS)}")
            if statement:
                yield section, statement
    rest = plain[start:].strip()
    if rest:
        raise UsageError(f"'{rest[:40]}' has no ';' at its end")


def _structure(file: _File, statement: str, _step: Fraction) -> None:
    name = statement.partition(":")[0].strip()
    file.unknown[name] = "a structure"


def _enumeration(file: _File, statement: str, _step: Fraction) -> None:
    found = _ENUMERATION.fullmatch(statement)
    if found is None:
        raise UsageError(f"'{statement}' is no enumeration, such as Mode: {{Idle, Busy: 4}}")
    name = found["name"]
    members: dict[str, int] = {}
    for code, member in enumerate(found["members"].split(","), 1):
        each = _MEMBER.fullmatch(member)
        if each is None:
            raise UsageError(
                f"'{member.strip()}' is no member of the enumeration {name}, such as Idle or Busy: 4"
            )
        if each["label"] in members:
            raise UsageError(f"the enumeration {name} has the member '{each['label']}' twice")
        members[each["label"]] = int(each["code"] or code)
    file.enumerations[name] = Enumeration(name, tuple(members.items()))


def _inputs(file: _File, statement: str, _step: Fraction) -> None:
    names, _, kind = statement.rpartition(":")
    kind = kind.strip()
    for name in (each.strip() for each in names.split(",")):
        if not _NAME.fullmatch(name):
            raise UsageError(f"'{statement}' declares no inputs, such as a, b: bool")
        if name in (*file.types, *file.numbers, *file.unknown):
            raise UsageError(f"the input '{name}' is declared twice")
        if kind == "bool":
            file.types[name] = BOOLEAN
        elif kind in ("int", "float"):
            file.numbers.append(name)
            if kind == "int":
                file.integers.add(name)
        elif kind in file.enumerations:
            file.types[name] = file.enumerations[kind]
        else:
            file.unknown[name] = f"of the type {kind or 'that is missing'}"


def _define(file: _File, statement: str, _step: Fraction) -> None:
    name, _, body = (each.strip() for each in statement.partition(":="))
    if not _NAME.fullmatch(name) or not body:
        raise UsageError(f"'{statement}' is no definition, such as near := x < 1")
    if name in (*file.types, *file.numbers, *file.unknown, *file.definitions):
        raise UsageError(f"'{name}' is defined twice")
    try:
        file.definitions[name] = _formula(file, body, condition=False)
    except (SpecificationError, InexpressibleError) as error:
        file.unknown[name] = f"a definition that cannot be read ({_first_line(error)})"


def _specification(file: _File, statement: str, step: Fraction) -> None:
    label, colon, body = statement.partition(":")
    number = len(file.requirements) + len(file.rejected)
    if not colon or not _NAME.fullmatch(label.strip()):
        label, body = f"spec_{number}", statement
    name = label.strip()
    try:
        require_new(name, file.requirements)
        parts = body.split("=>")
        formula = _contract(file, parts) if parts[1:] else _formula(file, body, condition=True)
        whole = STL["always"](resolved(formula, file.integers))
        if size(whole) > _LARGEST:
            raise InexpressibleError("with its definitions written out it has more than 20 000 operators")
    except (SpecificationError, InexpressibleError) as error:
        file.rejected.append(Rejection(name, str(error)))
        return
    if parts[1:]:
        file.unknown[name] = "a contract"
    else:
        file.definitions[name] = formula
    file.requirements.append(ReadRequirement(name, _in_seconds(whole, step), statement))


def _contract(file: _File, parts: list[str]) -> Formula:
    """Return the formula of a contract from what is beside its ``=>``, which binds weaker than every operator."""
    if len(parts) > 2 or parts[0].count("(") != parts[0].count(")"):
        raise InexpressibleError(
            "C2PO has one '=>' in a contract, between its assumption and its guarantee; write '->' inside of these"
        )
    return STL["implies"](*(_formula(file, part, condition=True) for part in parts))


_READERS = {
    "STRUCT": _structure,
    "ENUM": _enumeration,
    "INPUT": _inputs,
    "DEFINE": _define,
    "FTSPEC": _specification,
    "PTSPEC": _specification,
}


def _first_line(error: Exception) -> str:
    return str(error).partition("\n")[0]


def _formula(file: _File, text: str, *, condition: bool) -> Formula:
    """Return the formula of an expression, with bounds in samples, as definitions have them."""
    text = text.strip().translate(_SYMBOLS)
    for match in _BITWISE.finditer(text):
        raise SpecificationError(
            f"'{match[0]}' is a bitwise operator, which is not covered", text, Span(*match.span())
        )
    for match in _NAME.finditer(text):
        if match[0] in file.unknown:
            raise SpecificationError(
                f"'{match[0]}' is {file.unknown[match[0]]}, which is not covered", text, Span(*match.span())
            )
    written = _UPPER_BOUND.sub(r"\1[0,\2]", text)
    formula = C2PO.read(
        written,
        condition=condition,
        variables=[*file.types, *file.numbers],
        types=file.types,
        enumerations=file.enumerations,
        definitions=file.definitions,
    )
    return with_numerals(formula, written)


def _in_seconds(formula: Formula, step: Fraction) -> Formula:
    """Return a formula whose bounds are numbers of samples with bounds in seconds."""

    def scaled(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        interval = node.interval
        if interval is not None:
            interval = Interval(interval.begin * step, None if interval.end is None else interval.end * step)
        return node.op(*args, interval=interval)

    return fold(formula, scaled)
