"""For those who extend the language: one call that holds an operator to the generic laws.

Needs hypothesis, which ``pip install "rtamt[testing]"`` brings.

>>> from rtamt.extend import STL
>>> from rtamt.testing import check_operator
>>> check_operator(STL["since"], examples=5)
"""

from __future__ import annotations

try:
    import hypothesis  # noqa: F401 - asked for here, so that the sentence is this one
except ImportError as error:
    raise ImportError(
        "rtamt.testing needs hypothesis, which is not installed; pip install 'rtamt[testing]'"
    ) from error

from rtamt.testing.laws import check_operator

__all__ = ["check_operator"]
