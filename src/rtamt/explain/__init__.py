"""Explain why a formula is satisfied or violated: which signals, and when.

An explanation has two parts. The *critical point* is the predicate and the time that determine the robustness.
The *implicant* is a set of intervals of predicates that is sufficient for the verdict, independent of all other
samples; no interval can be removed.

===========  =======================================================================
module       purpose
===========  =======================================================================
explain      a formula and a recording to an explanation
signals      values of sub-formulas, and where they hold
critical     the critical point
propagate    required truth values, from the verdict down to the predicates
necessary    intervals that every implicant contains
witnesses    choose between several sufficient operands or times
shares       choose instants for a share of each of many windows
bands        a band of values around the robustness
spare        windows of a share that have no cell to spare
intervals    intervals of predicates, and groups of them
forcing      whether intervals force the verdict
minimise     remove intervals while the verdict is still forced
moves        how the robustness follows the values of predicates
readings     the samples that a predicate depends on
attained     where windows attain their values
description  intervals of predicates and the samples they read, as data and in words
explanation  the explanation as data and text
wording      the sentences of an explanation, the same in every output
===========  =======================================================================

Exact properties, which the tests verify by experiment:

- If every predicate changes by less than the absolute robustness, the verdict does not change.
- If only the critical value changes, the robustness follows it within the reported interval. The verdict changes
  with it if the interval contains 0, but not if another operand holds as well (``x or y`` with 3 and 2).
  If several places determine the robustness, one that changes the verdict is preferred, if there is any (among
  equal ones, the first that is tried).
- The implicant alone forces the verdict even if every predicate opposes it everywhere else; without any one of the
  intervals it does not. A predicate that occurs both with and without negation counts as two: for ``p or not p``
  the truth of p is reported, although either operand is sufficient.
- The samples that the implicant reads (``Stretch.reads``) are sufficient: if they keep their values, each predicate
  stays at least (where it holds) or at most (where it fails) as large as it is on its interval, whatever all
  other samples are.
- The number of intervals is not guaranteed to be minimal, because the choice between several witnesses is free.
"""
