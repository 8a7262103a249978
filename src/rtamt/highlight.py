"""Syntax highlighting for formulas and ``.stl`` files: keyword classes from the operator table, and a Pygments lexer.

Pygments finds the lexer by its entry point under the names ``stl`` and ``rtamt``, and by the extension ``.stl``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from pygments.lexer import RegexLexer, words
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Whitespace

from rtamt.language.operators import STL, Fixity, Tense
from rtamt.language.parsing.declarations import TYPES
from rtamt.language.parsing.grammar import ELSE, THEN
from rtamt.language.parsing.lexer import is_word
from rtamt.language.quantifiers import QUANTIFIERS
from rtamt.language.units.durations import UNITS

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.language import operators

__all__ = ["DECLARING", "QUANTIFYING", "StlLexer", "functions", "logical", "symbols", "temporal"]

#: The keywords of specification files that are not operators.
DECLARING = (
    "specification",
    "from",
    "import",
    "optional",
    "input",
    "output",
    "const",
    "enum",
    "parameter",
    "table",
    "topic",
    "require",
    "severity",
    "def",
    "sample",
    "group",
)

#: The words of quantifiers, before a name and `in`.
QUANTIFYING = (*QUANTIFIERS, "where")


def temporal() -> list[str]:
    """Return the keywords of temporal operators.

    >>> "always" in temporal() and "G" in temporal() and "and" not in temporal()
    True
    """
    return _spelled(lambda op: op.tense is not Tense.NONE and op.fixity is not Fixity.FUNCTION)


def functions() -> list[str]:
    """Return the names of functions.

    >>> functions()[:3]
    ['abs', 'acos', 'ahead']
    """
    return _spelled(lambda op: op.fixity is Fixity.FUNCTION)


def logical() -> list[str]:
    """Return the other keywords: connectives and truth values.

    >>> logical()
    ['and', 'else', 'false', 'if', 'iff', 'implies', 'not', 'or', 'then', 'true', 'xor']
    """
    words = {s for op in STL for s in op.spellings if is_word(s)} | {THEN, ELSE}
    return sorted(words - {*temporal(), *functions()})


def symbols() -> list[str]:
    """Return the operators that are symbols, the longest first.

    >>> symbols()[:2]
    ['!==', '<->']
    """
    found = {s for op in STL for s in op.spellings if not is_word(s)}
    return sorted(found, key=lambda s: (-len(s), s))


def _spelled(chosen: Callable[[operators.Operator], bool]) -> list[str]:
    return sorted(s for op in STL if chosen(op) for s in op.spellings if is_word(s))


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
