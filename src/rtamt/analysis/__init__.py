"""Analysis of requirements by a solver: what they allow, without a recording.

``pip install 'rtamt[analysis]'``: z3. Its modules:

===============  ========================================================================
module           purpose
===============  ========================================================================
solver           a small interface to z3: terms, queries, a time limit
values           extended real numbers and verdicts as terms
arithmetic       pointwise operators, by their opcodes
sequences        temporal operators over traces of unknown length
encoder          formulas as terms, by the operator table
problem          the search for traces of at most N samples
witness          a trace that was found, evaluated by the engine
declared         what specifications declare about their data
bounded_checker  queries about traces of at most N samples, and answers as sentences
satisfiability   satisfiable, valid, implies, equivalent: one query each
analysis         all checks of a specification
difference       two versions of a specification
===============  ========================================================================
"""

from rtamt.analysis.analysis import Analysis, analyze
from rtamt.analysis.bounded_checker import Conclusion
from rtamt.analysis.difference import diff
from rtamt.analysis.encoder import NotCoveredError
from rtamt.analysis.satisfiability import equivalent, implies, satisfiable, valid
from rtamt.analysis.witness import Witness

__all__ = [
    "Analysis",
    "Conclusion",
    "NotCoveredError",
    "Witness",
    "analyze",
    "diff",
    "equivalent",
    "implies",
    "satisfiable",
    "valid",
]
