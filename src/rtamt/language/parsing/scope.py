"""The names in a formula: constants, named formulas, declared variables."""

from __future__ import annotations

from functools import cached_property
from types import MappingProxyType

from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rtamt.language.formula import Formula
    from rtamt.language.parsing.templates import Argument, Template
    from rtamt.language.quantifiers import Group
    from rtamt.language.records import Operator
    from rtamt.language.value_types import Enumeration, ValueType


@dataclass(eq=False)  # not frozen, which would take thrice as long to make: nothing changes it
class Scope:
    """The meaning of names; with ``variables=None``, every other name is a variable.

    ``pending`` holds names that cannot be used here, each with an explanation; ``arguments`` what the parameters
    of a template stand for, in its formula. ``types``: of variables and constants that are Booleans or of an
    enumeration. ``enumerations``, ``tables`` and ``groups``: by name; ``members``: the groups of the variables of
    quantifiers.
    """

    constants: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    definitions: Mapping[str, Formula] = field(default_factory=lambda: MappingProxyType({}))
    variables: Collection[str] | None = None
    pending: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    templates: Mapping[str, Template] = field(default_factory=lambda: MappingProxyType({}))
    arguments: Mapping[str, Argument] = field(default_factory=lambda: MappingProxyType({}))
    #: The constants that are parameters.
    parameters: Collection[str] = ()
    types: Mapping[str, ValueType] = field(default_factory=lambda: MappingProxyType({}))
    enumerations: Mapping[str, Enumeration] = field(default_factory=lambda: MappingProxyType({}))
    tables: Mapping[str, Operator] = field(default_factory=lambda: MappingProxyType({}))
    groups: Mapping[str, Group] = field(default_factory=lambda: MappingProxyType({}))
    members: Mapping[str, Group] = field(default_factory=lambda: MappingProxyType({}))
    #: The declared units of constants, as written; a bound has that of its constant.
    units: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    def __contains__(self, name: str) -> bool:
        """Return whether a name is declared; a field (``req.value``) is declared if its signal is."""
        if any(name in known for known in (self.definitions, self.constants, self.arguments, self.tables)):
            return True
        declared = self.variables or ()
        return name in declared or name.split(".", 1)[0] in declared

    @cached_property
    def free(self) -> bool:
        """Whether no name has a meaning here, so that every one is a variable."""
        meant = self.constants or self.definitions or self.pending or self.templates or self.arguments
        return self.variables is None and not (meant or self.enumerations or self.tables or self.groups)

    @cached_property
    def typed(self) -> bool:
        """Whether operands may be anything but numbers and formulas; what a template is applied to may be anything."""
        return bool(self.types or self.enumerations or self.arguments or self.members)

    @property
    def names(self) -> tuple[str, ...]:
        """Every declared name."""
        return (*(self.variables or ()), *self.constants, *self.definitions, *self.arguments, *self.tables)

    @property
    def slashes(self) -> int:
        """The largest number of slashes in a declared name."""
        return max((name.count("/") for name in self.names), default=0)
