"""``rtamt describe``: requirements as English sentences."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import add_specification_options, add_time_option, json_text, read_specification
from rtamt.cli.parser import OK
from rtamt.cli.terminal import say

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
Print each requirement as an English sentence, made from the phrases of the operator table. Parentheses show what
belongs together, so that different formulas have different sentences. Named sub-specifications are written by
their names; their own sentences follow."""

_EPILOG = """\
--json prints one object per line: {"requirement", "text", "sentence", "names", "formula"}. "text" is what is written
after 'require', and "names" has the sentence of each name in the requirement.

examples:
  rtamt describe examples/request_grant/spec.stl
  rtamt describe "always((req >= 3) -> eventually[0:5](gnt >= 3))"
  rtamt describe driving"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    add_time_option(parser)
    parser.add_argument("--json", action="store_true", help="print JSON, one object per line")


def run(args: argparse.Namespace) -> int:
    """Read the specification and print its sentences."""
    spec = read_specification(args, args.time, runs=False)
    several = len(spec.document.requirements) > 1
    for known, sentence in zip(spec.document.requirements, spec.describe().values(), strict=True):
        if args.json:
            say(
                json_text(
                    {
                        "requirement": known.name,
                        "text": known.description,
                        "sentence": sentence.text,
                        "names": dict(sentence.names),
                        "formula": str(spec.requirements[known.name]),
                    }
                )
            )
            continue
        text = f" ({known.description})" if known.description else ""
        head = f"{known.name}{text}: " if several or known.explicit else ""
        say(f"{head}{sentence.text}")
        for name, meaning in sentence.names.items():
            say(f"  {name}: {meaning}")
    return OK
