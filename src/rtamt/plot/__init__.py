"""Pictures of results: signals, robustness over time and the explanation, and formulas as trees.

``scene.py`` says what there is to see, as data, which ``clock.py``, ``panels.py`` and ``lines.py`` help to
find; it draws nothing, and the HTML report shows the same scene. ``figure.py`` and ``tree.py`` draw it with
matplotlib, in the colours of ``style.py``.
"""
