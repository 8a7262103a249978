"""Rows and scenes to the text of a page."""

from __future__ import annotations

import json
import platform
from datetime import datetime, timezone
from importlib.resources import files
from math import inf
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from rtamt.errors import readable
from rtamt.extras import library
from rtamt.html_report.scene_data import data_of
from rtamt.html_report.signals import BUDGET, signals_of
from rtamt.html_report.store import Store
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

    from rtamt.html_report.signals import Signals
    from rtamt.plot.scene import Scene
    from rtamt.plot.x_axis import XAxis
    from rtamt.signals.trace import Trace

_VERDICTS = ("violated", "error", "unchecked", "satisfied")
_SIGNS = {"satisfied": "✓", "violated": "✗", "error": "!", "unchecked": "–"}
#: Sentences about causes that a card holds.
_CAUSES = 200
#: In the order in which they are run.
_SCRIPTS = ("lines.js", "times.js", "chart.js", "card.js", "controls.js", "matrix.js", "frame.js")


@dataclass(frozen=True, slots=True)
class Row:
    """The outcome of one requirement on one trace, as text; ``error`` instead of numbers if it failed."""

    requirement: str
    trace: str
    verdict: str
    robustness: str = ""
    first_violation: str = ""
    samples: str = ""
    error: str = ""
    episodes: str = ""
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class Formula:
    """A requirement as the page shows it."""

    text: str
    description: str = ""


@dataclass(frozen=True, slots=True)
class File:
    """A file of the page: its kind (``what``), its name, and its content or facts about it."""

    what: str
    name: str
    text: str = ""
    facts: str = ""


@dataclass(frozen=True, slots=True)
class Line:
    """A sentence, and the node and the two positions that it is about, if it is about an instant."""

    text: str
    place: tuple[int, float, float] | None = None


@dataclass(slots=True)
class Card:
    """One row in full; ``number`` counts the cards in the order in which they are added."""

    row: Row
    number: int
    formula: str
    description: str
    anchor: str
    headline: str
    title: str = ""
    first: bool = False
    summary: list[Line] = field(default_factory=list)
    causes: list[Line] = field(default_factory=list)
    more: list[Line] = field(default_factory=list)
    hidden: int = 0
    data: str = ""


def templates() -> Any:
    """Return the module jinja2; raises :class:`UsageError` where it is not installed."""
    return library("jinja2", "an HTML report", "report")


class Page:
    """A page, built row by row, so that no trace has to stay in memory."""

    def __init__(self, command: str, formulas: Mapping[str, Formula]) -> None:
        self._jinja = templates()
        self._command = command
        self._formulas = formulas
        self._store = Store()
        self._others = self._store.within(BUDGET)
        self._signals: list[Signals] = []
        self._cards: list[Card] = []

    def add(self, row: Row, scene: Scene | None = None) -> None:
        """Add the outcome of one requirement on one trace; ``scene``: None if nothing can be drawn."""
        formula, description = (
            self._formulas[row.requirement].text,
            self._formulas[row.requirement].description,
        )
        headline = row.verdict if row.error or scene is None else scene.verdict
        card = Card(row, len(self._cards), formula, description, _anchor(row), headline)
        card.title = " · ".join(
            filter(None, (row.requirement, description, row.trace, row.error or headline))
        )
        if scene is not None:
            explanation = scene.explanation
            card.summary, cause = _sentences(scene)
            shown = explanation.shown()
            card.causes = list(map(cause, shown))
            rest = [i for i in explanation.ranking if i not in set(shown)]
            card.more = list(map(cause, sorted(rest[:_CAUSES])))
            card.hidden = len(rest)
            data = data_of(scene, self._store) | {"trace": row.trace}
            card.data = _json(data)
        self._cards.append(card)

    def add_signals(
        self, trace: str, recording: Trace, known: Collection[str], x_axis: XAxis, place: tuple[int, int]
    ) -> str:
        """Add the signals of a recording that no card shows, for its charts; return a summary.

        ``known``: the signals in cards; ``place``: the number of the recording and how many there are.
        """
        signals = signals_of(trace, recording, known, x_axis, self._others, place)
        self._signals.append(signals)
        return signals.summary

    def text(self, sources: Iterable[File] = ()) -> str:
        """Return the text of the page; ``sources``: its specifications and recordings."""
        ordered = sorted(self._cards, key=lambda card: _VERDICTS.index(card.row.verdict))
        if ordered:
            ordered[0].first = ordered[0].row.verdict != "satisfied" or len(ordered) == 1
        verdicts = [card.row.verdict for card in self._cards]
        totals = [(verdict, verdicts.count(verdict)) for verdict in _VERDICTS if verdict in verdicts]
        safe = self._jinja.utils.markupsafe.Markup
        environment = self._jinja.Environment(
            autoescape=True, trim_blocks=False, undefined=self._jinja.StrictUndefined
        )
        for card in ordered:
            card.data = safe(card.data)
        corner, columns, lines = self._matrix()
        import rtamt

        return readable(
            environment.from_string(_file("page.html")).render(
                command=self._command,
                version=rtamt.__version__,
                versions=f"rtamt {rtamt.__version__}, Python {platform.python_version()}, numpy {np.__version__}, "
                f"{platform.system()} {platform.machine()}",
                date=datetime.now(timezone.utc).strftime("%Y-%m-%d %H:%M UTC"),
                counts=", ".join(f"{count} {verdict}" for verdict, count in totals),
                totals=totals,
                any_violated="violated" in verdicts,
                signs=_SIGNS,
                requirements=len(self._formulas),
                traces=list(dict.fromkeys(card.row.trace for card in self._cards)),
                corner=corner,
                columns=columns,
                lines=lines,
                cards=ordered,
                signals=[safe(_json({"trace": s.trace, "lines": s.lines})) for s in self._signals],
                files=list(sources),
                blobs=[{"kind": b.kind, "length": b.length, "text": safe(b.text)} for b in self._store.blobs],
                styles=safe(_file("vendor/uPlot.min.css") + _file("report.css")),
                scripts=safe(_scripts()),
            )
        )

    def _matrix(self) -> tuple[str, Sequence[str], list[dict[str, Any]]]:
        """Return what the first column is, the other columns, and the lines: whichever there are more of are lines."""
        traces = list(dict.fromkeys(card.row.trace for card in self._cards))
        requirements = list(dict.fromkeys(card.row.requirement for card in self._cards))
        places = {(card.row.requirement, card.row.trace): card for card in self._cards}
        across = len(traces) <= len(requirements)
        names, columns = (requirements, traces) if across else (traces, requirements)
        lines: list[tuple[tuple[int, float], dict[str, Any]]] = []
        for order, name in enumerate(names):
            cells = [places.get((name, column) if across else (column, name)) for column in columns]
            worst = min(_severity(cell) for cell in cells if cell)
            description = self._formulas[name].description if across else ""
            line = {"name": name, "order": order, "description": description, "cells": cells}
            lines.append((worst, line))
        ordered = [line for _, line in sorted(lines, key=lambda each: each[0])]
        return ("requirement" if across else "trace"), columns, ordered


def _severity(card: Card) -> tuple[int, float]:
    robustness = float(card.row.robustness) if card.row.robustness else inf
    return _VERDICTS.index(card.row.verdict), robustness


def _anchor(row: Row) -> str:
    """Return the fragment of a card's address, the same in every report about the same names."""
    return "/".join(
        quote(part.encode("utf-8", "surrogateescape"), safe="") for part in (row.requirement, row.trace)
    )


def _sentences(scene: Scene) -> tuple[list[Line], Callable[[int], Line]]:
    """Return the sentences before the causes, and a function that returns the sentence of one cause."""
    explanation, point = scene.explanation, scene.critical
    first = None
    if explanation.first_violation is not None:
        position = scene.x_axis.position(explanation.first_violation)
        first = (0, position, position)
    places: list[tuple[int, float, float] | None] = [None] * len(explanation.summary)
    if first is not None:
        places[1] = first
    if point is not None:
        places[-2] = (point[0], point[1], point[1])
    # The headline is above, and the formula is below.
    summary = [Line(text, place) for text, place in zip(explanation.summary, places, strict=True)][1:]
    nodes = {node.formula: number for number, node in enumerate(scene.nodes)}

    def cause(number: int) -> Line:
        stretch = explanation.implicant[number]
        node, place = nodes.get(stretch.formula), None
        if node is not None:
            start = scene.x_axis.position(stretch.start)
            end = scene.x_axis.end if stretch.end is None else scene.x_axis.position(stretch.end)
            place = (node, start, end)
        return Line(explanation.causes[number], place)

    return summary, cause


def _json(data: Mapping[str, Any]) -> str:
    return json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _scripts() -> str:
    licence = _file("vendor/LICENSE-uPlot")
    parts = "\n".join(_file(name) for name in _SCRIPTS)
    return (
        f'/*!\n{licence}\n*/\n{_file("vendor/uPlot.iife.min.js")}\n(() => {{\n"use strict";\n{parts}\n}})();'
    )


def _file(name: str) -> str:
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
