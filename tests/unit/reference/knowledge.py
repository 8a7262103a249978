"""What is known of a trace, written as lists of values and pairs."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from rtamt.language.definitions.enclosures import Enclosure
from rtamt.reference.discrete_bounds import Knowledge

ONE = Fraction(1)


def known(n: int | None = None, *, finished: bool = False, ranges=None, **columns) -> Knowledge:
    enclosures = {}
    for name, values in columns.items():
        pairs = [v if isinstance(v, tuple) else (v, v) for v in values][:n]
        enclosures[name] = Enclosure(*(np.array([pair[k] for pair in pairs], float) for k in (0, 1)))
    return Knowledge(enclosures, len(next(iter(enclosures.values())).lower), ranges or {}, finished)
