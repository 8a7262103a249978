"""JSON of lines and messages: no key twice, and numbers beyond the range of a double are told from infinities."""

from __future__ import annotations

import json
from math import isinf
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


class TooLarge(float):
    """A number beyond the range of a double, with its text: only an infinity that is written as such is a value.

    >>> value = loads("[1e999]")[0]
    >>> float(value), value.text
    (inf, '1e999')
    """

    __slots__ = ("text",)

    text: str

    def __new__(cls, text: str) -> TooLarge:
        """Return the number with a text, which is that of a float."""
        value = super().__new__(cls, text)
        value.text = text
        return value


class RepeatedKeyError(ValueError):
    """An object has a key twice."""


def loads(text: str | bytes, constant: Callable[[str], Any] | None = None) -> Any:
    """Return what a text contains; ``constant``: what NaN and Infinity are, which JSON lacks.

    Raises what :func:`json.loads` raises, and :class:`RepeatedKeyError` with the key.
    """
    return json.loads(text, parse_float=_float, parse_constant=constant, object_pairs_hook=_unique)


def _float(text: str) -> float:
    value = float(text)
    return TooLarge(text) if isinf(value) else value


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    data = dict(pairs)
    if len(data) < len(pairs):
        keys = [key for key, _ in pairs]
        raise RepeatedKeyError(next(key for key in keys if keys.count(key) > 1))
    return data
