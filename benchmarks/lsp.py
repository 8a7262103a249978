"""How long the language server takes to answer at 500 lines: requests of a client over the standard streams.

    python benchmarks/lsp.py [LINES]

Each time is from the request to its answer, the client's work included. "after a change" means that the first request
after a change is answered, which parses the new text; its diagnostics are sent before. The file has a declaration, a
template, or a requirement with two temporal operators on each line.
"""

from __future__ import annotations

import asyncio
import statistics
import sys
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from lsprotocol import types as lsp
from pygls.lsp.client import LanguageClient

if TYPE_CHECKING:
    from collections.abc import Awaitable

#: The answers of each kind that are timed.
ROUNDS = 15


def text_of(lines: int) -> str:
    """Return a specification of so many lines."""
    signals = lines // 5
    found = ["specification large", 'import "patterns.stl"']
    found += [f"input float s{n} [m/s] in [0, 60]  // signal {n}" for n in range(signals)]
    found += [f"def calm{n}(x, limit = {n + 1}) = abs(x) <= limit" for n in range(10)]
    found += [f"fast{n} = s{n} > {n % 40}" for n in range(signals)]
    left = lines - len(found)
    found += [
        f'require R{n} "text {n}": always(fast{n % signals} -> eventually[0:{n % 7 + 1}](calm{n % 10}(s{n % signals})))'
        for n in range(left)
    ]
    return "\n".join(found) + "\n"


class Timed:
    """A client, and the times of its requests."""

    def __init__(self) -> None:
        self.client = LanguageClient("benchmark", "1")
        self.times: dict[str, list[float]] = {}
        self.published = asyncio.Event()

        @self.client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def published(_params: lsp.PublishDiagnosticsParams) -> None:
            self.published.set()

    async def timed(self, name: str, request: Awaitable[object]) -> None:
        """Await a request, and record how long it took."""
        start = time.perf_counter()
        await request
        self.times.setdefault(name, []).append(1000 * (time.perf_counter() - start))

    async def run(self, text: str) -> None:
        """Ask everything about a text."""
        client = self.client
        await client.start_io(sys.executable, "-m", "rtamt", "lsp")
        await client.initialize_async(lsp.InitializeParams(lsp.ClientCapabilities()))
        client.initialized(lsp.InitializedParams())
        with tempfile.TemporaryDirectory() as folder:
            uri = Path(folder, "large.stl").as_uri()
            client.text_document_did_open(
                lsp.DidOpenTextDocumentParams(lsp.TextDocumentItem(uri, "stl", 0, text))
            )
            await self.published.wait()
            for version in range(1, ROUNDS + 1):
                await self._round(uri, text, version)
        await client.shutdown_async(None)
        client.exit(None)
        await client.stop()

    async def _round(self, uri: str, text: str, version: int) -> None:
        client, document = self.client, lsp.TextDocumentIdentifier(uri)
        lines = text.splitlines()
        last = len(lines) - 1
        place = lsp.Position(last, lines[last].index("fast") + 1)
        changed = f"{text}// version {version}\n"
        self.published.clear()
        client.text_document_did_change(
            lsp.DidChangeTextDocumentParams(
                lsp.VersionedTextDocumentIdentifier(version, uri),
                [lsp.TextDocumentContentChangeWholeDocument(changed)],
            )
        )
        await self.timed("diagnostics after a change", self.published.wait())
        await self.timed("hover", client.text_document_hover_async(lsp.HoverParams(document, place)))
        await self.timed(
            "completion", client.text_document_completion_async(lsp.CompletionParams(document, place))
        )
        await self.timed(
            "definition", client.text_document_definition_async(lsp.DefinitionParams(document, place))
        )
        await self.timed(
            "references",
            client.text_document_references_async(
                lsp.ReferenceParams(lsp.ReferenceContext(include_declaration=True), document, place)
            ),
        )
        await self.timed(
            "semantic tokens",
            client.text_document_semantic_tokens_full_async(lsp.SemanticTokensParams(document)),
        )
        await self.timed("code lenses", client.text_document_code_lens_async(lsp.CodeLensParams(document)))
        await self.timed(
            "code actions",
            client.text_document_code_action_async(
                lsp.CodeActionParams(document, lsp.Range(place, place), lsp.CodeActionContext([]))
            ),
        )
        await self.timed(
            "symbols", client.text_document_document_symbol_async(lsp.DocumentSymbolParams(document))
        )
        await self.timed(
            "rename",
            client.text_document_rename_async(
                lsp.RenameParams(text_document=document, position=place, new_name="renamed")
            ),
        )


def main() -> None:
    """Print the median and the longest time of each request."""
    lines = int(sys.argv[1]) if len(sys.argv) > 1 else 500
    timed = Timed()
    asyncio.run(timed.run(text_of(lines)))
    print(f"{lines} lines, {ROUNDS} answers each; milliseconds")
    print(f"{'request':28} {'median':>8} {'longest':>8}")
    for name, times in timed.times.items():
        print(f"{name:28} {statistics.median(times):8.1f} {max(times):8.1f}")


if __name__ == "__main__":
    main()
