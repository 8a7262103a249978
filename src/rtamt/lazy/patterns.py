"""Regular expressions that are compiled at their first use: to compile ours took a tenth of the start-up of a monitor.

>>> word = lazy_pattern("[a-z]+")
>>> word.fullmatch("word")[0]
'word'
"""

from __future__ import annotations

import re

from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from re import compile as lazy_pattern
else:

    class lazy_pattern:  # noqa: N801 - it replaces the function re.compile
        """Compiled when an attribute is first read; its attributes are those of the expression."""

        def __init__(self, text: str, flags: int = 0) -> None:
            self.pattern = text
            self._flags = flags

        def __getattr__(self, name: str) -> Any:
            found = self.__dict__[name] = getattr(re.compile(self.pattern, self._flags), name)
            return found


__all__ = ["lazy_pattern"]
