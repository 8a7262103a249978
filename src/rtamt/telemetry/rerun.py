"""A result as entities of Rerun: scalars over time, and verdicts and violations as text."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError
from rtamt.extras import library
from rtamt.files import replacing
from rtamt.lazy.modules import np
from rtamt.telemetry.content import SATISFIED, VIOLATED, content_of
from rtamt.telemetry.messages import ROOT, topic

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from rtamt.results import Result
    from rtamt.signals.arrays import FloatArray
    from rtamt.telemetry.content import Bounded, Content, Finding

#: The name of the timeline, and of the application.
TIMELINE, APPLICATION = "time", "rtamt"


def log_rerun(
    result: Result | Mapping[str, Result],
    path: str | os.PathLike[str] | None = None,
    *,
    recording: Any = None,
    bounds: bool = False,
) -> None:
    """Log signals, robustness, bounds, verdicts and violations to a recording of Rerun.

    ``result``: of any specification, or results by the names of their requirements. ``path``: the file to write
    (``.rrd``), which also has a layout of the viewer: a page for each requirement, with a plot of its signals and a
    plot of its robustness, next to the verdicts and violations. Without it they are logged to ``recording``, a
    ``rerun.RecordingStream``, by default the current one. Entities have the names of the topics of
    :func:`~rtamt.telemetry.write_mcap`; the timeline ``time`` has the times of the trace: dates if it has dates or
    counts from 1970, else durations. ``bounds``: also the bounds of the robustness at the start, as known after each
    sample.

    Raises :class:`UsageError` if the package ``rerun-sdk`` is missing, and :class:`TraceError` if the file cannot
    be written.
    """
    log_content(content_of(result, bounds=bounds), path, recording)


def log_content(content: Content, path: str | os.PathLike[str] | None = None, recording: Any = None) -> None:
    """Log what is exported of a result."""
    rerun = library("rerun", "logging to Rerun", "rerun")
    if path is None:
        _Log(rerun, recording, dated=content.dated).content(content)
        return
    try:
        with replacing(path) as new:
            stream = rerun.RecordingStream(APPLICATION)
            stream.save(new, default_blueprint=_blueprint(content))
            _Log(rerun, stream, dated=content.dated).content(content)
            stream.disconnect()  # writes what is still in memory
    except OSError as error:
        raise TraceError(f"cannot write '{path}': {error.strerror or error}") from None


def _blueprint(content: Content) -> Any:
    """Return a layout of the viewer: the plots of each requirement, and a list of verdicts and violations."""
    panels = library("rerun.blueprint", "logging to Rerun", "rerun")
    keys = {variable.key: variable for variable in content.variables}
    pages = []
    for finding in content.findings:
        plots = [
            panels.TimeSeriesView(
                name=f"{finding.name}: robustness",
                contents=[
                    *_lines(topic(finding, "robustness"), finding.robustness, topic(finding, "interval")),
                    *([] if finding.known is None else _ends(topic(finding, "known"))),
                ],
            )
        ]
        if finding.variables:
            signals = [f"{ROOT}/signals/{key}" for key in finding.variables]
            contents = [
                line
                for signal, key in zip(signals, finding.variables, strict=True)
                for line in _lines(signal, keys[key].samples, signal)
            ]
            plots.insert(0, panels.TimeSeriesView(name=f"{finding.name}: signals", contents=contents))
        pages.append(panels.Vertical(*plots, name=finding.name))
    texts = [topic(finding, what) for finding in content.findings for what in ("verdict", "violations")]
    log = panels.TextLogView(name="Verdicts and violations", contents=texts)
    return panels.Blueprint(panels.Horizontal(panels.Tabs(*pages), log, column_shares=[3, 2]))


def _lines(entity: str, samples: Bounded, bounds: str) -> list[str]:
    """Return the entities that show samples: one of what is known exactly, and two of bounds."""
    exact = samples.lower == samples.upper
    return ([entity] if exact.any() else []) + ([] if exact.all() else _ends(bounds))


def _ends(entity: str) -> list[str]:
    return [f"{entity}/{end}" for end in ("lower", "upper")]


class _Log:
    """Sends columns to one recording."""

    def __init__(self, rerun: Any, recording: Any, *, dated: bool) -> None:
        self._rerun = rerun
        self._recording = recording
        self._dated = dated

    def content(self, content: Content) -> None:
        for variable in content.variables:
            self._log_bounds(f"{ROOT}/signals/{variable.key}", variable.samples)
        for finding in content.findings:
            self._finding(finding)

    def _finding(self, finding: Finding) -> None:
        self._scalars(topic(finding, "robustness"), *finding.robustness.known)
        for what, bounded in (("interval", finding.robustness), ("known", finding.known)):
            if bounded is not None:
                self._scalars(f"{topic(finding, what)}/lower", bounded.times, bounded.lower)
                self._scalars(f"{topic(finding, what)}/upper", bounded.times, bounded.upper)
        levels = {SATISFIED: "INFO", VIOLATED: "ERROR"}
        before = [None, *(verdict for _, verdict in finding.verdicts)]
        changes = [
            (time, f"{finding.name}: {verdict}", levels.get(verdict, "WARN"))
            for (time, verdict), last in zip(finding.verdicts, before, strict=False)
            if verdict != last  # a list needs no end of the last one
        ]
        self._texts(topic(finding, "verdict"), changes)
        rows = []
        for episode in finding.episodes:
            worst = f"worst robustness {episode.worst:g}"
            rows.append((episode.begin, f"{finding.name}: violation begins, {worst}", "ERROR"))
            rows.append((episode.end, f"{finding.name}: violation ends, {worst}", "INFO"))
        self._texts(topic(finding, "violations"), rows)

    def _log_bounds(self, entity: str, samples: Bounded) -> None:
        """Log what is known exactly as one line, and bounds of the rest as two."""
        self._scalars(entity, *samples.known)
        open_ = samples.lower != samples.upper
        if open_.any():
            self._scalars(f"{entity}/lower", samples.times[open_], samples.lower[open_])
            self._scalars(f"{entity}/upper", samples.times[open_], samples.upper[open_])

    def _scalars(self, entity: str, times: NDArray[np.int64], values: FloatArray) -> None:
        if len(times):
            self._send(entity, times, self._rerun.Scalars.columns(scalars=values))

    def _texts(self, entity: str, rows: Sequence[tuple[int, str, str]]) -> None:
        if rows:
            times, texts, levels = zip(*rows, strict=True)
            columns = self._rerun.TextLog.columns(text=list(texts), level=list(levels))
            self._send(entity, np.array(times, np.int64), columns)

    def _send(self, entity: str, times: NDArray[np.int64], columns: Any) -> None:
        given = {"timestamp": times.view("M8[ns]")} if self._dated else {"duration": times.view("m8[ns]")}
        column = self._rerun.TimeColumn(TIMELINE, **given)
        self._rerun.send_columns(entity, indexes=[column], columns=columns, recording=self._recording)
