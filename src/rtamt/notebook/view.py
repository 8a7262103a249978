"""The page of a result, and which of the two views shows it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import UsageError, shown
from rtamt.html_report import Formula, Page, Row
from rtamt.lazy.dataclasses import replace
from rtamt.notebook.static import StaticView
from rtamt.plot.band import short_band
from rtamt.plot.scene import scene
from rtamt.signals.listing import show_time
from rtamt.violations import first_violation

if TYPE_CHECKING:
    from rtamt.notebook.widget import ResultWidget
    from rtamt.results import Result

_HEIGHT = 620


def view(result: Result, *, at: Any = None, height: int = _HEIGHT) -> ResultWidget | StaticView:
    """Show a result in the output of a notebook's cell: verdicts, charts and explanation.

    Charts zoom and have cursors and marks; parts of the formula unfold; each sentence of the explanation zooms to its
    time. ``at``: the instant to explain, as in :meth:`Result.explain`. ``height``: of the view, in pixels.

    Returns a widget whose ``zoom`` and ``cursor`` Python reads and sets; where anywidget is not installed
    (``pip install 'rtamt[notebook]'``), a view that shows the same. Raises :class:`UsageError` if jinja2 is
    missing, or if the result has only bounds.

    >>> import rtamt
    >>> result = rtamt.parse("always(x >= 3)").evaluate({"x": [5, 4, 2]})
    >>> shown = view(result, height=400)
    >>> shown.height
    400
    """
    if type(height) is not int or height <= 0:
        raise UsageError(f"height is {shown(height)}, expected a whole number of pixels")
    static = StaticView(_page(result, at), result._repr_html_(), height)
    try:
        from rtamt.notebook.widget import ResultWidget
    except ImportError:
        return static
    return ResultWidget(static)


def _page(result: Result, at: Any) -> str:
    parts = result.requirements
    written = {each.name: each.description for each in result.specification.document.requirements}
    formulas = {
        name: Formula(str(part.specification.formula), written.get(name, "")) for name, part in parts.items()
    }
    page = Page("rtamt.notebook.view", formulas)
    for name, part in parts.items():
        part._require_exact("view")
        violated = first_violation(part)
        row = Row(
            name,
            "recording",
            "satisfied" if violated is None else "violated",
            f"{part.robustness:.6g}",
            "" if violated is None else show_time(violated, part.signal.times[0]),
            str(part.trace.samples),
        )
        page.add(row, replace(scene(part, at), band=short_band(part)))
    return page.text()
