"""The state of the language server between requests: settings, an analysis of each open text, verdicts."""

from __future__ import annotations

import asyncio
import os
from typing import TYPE_CHECKING, Any

from lsprotocol import types as lsp
from pygls.exceptions import FeatureNotificationError, JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.uris import to_fs_path

import rtamt
from rtamt.language.formula import Span
from rtamt.lazy.dataclasses import dataclass, field
from rtamt.lsp.document import Analysis
from rtamt.lsp.messages import Protocol, details_of, report
from rtamt.lsp.places import Lines, Place
from rtamt.lsp.problems import problems
from rtamt.lsp.recording import ask, state_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from pygls.server import ServerErrors

    from rtamt.lint.found import Edit

_SEVERITIES = {
    "error": lsp.DiagnosticSeverity.Error,
    "warning": lsp.DiagnosticSeverity.Warning,
    "note": lsp.DiagnosticSeverity.Information,
}


@dataclass
class Settings:
    """The settings of the client: initialization options, or the section ``rtamt`` of its configuration."""

    recording: str = ""
    period: str = ""
    time: str = "discrete"
    documentation: str = ""

    def take(self, given: Any) -> None:
        """Take the settings of a client; those of another type stay as they are."""
        if not isinstance(given, dict):
            return
        for name in ("recording", "period", "time", "documentation"):
            if isinstance(given.get(name), str) and "\0" not in given[name]:
                setattr(self, name, given[name])


@dataclass
class State:
    """The state of the server: an analysis of each open text, and the results of recordings."""

    settings: Settings = field(default_factory=Settings)
    analyses: dict[str, tuple[Any, Analysis]] = field(default_factory=dict)
    #: From the state of a recording to its columns, while they are read a task.
    columns: dict[Any, asyncio.Task[dict[str, Any]]] = field(default_factory=dict)
    #: From a file to the text, the recording and the settings that were checked, and what was found.
    checked: dict[str, tuple[Any, dict[str, Any]]] = field(default_factory=dict)
    #: Background tasks, kept until they end.
    tasks: set[asyncio.Task[None]] = field(default_factory=set)


class Server(LanguageServer):
    """A server with its state."""

    def __init__(self) -> None:
        # Whole texts: positions of changes would depend on what ends a line, on which clients and pygls differ.
        super().__init__(
            "rtamt",
            rtamt.__version__,
            text_document_sync_kind=lsp.TextDocumentSyncKind.Full,
            protocol_cls=Protocol,
        )
        self.state = State()

    def report_server_error(self, error: Exception, source: ServerErrors) -> None:
        """Answer messages that are wrong; log errors of the server, and show those without a request."""
        assert isinstance(self.protocol, Protocol)
        if not report(self.protocol, error, source):
            return
        details = details_of(error)
        if details is not None:
            self.window_log_message(lsp.LogMessageParams(lsp.MessageType.Error, details))
        super().report_server_error(error, source)

    def analysis(self, uri: str) -> Analysis:
        """Return the analysis of the present version of a text that is open."""
        if uri not in self.workspace.text_documents:
            raise JsonRpcInvalidParams(f"the text '{uri}' is not open")
        document = self.workspace.get_text_document(uri)
        key = document.version, document.source, self.state.settings.period
        kept = self.state.analyses.get(uri)
        if kept is None or kept[0] != key:
            encoding = str(self.workspace.position_encoding or "utf-16")
            if isinstance(self.workspace.position_encoding, lsp.PositionEncodingKind):
                encoding = self.workspace.position_encoding.value
            kept = key, Analysis(document.source, folder_of(uri), self.state.settings.period, encoding)
            self.state.analyses[uri] = kept
        return kept[1]

    def recording(self, uri: str) -> str | None:
        """Return the path of the recording that is chosen: relative to the workspace, or else to the file."""
        given = self.state.settings.recording
        if not given:
            return None
        folders = [path for each in self.workspace.folders.values() if (path := to_fs_path(each.uri))]
        root = self.workspace.root_path
        tried = [os.path.join(folder, given) for folder in (*folders, root, folder_of(uri)) if folder]
        return next((path for path in tried if os.path.isfile(path)), tried[0] if tried else given)

    async def columns(self, uri: str) -> list[str]:
        """Return the columns of the recording, which another process reads once."""
        path = self.recording(uri)
        if path is None:
            return []
        key = state_of(path)
        if key not in self.state.columns:
            self.state.columns = {key: asyncio.ensure_future(ask({"recording": path}))}
        found = await asyncio.shield(self.state.columns[key])
        return [str(each) for each in found.get("columns", ())]

    def checking(self, uri: str) -> tuple[Any, ...] | None:
        """Return the inputs of a verdict; None if they are unknown, as there is no recording."""
        path = self.recording(uri)
        if path is None:
            return None
        settings = self.state.settings
        return self.analysis(uri).text, state_of(path), settings.period, settings.time

    async def check(self, uri: str) -> dict[str, Any]:
        """Evaluate a text on the recording; what is found is shown above the requirements."""
        key, path, analysis = self.checking(uri), self.recording(uri), self.analysis(uri)
        if key is None or analysis.spec is None or analysis.library:
            return {"error": "choose a recording" if key is None else "the text has an error"}
        kept = self.state.checked.get(uri)
        if kept is not None and kept[0] == key:
            return kept[1]
        settings = self.state.settings
        found = await ask(
            {
                "text": analysis.text,
                "folder": analysis.folder,
                "recording": path,
                "period": settings.period,
                "time": settings.time,
            }
        )
        if uri in self.workspace.text_documents:  # it may be closed by now, or have been checked again
            kept = self.state.checked.get(uri)
            if kept is None or kept[0] != self.checking(uri):
                self.state.checked[uri] = key, found
            self.refresh()
        return found

    def refresh(self) -> None:
        """Ask the client to refresh the verdicts, if it supports that."""
        workspace = self.client_capabilities.workspace
        if workspace and workspace.code_lens and workspace.code_lens.refresh_support:
            self.workspace_code_lens_refresh(None)

    def check_later(self, uri: str) -> None:
        """Evaluate a text while other requests are answered."""

        async def run() -> None:
            await self.check(uri)

        if self.checking(uri) is not None and self.analysis(uri).spec is not None:
            task = asyncio.ensure_future(run())
            self.state.tasks.add(task)
            task.add_done_callback(self._ended)

    def _ended(self, task: asyncio.Task[None]) -> None:
        """Report the error of a background task."""
        self.state.tasks.discard(task)
        error = None if task.cancelled() else task.exception()
        if isinstance(error, Exception):
            self.report_server_error(error, FeatureNotificationError)

    def publish(self, uri: str) -> None:
        """Send the errors and findings of a text."""
        document = self.workspace.get_text_document(uri)
        analysis = self.analysis(uri)
        base = self.state.settings.documentation.rstrip("/")
        found = [
            lsp.Diagnostic(
                range_of(analysis.lines, each.span),
                each.message,
                _SEVERITIES[each.severity],
                each.code or None,
                lsp.CodeDescription(f"{base}/reference/warnings/{each.code}/")
                if base and each.code
                else None,
                "rtamt",
            )
            for each in problems(analysis)
        ]
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, found, document.version))


def folder_of(uri: str) -> str | None:
    """Return the folder of a file; None for a text that is no file."""
    path = to_fs_path(uri) if uri.startswith("file:") else None
    return None if path is None else os.path.dirname(path) or None


def range_of(lines: Lines, span: Span) -> lsp.Range:
    """Return a span as a range of the protocol."""
    begin, end = lines.range(span)
    return lsp.Range(lsp.Position(*begin), lsp.Position(*end))


def offset_of(analysis: Analysis, position: lsp.Position) -> int:
    """Return the offset of a position."""
    return analysis.lines.offset(Place(position.line, position.character))


def edits_of(lines: Lines, edits: Iterable[Edit]) -> list[lsp.TextEdit]:
    """Return edits as those of the protocol."""
    return [lsp.TextEdit(range_of(lines, each.span), each.new) for each in edits]


def whole_of(analysis: Analysis, new: str) -> list[lsp.TextEdit]:
    """Return the edit that replaces a whole text."""
    return [lsp.TextEdit(range_of(analysis.lines, Span(0, len(analysis.text))), new)]
