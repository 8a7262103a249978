"""A view whose zoom and cursor Python reads and sets, with anywidget."""

from __future__ import annotations

import zlib
from importlib.resources import files
from typing import TYPE_CHECKING, Any

import anywidget
import traitlets

if TYPE_CHECKING:
    from rtamt.notebook.static import StaticView


class ResultWidget(anywidget.AnyWidget):
    """The charts of a result; ``zoom`` and ``cursor`` are positions on the axis of time, in seconds.

    Positions of recordings with dates, or whose timestamps start far from 0, count from the first sample.
    """

    _esm = files(__package__).joinpath("widget.js").read_text(encoding="utf-8")
    #: A complete page, which the notebook shows in a frame; compressed, because the output of the cell has it as HTML.
    _page = traitlets.Bytes().tag(sync=True)
    #: The height of the frame, in pixels.
    height = traitlets.Int().tag(sync=True)
    #: Begin and end of the visible time span; empty before the charts are drawn. Setting it zooms all charts.
    zoom: traitlets.List[float] = traitlets.List(traitlets.Float()).tag(sync=True)
    #: The position of the cursor; None if there is none. Setting it moves the cursor.
    cursor = traitlets.Float(None, allow_none=True).tag(sync=True)

    def __init__(self, static: StaticView, **traits: Any) -> None:
        super().__init__(_page=zlib.compress(static.page.encode()), height=static.height, **traits)
        self._static = static

    @property
    def page(self) -> str:
        """The complete page."""
        return self._static.page

    @traitlets.validate("zoom")
    def _in_order(self, proposal: Any) -> list[float]:
        ends: list[float] = proposal["value"]
        if ends and not (len(ends) == 2 and ends[0] < ends[1]):
            raise traitlets.TraitError(
                f"zoom is {ends}, expected two positions in seconds, the first before the second"
            )
        return ends

    def _repr_mimebundle_(self, **options: Any) -> Any:
        bundle = super()._repr_mimebundle_(**options)
        if bundle is None:
            return None
        data, metadata = bundle
        # A notebook that is read without its kernel shows this.
        return {**data, "text/html": self._static._repr_html_()}, metadata
