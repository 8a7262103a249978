"""The findings of all rules in a text, except those that its comments silence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import did_you_mean
from rtamt.language.operators import STL, Language
from rtamt.lint.comments import silenced
from rtamt.lint.found import LintWarning, Text
from rtamt.lint.rules import CODES, RULES, UNUSED_COMMENT

if TYPE_CHECKING:
    from fractions import Fraction

    from rtamt.language.document import Document
    from rtamt.lint.comments import Silenced


def findings(
    document: Document, language: Language = STL, period: Fraction | None = None
) -> tuple[LintWarning, ...]:
    """Return the warnings about the text of a document, in the order of the text; a selection has no effect.

    ``period``: the sampling period, if it is not that of the text.

    >>> from rtamt.language.parsing.specfile import parse_document
    >>> print(*findings(parse_document("x and y >= 3")))
    RT101: 'x' is a number where a formula is expected; compare it, such as x > 0
      line 1, column 1:
        x and y >= 3
        ^
    """
    text = Text(document.origin or document, language, period)
    characters = text.document.text
    found: dict[LintWarning, None] = {}
    for rule in RULES:
        for each in rule.find(text):
            warning = LintWarning(rule.code, each.message, characters, each.span, rule.severity, each.fix)
            found.setdefault(warning)
    if ignored := list(silenced(characters, language)):
        found = dict.fromkeys(_apply_comments(list(found), ignored, characters))
    return tuple(sorted(found, key=lambda each: (each.span.start if each.span else 0, each.code)))


def _apply_comments(found: list[LintWarning], ignored: list[Silenced], text: str) -> list[LintWarning]:
    """Return the warnings that no comment silences, and one about each code of a comment without effect."""
    heard, effective = [], set()
    for warning in found:
        at = warning.span.start if warning.span else 0
        by = [
            each for each in ignored if each.code == warning.code and each.where.start <= at < each.where.end
        ]
        effective.update(by)
        if not by:
            heard.append(warning)
    rule = UNUSED_COMMENT
    for each in ignored:
        if each not in effective:
            what = f"there is no code '{each.code}'{did_you_mean(each.code, CODES)}"
            if each.code in CODES:
                what = f"there is no {each.code} here to ignore; remove it"
            heard.append(LintWarning(rule.code, what, text, each.span, rule.severity))
    return heard
