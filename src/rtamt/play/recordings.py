"""Recordings that the user loads, by number; messages name them as the user does, without their folder."""

from __future__ import annotations

from collections import OrderedDict
from typing import TYPE_CHECKING, Any

from rtamt.errors import StlError, TraceError
from rtamt.lazy.dataclasses import dataclass
from rtamt.readers.read import read

if TYPE_CHECKING:
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification

#: How many recordings a process keeps in memory.
_KEPT = 4


@dataclass(frozen=True, slots=True)
class File:
    """A recording on the machine: its path, and the name shown to the user."""

    number: int
    path: str
    name: str

    def without_folder(self, text: str) -> str:
        """Return a sentence about the file without its folder."""
        return text.replace(self.path, self.name)


class Recordings:
    """The recordings read so far, the most recent last."""

    def __init__(self) -> None:
        self._read: OrderedDict[tuple[Any, ...], Trace] = OrderedDict()

    def trace(self, file: File, spec: Specification | None = None) -> Trace:
        """Return a recording; text columns become the codes of the specification's enumerations."""
        types = {} if spec is None else spec.types
        key = (file.number, tuple(sorted((name, str(kind)) for name, kind in types.items())))
        found = self._read.get(key)
        if found is None:
            try:
                found = read(file.path, types=types) if types else read(file.path)
            except StlError as error:
                raise TraceError(file.without_folder(str(error))) from None
            while len(self._read) >= _KEPT:
                self._read.popitem(last=False)
            self._read[key] = found
        self._read.move_to_end(key)
        return found

    def summary(self, file: File) -> dict[str, Any]:
        """Return the facts about a recording that the page lists."""
        trace = self.trace(file)
        units = trace.units
        longest = max((len(trace[name].values) for name in trace.names), default=0)
        return {
            "number": file.number,
            "name": file.name,
            "samples": longest,
            "signals": [{"name": name, "unit": units.get(name, "")} for name in trace.names],
            "notes": [file.without_folder(note) for note in trace.notes],
        }
