"""Write specifications in C2PO, the language of R2U2."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import TYPE_CHECKING

from rtamt.errors import UsageError
from rtamt.interchange.c2po import C2PO, END_NOTE
from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.dialect import InexpressibleError
from rtamt.interchange.labels import label_of
from rtamt.language.formula import Apply, Formula, Var, postorder
from rtamt.language.operators import STL, Tense
from rtamt.language.units.durations import decimal
from rtamt.language.value_types import Boolean, Enumeration
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    import re

    from rtamt.specification import Specification

_NAME = lazy_pattern(r"[A-Za-z_]\w*")
#: Characters of a label; C2PO allows 50, and some may follow.
_LONGEST_LABEL = 40
#: What a variable cannot be called: the words of the lexer.
_RESERVED = frozenset(
    ("STRUCT ENUM INPUT DEFINE FTSPEC PTSPEC TAU foreach forsome forexactly foratleast foratmost pow sqrt abs rate "
     "prev xor G F H O U R S T M true false bool int float").split()
)  # fmt: skip
#: An interval, whose bounds are ints, or a number.
_NUMBERS = lazy_pattern(r"\[[^]]*\]|(?<![\w.])\d+(?:\.\d+)?(?:[eE][+-]?\d+)?(?!\w)")


def write_c2po(spec: Specification, _component: str | None = None) -> Conversion:
    """Convert the requirements of a specification to a C2PO file.

    Args:
        spec: a specification in discrete time. A requirement ``always(φ)`` becomes the specification φ, whose verdicts
            R2U2 reports at every instant; any other φ likewise, of which the first verdict counts.

    Returns:
        The file, and the requirements that C2PO cannot express: unbounded operators, past and future in one formula.

    Raises:
        UsageError: the specification is in dense time.

    >>> import rtamt
    >>> print(write_c2po(rtamt.parse("require Q: always(x > 3 -> eventually[0:5](y > 3))", period=1)).text.strip())
    INPUT
        x, y: float;
    <BLANKLINE>
    FTSPEC
        Q: x > 3.0 -> F[0,5](y > 3.0);
    """
    if not spec.domain.sampled:
        raise UsageError("C2PO is about samples: read the specification in discrete time")
    step = Fraction(1) if spec.period is None else Fraction(spec.period)
    sections: dict[str, list[str]] = {"FTSPEC": [], "PTSPEC": []}
    converted: list[str] = []
    rejected: list[Rejection] = []
    first: list[str] = []
    formulas: list[Formula] = []
    everything = postorder(*(each.formula for each in spec.document.requirements))
    taken = {*_RESERVED, *(node.name for node in everything if isinstance(node, Var))}
    for requirement in spec.document.requirements:
        formula = requirement.formula
        everywhere = isinstance(formula, Apply) and formula.op is STL["always"] and formula.interval is None
        inner = formula.args[0] if isinstance(formula, Apply) and everywhere else formula
        name = label_of(requirement.name[:_LONGEST_LABEL], taken)
        try:
            section = _section(inner)
            _require_names(inner)
            sections[section].append(f"    {name}: {_with_floats(C2PO.write(inner, step))};")
        except InexpressibleError as error:
            rejected.append(Rejection(requirement.name, str(error)))
            continue
        taken.add(name)
        formulas.append(inner)
        converted.append(requirement.name)
        if not everywhere:
            first.append(name)
    notes = [f"bounds are numbers of samples of {decimal(step)} s", END_NOTE]
    if first:
        notes.append(f"of these, the verdict of the first instant counts: {', '.join(first)}")
    lines = _declare(formulas)
    for section, each in sections.items():
        lines += [section, *each, ""] if each else []
    return Conversion("\n".join(lines).rstrip() + "\n", tuple(converted), tuple(rejected), tuple(notes))


def _section(formula: Formula) -> str:
    """Return the section of a formula; raise where it has operators of both, or an unbounded one."""
    tenses: set[Tense] = set()
    for node in postorder(formula):
        if isinstance(node, Apply) and node.op.tense is not Tense.NONE:
            tenses.add(node.op.tense)
            if node.interval is None or node.interval.end is None:
                raise InexpressibleError(f"C2PO has bounded operators only, unlike '{node}'")
    if len(tenses) > 1:
        raise InexpressibleError("C2PO has no formulas of both future and past operators")
    return "PTSPEC" if Tense.PAST in tenses else "FTSPEC"


def _require_names(formula: Formula) -> None:
    """Raise where a variable has a name that C2PO does not read."""
    for node in postorder(formula):
        if not isinstance(node, Var):
            continue
        if not node.name.isascii() or not _NAME.fullmatch(node.name):
            raise InexpressibleError(
                f"'{node.name}' cannot be a variable of C2PO: use letters, digits and underscores"
            )
        if node.name in _RESERVED:
            raise InexpressibleError(f"'{node.name}' cannot be a variable of C2PO, where it is a keyword")


def _with_floats(text: str) -> str:
    """Return a formula whose numbers are floats, as all variables are, and have digits only."""

    def written(match: re.Match[str]) -> str:
        if match[0].startswith("["):
            return match[0]
        digits = f"{Decimal(match[0]):f}"
        return digits if "." in digits else f"{digits}.0"

    return _NUMBERS.sub(written, text)


def _declare(formulas: list[Formula]) -> list[str]:
    """Return the sections that declare the variables of formulas."""
    kinds: dict[str, list[str]] = {}
    enumerations: dict[str, Enumeration] = {}
    for node in postorder(*formulas):
        if isinstance(node, Var) and node.name not in (name for names in kinds.values() for name in names):
            kind = "float"
            if isinstance(node.type, Boolean | Enumeration):
                kind = node.type.name
            if isinstance(node.type, Enumeration):
                enumerations[kind] = node.type
            kinds.setdefault(kind, []).append(node.name)
    lines: list[str] = []
    for each in enumerations.values():
        members = ", ".join(f"{name}: {code}" for name, code in each.members)
        lines += ["ENUM", f"    {each.name}: {{{members}}};", ""]
    return [*lines, "INPUT", *(f"    {', '.join(names)}: {kind};" for kind, names in kinds.items()), ""]
