"""``rtamt completion``: the completion script of a shell, generated from the definitions of the arguments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.cli.parser import OK, Parser
from rtamt.cli.terminal import say
from rtamt.errors import UsageError, choices
from rtamt.extras import library

if TYPE_CHECKING:
    import argparse

SHELLS = ("bash", "zsh", "fish")

#: Arguments that are files, by what the help calls them.
_FILES = ("SPEC", "TRACE", "FILE", "PROBLEM")

_DESCRIPTION = """\
Print the completion script of 'rtamt' for a shell: commands, options, option values and files.
It requires the package shtab: pip install 'rtamt[completion]'."""

_EPILOG = """\
To enable it in every new shell:
  bash  rtamt completion bash > ~/.local/share/bash-completion/completions/rtamt
  zsh   rtamt completion zsh > ~/.zfunc/_rtamt
        and 'fpath+=~/.zfunc' before compinit in ~/.zshrc
  fish  rtamt completion fish > ~/.config/fish/completions/rtamt.fish

examples:
  rtamt completion bash"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument("shell", metavar="SHELL", help=f"one of {', '.join(SHELLS)}")


def run(args: argparse.Namespace) -> int:
    """Print the script."""
    if args.shell not in SHELLS:
        raise UsageError(f"there is no completion for '{args.shell}'{choices(args.shell, SHELLS, 'shells')}")
    shtab = library("shtab", "rtamt completion", "completion")
    say(shtab.complete(_whole(shtab.FILE), shell=args.shell))
    return OK


def _whole(file: Any) -> Parser:
    """Return one parser with all commands, with completion of file arguments."""
    from rtamt.cli import COMMANDS

    whole = Parser(prog="rtamt")
    whole.add_argument("--version", action="version", version="", help="print the version")
    commands = whole.add_subparsers()
    for command in COMMANDS.values():
        parser = commands.add_parser(command.name, help=command.summary)
        command.configure(parser)
        parser.description = command.summary  # which zsh shows; the whole one would be a page
        for action in parser._actions:
            if action.metavar in _FILES:
                action.complete = file  # type: ignore[attr-defined] # where shtab looks
    return whole
