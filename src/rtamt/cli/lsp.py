"""``rtamt lsp``: the language server for editors, on the standard streams."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.parser import OK
from rtamt.extras import library

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
Run the language server: editors start it, and speak the Language Server Protocol with it on stdin and stdout. It
reports errors and findings, describes names and operators, completes names, finds and renames them, formats files,
and shows above each requirement its verdict on a recording. Requires pygls: pip install 'rtamt[lsp]'.

Exit code: 0 when the editor ends it."""

_EPILOG = """\
The server executes nothing of a specification, and imports no message classes. Recordings are read in a process of its
own, for 60 s at most. Settings, as initialization options or in the section rtamt of the configuration: recording (a
path), period (such as 100ms), time (discrete or dense), documentation (the address of this documentation, for links).

examples:
  rtamt lsp
  rtamt lsp --stdio"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument("--stdio", action="store_true", help="use stdin and stdout, as it does anyway")


def run(args: argparse.Namespace) -> int:  # noqa: ARG001 - the one argument changes nothing
    """Serve until the editor ends the server."""
    library("pygls", "rtamt lsp", "lsp")
    from rtamt.lsp.server import serve

    serve()
    return OK
