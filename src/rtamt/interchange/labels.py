"""Names of requirements in files of tools whose names are of letters, digits and underscores."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Collection


def label_of(name: str, taken: Collection[str]) -> str:
    """Return the name of a requirement as such a tool reads it, and none of those that are taken.

    >>> label_of("R-1", set()), label_of("1st", set()), label_of("R 1", {"R_1", "R_1_2"})
    ('R_1', 'R_1st', 'R_1_3')
    """
    label = re.sub(r"\W", "_", name, flags=re.ASCII)
    if not label[:1].isalpha():
        label = f"R_{label}"
    found, number = label, 1
    while found in taken:
        number += 1
        found = f"{label}_{number}"
    return found
