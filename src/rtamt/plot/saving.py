"""Write a figure to a file."""

from __future__ import annotations

import re
import warnings
from typing import Any

from rtamt.files import replacing

#: matplotlib's warning that its fonts lack a character.
_MISSING = re.compile(r"Glyph (\d+) .*missing from ")


def save(figure: Any, path: str, dpi: int) -> tuple[str, ...]:
    """Write a figure completely or not at all; return notes on characters that its fonts lack, which are boxes."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        with replacing(path) as new:
            figure.savefig(new, dpi=dpi)
    lacking: dict[str, None] = {}
    for each in caught:
        if found := _MISSING.match(str(each.message)):
            lacking[chr(int(found[1]))] = None
        else:
            warnings.warn_explicit(each.message, each.category, each.filename, each.lineno)
    if not lacking:
        return ()
    return (f"the fonts of the plot lack {' '.join(lacking)}, drawn as boxes",)
