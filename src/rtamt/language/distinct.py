"""Distinct names for formats that have fewer characters."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable


def distinct(names: Iterable[str], written: Callable[[str], str]) -> dict[str, str]:
    """Return how each name is written; a later one that would be written like an earlier one ends in ``_2``, or more.

    >>> distinct(["REQ-1", "REQ_1", "gap"], lambda name: name.replace("-", "_"))
    {'REQ-1': 'REQ_1', 'REQ_1': 'REQ_1_2', 'gap': 'gap'}
    """
    found: dict[str, str] = {}
    taken: set[str] = set()
    for name in names:
        plain = key = written(name)
        number = 1
        while key in taken:
            number += 1
            key = f"{plain}_{number}"
        taken.add(key)
        found[name] = key
    return found
