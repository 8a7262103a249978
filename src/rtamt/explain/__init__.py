"""Why a formula is satisfied or violated: which instants of which signals are responsible.

Two answers: the *critical point* (``critical.py``), the predicate and the instant whose value is the
robustness; and the *implicant* (``demands.py``, ``choices.py``, ``needs.py``, ``minimise.py``), intervals of
predicates that force the verdict whatever the signals do elsewhere, none of which can be left out.
``structure.py`` takes the formula apart, ``timeline.py`` asks the engine, ``report.py`` and
``sentences.py`` say what was found.

What holds exactly, and is checked in the tests by doing it:

- If every predicate moves by less than the size of the robustness, the verdict stands.
- If the critical value alone moves, the robustness follows it, cut to an interval that is told; the
  verdict falls with it where 0 lies inside, and not where something else holds too (``x or y``, 3 and 2).
  Where several places give the robustness, one is taken with which the verdict falls, if there is any (of
  many that are equal, the first that are tried).
- On the implicant alone the formula has its verdict when everywhere else each place of each predicate
  speaks against it; without any one of the intervals it has not. A predicate that stands both with and
  without a negation is two for this: for ``p or not p`` the truth of p is told, though either would do.
- No set of fewer intervals is promised: which of several witnesses to rest on is a choice.
"""
