"""The hover text for the word under the pointer, as Markdown."""

from __future__ import annotations

from bisect import bisect_right
from typing import TYPE_CHECKING

from rtamt.errors import StlError
from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.lexer import tokenize
from rtamt.language.units.durations import format_duration
from rtamt.language.words import DECLARED_BY, meaning_of
from rtamt.lazy.tuples import NamedTuple
from rtamt.lsp.imported import place_of
from rtamt.patterns import patterns
from rtamt.requirement_info import info_of

if TYPE_CHECKING:
    from rtamt.language.operators import Operator
    from rtamt.lsp.document import Analysis
    from rtamt.lsp.symbols import Symbol

#: The longest sentence that is shown.
_LONGEST = 2000


class Shown(NamedTuple):
    """The hover text of a span."""

    span: Span
    markdown: str


def hover(analysis: Analysis, offset: int) -> Shown | None:
    r"""Return the hover text of the name or the operator at an offset.

    >>> from rtamt.lsp.document import Analysis
    >>> print(hover(Analysis("input float v [m/s]\nfast = v > 3\nalways(not fast)"), 45).markdown)
    ```stl
    fast = v > 3
    ```
    <BLANKLINE>
    v is more than 3 m/s.
    <BLANKLINE>
    Horizon 0 s; a monitor takes 16 bytes.
    """
    if analysis.in_comment(offset):
        return None
    found = analysis.outline.at(offset)
    if found is not None:
        span, symbol = found
        return Shown(span, _describe(analysis, symbol))
    token = _token_at(analysis, offset)
    if token is None:
        return None
    span, text = token
    operator = STL.opening(text) or STL.infix(text)
    if span in analysis.outline.texts:
        return None
    if operator is not None:
        return Shown(span, of_operator(operator, text))
    if text in patterns() and text in analysis.outline.free:
        pattern = patterns()[text]
        return Shown(span, f"```stl\n{pattern.signature}\n```\n\n{_capital(pattern.sentence)}.")
    defined = place_of(analysis, text)
    if defined is not None:
        return Shown(span, f"```stl\n{defined.written}\n```\n\nDefined in `{defined.called}`.")
    if text in DECLARED_BY:
        return Shown(span, f"`{text}`: {DECLARED_BY[text]}")
    if text in analysis.outline.free:
        return Shown(span, f"`{text}`: a signal that is not declared; its unit is not known.")
    return None


def of_operator(operator: Operator, written: str) -> str:
    """Return the row of the table of operators.

    >>> print(of_operator(STL["always"], "G").splitlines()[0])
    `always`, `G` (prefix operator, future, interval optional)
    """
    spellings = ", ".join(f"`{each}`" for each in dict.fromkeys((*operator.spellings, written)))
    kinds = [f"{operator.fixity.value} operator"]
    if operator.tense.value != "none":
        kinds.append(operator.tense.value)
    if operator.bounds.value != "none":
        kinds.append(
            f"interval {operator.bounds.value}" if operator.bounds.value != "duration" else "[duration]"
        )
    return f"{spellings} ({', '.join(kinds)})\n\n{meaning_of(operator)}\n\n```stl\n{operator.example}\n```"


def _describe(analysis: Analysis, symbol: Symbol) -> str:
    """Return the declaration of a name and what follows from it."""
    parts = [f"```stl\n{_declaration_text(analysis, symbol)}\n```"]
    comment = _comment_of(analysis, symbol)
    if comment:
        parts.append(comment)
    parts += _details(analysis, symbol)
    return "\n\n".join(parts)


def _declaration_text(analysis: Analysis, symbol: Symbol) -> str:
    """Return the line or the lines that declare a name."""
    if symbol.kind in ("formula", "requirement"):
        document = analysis.document
        spans = (
            []
            if document is None
            else [each.span for each in document.assertions if each.name == symbol.name]
        )
        if spans and spans[0] is not None:
            return analysis.text[spans[0].start : spans[0].end]
        line = analysis.lines.place(symbol.span.start).line
        starts = [*analysis.lines.starts, len(analysis.text)]
        return analysis.text[starts[line] : starts[line + 1]].strip()
    return analysis.text[symbol.whole.start : symbol.whole.end]


def _comment_of(analysis: Analysis, symbol: Symbol) -> str:
    """Return the comment behind a declaration on its line, or those directly above it."""
    place, text = analysis.lines.place, analysis.text
    last = place(symbol.whole.end).line
    behind = [
        each
        for each in analysis.comments
        if each.start >= symbol.whole.end and place(each.start).line == last
    ]
    if behind:
        return _words_of(text[behind[0].start : behind[0].end])
    above: list[str] = []
    line = place(symbol.whole.start).line
    for each in reversed([each for each in analysis.comments if each.end <= symbol.whole.start]):
        alone = not text[analysis.lines.starts[place(each.start).line] : each.start].strip()
        if not alone or place(each.end).line != line - 1:
            break
        above.insert(0, _words_of(text[each.start : each.end]))
        line = place(each.start).line
    return " ".join(above)


def _words_of(comment: str) -> str:
    return comment.removeprefix("//").removeprefix("/*").removesuffix("*/").strip()


def _details(analysis: Analysis, symbol: Symbol) -> list[str]:
    document = analysis.document
    if symbol.kind in ("formula", "requirement"):
        return _of_formula(analysis, symbol.name)
    if symbol.kind == "argument":
        return [f"Parameter of the template `{symbol.of}`."]
    if symbol.kind == "member":
        return [f"Stands for the members of `{symbol.of}`."]
    if symbol.kind in ("value", "field"):
        return [f"{_capital('member' if symbol.kind == 'value' else symbol.kind)} of `{symbol.of}`."]
    declared = None
    if document is not None:
        declared = next((each for each in document.declarations if each.name == symbol.name), None)
    if declared is None:
        return []
    facts = [_capital(f"{declared.role or ''} {symbol.kind}".strip())]
    facts.append(f"unit {declared.unit}" if declared.unit else "no declared unit")
    if declared.range is not None:
        facts.append(f"range [{declared.range[0]:g}, {declared.range[1]:g}]")
    if declared.columns:
        facts.append("recorded as " + " or ".join(f"`{each}`" for each in declared.columns))
    return ["; ".join(facts) + "."]


def _of_formula(analysis: Analysis, name: str) -> list[str]:
    """Return the sentence of a named formula or requirement, its horizon, and the memory of its monitor."""
    spec = analysis.spec
    if spec is None:
        return []
    try:
        one = spec.select(name)
        sentence = next(iter(one.describe().values())).text
        facts = info_of(one)
    except StlError as error:  # such as a formula that no monitor can run
        return [str(error).splitlines()[0]]
    parts = [sentence[:_LONGEST]]
    if facts.offline_only is not None:
        parts.append(f"Offline only: {facts.offline_only}.")
    elif facts.horizon is not None:
        memory = "" if facts.memory is None else f"; a monitor takes {facts.memory:,} bytes"
        parts.append(f"Horizon {format_duration(facts.horizon)}{memory}.")
    return parts


def _token_at(analysis: Analysis, offset: int) -> tuple[Span, str] | None:
    tokens = tokenize(analysis.text, STL)
    at = bisect_right(tokens.starts, offset) - 1
    for index in (at, at - 1):
        if 0 <= index < len(tokens) - 1 and tokens.starts[index] <= offset <= tokens.ends[index]:
            return Span(tokens.starts[index], tokens.ends[index]), tokens.texts[index]
    return None


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
