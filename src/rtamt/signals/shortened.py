"""Step functions over fewer cells: where all of them are constant for long, the middle is left out.

A formula of minima and maxima over windows has one value there, too, as soon as its bounded windows contain
nothing else: see ``settling``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.instants import StepFunction
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rtamt.signals.instants import Ints


@dataclass(frozen=True, slots=True, eq=False)
class Shortened:
    """Stretches of cells, each from one of ``starts`` to the next, of which at most 2 * ``margin`` cells are kept.

    ``places``: where each stretch starts when the others are shortened.

    >>> steps = StepFunction(np.array([0, 3]), np.array([1.0, 2.0]), 100)
    >>> short = Shortened.of([steps], margin=2)
    >>> short.end, short.of_function(steps).changes.tolist()
    (7, [0, 3])
    >>> short.cells(np.array([3, 4, 5, 6])).tolist()
    [3, 4, 98, 99]
    """

    starts: Ints
    places: Ints
    margin: int
    #: The number of cells, and how many are kept.
    whole: int
    end: int

    @classmethod
    def of(cls, functions: Iterable[StepFunction], margin: int) -> Shortened:
        """Shorten what all functions have in common; at least one of them is given."""
        functions = list(functions)
        starts, whole = merged([steps.changes for steps in functions]), functions[0].end
        kept = np.minimum(np.diff(starts, append=whole), 2 * margin)
        places = np.cumsum(kept)
        return cls(starts, places - kept, margin, whole, int(places[-1]))

    def of_function(self, steps: StepFunction) -> StepFunction:
        """Return one of the functions over the cells that are kept."""
        return StepFunction(self.places[np.searchsorted(self.starts, steps.changes)], steps.values, self.end)

    def cells(self, kept: Ints) -> Ints:
        """Return which cells those that are kept were: the first and the last of each stretch."""
        stretch = np.searchsorted(self.places, kept, side="right") - 1
        offset = kept - self.places[stretch]
        left_out = np.diff(self.starts, append=self.whole) - np.diff(self.places, append=self.end)
        found: Ints = self.starts[stretch] + offset + np.where(offset < self.margin, 0, left_out[stretch])
        return found

    def back(self, steps: StepFunction) -> StepFunction:
        """Return a function of the cells that are kept as one of all cells: it is constant over those left out."""
        return StepFunction(self.cells(steps.changes), steps.values, self.whole)
