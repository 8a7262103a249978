"""Names in a text of formulas: the tokens, a position in them, and the meaning of a name there."""

from __future__ import annotations

from abc import abstractmethod
from functools import cached_property
from math import inf

from rtamt.errors import NameInFormulaError, ParseError, SpecificationError
from rtamt.language.formula import Const, Formula, Parameter, Span, Var, span_of
from rtamt.language.lazy_modules import diagnostics
from rtamt.language.operators import Fixity, Language
from rtamt.language.parsing.grammar import INFINITY, sign
from rtamt.language.parsing.lexer import Token, Tokens, quoted, tokenize, unquoted
from rtamt.language.parsing.template_names import meaning
from rtamt.language.quantifiers import field_of
from rtamt.language.units.durations import check_unit
from rtamt.language.value_types import Enumeration
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from typing_extensions import Self

    from rtamt.language.parsing.scope import Scope
    from rtamt.language.parsing.templates import Use, Uses
    from rtamt.language.records import Operator

#: Words with which a statement may begin, and that else are names.
_BEGINNING = frozenset(("require", "def"))


class NameParser:
    """A position in a text, and the production of a name."""

    def __init__(self, text: str, language: Language, unit: str, scope: Scope) -> None:
        self.text = text
        self.language = language
        self.unit = check_unit(unit)
        self.scope = scope
        self.read(tokenize(text, language))
        #: The texts of all tokens: most texts have no definitions, no templates and no slashes.
        self.words = set(self.texts)
        #: The names of the definitions that have been used so far.
        self.used: set[str] = set()
        self._depth = 0
        self._opening, self._infix = language.lookups
        #: What each token is, by its text, where an operand begins: most tokens occur several times.
        self._kinds: dict[str, int] = {}
        #: Whether operands of an operator are checked, whatever the scope.
        self._checked: dict[Operator, bool] = {}
        self._sign = sign(language)
        self._slashes = scope.slashes if "/" in self.words else 0  # as many as any declared name has
        #: Where the template is used whose formula is being read; None outside templates.
        self.use: Use | None = None
        #: The IDs of the formulas that names have stood for.
        self.borrowed: set[int] = set()

    def twin(self) -> Self:
        """Return a parser at this position, with this scope."""
        made = object.__new__(type(self))  # copy.copy() takes several times as long
        made.__dict__.update(self.__dict__)
        return made

    @cached_property
    def uses(self) -> Uses:
        """The uses of templates so far."""
        from rtamt.language.parsing.templates import Uses

        return Uses()

    def read(self, tokens: Tokens) -> None:
        """Continue at the first of these tokens."""
        self.tokens = tokens
        self.texts, self.starts, self.ends = tokens.texts, tokens.starts, tokens.ends
        self.index = 0
        #: The indices of words such as ``if`` that begin no choice.
        self._plain_words: set[int] = set()

    @property
    def token(self) -> Token:
        """The next token."""
        return self.tokens[self.index]

    def next(self) -> Token:
        """Consume the next token; the end token is never consumed."""
        token = self.tokens[self.index]
        if token.kind != "end":
            self.index += 1
        return token

    def accept(self, symbol: str) -> bool:
        """Consume the next token if it is this symbol."""
        if self.texts[self.index] == symbol:
            self.index += 1
            return True
        return False

    def error(
        self, message: str, span: Span, kind: type[SpecificationError] = ParseError
    ) -> SpecificationError:
        """Return an error that points at the text; in the formula of a template, at its use."""
        if self.use is not None:
            return self.use.error(message, kind)
        if not self.text.isascii():
            combining = diagnostics.combining_characters(self.text, span)
            if combining is not None:
                return ParseError(combining[0], self.text, combining[1])
        return kind(message, self.text, span)

    # ---- names ---------------------------------------------------------------------------------

    def name(self) -> Formula:
        """``name = word , { "." , word } | topic | '"' , characters , '"'``."""
        first = last = self.index
        text = self.texts[first]
        if text[0] == '"':
            self.index += 1
            return self._meaning(unquoted(text), Span(self.starts[first], self.ends[first]), plain=False)
        if text in _BEGINNING and self._cannot_be_operand():
            raise self.error(*diagnostics.no_operand(self.tokens, first))
        if text == "/" or self.texts[last + 1] == "/":
            last = self._last_of_path()
            text = self.text[self.starts[first] : self.ends[last]]
        self.index = last + 1
        return self._meaning(text, span_of((self.starts[first], self.ends[last])))

    def _cannot_be_operand(self) -> bool:
        """Return whether a whole requirement or template begins here; a formula alone has none."""
        return False

    def _last_of_path(self) -> int:
        """Return the index of the last token of the name here: ``a/b`` is a name only if it is declared."""
        first = self.index
        start = self.tokens[first].start
        topic = self.tokens[first].kind == "symbol"
        free = topic and self.scope.variables is None
        last = self._after_slash(first if topic else first + 1)
        ends: list[int] = []
        while last and (topic or len(ends) < self._slashes):
            ends.append(last)
            last = self._after_slash(last + 1)
        if free:
            return ends[-1]
        for end in reversed(ends[: self._slashes]):
            if self.text[start : self.tokens[end].end] in self.scope:
                return end
        return ends[-1] if topic else first

    def _after_slash(self, at: int) -> int:
        """Return the index of the word after a slash at ``at`` if there is no space around it, else 0."""
        if self.texts[at] != "/":
            return 0
        slash, word = self.tokens[at], self.tokens[at + 1]
        glued = at == self.index or self.tokens[at - 1].end == slash.start
        found = glued and word.kind == "name" and word.start == slash.end
        return at + 1 if found else 0

    def _begins_topic(self, at: int) -> bool:
        """Return whether a topic such as ``/ns/req`` begins here: a slash after a space and before a word."""
        if self.texts[at] != "/":
            return False
        slash = self.tokens[at]
        if self.tokens[at + 1].kind != "name" or self.tokens[at + 1].start != slash.end:
            return False
        before = self.tokens[at - 1] if at else None
        return before is None or before.kind == "symbol" or before.end < slash.start

    def _meaning(self, name: str, span: Span, *, plain: bool = True) -> Formula:
        """Return the formula of a name."""
        scope = self.scope
        if scope.free:
            return self._undefined(name, span, plain=plain)
        if scope.groups and (found := field_of(self, name, span)) is not None:
            return found
        argument = meaning(self, name, span) if scope.arguments else None
        if argument is not None:
            return argument
        if name in scope.pending:
            raise self.error(scope.pending[name], span, NameInFormulaError)
        definition = scope.definitions.get(name)
        if definition is not None:
            self.used.add(name)
            self.borrowed.add(id(definition))
            return definition
        if name in scope.templates:
            signature = scope.templates[name].signature
            raise self.error(f"'{name}' is a template; give it arguments: {signature}", span)
        if name in scope.tables:
            call = f"{scope.tables[name].spellings[0]}(x)"
            raise self.error(f"'{name}' is a table; give it an operand: {call}", span)
        value = scope.constants.get(name)
        if value is not None:
            if name in scope.parameters:
                return Parameter(float(value), span, name, scope.types.get(name))
            return self._constant(name, float(value), span)
        if scope.variables is not None and name in scope:
            return self.signal(name, span)
        member = self._member(name, span) if scope.enumerations else None
        return member or self._undefined(name, span, plain=plain)

    def _undefined(self, name: str, span: Span, *, plain: bool) -> Formula:
        """Return the meaning of an undefined name: a variable, if these need no declaration."""
        if plain:
            if name == INFINITY:
                return Const(inf, span)
            if name in self.language.openings or name in self.language.infixes:
                self._not_an_operator(name, span)
        if self.scope.variables is None:
            return Var(name, span)
        raise self._undeclared(name, span)

    def signal(self, name: str, span: Span) -> Var:
        """Return the variable of this name, of its declared type."""
        return Var(name, span, self.scope.types.get(name))

    def _constant(self, name: str, value: float, span: Span) -> Const:
        """Return a named constant; of an enumeration, under the name of the member."""
        of = self.scope.types.get(name)
        member = of.member(value) if isinstance(of, Enumeration) else None
        named = self.member_text(of, member) if isinstance(of, Enumeration) and member is not None else name
        return Const(value, span, named, of)

    def member_text(self, of: Enumeration, member: str) -> str:
        """Return how a member of an enumeration is written here: with its type where its name means something else."""
        return f"{of.name}.{member}" if member in self.scope else member

    @abstractmethod
    def _member(self, name: str, span: Span) -> Const | None:
        """Return the enumeration member of a name, if there is one."""

    @abstractmethod
    def _undeclared(self, name: str, span: Span) -> SpecificationError:
        """Return the error for a name that means nothing."""

    def _not_an_operator(self, name: str, span: Span) -> None:
        """Raise an error for a word operator in the wrong place, unless it may be a variable.

        ``G`` may be a variable, and so may ``next`` in ``next >= 3``; ``next`` with nothing after it may not.
        """
        opening, infix = self._opening(name), self._infix(name) is not None and len(name) > 1
        prefix = opening is not None and opening.fixity is Fixity.PREFIX and len(name) > 2
        if not (prefix or infix):
            return
        follows = self.token
        compared = follows.kind == "symbol" and self.language.infix(follows.text) is not None
        if compared and self.scope.variables is None:
            return
        if infix:
            raise self.error(*diagnostics.no_operand(self.tokens, self.index - 1))
        raise self.error(
            f"expected an operand after '{name}', got {follows}; if it is a variable, write {quoted(name)}",
            span,
        )
