"""The time-domain-specific part of lowering.

The number of steps of a closed window, what follows the last sample, and how until over [a, b] is composed
for a > 0.
"""

from __future__ import annotations

from math import inf

from rtamt.compiler.lower import Lowering
from rtamt.language.operators import Tense
from rtamt.lazy.typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fractions import Fraction

    from rtamt.language.formula import Apply
    from rtamt.signals.time_domain_interface import TimeDomain


class SampledLowering(Lowering):
    """Signals have values at samples only: steps are samples; a closed window contains one more than its length."""

    point = 1

    @staticmethod
    def until_just_before(period: Fraction) -> Fraction:
        """Return by how much the closed window for [0, a) is shorter than a."""
        return period

    def ahead_of(self, node: Apply, x: int) -> int:
        """Return x since x: x itself, and its last value after the last sample."""
        distance, _ = self.bounds(node)
        if distance == 0 or self.is_const(x):
            self.known_early = self.known_early or distance > 0
            return x
        return self.add("since", node, x, x, lag=self.lags[x] + distance)

    def until_within(self, node: Apply, hold: int, goal: int, bounds: tuple[int, int], known: int) -> int:
        """φ on [t, t') is "φ on [j - a, j) for every j from t + a to t'".

        So a window over [t + a, t + b] alone sees all of it, and no second delay line is needed.
        """
        begin, end = bounds
        if begin:
            lag = max(self.lags[hold], self.lags[goal])
            before = self.late(self.slid("min", hold, begin, lag, node), lag)
            hold = self.moved(before, 1, inf, lag, node)
            goal = self.add("min", node, hold, goal, lag=lag)
        return self.chain(node, hold, goal, end - begin + 1, known)


class ContinuousLowering(Lowering):
    """Signals have values between samples: steps are ticks; a closed window contains as many as its length."""

    point = 0

    @staticmethod
    def until_just_before(period: Fraction) -> Fraction:
        """Signals are right-continuous: [0, a] and [0, a) differ only at isolated instants."""
        return 0 * period

    def ahead_of(self, node: Apply, x: int) -> int:
        """Continue the trace with its last values."""
        distance, _ = self.bounds(node)
        return self.moved(x, 0, -inf, self.lags[x] + distance, node) if distance else x

    def until_within(self, node: Apply, hold: int, goal: int, bounds: tuple[int, int], known: int) -> int:
        """φ until[a, b] ψ is φ on [t, t + a], and φ until[0, b - a] ψ from t + a on."""
        begin, end = bounds
        width = end - begin
        if begin == 0:
            return self.chain(node, hold, goal, width, known)
        lag = max(self.lags[hold], self.lags[goal])
        after = self.chain(node, hold, goal, width, known)
        if node.op.tense is Tense.FUTURE:
            first = self.add("slide_min", node, hold, n=begin, lag=self.lags[hold] + begin)
            first = self.delayed(first, known)
        else:
            first = self.moved(self.slid("min", hold, begin, lag, node), width, inf, lag, node)
        return self.add("min", node, after, first, lag=known)


def lowering_of(domain: type[TimeDomain]) -> type[Lowering]:
    """Return the lowering of a time domain."""
    return ContinuousLowering if domain.continuous else SampledLowering
