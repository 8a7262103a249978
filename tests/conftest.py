"""Hypothesis profiles: "dev" while working, "ci" (fixed examples, more of them) where CI=true.

"fuzz", very many examples, is for `make fuzz`. "soak", ten times as many of every test, also of those that
set their own number, is for `make soak`.
"""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from hypothesis import Phase, settings

from rtamt.language.formula import Formula

# Explaining a failure runs it again with every part varied, which takes minutes for a formula.
PHASES = [phase for phase in Phase if phase is not Phase.explain]

settings.register_profile("dev", max_examples=100, deadline=None, phases=PHASES)
settings.register_profile("ci", max_examples=150, deadline=None, phases=PHASES, derandomize=True)
settings.register_profile("soak", max_examples=1000, deadline=None, phases=PHASES)
settings.register_profile("fuzz", max_examples=20_000, deadline=None, phases=PHASES)
settings.load_profile("ci" if os.environ.get("CI") == "true" else "dev")

if TYPE_CHECKING:
    import pytest


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Under "soak", multiply the numbers of examples that tests set themselves."""
    if config.getoption("--hypothesis-profile") != "soak":
        return
    for item in items:
        test = getattr(item, "obj", None)
        test = getattr(test, "__func__", test)
        own = getattr(test, "_hypothesis_internal_use_settings", None)
        if own is not None and own.max_examples != settings().max_examples:
            test._hypothesis_internal_use_settings = settings(own, max_examples=10 * own.max_examples)


# A failing example shows its formula as text, not as nested records of operators.
Formula._repr_pretty_ = lambda formula, printer, _cycle: printer.text(f"<formula {formula}>")
