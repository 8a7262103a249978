"""The language server: requests of the protocol, answered by the other modules. It needs pygls."""

from __future__ import annotations

import os
import sys
from typing import Any

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams
from pygls.uris import from_fs_path, to_fs_path

from rtamt.errors import UsageError
from rtamt.language.formula import Span
from rtamt.language.operators import STL
from rtamt.layout import layout_text
from rtamt.lsp.colors import MODIFIERS, TYPES, classify_words
from rtamt.lsp.completion import completions
from rtamt.lsp.hover import hover
from rtamt.lsp.imported import place_of
from rtamt.lsp.lenses import lenses
from rtamt.lsp.messages import silence_logs
from rtamt.lsp.places import Lines
from rtamt.lsp.problems import fix_all, repairs
from rtamt.lsp.rename import rename, renameable_at
from rtamt.lsp.session import Server, edits_of, offset_of, range_of, whole_of

_SYMBOLS = {
    "variable": lsp.SymbolKind.Variable, "constant": lsp.SymbolKind.Constant, "parameter": lsp.SymbolKind.Constant,
    "formula": lsp.SymbolKind.Variable, "requirement": lsp.SymbolKind.Event, "template": lsp.SymbolKind.Function,
    "group": lsp.SymbolKind.Namespace, "table": lsp.SymbolKind.Function, "enumeration": lsp.SymbolKind.Enum,
    "class": lsp.SymbolKind.Class,
}  # fmt: skip
_ITEMS = {
    "variable": lsp.CompletionItemKind.Variable, "constant": lsp.CompletionItemKind.Constant,
    "parameter": lsp.CompletionItemKind.Constant, "formula": lsp.CompletionItemKind.Variable,
    "template": lsp.CompletionItemKind.Function, "function": lsp.CompletionItemKind.Function,
    "table": lsp.CompletionItemKind.Function, "operator": lsp.CompletionItemKind.Operator,
    "keyword": lsp.CompletionItemKind.Keyword, "column": lsp.CompletionItemKind.Field,
    "enumeration": lsp.CompletionItemKind.Enum, "value": lsp.CompletionItemKind.EnumMember,
    "class": lsp.CompletionItemKind.Class,
}  # fmt: skip


def make_server() -> Server:
    """Return a server with all request handlers."""
    server = Server()

    @server.feature(lsp.INITIALIZE)
    def initialize(params: lsp.InitializeParams) -> None:
        server.state.settings.take(params.initialization_options)

    @server.feature(lsp.WORKSPACE_DID_CHANGE_CONFIGURATION)
    def did_change_configuration(params: lsp.DidChangeConfigurationParams) -> None:
        given = params.settings
        server.state.settings.take(given.get("rtamt") if isinstance(given, dict) else None)
        for uri in list(server.workspace.text_documents):
            server.publish(uri)
            server.check_later(uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
    def did_open(params: lsp.DidOpenTextDocumentParams) -> None:
        server.publish(params.text_document.uri)
        server.check_later(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
    def did_change(params: lsp.DidChangeTextDocumentParams) -> None:
        server.publish(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_SAVE)
    def did_save(params: lsp.DidSaveTextDocumentParams) -> None:
        server.state.analyses.clear()  # other texts may import this one
        for uri in list(server.workspace.text_documents):
            server.publish(uri)
        server.check_later(params.text_document.uri)

    @server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
    def did_close(params: lsp.DidCloseTextDocumentParams) -> None:
        uri = params.text_document.uri
        server.state.analyses.pop(uri, None)
        server.state.checked.pop(uri, None)
        server.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))

    _add_queries(server)
    _add_edits(server)
    return server


def _add_queries(server: Server) -> None:
    """Add the requests that change nothing."""

    @server.feature(lsp.TEXT_DOCUMENT_HOVER)
    def hover_request(params: lsp.HoverParams) -> lsp.Hover | None:
        analysis = server.analysis(params.text_document.uri)
        found = hover(analysis, offset_of(analysis, params.position))
        if found is None:
            return None
        content = lsp.MarkupContent(lsp.MarkupKind.Markdown, found.markdown)
        return lsp.Hover(content, range_of(analysis.lines, found.span))

    @server.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=['"', "."]))
    async def completion(params: lsp.CompletionParams) -> lsp.CompletionList:
        uri = params.text_document.uri
        columns = await server.columns(uri)
        analysis = server.analysis(uri)
        items = [
            lsp.CompletionItem(
                each.label,
                kind=_ITEMS.get(each.kind, lsp.CompletionItemKind.Variable),
                detail=each.detail or None,
                documentation=lsp.MarkupContent(lsp.MarkupKind.Markdown, each.text) if each.text else None,
                text_edit=edits_of(analysis.lines, [each.edit])[0],
                # Quotes are part of the filter text only if the user has typed one.
                filter_text=each.edit.new
                if analysis.text[each.edit.span.start :].startswith('"')
                else each.label,
                sort_text=f"{number:04}",
                additional_text_edits=edits_of(analysis.lines, each.more) or None,
            )
            for number, each in enumerate(
                completions(analysis, offset_of(analysis, params.position), columns)
            )
        ]
        return lsp.CompletionList(is_incomplete=False, items=items)

    @server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
    def definition(params: lsp.DefinitionParams) -> lsp.Location | None:
        uri = params.text_document.uri
        analysis = server.analysis(uri)
        offset = offset_of(analysis, params.position)
        found = analysis.outline.at(offset)
        if found is not None:
            return lsp.Location(uri, range_of(analysis.lines, found[1].span))
        for name, spans in analysis.outline.free.items():
            if any(span.start <= offset <= span.end for span in spans):
                elsewhere = place_of(analysis, name)
                if elsewhere is not None:
                    lines = Lines(elsewhere.text)
                    return lsp.Location(from_fs_path(elsewhere.path) or "", range_of(lines, elsewhere.span))
        return None

    @server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
    def references(params: lsp.ReferenceParams) -> list[lsp.Location]:
        uri = params.text_document.uri
        analysis = server.analysis(uri)
        offset = offset_of(analysis, params.position)
        found = analysis.outline.at(offset)
        if found is None:
            near = [
                spans
                for spans in analysis.outline.free.values()
                if any(each.start <= offset <= each.end for each in spans)
            ]
            return [lsp.Location(uri, range_of(analysis.lines, each)) for spans in near for each in spans]
        symbol = found[1]
        spans = analysis.outline.uses_of(symbol)
        kept = [each for each in spans if params.context.include_declaration or each != symbol.span]
        return [lsp.Location(uri, range_of(analysis.lines, each)) for each in kept]

    @server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def document_symbols(params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
        analysis = server.analysis(params.text_document.uri)
        return [
            lsp.DocumentSymbol(
                each.name or '""',
                _SYMBOLS[each.kind],
                range_of(analysis.lines, each.whole),
                range_of(analysis.lines, each.span),
                detail=each.kind,
            )
            for each in analysis.outline.symbols
            if each.kind in _SYMBOLS
        ]

    _add_semantic_tokens(server)

    @server.feature(lsp.TEXT_DOCUMENT_CODE_LENS)
    def code_lenses(params: lsp.CodeLensParams) -> list[lsp.CodeLens]:
        uri = params.text_document.uri
        analysis, key = server.analysis(uri), server.checking(uri)
        kept = server.state.checked.get(uri)
        path = server.recording(uri)
        shown = lenses(
            analysis,
            None if path is None else os.path.basename(path),
            kept[1] if kept is not None and kept[0] == key else None,
        )
        return [
            lsp.CodeLens(
                range_of(analysis.lines, each.span), lsp.Command(each.title, each.command, arguments=[uri])
            )
            for each in shown
        ]

    @server.command("rtamt.check")
    async def check_command(*arguments: Any) -> dict[str, Any]:
        if len(arguments) != 1 or not isinstance(arguments[0], str):
            raise JsonRpcInvalidParams("rtamt.check takes the address of a text")
        return await server.check(arguments[0])


def _add_semantic_tokens(server: Server) -> None:
    """Add the semantic tokens."""
    legend = lsp.SemanticTokensLegend(list(TYPES), list(MODIFIERS))

    @server.feature(lsp.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, legend)
    def semantic_tokens(params: lsp.SemanticTokensParams) -> lsp.SemanticTokens:
        analysis = server.analysis(params.text_document.uri)
        data: list[int] = []
        line = character = 0
        for each in classify_words(analysis):
            place = analysis.lines.place(each.span.start)
            before = character if place.line == line else 0
            width = analysis.lines.width(each.span)
            modifiers = sum(1 << MODIFIERS.index(name) for name in each.modifiers)
            data += [place.line - line, place.character - before, width, TYPES.index(each.type), modifiers]
            line, character = place
        return lsp.SemanticTokens(data)


def _add_edits(server: Server) -> None:
    """Add the requests whose answers are edits."""

    @server.feature(lsp.TEXT_DOCUMENT_PREPARE_RENAME)
    def prepare_rename(params: lsp.PrepareRenameParams) -> lsp.Range:
        analysis, path = server.analysis(params.text_document.uri), to_fs_path(params.text_document.uri)
        try:
            span, _symbol = renameable_at(analysis, offset_of(analysis, params.position), path)
        except UsageError as error:
            raise JsonRpcInvalidParams(str(error)) from None
        return range_of(analysis.lines, span)

    @server.feature(lsp.TEXT_DOCUMENT_RENAME, lsp.RenameOptions(prepare_provider=True))
    def rename_request(params: lsp.RenameParams) -> lsp.WorkspaceEdit:
        uri = params.text_document.uri
        analysis = server.analysis(uri)
        try:
            edits = rename(analysis, offset_of(analysis, params.position), params.new_name, to_fs_path(uri))
        except UsageError as error:
            raise JsonRpcInvalidParams(str(error)) from None
        return lsp.WorkspaceEdit({uri: edits_of(analysis.lines, edits)})

    @server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
    def format_document(params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit]:
        analysis = server.analysis(params.text_document.uri)
        if analysis.spec is None:
            return []  # diagnostics show its error already
        new = layout_text(analysis.text, analysis.folder, STL)
        return [] if new == analysis.text else whole_of(analysis, new)

    kinds = [lsp.CodeActionKind.QuickFix, lsp.CodeActionKind.SourceFixAll]

    @server.feature(lsp.TEXT_DOCUMENT_CODE_ACTION, lsp.CodeActionOptions(code_action_kinds=kinds))
    def code_actions(params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
        uri = params.text_document.uri
        analysis = server.analysis(uri)
        span = Span(offset_of(analysis, params.range.start), offset_of(analysis, params.range.end))
        found = [
            lsp.CodeAction(
                each.title,
                lsp.CodeActionKind.QuickFix,
                [known for known in params.context.diagnostics if (known.code or "") == each.code],
                edit=lsp.WorkspaceEdit({uri: edits_of(analysis.lines, each.edits)}),
            )
            for each in repairs(analysis, span)
        ]
        wanted = params.context.only
        if wanted is None or any(each.split(".")[0] == "source" for each in wanted):
            text = fix_all(analysis)
            if text is not None:
                edit = lsp.WorkspaceEdit({uri: whole_of(analysis, text)})
                kind = lsp.CodeActionKind.SourceFixAll
                found.append(lsp.CodeAction("Fix all findings that have a fix", kind, edit=edit))
        return found


def serve() -> None:
    """Serve on the standard streams until the client exits."""
    silence_logs()
    # A separate stream, which pygls closes at the end.
    with os.fdopen(os.dup(sys.stdout.fileno()), "wb") as answers:
        make_server().start_io(stdout=answers)
