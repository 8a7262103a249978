"""The keys of a fleet as the core reads them, and in errors."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def place_of(key: Any, index: int | None) -> str:
    """Return where a sample is, for an error: in the batch, or among those that waited."""
    if index is None:
        return f"key {key!r}, a sample that waited"
    return f"key {key!r} at index {index} of the batch"


def full(where: str, capacity: int) -> UsageError:
    """Return the error for a key that has no room."""
    return UsageError(
        f"{where} is new, and the fleet has its {capacity} keys already; drop or expire keys, or make "
        f"a fleet of a larger capacity"
    )


def rows_of(keys: NDArray[Any]) -> NDArray[Any]:
    """Return keys as the core reads them: texts and bytes as rows of characters."""
    if keys.dtype.kind == "i":
        return keys
    width = keys.dtype.itemsize // (4 if keys.dtype.kind == "U" else 1)
    return keys.view(np.uint32 if keys.dtype.kind == "U" else np.uint8).reshape(len(keys), width)


def sentence(error: ValueError) -> str:
    """Return the message of the core as the sentence of an error."""
    text = str(error).rstrip(".")
    return text[:1].lower() + text[1:]
