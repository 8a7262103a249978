"""Parse specification files (``.stl``) and texts of one or more formulas to a document.

::

    document    = [ "specification" , word ] , { import } ,
                  { declaration | annotation | enumeration, see enumerations.py | table, see tables.py |
                  group, see groups.py | sampling, see sampling.py } ,
                  statement , { separator , statement } , [ ";" ]
    separator   = ";" | after a named assertion, a requirement or a template, as in RTAMT's files: the end of the line
    statement   = assertion | requirement | template, see templates.py
    import      = ( "from" , module , "import" , word | "import" , '"' , path , '"' ) , [ ";" ]
    declaration = ( [ "optional" ] , [ "input" | "output" ] , type , name , [ "[" , unit , "]" ] ,
                  [ range ] , [ rate ] , [ "=" , recorded , { "or" , recorded } ] |
                  ( "const" | "parameter" ) , type , name , "=" , value , [ "[" , unit , "]" ] ) , [ ";" ]
    range       = "in" , "[" , value , "," , value , "]"
    rate        = "rate" , "[" , value , "," , value , "]"
    recorded    = '"' , characters , '"'
    annotation  = "@" , "topic" , "(" , name , "," , topic , ")" , [ ";" ]
    assertion   = [ name , "=" ] , expression
    requirement = "require" , id , [ '"' , characters , '"' ] ,
                  [ "severity" , ( "error" | "warning" | "note" ) ] , ":" , expression
    id          = letters, digits, "_", "-" and ".", such as REQ-12.a | '"' , characters , '"'
    name        = word , { "." , word } | topic | '"' , characters , '"'
    unit        = characters, such as m/s
    type        = "float" | "int" | "long" | "complex" | "bool" | declared enumeration | imported class
    value       = [ "-" ] , number | "-inf" | "inf" | member | "true" | "false"

None of these words is reserved: ``input >= 3`` is a formula over a variable called input.

The requirements are the formulas after ``require``. In a text without any, they are the formulas (not numbers)
that no other assertion uses; if there are none of these either, the last assertion.
"""

from __future__ import annotations

from itertools import accumulate, repeat
from types import MappingProxyType

from rtamt.errors import NameInFormulaError
from rtamt.language.document import Assertion, Document
from rtamt.language.formula import Formula, Span, Var, postorder
from rtamt.language.lazy_modules import diagnostics, sampling_clause, templates
from rtamt.language.operators import STL, Language
from rtamt.language.parsing.groups import GroupParser
from rtamt.language.parsing.imports import Library
from rtamt.language.parsing.lexer import places_of
from rtamt.language.parsing.scope import Scope
from rtamt.language.parsing.statements import (
    begins_enumeration,
    begins_group,
    begins_sampling,
    begins_table,
    begins_template,
)
from rtamt.language.parsing.template_order import templates_to_come
from rtamt.language.value_types import UNKNOWN
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Mapping

    from rtamt.errors import SpecificationError
    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.sampling_clause import Sampling


def parse_document(
    text: str,
    *,
    language: Language = STL,
    unit: str = "s",
    constants: Mapping[str, float] | None = None,
    variables: Collection[str] | None = None,
    definitions: Mapping[str, Formula] | None = None,
    parameters: Mapping[str, float] | None = None,
    library: Library | None = None,
    truths: bool = True,
) -> Document:
    """Parse a specification text; a single formula is a specification text, too.

    ``language``, ``unit``, ``constants`` and ``definitions`` as in
    :func:`~rtamt.language.parsing.parser.parse_formula`; ``variables`` are names declared elsewhere. If any
    variable is declared, there or in the text, undeclared names are errors. ``parameters``: values of declared
    parameters, instead of those in the text. ``library``: where the files are that it imports. ``truths``: whether
    declared Booleans are true or false in formulas, and not numbers as in RTAMT.

    Raises :class:`ParseError`, :class:`NameInFormulaError` or :class:`BoundError`. Source: listing 8
    of the paper, and RTAMT's grammar.

    >>> document = parse_document("input float x  const float c = 2  low = x <= c; always(low)")
    >>> print(document.formula, document.declarations[0].role)
    always(x <= 2) input
    """
    scope = Scope(constants or {}, definitions or {}, variables or None)
    library = Library() if library is None else library
    return DocumentParser(text, language, unit, scope, parameters or {}, library, truths).document()


#: The messages for texts that can only be imported, and for declarations after formulas.
NO_FORMULA = "the text has declarations but no formula"
LATE = "declarations and annotations stand before the first formula"

_PARENTHESES: Mapping[str, int] = MappingProxyType({"(": 1, ")": -1})


class DocumentParser(GroupParser):
    """The grammar productions of a document, in addition to those of declarations.

    After an error, ``_begin`` is where the statement begins that has it.
    """

    _begin = 0
    _called: str | None = None
    _sampling: Sampling | None = None
    #: The names that formulas cannot use yet, with the reason; None before the first formula.
    _pending: dict[str, str] | None = None

    def document(self, *, imported: bool = False) -> Document:
        """``document = [ header ] , { import } , { declaration | annotation } , assertion , ...``."""
        self._statements()
        for error in self._final_errors(imported=imported):
            raise error
        return Document(
            self.text,
            tuple(self._found),
            self._requirements(),
            self._called,
            tuple(self._imports.values()),
            tuple(self._declarations.values()),
            MappingProxyType(self._topics),
            MappingProxyType(self._constants),
            MappingProxyType(self._definitions),
            MappingProxyType(self._templates),
            self._variables,
            MappingProxyType(self._enumerations),
            MappingProxyType(self._types),
            frozenset(self.used),
            imported=MappingProxyType(self.library.found),
            tables=MappingProxyType(self._tables),
            groups=MappingProxyType(self._groups),
            sampling=self._sampling,
        )

    def _statements(self) -> None:
        """Parse the rest of the text: declarations, unless formulas precede them, and formulas."""
        if self.index == 0:
            self._called = self._header()
        while not self._found and self._begins(self._import):
            pass
        while not self._found and self._begins(self._declared):
            pass
        self._assertions()

    def _final_errors(self, *, imported: bool = False) -> Iterator[SpecificationError]:
        """Yield the errors of the text as a whole; one that is imported needs no formula."""
        if not self._found and not imported:
            yield self.error("the text is empty" if self.index == 0 else NO_FORMULA, self.token.span)
        yield from self._undeclared_in_imports()
        yield from self._variables_as_requirements()

    def _begins(self, production: Callable[[], bool]) -> bool:
        """Return whether a production begins here, which is taken then."""
        self._begin = self.index
        return production()

    def _declared(self) -> bool:
        """Take a declaration, an annotation or the sampling rule, if there is one here."""
        if begins_sampling(self):
            word = self.token
            if self._sampling is not None:
                raise self.error("the sampling rule is given twice", word.span)
            self._sampling = sampling_clause.parse_sampling(self)
            return True
        return (
            self._enumeration() or self._table() or self._group() or self._declaration() or self._annotation()
        )

    @property
    def _variables(self) -> tuple[str, ...]:
        """The declared variables."""
        declared = (d.name for d in self._declarations.values() if d.kind == "var")
        return tuple(dict.fromkeys((*self._given, *declared)))

    # ---- the formulas ----------------------------------------------------------------------------

    def _assertions(self) -> None:
        """``assertion , { separator , assertion } , [ ";" ]``."""
        if self._pending is None:
            self._pending = self._names_to_come() | templates_to_come(self)
        pending, found = self._pending, self._found
        names = dict.fromkeys(self._variables) or None  # a dict for fast lookup
        self._slashes = self._scope(names).slashes if "/" in self.words else 0
        while self.texts[self.index]:
            self._begin = self.index
            required = self._requires()
            if self._imports_file():
                raise self.error("imports stand at the beginning, before declarations", self.token.span)
            if (found or self._templates) and not required and self._begins_declaration():
                raise self.error(LATE, self.token.span)
            self.scope = self._scope(names, pending)
            name: str | None
            if begins_template(self):
                name = self._template(pending)
            elif required:
                self._requirement()
                known = self._explicit[-1]
                name = known.name
                found.append(Assertion(name, known.formula, known.span))
                if name not in self.scope:
                    pending[name] = (
                        f"'{name}' is the name of a requirement, which formulas cannot read; "
                        f"give its formula a name before it, such as holds = ..., and use that in both"
                    )
            else:
                first, name = self.index, self._assertion_name()
                if name is not None:
                    self._check_new(name, self.tokens[first])
                    pending[name] = f"'{name}' is used in its own definition"
                formula = self.formula()
                whole = Span(self.starts[first], self.ends[self.index - 1])
                # A name has the type of its formula; a Boolean is also a number.
                found.append(
                    Assertion(name, self.standing_alone(formula, whole, named=name is not None), whole)
                )
                if name is not None:
                    del pending[name]
                    self._definitions[name] = formula
                    self._slashes = max(self._slashes, name.count("/"))
            # A formula without a name may continue on the next line, so it needs a semicolon.
            if self.texts[self.index] and not (
                self.accept(";")
                or (self._begins_a_line(self.index) and (name or self._requires() or begins_template(self)))
            ):
                raise self._not_finished()
            if required:
                self._check_requirement(self._explicit[-1])
            while self.accept(";"):
                pass

    def _undeclared_in_imports(self) -> Iterator[SpecificationError]:
        """Yield an error for each undeclared name in imported formulas, where names must be declared."""
        names = self._variables
        scope = Scope(variables=names)
        if not names or not self.origins:
            return
        for node in postorder(*(assertion.formula for assertion in self._found)):
            known = not isinstance(node, Var) or node.bound or node.type is UNKNOWN or node.name in scope
            if isinstance(node, Var) and not known:
                yield self.error(
                    f"'{node.name}', which an imported formula reads, is not declared",
                    node.span or Span(0, 0),
                    NameInFormulaError,
                )

    def _template(self, pending: dict[str, str]) -> str:
        """``template``: define it and return its name."""
        token = self._at(1)
        name = token.text
        self._check_new(name, token)
        pending[name] = f"'{name}' uses itself; templates cannot be recursive"
        template = templates.parse_template(self)
        del pending[name]
        self._templates[name] = template
        return name

    def _begins_declaration(self) -> bool:
        """Return whether a declaration or annotation begins here."""
        return (
            self.texts[self.index] == "@"
            or self._declares()
            or begins_enumeration(self)
            or begins_table(self)
            or begins_sampling(self)
            or begins_group(self)
        )

    def _assertion_name(self) -> str | None:
        """``[ name , "=" ]``."""
        last, token = self._end_of_name(), self.token
        if last is None:
            return None
        self._check_nameable(token)
        self.index = last + 2
        return token.name if token.kind == "quoted" else self.text[token.start : self.tokens[last].end]

    def _end_of_name(self) -> int | None:
        """Return the index of the last token of the name that is defined here; None where no name and no = stand."""
        last = self.index
        if "=" not in self.words or self.token.kind not in ("name", "quoted"):
            return None
        while (after := self._after_slash(last + 1)) > 0:
            last = after
        return last if self.texts[last + 1] == "=" else None

    def _names_to_come(self) -> dict[str, str]:
        """Return the names that later assertions define, each with the error message for an earlier use."""
        if "=" not in self.words:
            return {}
        # Except where an assertion may begin, '=' is a mistaken comparison: always(x = 3), or names an argument.
        depth = list(accumulate(map(_PARENTHESES.get, self.texts, repeat(0))))
        names = [
            self.tokens[at].name
            for at in (after - 1 for after in places_of("=", self.texts, self.index + 1))
            if depth[at] <= 0
            and self.tokens[at].kind in ("name", "quoted")
            and (at == self.index or self.texts[at - 1] == ";" or self._begins_a_line(at))
        ]
        return {n: f"'{n}' is only defined further down; move its definition up" for n in names}

    def _check_new(self, name: str, token: Token) -> None:
        if (self._is_defined(name) and name not in self._constants) or name in self._names:
            raise self.error(f"'{name}' is defined twice{self._from(name)}", token.span)
        if name in self._constants:
            raise self.error(f"'{name}' is a constant already{self._from(name)}", token.span)

    def _not_finished(self) -> SpecificationError:
        if self.token.kind == "name" and self.tokens[self.index + 1].text == "=":
            return self.error(f"expected ';' before the definition of {self.token}", self.token.span)
        return self.error(*diagnostics.no_operator(self.language, self.tokens, self.index, "';'"))
