"""Write editors/stl.tmLanguage.json: syntax highlighting for editors that read TextMate grammars.

    python tools/textmate.py            # rewrites it after a change of the operator table

It is committed, since editors load it from the repository; a test compares it with the operator table.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

from rtamt.language.parsing.declarations import TYPES
from rtamt.language.units.durations import UNITS
from rtamt.language.words import DECLARING, QUANTIFYING, functions, logical, symbols, temporal

FILE = Path(__file__).parents[1] / "editors" / "stl.tmLanguage.json"


def grammar() -> dict[str, object]:
    """Return the grammar: regular expressions, tried in this order at each place."""
    long = [word for word in temporal() if len(word) > 2]
    short = [word for word in temporal() if len(word) <= 2]
    number = r"(?:\d[\d_]*(?:\.[\d_]*)?|\.\d[\d_]*)(?:[eE][+-]?\d+)?"
    patterns = [
        {"name": "comment.line.double-slash.stl", "match": r"//.*$"},
        {"name": "comment.block.stl", "begin": r"/\*", "end": r"\*/"},
        {"name": "variable.other.quoted.stl", "match": r'"(?:[^"]|"")*"'},
        {
            "match": rf"({number})\s*((?:{'|'.join(UNITS)})\b|%)",
            "captures": {"1": {"name": "constant.numeric.stl"}, "2": {"name": "keyword.other.unit.stl"}},
        },
        {"name": "constant.numeric.stl", "match": rf"{number}|\binf\b"},
        {"name": "keyword.declaration.stl", "match": rf"@\s*topic\b|\b(?:{_any(DECLARING)})\b(?!\s*[<>=!.])"},
        {"name": "storage.type.stl", "match": rf"\b(?:{_any(TYPES)})\b(?=\s+\w)"},
        {"name": "keyword.control.temporal.stl", "match": rf"\b(?:{_any(long)})\b(?!\.)"},
        {"name": "keyword.control.temporal.stl", "match": rf"\b(?:{_any(short)})(?=\s*[\[(])"},
        {"name": "support.function.stl", "match": rf"\b(?:{_any(functions())})(?=\s*[\[(])"},
        {"name": "keyword.operator.word.stl", "match": rf"\b(?:{_any(logical())})\b(?!\.)|\bin\b(?=\s*\{{)"},
        {
            "name": "keyword.control.quantifier.stl",
            "match": rf"\b(?:{_any(QUANTIFYING)})(?=\s+\w+\s+in\b|\s+\w+\s*!=)|\bin(?=\s+\w+\s*(?::|where\b))",
        },
        {"name": "keyword.operator.stl", "match": _any(symbols())},
        {"name": "variable.other.stl", "match": r"[^\W\d][\w$]*(?:\.[^\W\d][\w$]*)*"},
    ]
    return {
        "name": "Signal Temporal Logic",
        "scopeName": "source.stl",
        "fileTypes": ["stl"],
        "patterns": patterns,
    }


def text() -> str:
    """Return the file."""
    return json.dumps(grammar(), indent=2) + "\n"


def _any(words: tuple[str, ...] | list[str]) -> str:
    return "|".join(map(re.escape, words))


if __name__ == "__main__":
    FILE.write_text(text(), encoding="utf-8")
