"""Parse specification files (``.stl``) and texts of one or more formulas to a document.

::

    document    = [ "specification" , word ] , { import } , { declaration | annotation } ,
                  statement , { separator , statement } , [ ";" ]
    separator   = ";" | after a named assertion or a requirement, as in RTAMT's files: the end of the line
    statement   = assertion | requirement
    import      = "from" , module , "import" , word , [ ";" ]
    declaration = ( [ "input" | "output" ] , type , name | "const" , type , name , "=" , value ) ,
                  [ "[" , unit , "]" ] , [ ";" ]
    annotation  = "@" , "topic" , "(" , name , "," , topic , ")" , [ ";" ]
    assertion   = [ name , "=" ] , expression
    requirement = "require" , id , [ '"' , characters , '"' ] ,
                  [ "severity" , ( "error" | "warning" | "note" ) ] , ":" , expression
    id          = letters, digits, "_", "-" and ".", such as REQ-12.a | '"' , characters , '"'
    name        = word , { "." , word } | topic | '"' , characters , '"'
    unit        = characters, such as m/s
    type        = "float" | "int" | "long" | "complex" | "bool" | imported class
    value       = [ "-" ] , number | "-inf" | "inf"

None of these words is reserved: ``input >= 3`` is a formula over a variable called input.

The requirements are the formulas after ``require``. In a text without any, they are the formulas (not numbers)
that no other assertion uses; if there are none of these either, the last assertion.
"""

from __future__ import annotations

from itertools import pairwise
from math import inf
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal

from rtamt.errors import NameInFormulaError, did_you_mean
from rtamt.language import diagnostics
from rtamt.language.document import Assertion, Declaration, Document, Import
from rtamt.language.formula import Formula, Span
from rtamt.language.grammar import INFINITY
from rtamt.language.lexer import Token, quoted
from rtamt.language.operators import STL, Fixity, Language
from rtamt.language.requirements import RequirementParser
from rtamt.language.scope import Scope

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rtamt.errors import SpecificationError

#: The types that need no import.
TYPES = ("float", "int", "long", "complex", "bool")

_ROLES: Mapping[str, Literal["input", "output"]] = MappingProxyType({"input": "input", "output": "output"})


def parse_document(
    text: str,
    *,
    language: Language = STL,
    unit: str = "s",
    constants: Mapping[str, float] | None = None,
    variables: Collection[str] | None = None,
    definitions: Mapping[str, Formula] | None = None,
) -> Document:
    """Parse a specification text; a single formula is a specification text, too.

    ``language``, ``unit``, ``constants`` and ``definitions`` as in
    :func:`~rtamt.language.parser.parse_formula`; ``variables`` are names declared elsewhere. If any
    variable is declared, there or in the text, undeclared names are errors.

    Raises :class:`ParseError`, :class:`NameInFormulaError` or :class:`BoundError`. Source: listing 8
    of the paper, and RTAMT's grammar.

    >>> document = parse_document("input float x  const float c = 2  low = x <= c; always(low)")
    >>> print(document.formula, document.declarations[0].role)
    always(x <= 2) input
    """
    scope = Scope(constants or {}, definitions or {}, variables or None)
    return _DocumentParser(text, language, unit, scope).document()


class _DocumentParser(RequirementParser):
    """The grammar productions of a document, in addition to those of a formula."""

    def __init__(self, text: str, language: Language, unit: str, scope: Scope) -> None:
        super().__init__(text, language, unit, scope)
        self._constants = dict(scope.constants)
        self._given = tuple(scope.variables or ())
        self._declarations: dict[str, Declaration] = {}
        self._topics: dict[str, str] = {}

    def document(self) -> Document:
        """``document = [ header ] , { import } , { declaration | annotation } , assertion , ...``."""
        name = self._header()
        while self._import():
            pass
        while self._declaration() or self._annotation():
            pass
        declared = tuple(d.name for d in self._declarations.values() if d.kind == "var")
        variables = tuple(dict.fromkeys((*self._given, *declared)))
        assertions = self._assertions(variables)
        return Document(
            self.text,
            assertions,
            self._requirements(assertions),
            name,
            tuple(self._imports.values()),
            tuple(self._declarations.values()),
            MappingProxyType(self._topics),
            MappingProxyType(self._constants),
            MappingProxyType(self._definitions),
            variables,
            frozenset(self.used),
        )

    # ---- before the formulas ---------------------------------------------------------------------

    def _header(self) -> str | None:
        """``header = "specification" , word``."""
        if not (self._word("specification") and self._plain_name(1)):
            return None
        self.next()
        name = self.next().text
        self.accept(";")
        return name

    def _import(self) -> bool:
        """``import = "from" , module , "import" , word , [ ";" ]``."""
        if not (self._word("from") and self._plain_name(1)):
            return False
        self.next()
        module = self.next()
        if not self.accept("import"):
            raise self._expected(f"'import' after 'from {module.text}'")
        name = self._taken("the name of a class")
        if name.text in self._imports:
            raise self.error(f"'{name.text}' is imported twice", name.span)
        self._imports[name.text] = Import(module.text, name.text)
        self.accept(";")
        return True

    def _declaration(self) -> bool:
        """``declaration = ( [ role ] , type , name | "const" , type , name , "=" , value ) , [ unit ] , [ ";" ]``."""
        if not self._declares():
            return False
        constant = self._word("const")
        role = None if constant else _ROLES.get(self.token.text) if self._plain_type(1) else None
        if constant or role:
            self.next()
        type_name = self.next()
        if not self._is_type(type_name):
            types = (*TYPES, *self._imports)
            hint = did_you_mean(type_name.text, types)
            raise self.error(
                f"'{type_name.text}' is not a type{hint or '; types are ' + ', '.join(types[:20])}"
                f"{'' if hint else ', and classes that are imported'}",
                type_name.span,
            )
        name = self._taken("the name of a constant" if constant else "the name of a variable", quotes=True)
        name = self._with_slashes(name)
        self._declare(name, type_name.text, role, constant=constant)
        self.accept(";")
        return True

    def _declare(
        self, token: Token, type_name: str, role: Literal["input", "output"] | None, *, constant: bool
    ) -> None:
        name = token.name
        self._check_nameable(token)
        head = name.split(".", 1)[0]
        if head != name and head in self._declarations:
            raise self.error(f"'{name}' is a field of '{head}', which is declared", token.span)
        if name in self._declarations or name in self._constants or (constant and name in self._given):
            raise self.error(f"'{name}' is declared twice", token.span)
        value = None
        if self.accept("="):
            if not constant:
                raise self.error(
                    f"a variable has no value of its own; define it after the declarations: {name} = ...",
                    self.tokens[self.index - 1].span,
                )
            value = self._value()
            self._constants[name] = value
        elif constant:
            raise self.error(
                f"the constant '{name}' has no value; write const {type_name} {name} = ...", token.span
            )
        self._declarations[name] = Declaration(
            name, type_name, "const" if constant else "var", role, value, self._unit(token), token.span
        )

    def _unit(self, name: Token) -> str:
        """``[ "[" , unit , "]" ]``: the unit of what is called ``name``, "" where none is written."""
        opening = self.token
        if opening.text != "[":
            return ""
        start = self.next().end
        while self.token.text not in ("]", "", '"', "/*"):
            self.next()
        unit = self.text[start : self.token.start].strip()
        if unit.isdigit() and opening.start == name.end:
            whole = f"{name.name}[{unit}]"
            raise self.error(
                f"'{unit}' is not a unit; a name with brackets is written in quotes: {quoted(whole)}",
                Span(name.start, self.token.end),
            )
        if not unit or not self.accept("]"):
            raise self.error(f"expected a unit and ']' after '{name.name} [', such as [m/s]", opening.span)
        return unit

    def _value(self) -> float:
        """``value = [ "-" ] , number | "-inf" | "inf"``."""
        minus = self.accept("-")
        if self.token.kind == "number":
            value = self.number().value
        elif self.accept(INFINITY):
            value = inf
        else:
            raise self._expected("a number")
        return -value if minus else value

    def _annotation(self) -> bool:
        """``annotation = "@" , "topic" , "(" , name , "," , topic , ")" , [ ";" ]``."""
        if not self.accept("@"):
            return False
        kind = self.next()
        if kind.text != "topic":
            raise self.error(f"expected 'topic' after '@', got {kind}", kind.span)
        if not self.accept("("):
            raise self._expected("'(' after '@ topic'")
        token = self._taken("the name of a variable", quotes=True)
        name = token.name
        declared = self._declarations.get(name)
        if name not in self._given and (declared is None or declared.kind != "var"):
            known = [*self._given, *(d.name for d in self._declarations.values() if d.kind == "var")]
            hint = did_you_mean(name, known) or "; declare it before its topic"
            raise self.error(f"'{name}' is not a declared variable{hint}", token.span, NameInFormulaError)
        if name in self._topics:
            raise self.error(f"'{name}' has two topics", token.span)
        if not self.accept(","):
            raise self._expected(f"',' after '{name}'")
        self._topics[name] = self._topic()
        if not self.accept(")"):
            raise self._expected("')' after the topic")
        self.accept(";")
        return True

    def _topic(self) -> str:
        """``topic``: characters without spaces, up to the parenthesis."""
        first = self.token
        end = first.start
        while self.token.text not in (")", "") and self.token.start == end:
            end = self.next().end
        if end == first.start:
            raise self._expected("the name of a topic")
        return self.text[first.start : end]

    # ---- the formulas ----------------------------------------------------------------------------

    def _assertions(self, variables: tuple[str, ...]) -> tuple[Assertion, ...]:
        """``assertion , { separator , assertion } , [ ";" ]``."""
        pending = self._names_to_come()
        names = dict.fromkeys(variables) or None  # a dict for fast lookup
        self._slashes = Scope(self._constants, self._definitions, names).slashes
        found: list[Assertion] = []
        while self.token.kind != "end":
            required = self._requires()
            if found and not required and (self.token.text == "@" or self._declares()):
                raise self.error(
                    "declarations and annotations stand before the first formula", self.token.span
                )
            self.scope = Scope(self._constants, self._definitions, names, pending)
            name: str | None
            if required:
                self._requirement()
                known = self._explicit[-1]
                name = known.name
                found.append(Assertion(name, known.formula, known.span))
            else:
                start, token, name = self.token.start, self.token, self._assertion_name()
                if name is not None:
                    self._check_new(name, token)
                    pending[name] = f"'{name}' is used in its own definition"
                formula = self.formula()
                found.append(Assertion(name, formula, Span(start, self.tokens[self.index - 1].end)))
                if name is not None:
                    del pending[name]
                    self._definitions[name] = formula
                    self._slashes = max(self._slashes, name.count("/"))
            # A formula without a name may continue on the next line, so it needs a semicolon.
            ended = self._begins_a_line(self.index) and (name or self._requires())
            if self.token.kind != "end" and not (self.accept(";") or ended):
                raise self._not_finished()
            while self.accept(";"):
                pass
        if not found:
            empty = "the text is empty" if self.index == 0 else "the text has declarations but no formula"
            raise self.error(empty, self.token.span)
        return tuple(found)

    def _begins_a_line(self, at: int) -> bool:
        between = self.text[self.tokens[at - 1].end : self.tokens[at].start]
        return "\n" in between or "\r" in between

    def _assertion_name(self) -> str | None:
        """``[ name , "=" ]``."""
        token, last = self.token, self.index
        if token.kind not in ("name", "quoted"):
            return None
        while (after := self._after_slash(last + 1)) > 0:
            last = after
        if self.tokens[last + 1].text != "=":
            return None
        self._check_nameable(token)
        self.index = last + 2
        return token.name if token.kind == "quoted" else self.text[token.start : self.tokens[last].end]

    def _names_to_come(self) -> dict[str, str]:
        """Return the names that later assertions define, each with the error message for an earlier use."""
        # Except where an assertion may begin, '=' is a mistaken comparison: always(x = 3).
        names = [
            token.name
            for at, (token, after) in enumerate(pairwise(self.tokens))
            if at >= self.index
            and token.kind in ("name", "quoted")
            and after.text == "="
            and (at == self.index or self.tokens[at - 1].text == ";" or self._begins_a_line(at))
        ]
        return {n: f"'{n}' is only defined further down; move its definition up" for n in names}

    def _check_new(self, name: str, token: Token) -> None:
        if name in self._definitions or name in self._names:
            raise self.error(f"'{name}' is defined twice", token.span)
        if name in self._constants:
            raise self.error(f"'{name}' is a constant already", token.span)

    def _not_finished(self) -> SpecificationError:
        if self.token.kind == "name" and self.tokens[self.index + 1].text == "=":
            return self.error(f"expected ';' before the definition of {self.token}", self.token.span)
        return self.error(*diagnostics.no_operator(self.language, self.tokens, self.index, "';'"))

    # ---- looking ahead ---------------------------------------------------------------------------

    def _is_type(self, token: Token) -> bool:
        return token.text in TYPES or token.text in self._imports

    def _plain_type(self, ahead: int) -> bool:
        """Return whether a type and a name follow at this offset; the name may be ``S``, the type may not."""
        typed = self._is_type(self._at(ahead)) or self._plain_name(ahead)
        return typed and self._at(ahead).kind == "name" and self._at(ahead + 1).kind in ("name", "quoted")

    def _declares(self) -> bool:
        """Return whether a declaration begins here, of a known or unknown type."""
        first = self.token
        if first.kind != "name" or self._requires():
            return False
        if (first.text in _ROLES or first.text == "const") and self._plain_type(1):
            return True
        if self._is_type(first):
            return self._at(1).kind in ("name", "quoted")
        # Two names in a row are a declaration of unknown type if no formula could continue after them.
        if self.language.opening(first.text) is not None or not (self._plain_name(0) and self._plain_name(1)):
            return False
        third = self._at(2)
        return third.text in ("@", "=") or (third.kind == "name" and self.language.infix(third.text) is None)

    def _with_slashes(self, token: Token) -> Token:
        """Consume a slash and a name that directly follow a name: ``robot/speed`` is one name."""
        while token.kind == "name" and self.token.text == "/" and self._at(1).kind == "name":
            slash, tail = self.token, self._at(1)
            if slash.start != token.end or tail.start != slash.end:
                break
            self.next()
            self.next()
            token = Token("name", f"{token.text}/{tail.text}", token.start, tail.end)
        return token

    # ---- errors ----------------------------------------------------------------------------------

    def _taken(self, what: str, *, quotes: bool = False) -> Token:
        """Consume a name, or raise an error."""
        if self.token.kind != "name" and not (quotes and self.token.kind == "quoted"):
            raise self._expected(what)
        return self.next()

    def _check_nameable(self, token: Token) -> None:
        op = self.language.opening(token.text)
        if op is not None and op.fixity is Fixity.ATOM:
            raise self.error(f"'{token.text}' is a word of the language and cannot be a name", token.span)
