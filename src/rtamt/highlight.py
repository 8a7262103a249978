"""Syntax highlighting for formulas and ``.stl`` files: keyword classes from the operator table, and a Pygments lexer.

Pygments finds the lexer by its entry point under the names ``stl`` and ``rtamt``, and by the extension ``.stl``.
"""

from __future__ import annotations

from pygments.lexer import RegexLexer, words
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Whitespace

from rtamt.language.parsing.declarations import TYPES
from rtamt.language.units.durations import UNITS
from rtamt.language.words import DECLARING, QUANTIFYING, functions, logical, symbols, temporal

__all__ = ["DECLARING", "QUANTIFYING", "StlLexer", "functions", "logical", "symbols", "temporal"]

_WORDS = tuple(word for word in temporal() if len(word) > 2)
_LETTERS = tuple(word for word in temporal() if len(word) <= 2)


class StlLexer(RegexLexer):
    """A lexer for Signal Temporal Logic in the syntax of rtamt.

    Single letters such as ``G`` are operators only before an interval or a parenthesis: elsewhere
    they may be variables.
    """

    name = "Signal Temporal Logic"
    aliases = ("stl", "rtamt")
    filenames = ("*.stl",)
    mimetypes = ("text/x-stl",)
    version_added = ""
    url = ""

    tokens = {  # noqa: RUF012 - the base class has it so
        "root": [
            (r"\s+", Whitespace),
            (r"//[^\n]*", Comment.Single),
            (r"/\*[\s\S]*?\*/", Comment.Multiline),
            (r'"(?:[^"]|"")*"', String.Symbol),
            (rf"[\d_.]+(?:[eE][+-]?\d+)?(?=\s*(?:(?:{'|'.join(UNITS)})\b|%))", Number, "unit"),
            (r"(?:\d[\d_]*(?:\.[\d_]*)?|\.\d[\d_]*)(?:[eE][+-]?\d+)?", Number),
            (r"@\s*topic\b", Keyword.Declaration),
            (words(DECLARING, suffix=r"\b(?!\s*[<>=!.])"), Keyword.Declaration),
            (words(TYPES, suffix=r"\b(?=\s+\w)"), Keyword.Type),
            (words(_WORDS, suffix=r"\b(?!\.)"), Keyword),
            (rf"(?:{'|'.join(_LETTERS)})(?=\s*[\[(])", Keyword),
            (words(functions(), suffix=r"(?=\s*[\[(])"), Name.Builtin),
            (words(logical(), suffix=r"\b(?!\.)"), Operator.Word),
            (r"in(?=\s*\{)", Operator.Word),
            (words(QUANTIFYING, suffix=r"(?=\s+\w+\s+in\b|\s+\w+\s*!=)"), Keyword),
            (r"in(?=\s+\w+\s*(?::|where\b))", Keyword),
            (r"inf\b", Number),
            (words(symbols()), Operator),
            (r"[()\[\]{},:;=]", Punctuation),
            (r"[^\W\d][\w$]*(?:\.[^\W\d][\w$]*)*|\$[\w$]*", Name.Variable),
        ],
        "unit": [(r"\s+", Whitespace), (r"\w+|%", Keyword.Type, "#pop")],
    }
