"""Find all errors of a text: after each, the parser continues at the next statement.

What a wrong statement declares stands for anything from there on, like a parameter of a template, so that no error
follows from another one.
"""

from __future__ import annotations

from bisect import bisect_left
from functools import cached_property
from typing import TYPE_CHECKING

from rtamt.errors import NameInFormulaError, SpecificationError
from rtamt.language.document import Import
from rtamt.language.formula import Var
from rtamt.language.operators import STL, Language
from rtamt.language.parsing.declarations import TYPES
from rtamt.language.parsing.diagnostics import no_close
from rtamt.language.parsing.grammar import ELSE, THEN
from rtamt.language.parsing.imports import Library
from rtamt.language.parsing.lexer import NAME, is_name, is_numeral, is_quoted, unquoted
from rtamt.language.parsing.scope import Scope
from rtamt.language.parsing.specfile import LATE, DocumentParser
from rtamt.language.parsing.templates import MOST_TOKENS, anything, parse_argument
from rtamt.language.quantifiers import Group
from rtamt.language.value_types import UNKNOWN, Enumeration
from rtamt.language.words import DECLARING

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from rtamt.language.document import Assertion
    from rtamt.language.formula import Formula, Span

#: The errors of one text that are looked for, and the wrong statements, also those whose error follows from another.
MOST_ERRORS, MOST_STATEMENTS = 100, 1000

_CLOSING = {")": "(", "]": "[", "}": "{"}
_DECLARING = frozenset((*TYPES, *DECLARING))
#: Words that continue a formula on a new line, besides operators.
_CONTINUING = frozenset((THEN, ELSE, "in", "where"))


def all_errors(
    text: str,
    *,
    language: Language = STL,
    unit: str = "s",
    constants: Mapping[str, float] | None = None,
    library: Library | None = None,
) -> list[SpecificationError]:
    """Return the errors of a text, in its order; of errors that follow from one another the first.

    The first error is the one that :func:`~rtamt.language.parsing.specfile.parse_document` raises, with the same
    arguments.

    >>> for error in all_errors("const float c = ; low = x < c; require R1: always(low and); require R2: lo"):
    ...     print(error.message)
    expected a number, got ';'
    expected an operand after 'and', got ')'
    'R2' requires a number, which neither holds nor fails; compare it, such as x >= 0
    """
    library = Library() if library is None else library
    return _RecoveringParser(text, language, unit, Scope(constants or {}), {}, library, True).errors()


class _RecoveringParser(DocumentParser):
    """A parser that collects errors."""

    _errors: list[SpecificationError]
    #: Whether names may come from a file that could not be imported.
    _open = False

    def errors(self) -> list[SpecificationError]:
        """Read the text to its end, and return its errors."""
        self._errors = []
        scope = self.scope
        for _ in range(MOST_STATEMENTS):
            error = self._next_error()
            if error is None:
                break
            begin = self._begin
            if not self._follows(error, begin):
                self._errors.append(error)
            if (
                len(self._errors) == MOST_ERRORS or self.uses.tokens > MOST_TOKENS
            ):  # an error of all further uses
                return self._errors
            self.scope, self._against = scope, None
            self._found = [each for each in self._found if _start(each) < self.starts[begin]]
            self.index = end = self._next_statement(begin)
            self._assume(begin, end)
        else:
            return self._errors
        if self._found or not self._errors:
            self._errors += [each for each in self._final_errors() if not self._concerns_unknown(each)]
        return self._errors[:MOST_ERRORS]

    def _next_error(self) -> SpecificationError | None:
        """Read on up to the next statement with an error; None at the end."""
        try:
            self._statements()
        except SpecificationError as error:
            return error
        return None

    # ---- consequences of an error ----------------------------------------------------------------

    def _follows(self, error: SpecificationError, begin: int) -> bool:
        """Return whether an error follows from one before it. ``begin``: of the statement."""
        if not self._errors:
            return False
        if error.message == LATE and any(each.message == LATE for each in self._errors):
            return True
        before = self._errors[-1].span
        if before is not None and error.span is not None and error.span.start <= before.start:
            return True
        return self._concerns_unknown(error) or (self._open and self._has_unknown_type(begin))

    def _concerns_unknown(self, error: SpecificationError) -> bool:
        """Return whether an error is about a name whose declaration is wrong, or may be."""
        if error.span is None:
            return False
        written = self.text[error.span.start : error.span.end]
        name = _unquote(written)
        if name in self._unknown or name.partition(".")[0] in self._unknown:
            return True
        return (
            self._open
            and self._is_plain(written)
            and not self._is_declared(name)
            and self._may_be_imported(error)
        )

    def _may_be_imported(self, error: SpecificationError) -> bool:
        """Return whether the name that an error is about may be a name, a function or a type of another file."""
        assert error.span is not None
        at = bisect_left(self.starts, error.span.end)
        after = "" if self._begins_a_line(at) else self.texts[at]
        return isinstance(error, NameInFormulaError) or after == "(" or is_name(after) or is_quoted(after)

    def _has_unknown_type(self, at: int) -> bool:
        """Return whether two names stand here, of which the first may be a type of a file that was not imported."""
        first, second = self.texts[at : at + 2]
        return (
            self._is_plain(first)
            and is_name(second)
            and first not in _DECLARING
            and not self._is_declared(first)
        )

    def _is_declared(self, name: str) -> bool:
        return self._is_taken(name)

    def _assume(self, begin: int, end: int) -> None:
        """Let names that a wrong statement may have declared match anything."""
        names = list(self._names_in(begin, end))
        self._unknown |= {name: anything(name) for name in names}
        for name in names:
            self._definitions.pop(name, None)  # of the beginning of what is wrong
            (self._pending or {}).pop(name, None)
        words = [_unquote(each) for each in self.texts[begin:end]]
        role = words[0] in ("input", "output")
        word, name, *more = (*words[role:], "", "")
        if word == "import":
            self._open = True
        elif word == "from" and names:
            self._imports[names[-1]] = Import("", names[-1])
        elif word == "group":
            self._groups[name] = Group(name, "*")
        elif word == "enum":
            members = dict.fromkeys(each for each in more if NAME.fullmatch(each))
            codes = tuple((each, code) for code, each in enumerate(members or [name]))
            self._enumerations[name] = Enumeration(name, codes)

    def _names_in(self, begin: int, end: int) -> Iterator[str]:
        """Yield the names that a wrong statement may declare: before ``=``, and behind a word that is no operator."""
        texts, starts, ends = self.texts, self.starts, self.ends
        at = begin
        while at < end:
            last = at
            if is_name(texts[at]) or is_quoted(texts[at]):
                while (
                    texts[last + 1] == "/" and is_name(texts[last + 2]) and ends[last] + 1 == starts[last + 2]
                ):
                    last += 2
                before = texts[at - 1] if at > begin else ""
                after = texts[last + 1] if last + 1 < end else ""
                name = _unquote(self.text[starts[at] : ends[last]])
                if after == "=" or (
                    self._is_plain(before)
                    and before != "require"
                    and not self._is_plain(after)
                    and self._is_plain(name)
                    and name not in _DECLARING
                    and not self._is_declared(name)
                ):
                    yield name
            at = last + 1

    # ---- wildcards -------------------------------------------------------------------------------

    def _parse_application(self, at: int) -> Formula | None:
        """Take the use of a wrong template or table for anything."""
        name, opening, *_ = self.tokens[at : at + 2]
        if name.name not in self._unknown or opening.text != "(":
            return super()._parse_application(at)
        self.index = at + 2
        while self.token.text != ")":
            if self.texts[self.index + 1] == "=":
                self.index += 2
            parse_argument(self)
            if not self.accept(","):
                break
        if not self.accept(")"):
            raise self.error(*no_close(self.language, self.tokens, self.index, opening, "',' or ')'"))
        return anything(name.name).formula

    def _meaning(self, name: str, span: Span, *, plain: bool = True) -> Formula:
        """Take the fields of members of a wrong group for anything."""
        group = self.scope.members.get(name.partition(".")[0])
        if group is not None and group.name in self._unknown:
            return Var(name, span, UNKNOWN)
        return super()._meaning(name, span, plain=plain)

    # ---- resynchronisation -----------------------------------------------------------------------

    def _next_statement(self, begin: int) -> int:
        """Return the index of the token that begins the statement after the one at ``begin``."""
        self.index = begin
        declares = self._begins_declaration()
        last = len(self.texts) - 1
        closed = begin
        for at in range(begin + 1, last):
            closed = max(closed, self._closing.get(at - 1, 0))
            if self._is_statement(at, inside=at <= closed, after_formula=not declares):
                return at
        return last

    def _is_statement(self, at: int, *, inside: bool, after_formula: bool) -> bool:
        """Return whether a statement begins at a token. ``inside``: whether it is between two brackets."""
        if self.texts[at - 1] == ";" and self.texts[at] != ";":
            return not inside
        if not self._begins_a_line(at):
            return False
        self.index = at
        if self._begins_statement():
            return True
        return not inside and (
            self._begins_declaration()
            or self._imports_file()
            or self._end_of_name() is not None
            or (after_formula and self._cannot_continue(at))
        )

    def _cannot_continue(self, at: int) -> bool:
        """Return whether a line begins with an operand, and the line before ends with one."""
        before, text = self.texts[at - 1], self.texts[at]
        complete = before == ")" or is_numeral(before) or is_quoted(before) or self._is_plain(before)
        operand = is_name(text) or is_quoted(text) or is_numeral(text)
        return complete and operand and self._infix(text) is None and text not in _CONTINUING

    def _is_plain(self, word: str) -> bool:
        """Return whether a word is no operator."""
        return is_name(word) and self._opening(word) is None and self._infix(word) is None

    @cached_property
    def _closing(self) -> dict[int, int]:
        """The closing bracket of each closed bracket."""
        found: dict[int, int] = {}
        opened: list[tuple[str, int]] = []
        counts = dict.fromkeys(_CLOSING.values(), 0)
        for at, text in enumerate(self.texts):
            if text in counts:
                opened.append((text, at))
                counts[text] += 1
            elif text in _CLOSING and counts[_CLOSING[text]]:
                while True:  # what is opened in between is never closed
                    bracket, begin = opened.pop()
                    counts[bracket] -= 1
                    if bracket == _CLOSING[text]:
                        break
                found[begin] = at
        return found


def _start(assertion: Assertion) -> int:
    return 0 if assertion.span is None else assertion.span.start


def _unquote(text: str) -> str:
    return unquoted(text) if is_quoted(text) else text
