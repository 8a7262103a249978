"""Hypothesis profiles: "dev" while working, "ci" (fixed examples, more of them) where CI=true.

"fuzz", very many examples, is for `make fuzz`.
"""

import os

from hypothesis import Phase, settings

from rtamt.language.formula import Formula

# Explaining a failure runs it again with every part varied, which takes minutes for a formula.
PHASES = [phase for phase in Phase if phase is not Phase.explain]

settings.register_profile("dev", max_examples=100, deadline=None, phases=PHASES)
settings.register_profile("ci", max_examples=150, deadline=None, phases=PHASES, derandomize=True)
settings.register_profile("fuzz", max_examples=20_000, deadline=None, phases=PHASES)
settings.load_profile("ci" if os.environ.get("CI") == "true" else "dev")

# A failing example shows its formula as text, not as nested records of operators.
Formula._repr_pretty_ = lambda formula, printer, _cycle: printer.text(f"<formula {formula}>")
