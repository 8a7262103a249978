"""What a specification file says, once it has been read (``specfile.py``)."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from collections.abc import Mapping

    from rtamt.language.formula import Formula, Span


@dataclass(frozen=True, slots=True)
class Import:
    """``from module import name``: a class that can be the type of a variable."""

    module: str
    name: str


@dataclass(frozen=True, slots=True)
class Declaration:
    """A declared variable (with its role, if any) or constant (with its value)."""

    name: str
    type: str
    kind: Literal["var", "const"] = "var"
    role: Literal["input", "output"] | None = None
    value: float | None = None
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Assertion:
    """A formula and the name it was given, if any; earlier names in it are already replaced."""

    name: str | None
    formula: Formula
    span: Span | None = field(default=None, compare=False, repr=False)


@dataclass(frozen=True)
class Document:
    """What a specification text says."""

    text: str
    assertions: tuple[Assertion, ...]
    name: str | None = None
    imports: tuple[Import, ...] = ()
    declarations: tuple[Declaration, ...] = ()
    #: From variable to topic.
    topics: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    #: Every constant a formula may use, by name: declared here, or given to :func:`parse_document`.
    constants: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    #: Every named formula: defined here, or given to :func:`parse_document`.
    definitions: Mapping[str, Formula] = field(default_factory=lambda: MappingProxyType({}))
    #: Every variable declared, here or for :func:`parse_document`; if there is none, all names are free.
    variables: tuple[str, ...] = ()

    def __hash__(self) -> int:
        return hash(self.text)

    def __getstate__(self) -> dict[str, Any]:
        # A read-only view can be neither pickled nor copied; what is behind it can.
        return {k: dict(v) if isinstance(v, MappingProxyType) else v for k, v in self.__dict__.items()}

    def __setstate__(self, state: dict[str, Any]) -> None:
        for name, value in state.items():
            object.__setattr__(self, name, MappingProxyType(value) if isinstance(value, dict) else value)

    @property
    def formula(self) -> Formula:
        """The formula of the last assertion: what the document requires."""
        return self.assertions[-1].formula
