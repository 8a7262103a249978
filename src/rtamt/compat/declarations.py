"""The base of all classes of the paper's API: names, types, topics, modules and the text."""

from __future__ import annotations

import copy
import importlib
import math
import sys
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any

from rtamt.compat.associativity import warn_of_chains
from rtamt.compat.failures import raises_rtamt
from rtamt.compat.objects import SCALARS, head_of, lacks, new_object
from rtamt.errors import (
    NameInFormulaError,
    SpecificationError,
    StlError,
    UsageError,
    did_you_mean,
    with_article,
)
from rtamt.extras import message_class
from rtamt.files import open_text
from rtamt.language.contents import variables
from rtamt.language.formula import Var, postorder
from rtamt.language.operators import STL, Language
from rtamt.language.parsing.parser import parse_formula
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.units.durations import check_unit

if TYPE_CHECKING:
    import os
    from types import ModuleType

    from typing_extensions import Self

    from rtamt.language.document import Document
    from rtamt.language.formula import Formula

#: What a program sets before ``parse``.
_DECLARED = (
    "name",
    "spec",
    "modules",
    "var_topic_dict",
    "var_io_dict",
    "_trusted",
    "_unit",
    "_sub_specs",
    "_types",
    "_constants",
    "_objects",
)

#: The name of the result of an assertion without one.
UNNAMED = "out"


class Declarations(ABC):
    """A specification under construction: declare, set :attr:`spec`, then :meth:`parse`.

    Not instantiated by users; the classes for discrete and dense time derive from it.
    """

    def __init__(self) -> None:
        #: The specification's name; a text that begins with ``specification <name>`` sets it.
        self.name = "STL specification"
        #: The text of the requirement.
        self.spec: str | None = None
        #: From the name of an imported class to its module.
        self.modules: dict[str, ModuleType] = {}
        #: From the name of a variable to its ROS topic.
        self.var_topic_dict: dict[str, str] = {}
        #: From the name of a declared variable to its role, ``'input'`` or ``'output'``.
        self.var_io_dict: dict[str, str] = {}
        #: Imports made by code, which the text may therefore use, too: (module, name).
        self._trusted: set[tuple[str, str]] = set()
        self._unit = "s"
        self._sub_specs: list[str] = []
        self._types: dict[str, str] = {}
        self._constants: dict[str, float] = {}
        self._objects: dict[str, Any] = {}
        self._document: Document | None = None

    # ---- copies ----------------------------------------------------------------------------------

    def __copy__(self) -> Self:
        """Return an independent specification in the same state, as ``copy.deepcopy`` does."""
        return copy.deepcopy(self)

    def __getstate__(self) -> dict[str, Any]:
        modules = {name: module.__name__ for name, module in self.modules.items()}
        return {**self.__dict__, "modules": modules}

    def __setstate__(self, state: dict[str, Any]) -> None:
        modules = {name: importlib.import_module(module) for name, module in state["modules"].items()}
        self.__dict__.update(state, modules=modules)

    # ---- declaring -------------------------------------------------------------------------------

    @raises_rtamt
    def declare_var(self, var_name: str, var_type: str) -> None:
        """Declare a variable: ``var_type`` is float, int, complex, or an imported message class.

        Declaring it again replaces the declaration. Raises :class:`RTAMTException` for a type that is
        neither built in nor imported.
        """
        _require_text("the name of a variable", var_name)
        if var_name in self._constants:
            raise UsageError(f"'{var_name}' is a constant already; give the variable another name")
        self._objects[var_name] = new_object(var_name, var_type, self.modules)
        self._types[var_name] = var_type
        self.var_io_dict[var_name] = "output"
        self.var_topic_dict.setdefault(var_name, f"rtamt/{var_name}")

    @raises_rtamt
    def declare_const(self, const_name: str, const_type: str, const_val: float | str) -> None:
        """Declare a named number, for use in formulas and as a bound; ``const_val`` may be its text."""
        _require_text("the name of a constant", const_name)
        if const_name in self._constants or const_name in self._types:
            raise UsageError(f"'{const_name}' is declared already; give the constant another name")
        if const_type not in SCALARS:
            raise UsageError(
                f"the constant '{const_name}' cannot be {with_article(const_type)}; its type is float or int"
            )
        try:
            value = float(const_val)
        except (TypeError, ValueError):
            value = math.nan
        if math.isnan(value):
            raise UsageError(f"the constant '{const_name}' is {const_val!r}, expected a number")
        self._constants[const_name] = value

    @raises_rtamt
    def set_var_io_type(self, var_name: str, var_iotype: str) -> None:
        """Set the role of a declared variable: ``'input'`` or ``'output'`` (the default)."""
        self._require_declared(var_name)
        if var_iotype not in ("input", "output"):
            raise UsageError(f"the io type of '{var_name}' is {var_iotype!r}; choose 'input' or 'output'")
        if self.var_io_dict[var_name] != var_iotype:
            self.var_io_dict[var_name] = var_iotype
            self._apply_settings()

    @raises_rtamt
    def set_var_topic(self, var_name: str, var_topic: str) -> None:
        """Set the ROS topic of a declared variable."""
        self._require_declared(var_name)
        self.var_topic_dict[var_name] = var_topic

    @raises_rtamt
    def import_module(self, from_name: str, module_name: str) -> None:
        """Import a class for variables: as Python's ``from from_name import module_name`` does.

        Imports in :attr:`spec` come from text by a possibly different author: they are limited to classes of message
        packages (``std_msgs.msg``) and to classes that this method has imported before.
        """
        try:
            module = importlib.import_module(from_name)
        except ImportError as error:
            raise UsageError(f"the module '{from_name}' cannot be imported: {error}") from error
        if not hasattr(module, module_name):
            raise UsageError(
                f"the module '{from_name}' has no '{module_name}'{did_you_mean(module_name, vars(module))}"
            )
        self.modules[module_name] = module
        self._trusted.add((from_name, module_name))

    @raises_rtamt
    def add_sub_spec(self, sub_spec: str) -> None:
        """Add named formulas (``name = formula;``) that :attr:`spec` can use; they change no result."""
        _require_text("a sub-specification", sub_spec)
        self._sub_specs.append(sub_spec)

    @raises_rtamt
    def get_spec_from_file(self, path: str | os.PathLike[str]) -> str:
        """Return the text of a file, for :attr:`spec`."""
        try:
            with open_text(path, "utf-8") as file:
                return file.read()
        except FileNotFoundError:
            raise UsageError(f"The file {path} does not exist.") from None
        except OSError as error:
            raise UsageError(f"The file {path} cannot be read: {error.strerror}.") from error
        except UnicodeDecodeError as error:
            raise UsageError(f"The file {path} is not UTF-8 text (byte {error.start}).") from error

    @property
    def unit(self) -> str:
        """The unit of timestamps and of bounds without a unit: h, min, s, ms, us or ns."""
        return self._unit

    @unit.setter
    @raises_rtamt
    def unit(self, unit: str) -> None:
        before, self._unit = self._unit, check_unit(unit)
        try:
            self._apply_settings()
        except StlError:
            self._unit = before
            raise

    # ---- reading ---------------------------------------------------------------------------------

    @raises_rtamt
    def parse(self) -> None:
        """Parse the sub-specifications and :attr:`spec`.

        Raises :class:`STLParseException`, with a caret under the position, for invalid text.
        """
        if not isinstance(self.spec, str):
            raise UsageError(f"spec is {self.spec!r}; set it to the text of the requirement first")
        document = self._read_as(self._text(self.spec), STL)
        warn_of_chains(document, self._read_as, stacklevel=4)
        self._adopt(document)
        self._check_objects(document)
        self._accept(document)
        self._document = document
        out = self._out_name[0]
        self._objects.setdefault(out, 0.0)
        self.var_topic_dict.setdefault(out, f"rtamt/{out}")

    def read_as_in(self, other: Declarations) -> None:
        """Parse the text of another specification with its declarations, independently of it."""
        theirs = copy.deepcopy(other).__dict__
        self.__dict__.update((name, theirs[name]) for name in _DECLARED)
        self.parse()

    @property
    def var_object_dict(self) -> dict[str, Any]:
        """The current value of each variable."""
        return self._objects

    @property
    def out_var(self) -> str | None:
        """The variable that holds the result: ``out`` if the text names none; None before ``parse``."""
        return None if self._document is None else self._out_name[0]

    @property
    def out_var_field(self) -> str:
        """The field of :attr:`out_var` that holds the result, ``''`` if it has no fields."""
        return "" if self._document is None else self._out_name[1]

    @property
    def free_vars(self) -> set[str]:
        """The declared or read variables that are not computed: the inputs of an update."""
        if self._document is None:
            return set(self._types)
        computed = {head_of(name) for name in self._assertions(self._document)}
        read = {head_of(name) for name in variables(*self._assertions(self._document).values())}
        return (set(self._types) | read) - computed

    def _apply_settings(self) -> None:
        """Apply a setting that changed after ``parse``; overridden by classes with more state."""
        if self._document is not None:
            document = self._read_as(self._document.text, STL)
            self._accept(document)
            self._document = document

    @abstractmethod
    def _accept(self, document: Document) -> None:
        """Accept a parsed document; each time domain adds its own checks."""

    @property
    def _parsed_document(self) -> Document:
        if self._document is None:
            raise UsageError("no specification has been read; set spec and call parse() first")
        return self._document

    @property
    def _out_name(self) -> tuple[str, str]:
        head, _, field = list(self._assertions(self._parsed_document))[-1].partition(".")
        return head, field

    def _text(self, spec: str) -> str:
        """Join sub-specifications and specification into one text, so that carets point into it."""
        parts = [text if text.rstrip().endswith(";") else text + ";" for text in self._sub_specs]
        return "\n".join([*parts, spec])

    def _read_as(self, text: str, language: Language) -> Document:
        document = parse_document(
            text,
            language=language,
            unit=self._unit,
            constants=self._constants,
            variables=tuple(self._types) or None,
            truths=False,
        )
        for group in document.groups.values():
            raise SpecificationError(
                f"RTAMT's classes have no groups such as '{group.name}'; use rtamt.parse, whose evaluate() and "
                f"monitor() find the members",
                text,
                group.span,
            )
        return document

    def _read_formula(self, text: str) -> Formula:
        """Parse a formula with the names of the specification."""
        document = self._parsed_document
        return parse_formula(
            text,
            constants=document.constants,
            definitions=document.definitions,
            variables=document.variables or None,
            types=document.types,
            enumerations=document.enumerations,
            tables=document.tables,
            unit=self._unit,
            parameters=document.parameters,
            units=document.units,
        )

    def _adopt(self, document: Document) -> None:
        """Declare the variables and constants that the text declares."""
        if document.name is not None:
            self.name = document.name
        for imported in document.imports:
            self._import_as_text(imported.module, imported.name)
        for declaration in document.declarations:
            if declaration.kind == "var":
                number = declaration.type in document.enumerations
                self.declare_var(declaration.name, "int" if number else declaration.type)
                self.var_io_dict[declaration.name] = declaration.role or "output"
        for name, topic in document.topics.items():
            self.set_var_topic(name, topic)

    def _import_as_text(self, module: str, name: str) -> None:
        """Execute the imports of the text: message classes, or classes that code has imported before."""
        if (module, name) in self._trusted:
            return
        try:
            message_class(module, name)
        except UsageError as error:
            raise UsageError(
                f"{error} (import_module('{module}', '{name}') before parse() imports any class)"
            ) from error.__cause__
        self.modules[name] = sys.modules[module]

    def _check_objects(self, document: Document) -> None:
        """Check that declared objects have the numeric fields that are read and written."""
        for node in postorder(*self._assertions(document).values()):
            if isinstance(node, Var) and head_of(node.name) in self._objects:
                message = self._lacks(node.name)
                if message:
                    raise NameInFormulaError(message, document.text, node.span)
        result = list(self._assertions(document))[-1]
        if "." in result and head_of(result) not in self._objects:
            raise UsageError(
                f"the result '{result}' is a field of '{head_of(result)}', which is not declared; "
                f"import its class and declare it"
            )
        if head_of(result) in self._objects:
            message = self._lacks(result)
            if message:
                raise UsageError(message)

    def _lacks(self, name: str) -> str:
        """Return why a declared object has no number called ``name``, or an empty string."""
        head = head_of(name)
        return lacks(name, self._objects[head], self._types.get(head, "number"))

    def _assertions(self, document: Document) -> dict[str, Formula]:
        """Return the formulas by name, the result last."""
        named = {assertion.name or UNNAMED: assertion.formula for assertion in document.assertions[:-1]}
        last = document.assertions[-1]
        named.pop(last.name or UNNAMED, None)
        return {**named, last.name or UNNAMED: last.formula}

    def _require_declared(self, name: str) -> None:
        if name not in self._types:
            raise UsageError(
                f"the variable '{name}' is not declared{did_you_mean(name, self._types)}; "
                f"call declare_var('{name}', ...) first"
            )


def _require_text(what: str, value: object) -> None:
    if not isinstance(value, str):
        raise UsageError(f"{what} is {value!r}, expected text")
