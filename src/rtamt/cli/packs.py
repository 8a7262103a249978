"""``rtamt packs``: list the packs of requirements in the package, or print one."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rtamt.cli.parser import OK
from rtamt.cli.terminal import say, table, use_color, width_of
from rtamt.specification_loader import pack, packs

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
List the packs: requirements on recordings of well-known systems, ready for 'rtamt check PACK TRACE'.
With a name, print that pack: a specification file to read, or to adapt to another system."""

_EPILOG = """\
A recording need not have all signals of a pack: a requirement whose signals are missing is reported as unchecked,
with the missing names. Limits are parameters, which --set changes.

examples:
  rtamt packs
  rtamt packs px4"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument("name", metavar="PACK", nargs="?", help="print the text of this pack")


def run(args: argparse.Namespace) -> int:
    """List the packs, or print one."""
    if args.name is not None:
        say(pack(args.name).text.rstrip(), exact=True)
        return OK
    rows = [("pack", "requirements", "about")]
    for name in packs():
        spec = pack(name)
        about = spec.text.splitlines()[0].removeprefix("// ")
        rows.append((name, str(len(spec.requirements)), about))
    say(table(rows, (1,), color=use_color("auto", sys.stdout), width=width_of(sys.stdout)))
    return OK
