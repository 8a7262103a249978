"""Laws of bounds and early verdicts, for the definition and for every monitor (``tests/laws/early``)."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from tests.laws.early import soak
from tests.laws.early.laws import NothingToCheck
from tests.laws.early.monitors import IMPLEMENTATIONS

PAIRS = [
    pytest.param(law, made, id=f"{law.__name__} of {made.name}")
    for made in IMPLEMENTATIONS
    for law in soak.laws_of(made)
]


@pytest.mark.parametrize(("law", "made"), PAIRS)
@given(seed=st.integers(0, 2**32))
def test_law(law, made, seed):
    try:
        law(Random(seed), made)  # noqa: S311 - no secret
    except NothingToCheck:
        assume(False)
