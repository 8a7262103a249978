"""Why a formula is satisfied or violated: which instants of which signals are responsible.

Two answers: the *critical point* (``critical.py``), the predicate and the instant whose value is the
robustness; and the *implicant* (``demands.py``, ``choices.py``, ``needs.py``, ``minimise.py``), intervals of
predicates that force the verdict whatever the signals do elsewhere, none of which can be left out.
``structure.py`` takes the formula apart, ``timeline.py`` asks the engine, ``report.py`` and
``sentences.py`` say what was found.
"""
