"""Results in notebooks: the charts of a report in the output of a cell.

>>> import rtamt
>>> from rtamt.notebook import view
>>> shown = view(rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 2]}))

=========  ==================================================================
module     purpose
=========  ==================================================================
view       the page of a result, and which of the two views shows it
widget     the view whose zoom and cursor Python reads and sets (anywidget)
static     the view that needs no widgets: HTML
=========  ==================================================================
"""

from rtamt.notebook.view import view

__all__ = ["view"]
