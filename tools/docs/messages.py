"""The messages in the source: every text that an error of ours is made with."""

from __future__ import annotations

import ast
from collections import defaultdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

#: Calls that make an error, and its class.
MAKERS = {
    "BoundError": "BoundError",
    "CommandError": "CommandError",
    "EvaluationError": "EvaluationError",
    "NameInFormulaError": "NameInFormulaError",
    "ParseError": "ParseError",
    "RTAMTException": "RTAMTException",
    "STLParseException": "STLParseException",
    "SpecificationError": "SpecificationError",
    "TraceError": "TraceError",
    "UsageError": "UsageError",
    "error": "ParseError",  # the parser's own: it adds the place
}


def by_kind(source: Path) -> dict[str, list[str]]:
    """Return the messages of each class of errors, sorted."""
    found: dict[str, set[str]] = defaultdict(set)
    for path in source.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and node.args:
                kind = MAKERS.get(_called(node.func))
                text = _text(node.args[0]) if kind else None
                if kind and text and any(map(str.isalpha, text)):
                    last = _called(node.args[-1])
                    found[last if last in MAKERS and last != "error" else kind].add(text)
    return {kind: sorted(texts, key=str.lower) for kind, texts in sorted(found.items())}


def _called(func: ast.expr) -> str:
    if isinstance(func, ast.Attribute):
        return func.attr
    return func.id if isinstance(func, ast.Name) else ""


def _text(node: ast.expr) -> str | None:
    if isinstance(node, ast.Constant) and isinstance(node.value, str):
        return _escaped(node.value)
    if isinstance(node, ast.JoinedStr):
        return "".join(_parts(node))
    return None


def _parts(node: ast.JoinedStr) -> Iterator[str]:
    for part in node.values:
        if isinstance(part, ast.Constant):
            yield _escaped(str(part.value))
        elif isinstance(part, ast.FormattedValue):
            yield (
                "⟨…⟩" if not isinstance(part.value, (ast.Name, ast.Attribute)) else f"⟨{_called(part.value)}⟩"
            )


def _escaped(text: str) -> str:
    for character in "\\`*_[]<>|#":
        text = text.replace(character, f"\\{character}")
    return text.replace("\n", " ")
