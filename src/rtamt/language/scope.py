"""The names in a formula: constants, named formulas, declared variables."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from rtamt.language.formula import Formula


@dataclass(frozen=True)
class Scope:
    """The meaning of names; with ``variables=None``, every other name is a variable.

    ``pending`` holds names that cannot be used here, each with an explanation.
    """

    constants: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    definitions: Mapping[str, Formula] = field(default_factory=lambda: MappingProxyType({}))
    variables: Collection[str] | None = None
    pending: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))

    def __contains__(self, name: str) -> bool:
        """Return whether a name is declared; a field (``req.value``) is declared if its signal is."""
        if name in self.definitions or name in self.constants:
            return True
        declared = self.variables or ()
        return name in declared or name.split(".", 1)[0] in declared

    @property
    def names(self) -> tuple[str, ...]:
        """Every declared name."""
        return (*(self.variables or ()), *self.constants, *self.definitions)

    @property
    def slashes(self) -> int:
        """The largest number of slashes in a declared name."""
        return max((name.count("/") for name in self.names), default=0)
