"""A band of values: a function changes far less often where only values close to one of them are told apart."""

from __future__ import annotations

from math import copysign, inf, nextafter
from typing import TYPE_CHECKING

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.signals.instants import StepFunction

if TYPE_CHECKING:
    from collections.abc import Iterable

#: One of as many values is in a band above the value that it is made for, and one below.
_PARTS = 64
#: As many values cost little.
_FEW = 2**12
#: From as many values the edges of a band are estimated.
_SAMPLE = 2**16


@dataclass(frozen=True, slots=True)
class Band:
    """The values whose magnitude is between two numbers, which stand for those beyond: 0 for the smaller ones.

    This commutes with minimum, maximum and negation, and so with all operators over predicates: a value that is found
    in the band is exact.
    """

    low: float
    high: float

    def contains(self, value: float) -> bool:
        """Return whether a value is told apart from all others."""
        above = not self.low or self.low < abs(value)
        return above and (abs(value) < self.high or self.high == inf)

    def edge(self, value: float, toward: float) -> float:
        """Return the last value in the band on the way from another one in it to -inf or +inf."""
        inward = self.low and (value > 0) != (toward > 0)
        return nextafter(copysign(self.low, value) if inward else copysign(self.high, toward), value)

    def of(self, steps: StepFunction) -> StepFunction:
        """Return a function of values in the band."""
        values = np.clip(steps.values, -self.high, self.high)
        values[np.abs(values) < self.low] = 0
        new = np.append(True, values[1:] != values[:-1])
        return StepFunction(steps.changes[new], values[new], steps.end)


def band_around(value: float, functions: Iterable[StepFunction]) -> Band | None:
    """Return a narrow band of the values of functions that contains one; None where that is not worth it."""
    every = [steps.values for steps in functions]
    count = sum(map(len, every))
    if count < _FEW or abs(value) == inf:
        return None
    step = -(-count // _SAMPLE)
    magnitudes = np.sort(np.abs(np.concatenate([values[::step] for values in every])))
    first, last = (int(np.searchsorted(magnitudes, abs(value), side=side)) for side in ("left", "right"))
    reach = len(magnitudes) // _PARTS
    low = float(magnitudes[first - reach - 1]) if first > reach else 0.0
    high = float(magnitudes[last + reach]) if last + reach < len(magnitudes) else inf
    return Band(low, high)
