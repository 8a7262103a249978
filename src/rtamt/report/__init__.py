"""Write a self-contained HTML report about requirements and recordings.

The report needs no network and no server. ``report.js`` and ``report.css`` are embedded in the page.

======  ==============================================
module  purpose
======  ==============================================
page    the text of the page, readable without scripts
data    a scene as compact JSON for ``report.js``
======  ==============================================
"""

from rtamt.report.page import Card, Row, page

__all__ = ["Card", "Row", "page"]
