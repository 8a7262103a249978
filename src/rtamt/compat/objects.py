"""Variables that are objects: the variable of a field, and the fields that hold numbers."""

from __future__ import annotations

from numbers import Real
from typing import Any


def head_of(name: str) -> str:
    """Return the variable to which a name belongs: for a field, the part before the first dot."""
    return name.partition(".")[0]


def numbers_in(held: Any) -> list[str]:
    """Return the names of an object's public fields that hold numbers."""
    return [name for name in dir(held) if name[0] != "_" and isinstance(getattr(held, name, None), Real)]
