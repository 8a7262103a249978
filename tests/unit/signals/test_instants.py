"""Sets of cells as intervals do what Python's sets of numbers do."""

from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from rtamt.signals.instants import Cells, StepFunction, two_valued

SETS = st.sets(st.integers(-12, 12))


def cells(numbers):
    return Cells.of((k, k + 1) for k in numbers)


def numbers(found):
    pairs = list(found)
    assert all(begin < end for begin, end in pairs)
    assert all(before[1] < after[0] for before, after in pairwise(pairs)), "apart"
    return {k for begin, end in pairs for k in range(begin, end)}


@given(SETS, SETS, st.integers(-3, 3), st.integers(0, 4))
def test_sets(a, b, before, length):
    assert numbers(cells(a) | cells(b)) == a | b
    assert numbers(cells(a) & cells(b)) == a & b
    assert numbers(cells(a) - cells(b)) == a - b
    assert numbers(cells(a).mirrored()) == {-k for k in a}
    assert numbers(cells(a).widened(before, before + length)) == {
        k + i for k in a for i in range(before, before + length + 1)
    }
    assert numbers(cells(a).within(before, before + length)) == a & set(range(before, before + length))
    assert all((k in cells(a)) == (k in a) for k in range(-14, 15))
    assert cells(a).meets(before, before + length + 1) == bool(a & set(range(before, before + length + 1)))
    assert cells(a).count == len(a)
    assert cells(a).lone == (next(iter(a)) if len(a) == 1 else None)


@given(st.lists(st.integers(0, 3), min_size=1, max_size=12), st.data())
def test_steps(samples, data):
    values = np.array(samples, float)
    steps = StepFunction.of_samples(values)
    begin = data.draw(st.integers(0, len(samples) - 1))
    end = data.draw(st.integers(begin + 1, len(samples)))
    assert [steps.at(k) for k in range(len(samples))] == samples
    changes, found = steps.between(begin, end)
    assert np.repeat(found, np.diff(changes, append=end)).tolist() == samples[begin:end]
    mirrored = steps.mirrored(begin, end)
    assert [mirrored.at(-k) for k in range(begin, end)] == samples[begin:end]
    changed = steps.changed(Cells.of([(begin, end)]), 9.0)
    assert [changed.at(k) for k in range(len(samples))] == samples[:begin] + [9] * (end - begin) + samples[
        end:
    ]
    some = set(data.draw(st.lists(st.integers(0, len(samples) - 1), max_size=6)))
    changed = steps.changed(cells(some), 9.0)
    assert [changed.at(k) for k in range(len(samples))] == [
        9 if k in some else value for k, value in enumerate(samples)
    ]
    first, after = steps.around(begin)
    assert first <= begin < after
    assert set(samples[first:after]) == {samples[begin]}
    assert numbers(steps.positive()) == {k for k, value in enumerate(samples) if value > 0}
    inside = {k for k in range(len(samples)) if begin <= k < end}
    two = two_valued(cells(inside), 1.0, -1.0, len(samples))
    assert numbers(two.positive()) == inside
