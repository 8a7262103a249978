"""The content of a specification file, as parsed by ``specfile.py``."""

from __future__ import annotations

from functools import cached_property, reduce
from types import MappingProxyType

from rtamt.errors import UsageError, choices
from rtamt.language.operators import STL
from rtamt.language.quantifiers import fields_of, quantifiers
from rtamt.lazy.dataclasses import dataclass, field, replace
from rtamt.lazy.typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from rtamt.language.formula import Formula, Span
    from rtamt.language.parsing.sampling_clause import Sampling
    from rtamt.language.parsing.templates import Template
    from rtamt.language.quantifiers import Group
    from rtamt.language.records import Operator
    from rtamt.language.value_types import Enumeration, ValueType

#: The severity of a violation, in the terms of SARIF.
Severity: TypeAlias = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")


@dataclass(frozen=True, slots=True)
class Import:
    """``from module import name``: a class that can be the type of a variable."""

    module: str
    name: str


@dataclass(frozen=True, slots=True)
class Declaration:
    """A declared variable (with its role, if any), constant or parameter (with its value as written).

    ``unit``: as written, such as m/s. ``columns``: the recorded names of the variable, the preferred one first.
    ``optional``: whether recordings may lack it; requirements that read it are then not checked. ``range``: its least
    and its greatest value, also of samples that are not known. ``rate``: its least and its greatest change, per second.
    """

    name: str
    type: str
    kind: Literal["var", "const", "parameter"] = "var"
    role: Literal["input", "output"] | None = None
    value: float | None = None
    unit: str = ""
    columns: tuple[str, ...] = ()
    optional: bool = False
    range: tuple[float, float] | None = None
    rate: tuple[float, float] | None = None
    span: Span | None = field(default=None, compare=False, repr=False)


def constant_units(declarations: Iterable[Declaration]) -> dict[str, str]:
    """Return the declared units of constants and parameters, as written; those without a unit are left out."""
    return {each.name: each.unit for each in declarations if each.kind != "var" and each.unit}


@dataclass(frozen=True, slots=True)
class Assertion:
    """A formula and its name, if any; names of earlier assertions in it are already replaced."""

    name: str | None
    formula: Formula
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Requirement:
    """A formula that must hold, and its name in reports.

    ``name``: the word after ``require``; otherwise the name of the assertion; otherwise ``requirement_2`` for
    the second requirement of the text. ``description`` and ``severity``: as written after ``require``.
    ``explicit``: whether the requirement was written with ``require``.
    """

    name: str
    formula: Formula
    description: str = ""
    severity: Severity = "error"
    explicit: bool = False
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Document:
    """The content of a specification text."""

    text: str
    assertions: tuple[Assertion, ...]
    #: The formulas that must hold. If no assertion is a formula: the last assertion, a number.
    requirements: tuple[Requirement, ...]
    name: str | None = None
    imports: tuple[Import, ...] = ()
    declarations: tuple[Declaration, ...] = ()
    #: From variable to topic.
    topics: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    #: Every constant and parameter a formula may use, by name, with its value in use: declared here, or
    #: given to :func:`parse_document`.
    constants: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    #: Every named formula: defined here, or given to :func:`parse_document`.
    definitions: Mapping[str, Formula] = field(default_factory=lambda: MappingProxyType({}))
    #: Every template defined here, by name.
    templates: Mapping[str, Template] = field(default_factory=lambda: MappingProxyType({}))
    #: Every declared variable, here or given to :func:`parse_document`; if there are none, any name is a variable.
    variables: tuple[str, ...] = ()
    #: The enumerations that are declared here, by name.
    enumerations: Mapping[str, Enumeration] = field(default_factory=lambda: MappingProxyType({}))
    #: The types of the declared variables and constants that are Booleans or of an enumeration.
    types: Mapping[str, ValueType] = field(default_factory=lambda: MappingProxyType({}))
    #: The names of the assertions that other assertions use.
    used: frozenset[str] = frozenset()
    #: The files that it imports, see :attr:`Library.found`.
    imported: Mapping[tuple[str, str], tuple[str, str]] = field(
        default_factory=lambda: MappingProxyType({}), compare=False, repr=False
    )
    #: The tables that formulas may use, by name.
    tables: Mapping[str, Operator] = field(default_factory=lambda: MappingProxyType({}))
    #: The groups of signals that quantifiers range over, by name.
    groups: Mapping[str, Group] = field(default_factory=lambda: MappingProxyType({}))
    #: The sampling rule; None if there is none.
    sampling: Sampling | None = None
    #: The name of the assertion or requirement selected by :meth:`select`.
    selected: str | None = None
    #: The document it was selected from, with every requirement; None if nothing was selected.
    origin: Document | None = field(default=None, compare=False, repr=False)
    #: Whether :meth:`with_formula` has replaced the requirements of the text.
    replaced: bool = False

    def __hash__(self) -> int:
        return hash(self.text)

    @cached_property
    def parameters(self) -> Mapping[str, float]:
        """The value in use of every declared parameter."""
        declared = (d.name for d in self.declarations if d.kind == "parameter")
        return MappingProxyType({name: self.constants[name] for name in declared})

    @cached_property
    def units(self) -> Mapping[str, str]:
        """The declared unit of every constant and parameter that has one, as written."""
        return MappingProxyType(constant_units(self.declarations))

    @cached_property
    def formula(self) -> Formula:
        """The conjunction of the requirements; a single requirement as it is."""
        return reduce(STL["and"], (requirement.formula for requirement in self.requirements))

    def select(self, name: str) -> Document:
        """Return the same document with one requirement only: the requirement of this name, or else the assertion.

        Raises :class:`UsageError` if there is none.
        """
        if name not in self._named:
            raise UsageError(f"there is no requirement '{name}'{choices(name, self._named, 'requirements')}")
        return replace(self, requirements=(self._named[name],), selected=name, origin=self.origin or self)

    def with_formula(self, formula: Formula) -> Document:
        """Return the same document with this formula as its only requirement."""
        first = self.requirements[0]
        return replace(self, requirements=(replace(first, formula=formula),), replaced=True)

    @cached_property
    def names_of(self) -> Mapping[Formula, str]:
        """The first name of each formula that has one."""
        if self._as_in_origin is not None:
            return self._as_in_origin.names_of
        names: dict[Formula, str] = {}
        for assertion in self.assertions:
            if assertion.name:
                names.setdefault(assertion.formula, assertion.name)
        return MappingProxyType(names)

    @cached_property
    def quantified_groups(self) -> Mapping[str, tuple[Group, tuple[str, ...]]]:
        """The groups that quantifiers of the assertions range over, each with the fields of its members."""
        if self._as_in_origin is not None:
            return self._as_in_origin.quantified_groups
        return groups_in(*(assertion.formula for assertion in self.assertions))

    @property
    def _as_in_origin(self) -> Document | None:
        """The document from which this one was selected, if it has the same formulas: what it has found is shared."""
        origin = self.origin
        return origin if origin is not None and origin.assertions is self.assertions else None

    @cached_property
    def _named(self) -> dict[str, Requirement]:
        """The formulas from which :meth:`select` chooses."""
        named = {a.name: Requirement(a.name, a.formula, span=a.span) for a in self.assertions if a.name}
        return {**named, **{requirement.name: requirement for requirement in self.requirements}}


def groups_in(*formulas: Formula) -> Mapping[str, tuple[Group, tuple[str, ...]]]:
    """Return the groups of the quantifiers in formulas, each with the fields of its members, declared or read."""
    found: dict[str, tuple[Group, dict[str, None]]] = {}
    for node in quantifiers(*formulas):
        assert node.op.binder is not None
        group = node.op.binder.group
        found.setdefault(group.name, (group, dict.fromkeys(each.name for each in group.fields)))
    for field_of in fields_of(*formulas):
        assert field_of.group is not None
        found[field_of.group.name][1].setdefault(field_of.field)
    return MappingProxyType({name: (group, tuple(fields)) for name, (group, fields) in found.items()})
