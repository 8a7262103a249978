"""``rtamt format``: specification files in the common layout."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from rtamt.cli.command import CommandError, read_text, write_output
from rtamt.cli.language import add_language_option, read_language
from rtamt.cli.parser import ERROR, OK, VIOLATED, complain
from rtamt.cli.terminal import say
from rtamt.errors import StlError
from rtamt.layout import layout_text

if TYPE_CHECKING:
    import argparse

    from rtamt.language.operators import Language

_DESCRIPTION = """\
Rewrite specification files in the common layout: spaces around operators, indented continuation lines, at most one
blank line in a row. Line breaks and comments stay where they are. Each new text is parsed, and has the meaning of the
old one; a file with an error stays as it is.

Exit code: 0 all files have the layout, or have it now, 1 with --check if some do not have it, 2 some have errors."""

_EPILOG = """\
examples:
  rtamt format limits.stl
  rtamt format examples/request_grant/spec.stl --check"""

_MARK = "\ufeff"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument("files", metavar="FILE", nargs="+", help="specification files (.stl)")
    parser.add_argument(
        "--check", action="store_true", help="write nothing; list the files that would change"
    )
    add_language_option(parser)


def run(args: argparse.Namespace) -> int:
    """Write every file that does not have the layout."""
    language = read_language(args.language)
    changed, wrong = 0, 0
    for file in args.files:
        try:
            new = _reformat(file, language)
        except StlError as error:
            complain(error)
            wrong += 1
            continue
        if new is None:
            continue
        changed += 1
        if not args.check:
            write_output(file, new.encode())
        say(f"{file}: {'would change' if args.check else 'formatted'}")
    same = len(args.files) - changed - wrong
    if same:
        say(f"{same} {'file has' if same == 1 else 'files have'} the common layout")
    if wrong:
        return ERROR
    return VIOLATED if changed and args.check else OK


def _reformat(file: str, language: Language) -> str | None:
    """Return the new text of a file; None if it has the layout."""
    text = read_text(file, "utf-8", newline="")
    mark, body = (_MARK, text[1:]) if text.startswith(_MARK) else ("", text)
    folder = os.path.dirname(file) or os.curdir
    try:
        new = layout_text(body, folder, language)
    except StlError as error:
        raise CommandError(f"{file}: {error}") from error
    return None if new == body else mark + new
