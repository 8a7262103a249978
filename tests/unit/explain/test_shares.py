"""Instants for a share of many windows: enough for each, and none to spare."""

import pickle
from time import process_time

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import rtamt
from rtamt.explain import shares
from rtamt.explain.explanation import Listed
from rtamt.explain.forcing import Forcing
from rtamt.explain.shares import sharing, windows_with
from rtamt.signals.instants import Cells


def cells(numbers):
    return Cells.of((k, k + 1) for k in numbers)


@given(st.sets(st.integers(0, 30)), st.integers(-6, 4), st.integers(0, 7), st.integers(1, 8))
def test_windows_with_enough_cells_are_those_counted(inside, before, width, need):
    after = before + width
    found = [k for begin, end in windows_with(cells(inside), before, after, need) for k in range(begin, end)]
    windows = {k: inside & set(range(k + before, k + after + 1)) for k in range(-20, 50)}
    assert found == [k for k, window in windows.items() if len(window) >= need]


@given(
    st.sets(st.integers(0, 30)),
    st.booleans(),
    st.booleans(),
    st.integers(-6, 4),
    st.integers(0, 7),
    st.data(),
)
def test_every_window_has_what_it_needs_and_no_cell_can_be_left_out(
    inside, earlier, later, before, width, data
):
    outside = set(range(-9, 0) if earlier else ()) | set(range(31, 45) if later else ())
    found, after = inside | outside, before + width
    need = data.draw(st.integers(1, width + 1))

    def enough(having, k):
        return len(having & set(range(k + before, k + after + 1))) >= need

    asked = [k for k in range(31) if enough(found, k) and data.draw(st.integers(0, 4))]
    given_cells = cells(found) & cells(asked).widened(before, after)
    taken = {
        k for begin, end in sharing(cells(asked), given_cells, before, after, need) for k in range(begin, end)
    }
    assert taken <= found
    chosen = taken & inside
    assert all(enough(chosen | outside, k) for k in asked)
    for left_out in chosen:
        assert not all(enough((chosen | outside) - {left_out}, k) for k in asked)


@given(
    st.sets(st.integers(-9, 45)),
    st.integers(-12, 9),
    st.integers(0, 7),
    st.integers(1, 8),
    st.sets(st.integers(-3, 31)),
)
@example(set(range(45)), 0, 3, 2, set(range(6)))
def test_the_core_takes_the_cells_that_the_sweep_takes(found, before, width, need, places):
    after = before + width
    asked = {k for k in places if len(found & set(range(k + before, k + after + 1))) >= need}
    having = cells(found) & cells(asked).widened(before, after)
    taken = sharing(cells(asked), having, before, after, need)
    assert list(taken) == list(shares._Sweep(having, before, after, need).over(cells(asked)))


def test_a_share_of_many_windows_is_not_tried_interval_by_interval(monkeypatch):
    monkeypatch.delattr(Forcing, "failures")
    x = np.random.default_rng(0).normal(size=20_000)
    explanation = rtamt.parse("always(atleast[0:1000](50%, x > -0.5))").evaluate({"x": x}).explain()
    assert explanation.satisfied
    assert len(explanation.causes) > 2000


@pytest.mark.parametrize("share", ["20%", "95%"])
def test_a_share_in_dense_time_is_not_tried_interval_by_interval(monkeypatch, share):
    monkeypatch.delattr(Forcing, "failures")
    data = np.random.default_rng(0)
    times, x = np.cumsum(data.integers(1, 9, 3000)), data.normal(size=3000)
    spec = rtamt.parse(f"atleast[0:{times[-1] - times[0]}s]({share}, x > -0.5)", time="dense")
    explanation = spec.evaluate({"x": (times.astype(float), x)}).explain()
    assert explanation.satisfied == (share == "20%")
    taken = sum(each.end - each.start for each in explanation.implicant)
    whole = (times[-1] - times[0]) * (0.2 if explanation.satisfied else 0.05)
    assert whole <= taken <= whole + max(each.end - each.start for each in explanation.implicant)


def test_causes_are_made_when_they_are_read():
    made = []
    listed = Listed(1000, lambda k: made.append(k) or k)
    assert (listed[3], listed[-1], listed[3], len(listed)) == (3, 999, 3, 1000)
    assert made == [3, 999]
    assert listed == tuple(range(1000))
    assert hash(listed) == hash(tuple(range(1000)))
    assert listed[:2] == (0, 1)
    assert listed != tuple(range(999))


def test_an_explanation_can_be_pickled():
    explanation = rtamt.parse("always(maximum[0:2](x) > 3)").evaluate({"x": [5, 1, 1, 1]}).explain()
    twin = pickle.loads(pickle.dumps(explanation))
    assert (twin.implicant, twin.critical, str(twin)) == (
        explanation.implicant,
        explanation.critical,
        str(explanation),
    )


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_violated_until_over_shares_was_explained_in_quadratic_time(time):
    """Each cause was tried alone over the whole recording: 100 000 samples took minutes."""
    n = 100_000
    random = np.random.default_rng(3)
    data = {"time": np.arange(n) * 1.0, "a": random.normal(size=n), "b": random.normal(size=n)}
    data["b"][:99_000] = 0.0
    data["b"][99_000] = -5.0
    result = rtamt.parse("(b >= -4.5) until (atleast[0:100](90%, a >= 1))", time=time).evaluate(data)
    start = process_time()
    explanation = result.explain()
    assert process_time() - start < 30
    assert not explanation.satisfied
    assert len(explanation.causes) > 1
