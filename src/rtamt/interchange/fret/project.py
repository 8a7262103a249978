"""Read requirements of FRET: its JSON files, or sentences one a line."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from rtamt.errors import SpecificationError, UsageError
from rtamt.interchange.conversion import Conversion, Rejection
from rtamt.interchange.fret.formalize import formalize, inside
from rtamt.interchange.fret.lower import Lowering, Types
from rtamt.interchange.fret.sentence import Duration, Sentence, parse_sentence
from rtamt.interchange.written import Names, ReadRequirement, specification_text
from rtamt.language.formula import Apply, Var, postorder
from rtamt.language.parsing.lexer import LINE_END
from rtamt.language.units.durations import decimal
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rtamt.interchange.fret.expressions import Expression
    from rtamt.language.formula import Formula, Span

#: FRET's data types of variables that are Booleans, and of numbers; a variable may have none yet.
_BOOLEAN = ("boolean", "bool")
_NUMBERS = ("integer", "unsigned integer", "int", "single", "double", "real")
#: FRET's kinds of variables and their roles here; all others have none.
_ROLES = {"input": "input", "output": "output"}
_LABEL = lazy_pattern(r"\s*(?P<label>[\w.-]+)\s*:\s*(?P<sentence>.*)", re.DOTALL)

UNITS_NOTE = (
    "FRET counts one unit of time as one sample and converts no units; here durations are seconds, and 'sample' gives "
    "the period"
)
EXACT_NOTE = "FRET's '=' between numbers is '==', which no tolerance widens: robustness is 0 where it holds"


@dataclass(frozen=True, slots=True)
class FretRequirement:
    """A requirement as FRET stores it."""

    name: str
    sentence: str
    rationale: str = ""


@dataclass(frozen=True, slots=True)
class FretVariable:
    """A variable as FRET stores it; ``value``: of one that represents a number, ``definition``: of any other one."""

    name: str
    role: str = ""
    boolean: bool = False
    number: bool = False
    value: float | None = None
    definition: str = ""


def read_fret(text: str, period: Fraction | None = None) -> Conversion:
    """Convert requirements of FRET to a specification.

    Args:
        text: a JSON file that FRET has exported, or sentences of FRETish, one a line, each with an optional name and
            a colon before it.
        period: the sampling period in seconds. By default one unit of time of the sentences, as FRET reads them.

    Returns:
        The specification, the requirements that it cannot express, and where FRET differs.

    Raises:
        UsageError: the text is no set of FRET requirements, or its durations have several units and no period is given.

    >>> print(read_fret("R1: when c the pump shall within 2 ticks satisfy level > 3").text.splitlines()[-1].strip())
    always(rise(c) -> eventually[0:2](level > 3) or always[2:2] false)
    """
    requirements, variables = _content(text)
    sentences: dict[str, tuple[FretRequirement, Sentence]] = {}
    rejected: list[Rejection] = []
    for requirement in requirements:
        if requirement.name in sentences:
            rejected.append(Rejection(requirement.name, "there are two requirements of this name"))
            continue
        try:
            sentences[requirement.name] = requirement, parse_sentence(requirement.sentence)
        except SpecificationError as error:
            rejected.append(Rejection(requirement.name, str(error)))
    step = period or _unit([sentence for _, sentence in sentences.values()])
    types = Types([v.name for v in variables if v.boolean], [v.name for v in variables if v.number])
    types.learn(each for _, sentence in sentences.values() for each in _formulas_of(sentence))
    constants = {each.name: each.value for each in variables if each.value is not None}
    formulas: dict[str, Formula] = {}
    for name, (_, sentence) in sentences.items():
        try:
            formulas[name] = _formula(sentence, types, step, constants, follow_units=period is not None)
        except SpecificationError as error:  # noqa: PERF203 - one requirement must not reject the others
            rejected.append(Rejection(name, str(error)))
    notes = [UNITS_NOTE] if any(sentence.duration for _, sentence in sentences.values()) else []
    if any(isinstance(node, Apply) and node.op.equates for node in postorder(*formulas.values())):
        notes.append(EXACT_NOTE)
    used = {node.name for node in postorder(*formulas.values()) if isinstance(node, Var)}
    notes += [
        f"'{each.name}' is read from the trace; FRET defines it as '{each.definition}'"
        for each in variables
        if each.definition and each.name in used
    ]
    written = [
        ReadRequirement(name, formulas[name], requirement.sentence, requirement.rationale)
        for name, (requirement, _) in sentences.items()
        if name in formulas
    ]
    names = Names({each.name: each.role for each in variables if each.role}, constants)
    specification = specification_text("Requirements of FRET.", written, names, step)
    return Conversion(specification, tuple(formulas), tuple(rejected), tuple(notes))


# ---- files ---------------------------------------------------------------------------------------


def _content(text: str) -> tuple[list[FretRequirement], list[FretVariable]]:
    if text.lstrip()[:1] in ("[", "{"):
        return _project(text)
    found: list[FretRequirement] = []
    for number, line in enumerate(LINE_END.split(text), 1):
        if not line.strip() or line.lstrip().startswith(("//", "#")):
            continue
        match = _LABEL.fullmatch(line)
        label, sentence = (match["label"], match["sentence"]) if match else (f"line_{number}", line.strip())
        found.append(FretRequirement(label, sentence))
    if not found:
        raise UsageError(
            "there is no sentence of FRETish in the text, such as: the pump shall always satisfy x > 0"
        )
    return found, []


def _project(text: str) -> tuple[list[FretRequirement], list[FretVariable]]:
    try:
        content: Any = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise UsageError(f"the text is no JSON: {error}") from None
    listed = content.get("requirements") if isinstance(content, Mapping) else content
    if (
        not isinstance(listed, Sequence)
        or isinstance(listed, str)
        or not all(isinstance(e, Mapping) for e in listed)
    ):
        raise UsageError("expected FRET's JSON: a list of requirements, or an object with 'requirements'")
    stored = content.get("variables", []) if isinstance(content, Mapping) else []
    requirements = [
        FretRequirement(
            _text(each, "reqid") or f"requirement_{n}", _text(each, "fulltext"), _text(each, "rationale")
        )
        for n, each in enumerate(listed, 1)
    ]
    return requirements, list(_variables(stored))


def _variables(stored: Any) -> Iterator[FretVariable]:
    """Yield the variables of a project; FRET stores those of older projects under another key."""
    every = stored.get("docs", []) if isinstance(stored, Mapping) else stored
    for each in every if isinstance(every, Sequence) else []:
        if isinstance(each, Mapping) and _text(each, "variable_name"):
            try:
                value = float(_text(each, "assignment"))
            except ValueError:
                value = None
            kind, role = _text(each, "dataType").lower(), _text(each, "idType").lower()
            boolean = kind in _BOOLEAN or role == "mode"
            number = not boolean and (kind in _NUMBERS or value is not None)
            name = _text(each, "variable_name")
            value = None if boolean else value
            defined = _text(each, "modeRequirement") or _text(each, "assignment") if value is None else ""
            yield FretVariable(name, _ROLES.get(role, ""), boolean, number, value, defined)


def _text(stored: Mapping[str, Any], key: str) -> str:
    value = stored.get(key)
    return " ".join(value.split()) if isinstance(value, str) else ""


# ---- formulas ------------------------------------------------------------------------------------


def _formulas_of(sentence: Sentence) -> Iterable[Expression]:
    """Return the Boolean expressions of a sentence."""
    scope = sentence.scope.mode if sentence.scope is not None else None
    return [
        each for each in (scope, sentence.condition, sentence.stop, sentence.response) if each is not None
    ]


def _unit(sentences: Iterable[Sentence]) -> Fraction:
    """Return the seconds of one unit of time, which FRET takes for one sample."""
    units = {s.duration.unit: s.duration.seconds for s in sentences if s.duration is not None}
    if len(set(units.values())) > 1:
        named = ", ".join(f"{unit}s" for unit in sorted(units))
        raise UsageError(
            f"durations are in {named}, each of which FRET takes for one sample: "
            "give the sampling period, such as 100ms"
        )
    return next(iter(units.values()), None) or Fraction(1)


def _formula(
    sentence: Sentence, types: Types, step: Fraction, constants: dict[str, float], *, follow_units: bool
) -> Formula:
    def error(message: str, span: Span) -> SpecificationError:
        return SpecificationError(message, sentence.text, span)

    scope, where = sentence.scope, None
    if scope is not None:
        mode = Lowering(types, step, error, constants).formula(scope.mode)
        where = inside(scope.name, mode, only=scope.only)
    lower = Lowering(types, step, error, constants, where).formula
    duration = sentence.duration
    seconds = None if duration is None else _seconds(duration, step, sentence, follow_units=follow_units)
    return formalize(
        sentence.timing,
        lower(sentence.response),
        step=step,
        scope=where,
        condition=None if sentence.condition is None else lower(sentence.condition),
        holding=sentence.trigger == "holding",
        only=scope is not None and scope.only,
        stop=None if sentence.stop is None else lower(sentence.stop),
        duration=seconds,
    )


def _seconds(duration: Duration, step: Fraction, sentence: Sentence, *, follow_units: bool) -> Fraction:
    unit = duration.seconds if duration.seconds is not None and follow_units else step
    seconds = duration.count * unit
    if seconds % step:
        raise SpecificationError(
            f"{decimal(duration.count)} {duration.unit}s are not a whole number of periods of {decimal(step)} s",
            sentence.text,
            duration.span,
        )
    return seconds
