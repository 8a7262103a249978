"""Rewrite formulas with pure functions from formula to formula.

==================  =================================================================================
module              purpose
==================  =================================================================================
check               reject formulas that cannot be evaluated: bounds, time domain, boundedness
desugar             expand derived operators
early               whether bounds are tight, and whether early verdicts hold at the end
ground              half-open bounds to closed ones, once the length of a period or tick is known
horizon             how far a formula looks ahead (the paper's Definition 3)
quantifiers         quantifiers to formulas over the members of groups
quantifier_streams  quantifiers to formulas over one member, for streams in which members come and go
merge               equal parts become one node
partial             operations that may have no value, and numbers for which each has one
pastify             bounded future to past (the paper's Definition 4)
presence            ``valid(x)`` where samples may be missing
recipes             the expansions of built-in operators, whatever the operands
semantics           replace predicates according to a semantics; the table of semantics
truth               formulas as conditions, +inf or -inf under every semantics
structure           split a formula into predicates, minimum and maximum
==================  =================================================================================
"""
