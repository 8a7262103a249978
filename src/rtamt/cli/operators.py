"""``rtamt operators``: list the operator table."""

from __future__ import annotations

import sys
import textwrap
from typing import TYPE_CHECKING

from rtamt.cli.language import add_language_option, read_language
from rtamt.cli.parser import OK
from rtamt.cli.terminal import say, table, terminal_width, use_color, width_of
from rtamt.errors import UsageError, did_you_mean
from rtamt.language.operators import Bounds, Fixity
from rtamt.language.quantifiers import QUANTIFIERS
from rtamt.language.units.durations import UNITS

if TYPE_CHECKING:
    import argparse

    from rtamt.language.operators import Language, Operator

_DESCRIPTION = "List the operators of the language in order of decreasing precedence."

_EPILOG = """\
examples:
  rtamt operators                 all operators
  rtamt operators until since     two operators"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument("names", metavar="OPERATOR", nargs="*", help="a name or spelling (default: all)")
    add_language_option(parser)


def run(args: argparse.Namespace) -> int:
    """Print the selected operators."""
    language = read_language(args.language)
    tightest_first = sorted((*language, *QUANTIFIERS.values()), key=lambda op: -op.power)
    chosen = (
        tightest_first
        if not args.names
        else [op for name in args.names for op in _find_operators(name, language)]
    )
    rows = [("name", "written", "example", "meaning")]
    rows += [(op.name, _signature(op), op.example, op.doc) for op in chosen]
    color = use_color("auto", sys.stdout)
    say(_fit(rows, color), color=color)
    if not args.names:
        say(f"\n{_notes(language)}")
    return OK


def _fit(rows: list[tuple[str, str, str, str]], color: bool) -> str:
    """Return the rows as a table; on a narrow terminal, meanings are on separate lines."""
    columns = width_of(sys.stdout)
    if columns is None or max(len(line) for line in table(rows, width=columns).splitlines()) <= columns:
        return table(rows, color=color, width=columns)
    lines = table([row[:3] for row in rows], color=color).splitlines()
    return "\n".join(f"{line}\n    {meaning}" for line, (*_, meaning) in zip(lines, rows, strict=True))


def _notes(language: Language) -> str:
    right = ", ".join(op.spellings[0] for op in language if op.fixity is Fixity.RIGHT)
    notes = (
        f"[a:b] is an interval, also written [a,b], with or without units ({', '.join(UNITS)}), as in "
        f"always[0:500ms](x >= 3); [a:b]? is optional: without it, the window is unbounded. Operators with "
        f"two operands associate to the left, {right} to the right. A number used as a formula is its own "
        f"robustness."
    )
    return textwrap.fill(notes, min(100, terminal_width()))


def _find_operators(name: str, language: Language) -> list[Operator]:
    found = [op for op in (*language, *QUANTIFIERS.values()) if name == op.name or name in op.spellings]
    if not found:
        known = sorted({word for op in language for word in (op.name, *op.spellings)})
        raise UsageError(f"there is no operator '{name}'{did_you_mean(name, known)}; see 'rtamt operators'")
    return found


#: How the interval of an operator is shown.
_INTERVALS = {
    Bounds.NONE: "",
    Bounds.OPTIONAL: " [a:b]?",
    Bounds.REQUIRED: " [a:b]",
    Bounds.DURATION: " [d]?",
}


def _signature(op: Operator) -> str:
    interval = _INTERVALS[op.bounds]
    return " ".join(op.spellings) + interval
