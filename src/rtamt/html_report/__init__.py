"""Write a self-contained HTML report about requirements and recordings.

The report needs no network and no server. The template ``page.html``, the scripts, ``report.css`` and uPlot
(``vendor/``) are embedded in the page; samples are compressed arrays that a card decodes when it is opened.

==========  ==============================================
module      purpose
==========  ==============================================
page        the text of the page, readable without scripts
scene_data  a scene as compact JSON
signals     signals that no requirement reads
store       the arrays of a page, compressed, each once
==========  ==============================================

=============  =====================================================================
script         purpose
=============  =====================================================================
lines.js       decode arrays; what is drawn of a line between two instants
times.js       positions as text, ticks, and what cards of one recording share
chart.js       one chart: lines, intervals, cursors
card.js        one card: its charts, and the formula as a tree
controls.js    legends, tool bar, keys, export
matrix.js      filter, sort, search, deep links, themes
frame.js       zoom and cursor, from and to the page around a frame
=============  =====================================================================
"""

from rtamt.html_report.page import File, Formula, Page, Row, templates

__all__ = ["File", "Formula", "Page", "Row", "templates"]
