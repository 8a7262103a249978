"""A client of the language server: that of pygls, over the standard streams of a process."""

from __future__ import annotations

import asyncio
import sys
from collections import defaultdict

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient


class Editor:
    """An editor: it opens texts, and keeps what the server sends of itself."""

    def __init__(self, folder, options=None):
        self.loop = asyncio.new_event_loop()
        self.client = LanguageClient("tests", "1")
        self.published = defaultdict(list)
        self.refreshed = 0
        self.news = asyncio.Event()
        self.versions = defaultdict(int)
        self._listen()
        self.capabilities = self.run(self._start(folder, options))

    def run(self, coroutine):
        return self.loop.run_until_complete(asyncio.wait_for(coroutine, 120))

    def _listen(self):
        @self.client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def published(params):
            self.published[params.uri].append(params)
            self.news.set()

        @self.client.feature(lsp.WORKSPACE_CODE_LENS_REFRESH)
        def refreshed(*_):
            self.refreshed += 1
            self.news.set()

    async def _start(self, folder, options):
        await self.client.start_io(sys.executable, "-m", "rtamt", "lsp")
        refresh = lsp.CodeLensWorkspaceClientCapabilities(refresh_support=True)
        result = await self.client.initialize_async(
            lsp.InitializeParams(
                lsp.ClientCapabilities(workspace=lsp.WorkspaceClientCapabilities(code_lens=refresh)),
                root_uri=folder.as_uri(),
                workspace_folders=[lsp.WorkspaceFolder(folder.as_uri(), "work")],
                initialization_options=options,
            )
        )
        self.client.initialized(lsp.InitializedParams())
        return result.capabilities

    def stop(self):
        async def stop():
            await self.client.shutdown_async(None)
            self.client.exit(None)
            await self.client.stop()

        self.run(stop())
        self.loop.close()

    # ---- texts -----------------------------------------------------------------------------------

    def open(self, path, text):
        """Open a text; return the diagnostics that the server sends."""
        path.write_text(text, encoding="utf-8", newline="")
        uri = path.as_uri()
        self.versions[uri] += 1
        item = lsp.TextDocumentItem(uri, "stl", self.versions[uri], text)
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))
        return self.diagnostics(uri)

    def change(self, path, text):
        """Replace a text; return the diagnostics that the server sends."""
        uri = path.as_uri()
        self.versions[uri] += 1
        self.client.text_document_did_change(
            lsp.DidChangeTextDocumentParams(
                lsp.VersionedTextDocumentIdentifier(self.versions[uri], uri),
                [lsp.TextDocumentContentChangeWholeDocument(text)],
            )
        )
        return self.diagnostics(uri)

    def diagnostics(self, uri):
        """Return the diagnostics of the present version, once they have come."""
        found = self.until(
            lambda: next((p for p in self.published[uri] if p.version == self.versions[uri]), None)
        )
        return list(found.diagnostics)

    def until(self, found):
        """Return what is true at last, as soon as it is: looked at after each message."""

        async def wait():
            while not (value := found()):
                self.news.clear()
                await self.news.wait()
            return value

        return self.run(wait())

    def ask(self, name, path, line=None, character=None, **more):
        """Return the answer to a request about a text, at a position if one is given."""
        kind = {
            "hover": lsp.HoverParams,
            "completion": lsp.CompletionParams,
            "definition": lsp.DefinitionParams,
            "references": lsp.ReferenceParams,
            "rename": lsp.RenameParams,
            "prepare_rename": lsp.PrepareRenameParams,
            "code_action": lsp.CodeActionParams,
            "code_lens": lsp.CodeLensParams,
            "document_symbol": lsp.DocumentSymbolParams,
            "semantic_tokens_full": lsp.SemanticTokensParams,
            "formatting": lsp.DocumentFormattingParams,
        }[name]
        if line is not None:
            more["position"] = lsp.Position(line, character)
        params = kind(text_document=lsp.TextDocumentIdentifier(path.as_uri()), **more)
        return self.run(getattr(self.client, f"text_document_{name}_async")(params))


def apply_edits(text, edits):
    """Return a text after edits of the protocol; lines end with a line feed, characters are of one unit."""
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))

    def offset(position):
        return starts[position.line] + position.character

    for edit in sorted(
        edits, key=lambda each: (each.range.start.line, each.range.start.character), reverse=True
    ):
        text = text[: offset(edit.range.start)] + edit.new_text + text[offset(edit.range.end) :]
    return text
