"""The analysis of one text, parsed once per version and shared by all requests."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

from rtamt.errors import BoundError, SpecificationError, StlError
from rtamt.language.operators import STL
from rtamt.language.parsing.imports import Library
from rtamt.language.parsing.lexer import comments
from rtamt.language.parsing.specfile import NO_FORMULA, parse_document
from rtamt.language.units.durations import positive_period
from rtamt.lint.report import findings
from rtamt.lint.rules import SHORTER, UNUSED
from rtamt.lsp.outline import outline
from rtamt.lsp.places import Lines
from rtamt.specification_loader import parse
from rtamt.text_errors import errors_of

if TYPE_CHECKING:
    from rtamt.language.document import Document
    from rtamt.language.formula import Span
    from rtamt.lint.found import LintWarning
    from rtamt.lsp.symbols import Outline
    from rtamt.specification import Specification

#: The longest text that is analysed while it is edited.
MOST_CHARACTERS = 2**20

#: A formula behind a text that only declares what others import.
ENDING = "\ntrue"


class Analysis:
    """One version of a text.

    ``folder``: that of the file, for its imports. ``period``: the sampling period, as text, if it is known.
    ``encoding``: of positions.

    >>> [error.message for error in Analysis("always(spede > ) // fast").errors]
    ["expected an operand after '>', got ')'"]
    """

    def __init__(
        self, text: str, folder: str | None = None, period: str | None = None, encoding: str = "utf-16"
    ) -> None:
        self.text = text
        self.folder = folder
        self.period = period or None
        self.lines = Lines(text, encoding)
        #: Whether it is a text that only declares what others import.
        self.library = False
        #: What is wrong with the text; nothing else is known of a wrong one but its names.
        self.errors: list[StlError] = []
        self._short_bounds: tuple[LintWarning, ...] = ()
        self.spec: Specification | None = None
        if len(text) > MOST_CHARACTERS:
            self.text = text[:0]
            too_long = (
                f"the file is too long to be checked while it is edited ({len(text):,} characters, at most "
                f"{MOST_CHARACTERS:,}); rtamt lint checks it"
            )
            self.errors = [StlError(too_long)]
            return
        try:
            self.spec = self._parse(text)
        except StlError as error:
            if isinstance(error, SpecificationError) and error.message == NO_FORMULA:
                self._read_library()
            if self.spec is None:
                self._read_errors(error)

    def _parse(self, text: str) -> Specification:
        return parse(text, folder=self.folder, period=self.period)

    def _read_errors(self, first: StlError) -> None:
        """Find the errors of the text. Of its bounds, those with a code are findings, as in ``rtamt lint``."""
        self.errors = errors_of(self.text, first, folder=self.folder, period=self.period)
        if not any(isinstance(each, BoundError) for each in self.errors):
            return
        try:
            document = self.read(self.text)
        except StlError:
            return
        period = None if self.period is None else positive_period(self.period)
        self._short_bounds = tuple(each for each in findings(document, STL, period) if each.code == SHORTER)
        short = {each.span for each in self._short_bounds}
        self.errors = [each for each in self.errors if getattr(each, "span", None) not in short]

    def _read_library(self) -> None:
        """Read the text as one that others import, if that is possible."""
        try:
            spec = self._parse(self.text + ENDING)
        except StlError:
            return
        found = spec.document
        if len(found.assertions) == 1 and (
            found.declarations or found.templates or found.tables or found.enumerations or found.groups
        ):
            self.spec, self.library = spec, True

    @property
    def document(self) -> Document | None:
        """The parsed text; None where it is wrong."""
        return None if self.spec is None else self.spec.document

    @cached_property
    def outline(self) -> Outline:
        """The names of the text."""
        document = self.document
        if document is not None and self.library:
            return outline(document.text, document)
        return outline(self.text, document)

    @cached_property
    def comments(self) -> list[Span]:
        """Where the comments are."""
        return comments(self.text, STL) if "/" in self.text else []

    @cached_property
    def findings(self) -> tuple[LintWarning, ...]:
        """The warnings of ``rtamt lint``."""
        if self.spec is None:
            return self._short_bounds
        return tuple(each for each in self.spec.warnings if not (self.library and each.code == UNUSED))

    def read(self, text: str) -> Document:
        """Parse another version of the text, as this one was parsed."""
        folder = self.folder
        return parse_document(text + (ENDING if self.library else ""), library=Library(folder))

    def in_comment(self, offset: int) -> bool:
        """Return whether an offset is inside a comment."""
        return any(span.start < offset <= span.end for span in self.comments)
