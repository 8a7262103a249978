"""Formulas of py-metric-temporal-logic (``mtl.parse``): read and written, one a line.

Facts: the grammar of github.com/mvcisback/py-metric-temporal-logic.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import SpecificationError, UsageError
from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.dialect import Dialect, InexpressibleError, Word
from rtamt.interchange.labels import label_of
from rtamt.interchange.written import Names, ReadRequirement, require_new, require_period, specification_text
from rtamt.language.formula import Apply, Interval, Var, fold, postorder
from rtamt.language.operators import STL, Fixity
from rtamt.language.parsing.lexer import LINE_END
from rtamt.language.units.durations import decimal
from rtamt.language.unwritten import TRUTH
from rtamt.language.value_types import BOOLEAN
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable
    from fractions import Fraction

    from rtamt.language.formula import Formula
    from rtamt.specification import Specification


def _until(a: Formula, b: Formula, interval: Interval | None) -> Formula:
    """Return ``a U[l,h] b``, of which the first operand must hold where the interval begins, too."""
    found = STL["until"](a, b, interval=interval)
    if interval is None:
        return found
    return STL["and"](STL["always"](a, interval=Interval(0 * interval.begin, interval.begin)), found)


MTL = Dialect(
    "py-metric-temporal-logic",
    (
        Word("true", "TRUE"),
        Word("false", "FALSE"),
        Word("not", "~ ¬", 130),
        Word("always", "G \ue002", 130),
        Word("eventually", "F \ue003", 130),
        Word("next", "X \ue001", 130),
        Word("until", "U", 60),
        Word("unless", "W", 60),
        Word("and", "& and ∧"),
        Word("or", "| or ∨"),
        Word("implies", "-> →", fixity=Fixity.LEFT),
        Word("iff", "<-> iff ⇔"),
        Word("xor", "^ xor ⊕"),
    ),
    tokens=r"\s+|[A-Za-z_][A-Za-z_\d]*|(?:\d*\.\d+|\d+)(?![\w.])|<->|->|< >|[][(),~¬@\ue001-\ue003&∧|∨→⇔^⊕+-]",
    bounds=(r"[-+]?(?:\d*\.\d+|\d+)|inf|[a-z\d]+", "numbers of seconds or inf"),
    meanings={"until": _until},
    characters={"@": "\ue001", "< >": "\ue003  ", "[ ]": "\ue002  "},
)

_SIGNED = lazy_pattern(r"([\[,]\s*)\+(?=[\d.])")
#: Operators that their operand follows without a space, as in the formulas that it prints: GFa is G F a.
_JOINED = lazy_pattern(r"\b[GFX]+(?=[a-z_]|TRUE\b|FALSE\b)|\b[GFX]{2,}\b")
_APART = str.maketrans("XGF", "\ue001\ue002\ue003")
_TOGETHER = {other: letter for letter, other in _APART.items()}
_ATOM = lazy_pattern(r"\b[a-z_][A-Za-z_\d]*\b")
_WORDS = frozenset({"and", "or", "iff", "xor", "inf"})
_NAME = lazy_pattern(r"[\w.-]+")
_LABEL = lazy_pattern(r"\s*(?P<name>[\w.-]+)\s*:\s*(?P<formula>.*)")
_NOTE = "py-metric-temporal-logic holds each value until the next sample: use --time dense for verdicts between samples"
_END_NOTE = "its signals keep their last values for ever; here windows end with the trace"
_WINDOW_NOTE = (
    "its evaluator leaves out the end of a window: F[0,3] misses what begins 3 s later; here it counts"
)
_WEAK_NOTE = "its evaluator takes 'a W b' as true where b never holds from then on; here a has to hold then"


def _notes(formulas: Iterable[Formula]) -> tuple[str, ...]:
    nodes = [node for node in postorder(*formulas) if isinstance(node, Apply)]
    notes = [_NOTE, _END_NOTE]
    if any(node.interval is not None and node.interval.end is not None for node in nodes):
        notes.append(_WINDOW_NOTE)
    if any(node.op is STL["unless"] for node in nodes):
        notes.append(_WEAK_NOTE)
    return tuple(notes)


def read_mtl(text: str, period: Fraction | None = None) -> Conversion:
    """Convert formulas of py-metric-temporal-logic to a specification.

    Args:
        text: one formula a line, each with an optional name and a colon before it. Its atoms become Booleans.
        period: the sampling period in seconds that the specification declares; None for none.

    Raises:
        UsageError: the text has no formula.

    >>> print(read_mtl("R1: G(a -> F[0, 2] b)").text.splitlines()[-1].strip())
    always(a -> eventually[0:2] b)
    """
    written: list[ReadRequirement] = []
    rejected: list[Rejection] = []
    for number, line in enumerate(LINE_END.split(text), 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        match = _LABEL.fullmatch(line)
        name, source = (match["name"], match["formula"]) if match else (f"line_{number}", line.strip())
        try:
            formula = _formula(source)
            require_period(formula, period)
            require_new(name, written)
        except (SpecificationError, InexpressibleError) as error:
            rejected.append(Rejection(name, str(error)))
            continue
        written.append(ReadRequirement(name, formula, source))
    if not written and not rejected:
        raise UsageError("there is no formula in the text, such as: G(a -> F[0, 2] b)")
    return Conversion(
        specification_text("Formulas of py-metric-temporal-logic.", written, Names(), period),
        tuple(each.name for each in written),
        tuple(rejected),
        _notes(each.formula for each in written),
    )


def _formula(source: str) -> Formula:
    plain = _JOINED.sub(lambda match: match[0].translate(_APART), _SIGNED.sub(r"\1 ", source))
    atoms = set(_ATOM.findall(plain)) - _WORDS
    try:
        return MTL.read(plain, variables=atoms, types=dict.fromkeys(atoms, BOOLEAN))
    except SpecificationError as error:
        raise SpecificationError(error.message.translate(_TOGETHER), source, error.span) from None


def write_mtl(spec: Specification, _component: str | None = None) -> Conversion:
    r"""Convert the requirements of a specification to formulas of py-metric-temporal-logic, one a line.

    Returns:
        The formulas, and the requirements that it cannot express: it has no arithmetic, no comparisons and no past.

    >>> import rtamt
    >>> print(write_mtl(rtamt.parse("bool a\nbool b\nrequire R: always(a -> eventually[0:2] b)")).text.strip())
    R: G (a -> F[0,2] b)
    """
    lines: list[str] = []
    rejected: list[Rejection] = []
    converted: list[str] = []
    names = {requirement.name for requirement in spec.document.requirements}
    for requirement in spec.document.requirements:
        try:
            for node in postorder(requirement.formula):
                if isinstance(node, Apply) and node.op is STL["unless"] and node.interval is not None:
                    raise InexpressibleError(f"{MTL.title} has no 'W' with an interval, as in '{node}'")
                if isinstance(node, Var) and (node.type is not BOOLEAN or not _ATOM.fullmatch(node.name)):
                    raise InexpressibleError(
                        f"'{node.name}' is no Boolean whose name begins with a small letter"
                    )
            text = fold(MTL.translated(requirement.formula), _group)
        except InexpressibleError as error:
            rejected.append(Rejection(requirement.name, str(error)))
            continue
        converted.append(requirement.name)
        label = requirement.name
        if not _NAME.fullmatch(label):
            label = label_of(label, names)
            names.add(label)
        lines.append(f"{label}: {text}")
    return Conversion(
        "\n".join(lines) + "\n",
        tuple(converted),
        tuple(rejected),
        _notes(each.formula for each in spec.document.requirements if each.name in converted),
    )


def _group(node: Formula, args: tuple[str, ...]) -> str:
    """Return the text of a node; in its grammar each infix operation is parenthesised."""
    if not isinstance(node, Apply):
        return str(node)
    if node.op is TRUTH:
        return args[0]
    word = node.op.spellings[0]
    if node.interval is not None:
        begin = decimal(node.interval.begin)
        end = "inf" if node.interval.end is None else decimal(node.interval.end)
        if begin is None or end is None:
            raise InexpressibleError(f"{MTL.title} has decimal bounds only, unlike '{node}'")
        word += f"[{begin},{end}]"
    if len(args) == 2:
        return f"({args[0]} {word} {args[1]})"
    return word if not args else f"{word}{args[0]}" if word == "~" else f"{word} {args[0]}"
