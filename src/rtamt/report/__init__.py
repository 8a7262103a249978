"""One HTML file about requirements and recordings that needs nothing else: no network, no server.

``page.py`` writes the text, which can be read without scripts; ``data.py`` what ``report.js`` draws into it,
in the colours of ``report.css``.
"""

from rtamt.report.page import Card, Row, page

__all__ = ["Card", "Row", "page"]
