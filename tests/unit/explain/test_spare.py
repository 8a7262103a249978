"""Windows that have, or do not have, cells to spare: compared with counting."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt
from rtamt.explain.signals import clipped, near, spliced
from rtamt.explain.spare import ShareWindows
from rtamt.signals.instants import Cells, StepFunction


def cells(numbers):
    return Cells.of((k, k + 1) for k in numbers)


class Case:
    """Windows that have what they need, and the intervals that they have it from."""

    def __init__(self, draw):
        self.before = draw(st.integers(-6, 4))
        self.both = draw(st.sampled_from([None, True, False]))
        self.after = self.before + draw(st.integers(0, 9))
        self.need = draw(st.integers(1, 6))
        self.found = draw(st.sets(st.integers(-4, 40), min_size=15))
        self.asked = {
            k
            for k in draw(st.sets(st.integers(0, 30), min_size=5))
            if self.number(self.found, k) >= self.need
        }
        self.windows = ShareWindows(cells(self.asked), self.before, self.after, self.need, self.both)
        self.intervals = [set(range(*each)) for each in cells(self.found)]

    def number(self, having, k):
        """How many cells count at k."""

        def count(first, last):
            return len(having & set(range(k + first, k + last + 1)))

        if self.both is None:
            return count(self.before, self.after)
        either = count(self.before, self.after - 1), count(self.before + 1, self.after)
        return min(either) if self.both else max(either)

    def failing(self, having):
        return {k for k in self.asked if self.number(having, k) < self.need}


@given(st.data())
def test_a_window_with_too_few_cells_is_found(data):
    case = Case(data.draw)
    left = set().union(*(each for each in case.intervals if data.draw(st.integers(0, 3))))
    failing = {
        k
        for each in case.windows.failing(cells(left), case.windows.lows(cells(case.found)))
        for k in range(*each)
    }
    assert failing <= case.failing(left)
    assert bool(failing) == bool(case.failing(left))


@given(st.data())
def test_neighbours_that_cannot_be_spared_cannot_be_taken_away(data):
    case = Case(data.draw)
    groups = [case.intervals[k : k + 2] for k in range(len(case.intervals))] + [
        [each] for each in case.intervals
    ]
    together = [set().union(*group) for group in groups]
    starts, ends, weights = (
        np.array(list(map(of, together))) for of in (min, lambda each: max(each) + 1, len)
    )
    points = case.windows.lows(cells(case.found))
    counts = case.windows.counts(cells(case.found), points)
    needed = case.windows.cannot_spare(points, counts, starts, ends, weights)
    for group, is_needed in zip(together, needed, strict=True):
        assert not is_needed or case.failing(case.found - group)


def test_what_a_window_cannot_spare_is_recognised():
    windows = ShareWindows(cells(range(5)), 0, 3, 3, None)
    found = cells([0, 1, 3, 4, 5, 6, 8])
    points = windows.lows(found)
    assert windows.cannot_spare(
        points, windows.counts(found, points), np.array([0, 3]), np.array([2, 4]), np.array([2, 1])
    ).tolist() == [True, True]


@given(st.data())
def test_windows_that_have_no_more_than_they_need_are_found(data):
    case = Case(data.draw)
    tight = {k for k in case.asked if case.number(case.found, k) == case.need}
    assert tight <= {k for each in case.windows.tight(cells(case.found)) for k in range(*each)} <= case.asked


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    "text", ["atleast[1:5](60%, x > 0)", "wasatleast[0:4](2s, x > 0)", "wasatleast[2:6](50%, x > 0)"]
)
def test_the_robustness_of_a_share_is_that_of_the_evaluation(time, text):
    x = np.random.default_rng(3).normal(size=20)
    data = {"x": (np.arange(20.0), x)} if time == "dense" else {"x": x}
    result = rtamt.parse(text).evaluate(data, time=time)
    for k in range(20):
        at = np.searchsorted(result.signal.times, k, side="right") - 1
        assert result.explain(at=k).robustness == result.signal.values[at]


def test_functions_are_cut_and_joined():
    steps = StepFunction(np.array([0, 3, 5, 8]), np.array([1.0, 4.0, 2.0, 7.0]), 10)
    cut = near(steps, 4, 6)
    assert (cut.changes.tolist(), cut.values.tolist(), cut.end) == ([0, 5], [4, 2], 10)
    limited = clipped(steps, 2.0, 3.0)
    assert (limited.changes.tolist(), limited.values.tolist()) == ([0, 3, 5, 8], [2, 3, 2, 3])
    assert clipped(steps, 5.0, 6.0).changes.tolist() == [0, 8]
    joined = spliced(steps, StepFunction(np.array([0, 4]), np.array([8.0, 9.0]), 10), 2, 7)
    assert (joined.changes.tolist(), joined.values.tolist()) == ([0, 2, 4, 7, 8], [1, 8, 9, 2, 7])
    assert spliced(steps, cut, -3, 12).changes.tolist() == cut.changes.tolist()
