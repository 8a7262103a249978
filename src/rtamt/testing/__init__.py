"""Test custom operators against the laws that every operator obeys.

This package needs hypothesis: ``pip install "rtamt[testing]"``.

>>> from rtamt.extend import STL
>>> from rtamt.testing import check_operator
>>> check_operator(STL["since"], examples=5)

==========  =======================================================
module      purpose
==========  =======================================================
laws        ``check_operator``, and the laws of discrete time
dense_laws  the laws of dense time
case        the operator under test, and the report of a broken law
strategies  random formulas, traces and chunkings
members     random formulas with quantifiers, and scenes of members that appear and disappear
==========  =======================================================
"""

from __future__ import annotations

try:
    import hypothesis  # noqa: F401 - imported first, for this error message
except ImportError as error:
    raise ImportError(
        "rtamt.testing needs hypothesis, which is not installed; pip install 'rtamt[testing]'"
    ) from error

from rtamt.testing.laws import check_operator

__all__ = ["check_operator"]
