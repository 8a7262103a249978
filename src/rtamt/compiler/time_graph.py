"""The time-domain-specific part of graphs: nodes, and the steps that windows cover.

It corresponds to ``time_lowering.py``, which decides the same for programs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.language.shares import Rank, rank_of

if TYPE_CHECKING:
    from fractions import Fraction

    from rtamt.language.formula import Interval
    from rtamt.signals.time_domain_interface import TimeDomain


class SampledGraphs:
    """Signals have values at samples only: steps are samples; a closed window contains one more than its length."""

    #: How many steps a closed window contains besides its length.
    point = 1
    #: The node of a signal some steps ahead, which keeps its last value after the last sample.
    ahead = "held"
    #: The node of the recursion of since.
    since = "since"
    #: Whether that recursion leaves out a goal at the present instant.
    goal_apart = False
    #: Whether a sum counts the pulses in a window, which last for one step each.
    pulses = False

    @staticmethod
    def last_before(begin: int) -> int:
        """Return the last step of the closed window for [0, a)."""
        return begin - 1

    @staticmethod
    def rank(interval: Interval | None, step: Fraction) -> Rank:
        """Return the rank of a share of an interval."""
        return rank_of(interval, step, continuous=False)

    @staticmethod
    def rank_windows(low: int, high: int) -> tuple[tuple[int, int], ...]:
        """Return the windows of steps whose ranks together are that of a window."""
        return ((low, high),)


class ContinuousGraphs(SampledGraphs):
    """Signals have values between samples: steps are ticks; a closed window contains as many as its length."""

    point = 0
    ahead = "greatest"
    since = "since_dense"
    goal_apart = True
    pulses = True

    @staticmethod
    def last_before(begin: int) -> int:
        """The closed window that replaces [0, a)."""
        return begin

    @staticmethod
    def rank(interval: Interval | None, step: Fraction) -> Rank:
        """See :class:`SampledGraphs`."""
        return rank_of(interval, step, continuous=True)

    @staticmethod
    def rank_windows(low: int, high: int) -> tuple[tuple[int, int], ...]:
        """A rank holds for whole ticks, and a window covers a part of each of the ticks at its ends.

        See ``core/dense/rank.hpp``.
        """
        return ((low, high - 1), (low + 1, high))


def graphs_of(domain: type[TimeDomain]) -> type[SampledGraphs]:
    """Return the time-domain-specific part of graphs."""
    return ContinuousGraphs if domain.continuous else SampledGraphs
