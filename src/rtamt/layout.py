"""The layout of specification files: what ``rtamt format`` and editors write.

Only white space between tokens changes. Line breaks stay where they are, as some end a statement; comments stay as they
are. The new text is parsed, and has the meaning of the old one.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from rtamt.errors import SpecificationError, StlError
from rtamt.language.parsing.imports import Library
from rtamt.language.parsing.lexer import LINE_END, comments, is_name, is_numeral, is_quoted, tokenize
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.records import Bounds
from rtamt.language.units.durations import UNITS
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rtamt.language.document import Document
    from rtamt.language.operators import Language

_INDENT = "    "
_ID = lazy_pattern(r"\w(?:[\w.-]*\w)?")
_OPENING, _CLOSING = frozenset("([{"), frozenset(")]}")
#: Words that no operand precedes or follows on their line, besides operators.
_OPEN_WORDS = frozenset(("if", "then", "else", "in", "or", "where", "severity", "require"))


class _Piece(NamedTuple):
    """A token or a comment, and the white space before it."""

    gap: str
    text: str
    start: int
    comment: bool


def formatted(text: str, parse: Callable[[str], Document], language: Language) -> str:
    r"""Return a specification text in the common layout, with the same meaning.

    ``parse``: reads a text; its error is raised if the text is wrong.

    >>> from rtamt.language.operators import STL
    >>> from rtamt.language.parsing.specfile import parse_document
    >>> print(formatted("float x ;\n\n\nalways [0 : 5]( x>=3->\n x -1<4 )  // fast", parse_document, STL), end="")
    float x;
    <BLANKLINE>
    always[0:5](x >= 3 ->
        x - 1 < 4)  // fast
    """
    before = _meaning(parse(text))
    for careful in (False, True):
        new = _Layout(text, language, careful=careful).text()
        if _is_same(new, text, before, parse, language):
            return new
    return text


def layout_text(text: str, folder: str | None, language: Language) -> str:
    """Return the text of a file in the common layout; also of one that only declares what others import.

    ``folder``: that of the file. Raises :class:`SpecificationError` if the text is wrong.
    """

    def parse(new: str, ending: str = "") -> Document:
        return parse_document(new + ending, language=language, library=Library(folder))

    try:
        return formatted(text, parse, language)
    except SpecificationError as error:
        try:
            return formatted(text, partial(parse, ending="\ntrue"), language)
        except SpecificationError:
            raise error from None


def _is_same(
    new: str, text: str, before: object, parse: Callable[[str], Document], language: Language
) -> bool:
    """Return whether a new text has the tokens, the comments and the meaning of the old one."""
    pieces = [
        (tokenize(each, language).texts, [each[span.start : span.end] for span in comments(each, language)])
        for each in (new, text)
    ]
    try:
        return pieces[0] == pieces[1] and _meaning(parse(new)) == before
    except StlError:
        return False


def _meaning(document: Document) -> object:
    """Return the meaning of a document: all of it except positions."""
    templates = [
        (each.signature, [(p.name, p.default) for p in each.parameters], each.tokens.texts)
        for each in document.templates.values()
    ]
    requirements = [
        (each.name, each.formula, each.description, each.severity, each.explicit)
        for each in document.requirements
    ]
    named = [(each.name, each.formula) for each in document.assertions]
    return (
        document.name, document.imports, document.declarations, dict(document.topics), dict(document.constants),
        dict(document.definitions), document.variables, dict(document.enumerations), dict(document.types),
        document.used, dict(document.tables), dict(document.groups), document.sampling, named, requirements, templates,
    )  # fmt: skip


class _Layout:
    """A text as tokens and comments, and the white space between them anew.

    ``careful``: whether white space inside lines stays as it is.
    """

    def __init__(self, text: str, language: Language, *, careful: bool) -> None:
        self.language = language
        self.careful = careful
        self.end = (
            "\n" if "\n" in text.replace("\r\n", "") or "\r" not in text else "\r\n" if "\n" in text else "\r"
        )
        tokens = tokenize(text, language)
        spans = [
            *((start, end, False) for start, end in zip(tokens.starts[:-1], tokens.ends, strict=False)),
            *((span.start, span.end, True) for span in comments(text, language)),
        ]
        self.pieces: list[_Piece] = []
        at = 0
        for start, end, comment in sorted(spans):
            self.pieces.append(_Piece(text[at:start], text[start:end], start, comment))
            at = end
        self.words = [piece for piece in self.pieces if not piece.comment]
        #: Tokens before which white space stays as it is: in units, topics and names of requirements.
        self.frozen = self._frozen(text)

    def text(self) -> str:
        """Return the text in the common layout."""
        return "".join(self._write()) + (self.end if self.pieces else "")

    def _write(self) -> Iterator[str]:
        before: _Piece | None = None  # the token before
        depth, brackets, broken = 0, 0, False
        last: _Piece | None = None  # the piece before
        number = 0
        for piece in self.pieces:
            breaks = len(LINE_END.findall(piece.gap))
            after = self.words[number] if number < len(self.words) else None
            begins = depth == 0 and self._begins(before, after, number)
            if (
                not piece.comment
                and begins
                and (breaks or last is None or before is None or before.text == ";")
            ):
                broken = False
            if last is None:
                yield piece.gap if self.careful and not breaks else ""
            elif breaks:
                yield self.end * min(breaks, 2)
                if self.careful:
                    yield LINE_END.split(piece.gap)[-1]
                else:
                    closes = after is not None and after.text in _CLOSING
                    broken = broken or (depth == 0 and not begins and after is not None)
                    yield _INDENT * (0 if begins or after is None else max(depth - closes, 0) + broken)
            elif self.careful or (not piece.comment and piece.start in self.frozen):
                yield piece.gap
            elif piece.comment or last.comment:
                yield (
                    piece.gap
                    if piece.text.startswith("//") and piece.gap.isspace()
                    else " " * bool(piece.gap)
                )
            else:
                yield self._gap(number, depth, brackets)
            yield piece.text
            last = piece
            if not piece.comment:
                depth = max(depth + (piece.text in _OPENING) - (piece.text in _CLOSING), 0)
                brackets = max(brackets + (piece.text == "[") - (piece.text == "]"), 0)
                before = piece
                number += 1

    # ---- lines -----------------------------------------------------------------------------------

    def _begins(self, before: _Piece | None, after: _Piece | None, number: int) -> bool:
        """Return whether a statement or declaration begins at a token that begins a line."""
        if before is None or after is None or before.text == ";":
            return True
        follows = self.words[number + 1].text if number + 1 < len(self.words) else ""
        if follows == "=" and (is_name(after.text) or is_quoted(after.text)):
            return True
        if self._in_head(number):
            return False
        if self.language.infix(after.text) is not None or after.text in ("then", "else", ":", "=", "[", ")"):
            return False
        return self._ends_operand(number - 1)

    def _in_head(self, number: int) -> bool:
        """Return whether a token is between ``require`` and its colon."""
        for at in range(number - 1, max(number - 24, -1), -1):
            if self.words[at].text in (":", ";", "="):
                return False
            if self.words[at].text == "require":
                return True
        return False

    def _ends_operand(self, number: int) -> bool:
        """Return whether an operand, or a declaration, can end with a token."""
        text = self.words[number].text
        if text in (")", "]", "}") or is_numeral(text) or is_quoted(text):
            return True
        if not is_name(text):
            return False
        before = self.words[number - 1].text if number else ""
        if text in UNITS and is_numeral(before):
            return True
        opening = self.language.opening(text)
        free = opening is None or text in ("true", "false")
        return free and self.language.infix(text) is None and text not in _OPEN_WORDS

    # ---- inside lines ----------------------------------------------------------------------------

    def _gap(self, number: int, depth: int, brackets: int) -> str:
        """Return the white space between two tokens on a line."""
        before, piece = self.words[number - 1].text, self.words[number]
        text, spaced = piece.text, bool(piece.gap)
        if text in (",", ";", ")", "]") or before in ("(", "["):
            return ""
        if before in (",", ";"):
            return " "
        if ":" in (before, text):
            return "" if text == ":" or brackets else " "
        if "=" in (before, text):
            return " " if depth == 0 else " " * spaced
        if text == "[" and self._takes_interval(before):
            return ""
        if "/" in (before, text):
            return " " * spaced
        if text == "-" and self._ends_operand(number - 1):
            return " "
        if before == "-":
            return " " if spaced or self._ends_operand(number - 2) else ""
        if self._separates(text) or self._separates(before):
            return " "
        return " " * spaced

    def _separates(self, text: str) -> bool:
        """Return whether a symbol is an operator between operands."""
        return (
            not is_name(text)
            and self.language.infix(text) is not None
            and self.language.opening(text) is None
        )

    def _takes_interval(self, text: str) -> bool:
        found = (self.language.opening(text), self.language.infix(text))
        return any(op is not None and op.bounds is not Bounds.NONE for op in found)

    def _frozen(self, text: str) -> set[int]:
        """Return where tokens begin before which white space may have a meaning."""
        found: set[int] = set()
        closing, head = "", range(0)
        for at, (_gap, word, start, _comment) in enumerate(self.words):
            before = self.words[at - 1].text if at else ""
            if closing or start in head:
                found.add(start)
                closing = "" if word == closing else closing
            elif word == "@":
                closing = ")"
            elif word == "[" and not self._takes_interval(before) and before not in ("in", "rate"):
                closing = "]"
            elif word == "require" and at + 1 < len(self.words):
                match = _ID.match(text, self.words[at + 1].start)
                head = range(match.start() + 1, match.end()) if match is not None else head
        return found
