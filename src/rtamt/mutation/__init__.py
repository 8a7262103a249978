"""Mutate requirements: changes that no recording detects show where a requirement, or the recordings, can be tightened.

>>> import rtamt
>>> from rtamt.mutation import mutate
>>> found = mutate(rtamt.parse("always(x >= 3)"), {"drive": {"x": [5, 3, 4]}})
>>> found.score, [mutant.change for mutant in found.survivors]
(0.5714285714285714, ['always(x >= 3) → eventually(x >= 3)', 'always(x >= 3) → x >= 3', 'x >= 3 → x >= 2.7'])

==============  ================================================================
module          purpose
==============  ================================================================
mutate          evaluate the mutants on recordings; which recording kills which
mutants         the mutants of a specification
operators       the mutation operators: what they change in a formula
equal_formulas  keys of formulas that are trivially equal
plot            the matrix of mutants and recordings
==============  ================================================================
"""

from rtamt.mutation.mutants import Mutant, mutants_of
from rtamt.mutation.mutate import Mutation, mutate

__all__ = ["Mutant", "Mutation", "mutants_of", "mutate"]
