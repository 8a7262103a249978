"""Names of :mod:`typing`, which is not imported: a start-up of a monitor took a twentieth longer with it.

Annotations are not evaluated, so that these names only need to exist when a program runs. Modules that a monitor needs
take them from here; a type checker reads those of the standard library.

>>> Count: TypeAlias = Literal[1, 2]
>>> Any is Count is TypeVar("T")
True
>>> cast(int, "one")
'one'
"""

from __future__ import annotations

TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import (
        Any,
        ClassVar,
        Concatenate,
        Literal,
        ParamSpec,
        Protocol,
        SupportsFloat,
        TypeAlias,
        TypeGuard,
        TypeVar,
        cast,
        overload,
    )
else:

    class Any:
        """Stands for every type; a class, since it may be the base of one or a part of a union."""

        def __class_getitem__(cls, _parameters: object) -> type:
            return cls

    ClassVar = Concatenate = Literal = Protocol = SupportsFloat = TypeAlias = TypeGuard = Any

    def _type_variable(_name: str, **_options: object) -> type:
        """Return a type, which is not read."""
        return Any

    TypeVar = ParamSpec = _type_variable

    def cast(_kind: object, value: object) -> object:
        """Return the value."""
        return value

    def overload(signature: object) -> object:
        """Return the signature, which the implementation replaces."""
        return signature


__all__ = [
    "TYPE_CHECKING",
    "Any",
    "ClassVar",
    "Concatenate",
    "Literal",
    "ParamSpec",
    "Protocol",
    "SupportsFloat",
    "TypeAlias",
    "TypeGuard",
    "TypeVar",
    "cast",
    "overload",
]
