"""One self-contained HTML page about requirements and traces: of ``rtamt report`` and ``rtamt check --html``."""

from __future__ import annotations

import os
from datetime import datetime, timezone
from typing import TYPE_CHECKING, Any

from rtamt.cli.command import CommandError, find_pack, short, write_output
from rtamt.cli.reading_options import instant, whole_recording
from rtamt.cli.runner import LARGE
from rtamt.cli.terminal import printed
from rtamt.errors import StlError
from rtamt.html_report import File, Formula, Page, Row
from rtamt.lazy.dataclasses import replace
from rtamt.plot.band import short_band
from rtamt.plot.scene import scene
from rtamt.readers.sql import shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from rtamt.cli.outcome import Outcome, Requirement
    from rtamt.cli.reading_options import Reading
    from rtamt.plot.x_axis import XAxis
    from rtamt.specification import Specification

#: Characters of a specification that a page shows.
_TEXT = 20_000


class HtmlReport:
    """A page, built outcome by outcome, recording by recording.

    ``given``: the specifications, ``requirements`` those with their own row; ``traces`` and ``reading``: the
    recordings and how they are read; ``at``: the time that is explained, by default the first of each trace. Raises
    :class:`UsageError` where jinja2 is not installed.
    """

    def __init__(
        self,
        command: str,
        given: Sequence[Requirement],
        requirements: Sequence[Requirement],
        traces: Sequence[str],
        reading: Reading,
        at: Any = None,
    ) -> None:
        self._given = given
        self._recordings = {shown(trace): trace for trace in traces}
        self._reading = reading
        self._at = at
        self._traces: dict[str, str] = {}
        #: The recording of the last outcome, its x axis, and the requirements that were evaluated on it.
        self._trace = ""
        self._x_axis: XAxis | None = None
        self._specs: list[Specification] = []
        texts = {
            requirement.label: Formula(printed(requirement.spec.formula), requirement.written.description)
            for requirement in requirements
        }
        self._page = Page(command, texts)

    def add(self, outcome: Outcome) -> None:
        """Add the outcome of one requirement on one trace, with charts if there is a result."""
        if outcome.trace != self._trace:
            self._end_trace()
            self._trace = outcome.trace
            self._traces[outcome.trace] = ""
        row, seen = _row(outcome), None
        if outcome.result is not None:
            self._specs.append(outcome.result.specification)
            try:
                seen = scene(outcome.result, instant(self._at, outcome.result))
                self._x_axis = seen.x_axis
                seen = replace(seen, band=short_band(outcome.result))
            except StlError as error:
                if self._at is not None:
                    raise CommandError(f"{outcome.trace}: {error}") from error
                row = replace(row, notes=(*row.notes, str(error)))
        self._page.add(row, seen)

    def _end_trace(self) -> None:
        """Add the signals of the last recording that no requirement reads."""
        x_axis, specs, self._x_axis, self._specs = self._x_axis, self._specs, None, []
        if x_axis is None:
            return
        source = self._recordings[self._trace]
        try:
            if os.path.isfile(source) and os.path.getsize(source) >= LARGE:
                summary = f"other signals are not in this page: the file has {LARGE >> 20} MB or more"
            else:
                recording = whole_recording(specs, source, self._reading)
                place = len(self._traces), len(self._recordings)
                known = {name for spec in specs for name in spec.input_names}
                summary = (
                    ""
                    if recording is None
                    else self._page.add_signals(self._trace, recording, known, x_axis, place)
                )
        except StlError as error:  # of signals that no verdict depends on
            summary = f"other signals are not in this page: {error}"
        self._traces[self._trace] = summary

    def write(self, path: str) -> None:
        """Write the page."""
        self._end_trace()
        write_output(path, self._page.text(self._files()))

    def _files(self) -> Iterator[File]:
        for requirement in self._given:
            text = requirement.spec.text or printed(requirement.spec.formula)
            name = find_pack(requirement.given)
            if name is not None:
                yield File("Pack", name, text=_abbreviate(text))
            elif not os.path.isfile(requirement.given):
                yield File("Formula", "", text=_abbreviate(requirement.given))
            else:
                yield File("Specification", requirement.given, text=_abbreviate(text))
        for trace, signals in self._traces.items():
            yield File("Trace", trace, facts="; ".join(filter(None, (_facts(trace), signals))))


def _abbreviate(text: str) -> str:
    return text if len(text) <= _TEXT else f"{text[:_TEXT]}\n… {len(text) - _TEXT} more characters"


def _facts(path: str) -> str:
    """Return size and date of a file; "" if it is not a file."""
    if not os.path.isfile(path):
        return ""
    status = os.stat(path)
    changed = datetime.fromtimestamp(status.st_mtime, timezone.utc)
    return f"{status.st_size} bytes, modified {changed:%Y-%m-%d %H:%M} UTC"


def _row(outcome: Outcome) -> Row:
    """Return the result of one requirement over one trace as text."""
    if not outcome.result_known:
        reason = outcome.error or outcome.unchecked
        return Row(outcome.requirement, outcome.trace, outcome.verdict, error=reason)
    return Row(
        outcome.requirement,
        outcome.trace,
        outcome.verdict,
        short(outcome.robustness),
        outcome.moment,
        str(outcome.samples),
        episodes=outcome.episodes_text,
        notes=outcome.notes,
    )
