"""Rows and cards to the text of a page."""

from __future__ import annotations

import json
from dataclasses import dataclass
from html import escape
from importlib.resources import files
from typing import TYPE_CHECKING

from rtamt.plot import style
from rtamt.report.data import COLUMNS, data_of

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.plot.scene import Scene

_HEAD = ("requirement", "recording", "verdict", "robustness", "first violated", "samples")
_VERDICTS = ("satisfied", "violated", "error")
_SIGNS = {"satisfied": "✓", "violated": "✗", "error": "!"}

#: Nothing is loaded from anywhere, whatever is in the data.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


@dataclass(frozen=True, slots=True)
class Row:
    """What came of one requirement over one recording, as text; ``error`` instead of numbers where it failed."""

    requirement: str
    trace: str
    verdict: str
    robustness: str = ""
    first_violation: str = ""
    samples: str = ""
    error: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Card:
    """A row in pictures: its text, and its data as JSON (a scene may hold the whole recording, a card does not)."""

    title: str
    text: str
    data: str

    @staticmethod
    def of(row: Row, scene: Scene) -> Card:
        """Return the card of a row."""
        data = json.dumps(data_of(scene), allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")
        return Card(f"{row.requirement} · {row.trace}", _told(scene), data)


def page(
    title: str, formulas: Mapping[str, str], rows: Sequence[Row], cards: Mapping[Row, Card] | None = None
) -> str:
    """Return the text of the page: a table of all rows, then a card for each row that has one.

    ``formulas``: of every requirement.
    """
    cards = cards or {}
    numbers = {row: number for number, row in enumerate(cards, 1)}
    verdicts = [row.verdict for row in rows]
    counts = ", ".join(f"{verdicts.count(v)} {v}" for v in _VERDICTS if v in verdicts)
    listed = "\n".join(
        f"<tr><td>{escape(name)}</td><td><code>{escape(text)}</code></td></tr>"
        for name, text in formulas.items()
    )
    head = "".join(f'<th scope="col">{name}</th>' for name in _HEAD)
    body = "\n".join(_row(row, numbers.get(row)) for row in rows)
    told = "\n".join(_card(number, row, cards[row]) for row, number in numbers.items())
    script = f"<script>\n{_file('report.js')}</script>\n" if cards else ""
    return f"""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<meta name="color-scheme" content="light dark">
<meta http-equiv="Content-Security-Policy" content="{_POLICY}">
<title>{escape(title)}: {counts}</title>
<style>
{_file("report.css")}</style>
</head>
<body>
<main>
<h1>{counts}</h1>
<table>
<tr><th scope="col">requirement</th><th scope="col">formula</th></tr>
{listed}
</table>
<table>
<tr>{head}</tr>
{body}
</table>
{told}
</main>
{script}</body>
</html>
"""


def _file(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")


def _row(row: Row, number: int | None) -> str:
    trace = escape(row.trace)
    if number is not None:
        trace = f'<a href="#card-{number}">{trace}</a>'
    first = f"<td>{escape(row.requirement)}</td><td>{trace}</td>"
    verdict = f'<td class="{row.verdict}">{row.verdict}</td>'
    if row.error:
        return f'<tr>{first}{verdict}<td colspan="3">{escape(row.error)}</td></tr>'
    cells = (row.robustness, row.first_violation, row.samples)
    notes = "".join(f'<tr><td colspan="6">note: {escape(note)}</td></tr>' for note in row.notes)
    numbers = "".join(f"<td class=number>{escape(cell)}</td>" for cell in cells)
    return f"<tr>{first}{verdict}{numbers}</tr>{notes}"


def _card(number: int, row: Row, card: Card) -> str:
    return f"""\
<section class="card" id="card-{number}" aria-labelledby="card-{number}-title">
<h2 id="card-{number}-title"><span class="{row.verdict}">{_SIGNS[row.verdict]}</span> {escape(card.title)}</h2>
{card.text}
<script type="application/json">{card.data}</script>
</section>"""


def _told(scene: Scene) -> str:
    """Return what a card says without pictures: the explanation, and the formula as a tree that folds."""
    told = scene.explanation
    kind = "satisfied" if told.satisfied else "violated"
    rows = [
        f"<p><code>{escape(told.formula)}</code></p>",
        f'<p class="{kind}"><b>{escape(scene.verdict)}</b></p>',
    ]
    rows.append(_explanation(scene))
    rows.append('<div class="tools" hidden></div>')
    for number, panel in enumerate(scene.panels):
        names = ", ".join(line.label for line in panel.lines)
        rows.append(f'<div class="chart" data-panel="{number}"><h3>{escape(names)}</h3></div>')
    rows.append(f'<h3 class="above">Robustness, and values at {escape(scene.clock.told(scene.at))}</h3>')
    rows.append(_tree(scene))
    most = max(len(node.line.positions) for node in scene.nodes)
    if most > 4 * COLUMNS:
        rows.append(
            f'<p class="note">Of up to {most} points a line, those are drawn that are the first, lowest, highest '
            f"or last in one of {COLUMNS} parts of the time; where a formula does not hold is joined over gaps "
            f"that are shorter than such a part.</p>"
        )
    return "\n".join(rows)


def _explanation(scene: Scene) -> str:
    """Return the sentences; those about an instant are linked to it."""
    told, point = scene.explanation, scene.critical
    places = {node.formula: number for number, node in enumerate(scene.nodes)}
    critical = escape(told.sentences[1])
    if point is not None:
        critical = _link(critical, point[0], point[1], point[1])
    items = [f"<li>{critical}</li>"]
    stretches = told.sentences[3:]
    if not stretches:
        items += [f"<li>{escape(sentence)}</li>" for sentence in told.sentences[2:]]
        return f'<ul class="why">{"".join(items)}</ul>'
    inner = ""
    for sentence, stretch in zip(stretches, told.implicant, strict=True):
        text, number = escape(sentence.strip()), places.get(stretch.formula)
        if number is not None:
            start = scene.clock.position(stretch.start)
            end = scene.clock.end if stretch.end is None else scene.clock.position(stretch.end)
            text = _link(text, number, start, end)
        inner += f"<li>{text}</li>"
    items.append(f"<li>{escape(told.sentences[2])}<ul>{inner}</ul></li>")
    return f'<ul class="why">{"".join(items)}</ul>'


def _link(text: str, node: int, start: float, end: float) -> str:
    return f'<a class="go" data-node="{node}" data-from="{start!r}" data-to="{end!r}">{text}</a>'


def _tree(scene: Scene) -> str:
    """Return the formula as lists that fold; a sub-formula that stands in several places is shown in the first."""
    shown: set[int] = set()
    pieces: list[str] = []
    best = set(scene.chosen(6))
    stack: list[int | str] = [0]
    while stack:
        step = stack.pop()
        if isinstance(step, str):
            pieces.append(step)
            continue
        if step in shown:
            continue
        shown.add(step)
        node = scene.nodes[step]
        fails = node.fails_at(scene.at)
        name = f"<i>{escape(node.name)}</i> = " if node.name else ""
        number = style.number(node.line.at(scene.at))
        verdict = "violated" if fails else "satisfied"
        pieces.append(
            f'<details{" open" if step in best else ""} data-node="{step}"><summary><code>{name}{escape(node.text)}'
            f'</code> <b class="{verdict}">{style.SIGNS[not fails]} {number}</b></summary>'
            f'<div class="chart" data-node="{step}"></div>'
        )
        stack.append("</details>")
        if node.hidden:
            stack.append('<p class="note">What is below is left out here.</p>')
        stack.extend(reversed(node.children))
    return "\n".join(pieces)
