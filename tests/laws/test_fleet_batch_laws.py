"""A batch that the core reads as it is gives what the general conversion gives, to the bit, or the same error."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.engine.discrete.fleet import DiscreteFleet
from tests.laws.test_recording_laws import bits, columns, outcome, stamps

FORMULAS = ["x + y >= 0", "historically[0:2](x >= y)", "sqrt(x) >= y", "eventually[0:1](x > 0) and y >= 0"]


class Converting(DiscreteFleet):
    """Takes every batch the general way."""

    def take(self, *_: Any) -> None:
        """Take nothing."""


def converting(spec: rtamt.Specification, **settings_: Any) -> rtamt.Fleet:
    """Return a fleet that converts every batch."""
    made = rtamt.Fleet(spec, 3, **settings_)
    records: Any = made._samples.records
    records.__class__ = Converting
    return made


@st.composite
def batches(draw: st.DrawFn, first: int) -> tuple[Any, Any, dict[str, Any]]:
    """Draw a sample of each of some keys, a period after the last, and now and then something else."""
    n = draw(st.sampled_from([0, 1, 2, 2, 2, 4]))
    keys: Any = [10, 11, 12, 13][:n]
    if draw(st.booleans()):
        keys = np.array(keys, draw(st.sampled_from(["i8", "i4", "u2"])))
    times = draw(columns(n) if draw(st.integers(0, 5)) == 0 else st.just(np.full(n, float(first))))
    if draw(st.integers(0, 9)) == 0:
        times = draw(stamps(n, float(first)))
    data = {name: draw(columns(n, odd=draw(st.integers(0, 3)) == 0)) for name in ("x", "y")}
    if draw(st.integers(0, 9)) == 0:
        data[draw(st.sampled_from(["x", "z"]))] = draw(columns(n + 1))
    if draw(st.integers(0, 19)) == 0:
        del data["y"]
    return keys, times, data


def facts(update: rtamt.FleetUpdate) -> Any:
    """Return all that an update is made of."""
    released = update.released
    arrays = (update.values, update.known, update.times, update.warming, update.late)
    return [
        bits(each)
        for each in (*arrays, released.keys, released.times, released.values, released.requirements)
    ]


def taken(fleet: rtamt.Fleet, batch: tuple[Any, Any, dict[str, Any]]) -> Any:
    """Return what a batch made known, or the error."""
    return outcome(lambda: facts(fleet.update_many(*batch)))


@settings(max_examples=200)
@given(st.data(), st.sampled_from(FORMULAS), st.sampled_from(["reject", "restart"]))
def test_a_batch_is_taken_as_the_general_conversion_takes_it(
    data: st.DataObject, text: str, gaps: str
) -> None:
    spec = rtamt.parse(text)
    one, other = rtamt.Fleet(spec, 3, gaps=gaps), converting(spec, gaps=gaps)
    for number in range(data.draw(st.integers(1, 4))):
        batch = data.draw(batches(number))
        found, expected = (taken(each, batch) for each in (one, other))
        assert found == expected
        assert one.snapshot() == other.snapshot()


@pytest.mark.parametrize("keys", [np.arange(3), [5, 6, 7], ["a", "b", "c"], [b"a", b"b", b"c"]])
def test_a_plain_batch_is_taken_as_it_is(keys: Any) -> None:
    fleet = rtamt.Fleet(rtamt.parse("x + y >= 0"), 3)
    observations = np.arange(6.0).reshape(3, 2)
    records: Any = fleet._samples.records
    records.columns = None
    update = fleet.update_many(keys, np.zeros(3), {"x": observations[:, 0], "y": [1, 2.5, True]})
    assert update.values.tolist() == [1.0, 4.5, 5.0]
    assert update.known.dtype == update.warming.dtype == update.late.dtype == np.bool_
    assert len(update.released) == 0
