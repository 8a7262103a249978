"""A recording that is read in chunks."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rtamt.errors import StlError
    from rtamt.signals.trace import Trace
    from rtamt.specification import Specification


class Chunks:
    """Chunks, and the number of samples so far."""

    def __init__(self, spec: Specification, chunks: Iterator[Trace], *, bound: bool = False) -> None:
        self._chunks = chunks if bound else map(spec.binding.applied, chunks)
        self._counts: Counter[str] = Counter()
        #: The last chunk, whose notes include those of all before.
        self.last: Trace | None = None

    def __iter__(self) -> Iterator[Trace]:
        for chunk in self._chunks:
            if self.last is not None:
                self._counts.update({name: len(self.last[name].values) for name in self.last})
            self.last = chunk
            yield chunk

    def before(self, error: StlError) -> int:
        """Return how many samples the variable that an error is about had before the last chunk."""
        return self._counts[str(getattr(error, "variable", None))]
