"""Requirements in a specification text: ``require ID ["text"] [severity WORD]: formula``, or named formulas."""

from __future__ import annotations

from rtamt.errors import ParseError
from rtamt.language.contents import variables
from rtamt.language.document import SEVERITIES, Requirement
from rtamt.language.formula import Span
from rtamt.language.parsing.grammar import is_number
from rtamt.language.parsing.lexer import quoted, unquoted
from rtamt.language.parsing.parser import FormulaParser
from rtamt.language.parsing.statements import begins_template
from rtamt.language.parsing.type_rules import type_of
from rtamt.language.value_types import UNKNOWN
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.errors import SpecificationError
    from rtamt.language.document import Assertion, Import, Severity
    from rtamt.language.operators import Language
    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.scope import Scope

#: A requirement name that needs no quotes.
ID = lazy_pattern(r"\w(?:[\w.-]*\w)?")


class RequirementParser(FormulaParser):
    """The grammar productions of a requirement, in addition to those of a formula."""

    def __init__(self, text: str, language: Language, unit: str, scope: Scope) -> None:
        super().__init__(text, language, unit, scope)
        self._imports: dict[str, Import] = {}
        self._definitions = dict(scope.definitions)
        self._explicit: list[Requirement] = []
        self._names: dict[str, Span] = {}  # the position of each name
        #: The formulas so far.
        self._found: list[Assertion] = []

    def _requirement(self) -> None:
        """``requirement = "require" , id , [ text ] , [ "severity" , word ] , ":" , expression``."""
        start = self.next().start
        span, name = self._id_span(), self._id()
        if not name.strip() or not name.isprintable():
            raise self.error(
                "the name of a requirement is one line of visible characters, such as REQ-12", span
            )
        if any(
            name in known
            for known in (self._definitions, self._names, self.scope.templates, self.scope.tables)
        ):
            raise self.error(f"'{name}' is the name of another requirement or definition", span)
        if name in self.scope.constants:
            raise self.error(f"'{name}' is the name of a constant; give the requirement another one", span)
        description = unquoted(self.next().text) if self.token.kind == "quoted" else ""
        severity: Severity = "error"
        if self._word("severity"):
            self.next()
            chosen = next((known for known in SEVERITIES if known == self.token.text), None)
            if chosen is None:
                raise self._expected_error(f"a severity ({', '.join(SEVERITIES)})")
            severity = chosen
            self.next()
        if not self.accept(":"):
            raise self._expected_error(f"':' after 'require {name}'")
        begin = self.token.start
        formula = self.formula()
        formula = self.standing_alone(formula, Span(begin, self.tokens[self.index - 1].end))
        whole = Span(start, self.tokens[self.index - 1].end)
        self._explicit.append(Requirement(name, formula, description, severity, True, whole))
        self._names[name] = span

    def _check_requirement(self, known: Requirement) -> None:
        """Reject a number."""
        if is_number(known.formula) and type_of(known.formula) is not UNKNOWN:
            message = (
                f"'{known.name}' requires a number, which neither holds nor fails; compare it, such as x >= 0"
            )
            raise self.error(message, known.formula.span or self._names[known.name])

    def _id_span(self) -> Span:
        """Return the position of the name of a requirement."""
        if self.token.kind == "quoted":
            return self.token.span
        match = ID.match(self.text, self.token.start)
        if match is None:
            raise self._expected_error("the name of a requirement, such as REQ-12")
        return Span(match.start(), match.end())

    def _id(self) -> str:
        """``id``: a word that may contain dashes and dots, or any text in double quotes."""
        if self.token.kind == "quoted":
            return unquoted(self.next().text)
        span = self._id_span()
        while self.token.kind != "end" and self.token.end <= span.end:
            self.next()
        return self.text[span.start : span.end]

    def _variables_as_requirements(self) -> Iterator[SpecificationError]:
        """Yield an error for each requirement with the name of a variable that formulas read."""
        if not self._names:
            return
        read = set(variables(*(assertion.formula for assertion in self._found)))
        for name, span in self._names.items():
            if name in read:
                yield self.error(
                    f"'{name}' is the name of a variable; give the requirement another one", span
                )

    def _requirements(self) -> tuple[Requirement, ...]:
        """Return the requirements in the order of the text."""
        if self._explicit:
            return tuple(self._explicit)
        assertions = tuple(self._found)
        unused = [a for a in assertions if not is_number(a.formula) and a.name not in self.used]
        found = []
        taken: set[str | None] | None = None
        for number, assertion in enumerate(unused or assertions[-1:], 1):
            name = assertion.name or f"requirement_{number}"
            if assertion.name is None and self._may_occur(name):
                if taken is None:
                    taken = {
                        *variables(*(each.formula for each in assertions)),
                        *(each.name for each in assertions),
                    }
                while name in taken:
                    name += "_"
            found.append(Requirement(name, assertion.formula, span=assertion.span))
        return tuple(found)

    def _may_occur(self, name: str) -> bool:
        """Return whether formulas may have or read this name; to ask them takes a sixth of the time to parse them."""
        others = self._definitions or self._imports or self.scope.templates  # they may come from other texts
        return bool(others) or not self.words.isdisjoint((name, quoted(name)))

    # ---- lookahead -------------------------------------------------------------------------------

    def _requires(self) -> bool:
        """Return whether a requirement begins here: ``require`` where it cannot be a variable."""
        if not self._word("require") or "require" in self._imports:
            return False
        if self._plain_name(1) or self._at(1).kind == "number":
            return self._at(2).text != "="  # otherwise a declaration without a type
        # An infix operator such as S may be the name, unless an operand follows.
        return self._has_head()

    def _has_head(self) -> bool:
        """Return whether the next tokens up to a colon are those of a requirement: name, text and severity."""
        name = ID.match(self.text, self._at(1).start)
        if name is None or self._at(1).kind not in ("name", "number"):
            return False
        ahead = next(k for k in range(2, len(self.tokens)) if self._at(k).start >= name.end())
        ahead += self._at(ahead).kind == "quoted"
        ahead += 2 * (self._at(ahead).text == "severity")
        return self._at(ahead).text == ":"

    def _begins_statement(self) -> bool:
        return self._requires() or begins_template(self)

    def _cannot_be_operand(self) -> bool:
        required = self._word("require") and "require" not in self._imports and self._has_head()
        return required or begins_template(self)

    def _begins_a_line(self, at: int) -> bool:
        between = self.text[self.ends[at - 1] : self.starts[at]]
        return "\n" in between or "\r" in between

    def _word(self, word: str) -> bool:
        return self.texts[self.index] == word

    def _at(self, ahead: int) -> Token:
        return self.tokens[min(self.index + ahead, len(self.tokens) - 1)]

    def _plain_name(self, ahead: int) -> bool:
        """Return whether the token that far ahead is a name that cannot be an infix operator."""
        token = self._at(ahead)
        return self._infix(token.text) is None and token.kind in ("name", "quoted")

    # ---- errors ----------------------------------------------------------------------------------

    def _expected_error(self, what: str) -> SpecificationError:
        return self.error(f"expected {what}, got {self.token}", self.token.span, ParseError)
