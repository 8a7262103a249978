"""A view that needs no widgets: the page in a frame."""

from __future__ import annotations

from html import escape

from rtamt.lazy.dataclasses import dataclass


@dataclass(frozen=True, slots=True, repr=False)
class StaticView:
    """The charts of a result as HTML, which any notebook shows; Python does not see their zoom and cursor.

    ``page``: a complete page. ``summary``: what is shown where frames are not, such as on the pages of repositories.
    ``height``: of the frame, in pixels.
    """

    page: str
    summary: str
    height: int

    def __repr__(self) -> str:
        return "<view of a result: charts in HTML>"

    def _repr_html_(self) -> str:
        # The frame runs the scripts of the page, which has no access to the notebook.
        return (
            f'{self.summary}<iframe title="requirements and charts" sandbox="allow-scripts allow-downloads" '
            f'style="width:100%;height:{self.height}px;border:0" srcdoc="{escape(self.page)}"></iframe>'
        )
