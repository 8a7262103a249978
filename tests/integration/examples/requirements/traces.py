"""Made traces for ``examples/requirements``: for each requirement one that satisfies it and one that violates it.

A trace has ``length`` samples; a column is a number, a list (whose last value goes on) or a function of the index.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf
from typing import Any

import numpy as np

Columns = dict[str, Any]


@dataclass(frozen=True)
class Traces:
    """The traces for one file: ``common`` columns, and for each requirement what differs, first good, then bad."""

    length: int
    common: Columns
    cases: dict[str, tuple[Columns, Columns]] = field(default_factory=dict)

    def made(self, changed: Columns) -> dict[str, np.ndarray]:
        """Return a trace."""
        columns = {**self.common, **changed}
        return {
            name: np.array([_at(value, i) for i in range(self.length)]) for name, value in columns.items()
        }


def _at(value: Any, i: int) -> float:
    if isinstance(value, list):
        value = value[min(i, len(value) - 1)]
    return float(value(i) if callable(value) else value)


def step(begin: int, value: float, before: float = 0.0, end: float = inf) -> Any:
    """Return a column that has another value from ``begin`` on, until ``end``."""
    return lambda i: value if begin <= i < end else before
