"""Parse the imports of a specification file: classes of messages, and the declarations of other files."""

from __future__ import annotations

from abc import abstractmethod
from functools import lru_cache, partial

from rtamt.errors import SpecificationError, line_and_column
from rtamt.language.document import Declaration, Import, constant_units
from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.language.parsing.imports import (
    Imported,
    ImportedFileError,
    ImportsOthersError,
    Library,
    NoLibrary,
    called,
    moved,
)
from rtamt.language.parsing.requirements import RequirementParser
from rtamt.language.parsing.scope import Scope
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula
    from rtamt.language.operators import Language
    from rtamt.language.parsing.lexer import Token
    from rtamt.language.parsing.templates import Argument, Template
    from rtamt.language.quantifiers import Group
    from rtamt.language.records import Operator
    from rtamt.language.value_types import Enumeration, ValueType

    #: What a file means that imports no other: the parser, the text, the default unit, and whether Booleans are truths.
    _Key = tuple[type["ImportParser"], str, str, bool]


#: Imported files that are kept parsed: an editor parses a text at every change.
_KEPT = 32


@lru_cache(_KEPT)
def _parse_file(key: _Key) -> Document:
    """Return the document of a file; raise :class:`ImportsOthersError` if it imports others."""
    parser, text, unit, truths = key
    return parser(text, STL, unit, Scope(), {}, NoLibrary(), truths).document(imported=True)


@lru_cache(_KEPT)
def _placed(key: _Key, span: Span) -> tuple[Mapping[str, Formula], Mapping[str, Template]]:
    """Return the definitions and templates of a file at the position of its import."""
    return moved(_parse_file(key), span)


class ImportParser(RequirementParser):
    """The grammar productions of imports, in addition to those of a requirement, and the declarations so far."""

    def __init__(
        self,
        text: str,
        language: Language,
        unit: str,
        scope: Scope,
        values: Mapping[str, float],
        library: Library,
        truths: bool,
    ) -> None:
        super().__init__(text, language, unit, scope)
        self._truths = truths
        self._enumerations: dict[str, Enumeration] = dict(scope.enumerations)
        self._types: dict[str, ValueType] = dict(scope.types)
        self.library = library
        #: From each name that is imported to the file that defines it.
        self.origins: dict[str, str] = {}
        #: The values of parameters that are given.
        self._values = values
        #: The names of the declared parameters.
        self._parameters: set[str] = set()
        self._constants = dict(scope.constants)
        self._given = tuple(scope.variables or ())
        self._declarations: dict[str, Declaration] = {}
        #: The declared units of constants.
        self._units: dict[str, str] = {}
        self._topics: dict[str, str] = {}
        self._templates: dict[str, Template] = {}
        self._tables: dict[str, Operator] = {}
        self._groups: dict[str, Group] = dict(scope.groups)
        #: Names from wrong statements, which match anything.
        self._unknown: dict[str, Argument] = {}

    @abstractmethod
    def document(self, *, imported: bool = False) -> Document:
        """Parse the whole text; one that is imported needs no formula."""

    def _import(self) -> bool:
        """``import = ( "from" , module , "import" , word | "import" , '"' , path , '"' ) , [ ";" ]``."""
        if self._imports_file():
            start = self.next().start
            token = self.next()
            self._import_file(token, Span(start, token.end))
            self.accept(";")
            return True
        if not (self._word("from") and self._plain_name(1)):
            return False
        self.next()
        module = self.next()
        if not self.accept("import"):
            raise self._expected_error(f"'import' after 'from {module.text}'")
        name = self._take_name("the name of a class")
        if name.text in self._imports:
            raise self.error(f"'{name.text}' is imported twice", name.span)
        self._imports[name.text] = Import(module.text, name.text)
        self.accept(";")
        return True

    def _imports_file(self) -> bool:
        return self._word("import") and self._at(1).kind == "quoted" and "import" not in self._imports

    def _import_file(self, token: Token, span: Span) -> None:
        """Take over what a file declares and defines, but for its requirements."""
        library = self.library
        try:
            file, text = library.read(token.name)
        except ImportedFileError as error:
            raise self._no_file(error, token) from None
        if file not in library.documents:
            library.open.append(file)
            try:
                library.documents[file] = self._read_file(file, text)
            except SpecificationError as error:
                raise self._error_in(file, error, token) from None
            except ImportedFileError as error:
                outermost = len(library.open) == 1
                raise (self.error(str(error), token.span) if outermost else error) from None
            finally:
                library.open.pop()
        document, origins, placed = library.documents[file]
        for name, origin in origins.items():
            known = self.origins.setdefault(name, origin)
            if known != origin:
                raise self.error(
                    f"'{name}' is in '{called(known)}' and in '{called(origin)}'; rename one of them", span
                )
        definitions, templates = placed(span)
        self._constants.update(document.constants)
        self._parameters.update(document.parameters)
        self._add_declarations(*document.declarations)
        self._definitions.update(definitions)
        self._templates.update(templates)
        self._enumerations.update(document.enumerations)
        self._tables.update(document.tables)
        self._groups.update(document.groups)
        self._types.update(document.types)
        self._topics.update(document.topics)
        self._imports.update({each.name: each for each in document.imports})

    def _add_declarations(self, *declarations: Declaration) -> None:
        """Take over declarations."""
        self._declarations.update({each.name: each for each in declarations})
        self._units.update(constant_units(declarations))

    def _read_file(self, file: str, text: str) -> Imported:
        """Parse an imported file, if it was not parsed before."""
        found = self._read_alone(text)
        if found is None:
            other = type(self)(
                text, self.language, self.unit, Scope(), self._values, self.library, self._truths
            )
            document = other.document(imported=True)
            found = Imported(document, other.origins, partial(moved, document))
        document = found.document
        names = (
            *document.constants,
            *document.definitions,
            *document.templates,
            *document.variables,
            *document.enumerations,
            *document.tables,
            *document.groups,
        )
        return found._replace(origins={**dict.fromkeys(names, file), **found.origins})

    def _read_alone(self, text: str) -> Imported | None:
        """Return a file that imports no other, which this process parses once; None for others."""
        if self._values or self.language is not STL:
            return None
        key = type(self), text, self.unit, self._truths
        try:
            return Imported(_parse_file(key), {}, partial(_placed, key))
        except ImportsOthersError:
            return None

    def _no_file(self, error: ImportedFileError, token: Token) -> SpecificationError | ImportedFileError:
        """Return the error of a file that cannot be imported: at the outermost import, else for it."""
        if not self.library.open:
            return self.error(str(error), token.span)
        line, column = line_and_column(self.text, token.start)
        return ImportedFileError(f"{called(self.library.open[-1])}, line {line}, column {column}: {error}")

    def _error_in(self, file: str, error: SpecificationError, token: Token) -> SpecificationError:
        """Return the error of an imported file at the import: where it is in the file, and no word of the file.

        The file may belong to someone else than who reads the message.
        """
        message = error.message
        if error.text is not None and error.span is not None:  # else placed by a file that this one imports
            line, column = line_and_column(error.text, error.span.start)
            name = called(file)
            message = f"{name} has an error in line {line}, column {column}: 'rtamt lint {name}' shows it"
        outermost = len(self.library.open) == 1
        return self.error(message, token.span, type(error)) if outermost else type(error)(message)

    def _from(self, name: str) -> str:
        """Return the origin of a name for messages: "" for this text."""
        return f" (it is imported from '{called(self.origins[name])}')" if name in self.origins else ""

    def _take_name(self, what: str, *, quotes: bool = False) -> Token:
        """Consume a name, or raise an error."""
        if self.token.kind != "name" and not (quotes and self.token.kind == "quoted"):
            raise self._expected_error(what)
        return self.next()
