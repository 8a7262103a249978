"""Laws of bounds and early verdicts, for the definition and for every monitor (``tests/laws/early``)."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from tests.laws.early import soak
from tests.laws.early.laws import NothingToCheck
from tests.laws.early.monitors import IMPLEMENTATIONS, PYTHON

#: The Python back end adds little to the definition, which it evaluates again and again.
FEW = 25

#: How many cases are drawn until one of them has something to check, which for some laws few have.
DRAWS = 10


def pairs(*implementations):
    return [
        pytest.param(law, made, id=f"{law.__name__} of {made.name}")
        for made in implementations
        for law in soak.laws_of(made)
    ]


def check(law, made, seed):
    rng = Random(seed)
    for _ in range(DRAWS):
        try:
            law(rng, made)
        except NothingToCheck:
            continue
        return
    assume(False)


@pytest.mark.parametrize(("law", "made"), pairs(*(made for made in IMPLEMENTATIONS if made is not PYTHON)))
@given(seed=st.integers(0, 2**32))
def test_law(law, made, seed):
    check(law, made, seed)


@pytest.mark.parametrize(("law", "made"), pairs(PYTHON))
@settings(max_examples=FEW)
@given(seed=st.integers(0, 2**32))
def test_law_of_the_python_back_end(law, made, seed):
    check(law, made, seed)
