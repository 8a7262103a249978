"""The patterns of the library, and specifications that use them: what ``rtamt new`` writes.

A pattern is a template of ``library/patterns.stl`` or ``library/signals.stl``; the comments there state in English what
each requires, with its parameters in backquotes.
"""

from __future__ import annotations

import os
import re
from functools import cache
from typing import TYPE_CHECKING

from rtamt.errors import SpecificationError, UsageError, choices
from rtamt.language.contents import variables
from rtamt.language.formula import Var
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.imports import PACKAGED
from rtamt.language.parsing.lexer import NAME, quoted
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.printing.english import to_english
from rtamt.language.units.durations import NUMBER, UNITS
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.patterns import lazy_pattern
from rtamt.specification_loader import parse

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_FILES = ("patterns.stl", "signals.stl")
_SECTION = lazy_pattern(r"// ---- ([^:]+?)(?:: (.*))? ----")
_DEFINED = lazy_pattern(r"def (\w+)\(([^)]*)\)")
_SCOPES = lazy_pattern(r"within a scope: (.*?)\.", re.DOTALL)
_PARAMETER = lazy_pattern(r"`(\w+)`")
_DURATION = lazy_pattern(rf"({NUMBER})\s*({'|'.join(UNITS)})")


@dataclass(frozen=True, slots=True)
class Pattern:
    """A pattern: its name, the file of the library, its parameters, and what it requires.

    ``sentence``: in English, with the parameters in backquotes.
    """

    name: str
    file: str
    parameters: tuple[str, ...]
    sentence: str

    @property
    def signature(self) -> str:
        """The usage: ``response(p, s)``."""
        return f"{self.name}({', '.join(self.parameters)})"

    def described(self, arguments: Mapping[str, str]) -> str:
        """Return the sentence with arguments, which are texts of formulas, numbers or durations.

        >>> patterns()["response_within"].described({"p": "speed > 2", "s": "locked", "duration": "1s"})
        'Each (speed is more than 2) is followed by locked within 1 s.'
        """
        text = _PARAMETER.sub(lambda match: _english(arguments[match[1]]), self.sentence)
        first = self.sentence[:1]
        return f"{text[:1].upper() + text[1:] if first != '`' else text}."


def _english(argument: str) -> str:
    """Return an argument of a pattern as part of a sentence."""
    duration = _DURATION.fullmatch(argument.strip())
    if duration:
        return f"{duration[1]} {duration[2]}"
    formula = parse_formula(argument)
    text = to_english(formula)
    return text if not variables(formula) or isinstance(formula, Var) else f"({text})"


@cache
def patterns() -> Mapping[str, Pattern]:
    """Return every pattern of the library by its name.

    >>> patterns()["absence_between"].sentence
    'between each `q` and the next `r`, `p` never holds'
    """
    return {pattern.name: pattern for file in _FILES for pattern in _patterns_in(file)}


def find_pattern(name: str) -> Pattern:
    """Return the pattern of this name. Raises :class:`UsageError` if there is none."""
    if name not in patterns():
        raise UsageError(f"there is no pattern '{name}'{choices(name, patterns(), 'patterns')}")
    return patterns()[name]


def _patterns_in(file: str) -> Iterator[Pattern]:
    with open(os.path.join(PACKAGED, file), encoding="utf-8") as opened:
        text = opened.read()
    scopes = _scopes_in(text)
    section = own = ""
    for line in text.splitlines():
        heading, defined = _SECTION.match(line), _DEFINED.match(line)
        if heading:
            section, own = heading[2] or "", ""
        elif line.startswith("//"):
            own = f"{own} {line.removeprefix('//').strip()}".strip()
        elif defined:
            name, parameters = defined[1], tuple(defined[2].split(", "))
            helper = bool(own) and len(re.findall(rf"\b{name}\(", text)) > 1
            sentence = own.rstrip(".") or _apply_scope(name, parameters, section, scopes)
            if not helper:
                yield Pattern(name, file, parameters, sentence)
            own = ""


def _scopes_in(text: str) -> list[str]:
    """Return the scopes as the comment at the beginning of a file lists them."""
    found = _SCOPES.search(text)
    if found is None:
        return []
    listed = re.sub(r"\s*\n// ", " ", found[1])
    return re.split(r", (?:or )?(?=before|from|between)", listed)


def _apply_scope(name: str, parameters: tuple[str, ...], sentence: str, scopes: list[str]) -> str:
    """Return the requirement of a pattern within its scope, which follows from its last parameters and its name."""
    ends = {each for each in ("q", "r") if each in parameters}
    fitting = [scope for scope in scopes if set(_PARAMETER.findall(scope)) == ends]
    if not ends or not fitting:
        return sentence
    word = name.rpartition("_")[2]
    scope = next((scope for scope in fitting if word in scope), fitting[0])
    return f"{scope}, {sentence}"


# ---- specifications ------------------------------------------------------------------------------


def specification_of(pattern: Pattern, arguments: Mapping[str, str], name: str = "REQ-1") -> str:
    """Return the text of a specification file that requires a pattern, with its sentence as the text.

    ``arguments``: of each parameter the text of a formula, a number or a duration. Variables that are an argument by
    themselves, in the place of a formula, are declared as Booleans, the others as numbers.

    Raises :class:`UsageError` for missing or unknown parameters, :class:`SpecificationError` for what is no formula.

    >>> print(specification_of(patterns()["response"], {"p": "speed > 2", "s": "locked"}, "DOOR-1"))
    import "patterns.stl"
    <BLANKLINE>
    float speed
    bool locked
    <BLANKLINE>
    require DOOR-1 "Each (speed is more than 2) is followed by locked, at once or later.":
        response(speed > 2, locked)
    <BLANKLINE>
    """
    for given in arguments:
        if given not in pattern.parameters:
            raise UsageError(
                f"{pattern.signature} has no parameter '{given}'{choices(given, pattern.parameters, 'parameters')}"
            )
    missing = [each for each in pattern.parameters if not arguments.get(each, "").strip()]
    if missing:
        raise UsageError(f"{pattern.signature} needs {', '.join(missing)}: give {missing[0]}=...")
    texts = {each: arguments[each].strip() for each in pattern.parameters}
    types = _types_of(pattern, texts)
    declared = "".join(
        f"{kind} {known if NAME.fullmatch(known) else quoted(known)}\n" for known, kind in types.items()
    )
    use = f"{pattern.name}({', '.join(texts.values())})"
    sentence = quoted(pattern.described(texts))
    text = f'import "{pattern.file}"\n\n{declared}\nrequire {name} {sentence}:\n    {use}\n'
    parse(text)
    return text


def _types_of(pattern: Pattern, texts: Mapping[str, str]) -> dict[str, str]:
    """Return the type of each variable of arguments."""
    types: dict[str, str] = {}
    for parameter, text in texts.items():
        if _DURATION.fullmatch(text):
            continue
        try:
            formula = parse_formula(text)
        except SpecificationError as error:
            raise type(error)(
                f"{parameter} of {pattern.signature}: {error.message}", text, error.span
            ) from None
        alone = isinstance(formula, Var) and _takes_formula(parameter)
        for known in variables(formula):
            kind = "bool" if alone and is_number(formula) else "float"
            types[known] = "float" if types.get(known) == "float" else kind
    return types


def _takes_formula(parameter: str) -> bool:
    """Return whether a parameter is a formula: one letter, other than the signal x."""
    return len(parameter) == 1 and parameter != "x"
