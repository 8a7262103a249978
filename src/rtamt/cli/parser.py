"""The argument parser, the interface of a command, and the exit codes.

It imports neither the library nor numpy, so that ``rtamt --help`` is quick.
"""

from __future__ import annotations

import argparse
import os
import sys
import textwrap
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

from rtamt.cli.terminal import say, terminal_width
from rtamt.errors import UsageError, did_you_mean
from rtamt.files import same_file
from rtamt.lazy.dataclasses import dataclass

if TYPE_CHECKING:
    from collections.abc import Sequence
    from types import ModuleType

OK, VIOLATED, ERROR = 0, 1, 2
INTERRUPTED = 130  # what a shell reports for a program that Ctrl-C ended
#: Before an argument that is no option whatever it looks like; no argument of a process can have it.
_MARK = "\0"


@dataclass(frozen=True, slots=True)
class Command:
    """One command: a module of this package with its name, imported when the command is used."""

    name: str
    summary: str

    @property
    def _module(self) -> ModuleType:
        return import_module(f"rtamt.cli.{self.name}")

    def configure(self, parser: argparse.ArgumentParser) -> None:
        """Add the arguments of the command."""
        self._module.configure(parser)

    def run(self, args: argparse.Namespace) -> int:
        """Run the command; return the exit code."""
        code: int = self._module.run(args)
        return code


class Help(argparse.HelpFormatter):
    """Wraps prose to the width of the terminal; a paragraph with indented lines stays as it is."""

    def __init__(self, prog: str, **options: Any) -> None:
        super().__init__(prog, **{"width": terminal_width() - 2, **options})

    def _fill_text(self, text: str, width: int, indent: str) -> str:  # noqa: ARG002 - the base class has it
        paragraphs = text.split("\n\n")
        return "\n\n".join(p if "\n " in p else textwrap.fill(p, width) for p in paragraphs)


#: How options call a file that they write.
WRITTEN = "FILE"


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one sentence, like all others."""

    def error(self, message: str) -> NoReturn:
        """Raise :class:`UsageError`, with the way to the help."""
        raise UsageError(f"{message.replace(_MARK, '')}; see '{self.prog} --help'")

    def _print_message(self, message: str, file: Any = None) -> None:
        """Print help or version; argparse itself passes over what goes wrong then."""
        say(message.rstrip("\n"), file=file)

    def read(self, argv: Sequence[str]) -> argparse.Namespace:
        """Parse arguments: options may be anywhere before "--", and nothing after it is an option."""
        # Intermixed parsing of Python 3.10 and 3.11 does not know "--", so that what follows it is marked.
        end = argv.index("--") if "--" in argv else len(argv)
        self._refuse_unknown(argv[:end])
        marked = [*argv[:end], *(f"{_MARK}{text}" for text in argv[end + 1 :])]
        found, rest = self.parse_known_intermixed_args(marked)
        if rest:
            self.error(f"unexpected argument '{rest[0]}'")
        args = argparse.Namespace(**{name: _unmark(value) for name, value in vars(found).items()})
        self._refuse_overwriting(args)
        return args

    def _refuse_overwriting(self, args: argparse.Namespace) -> None:
        """Raise :class:`UsageError` if an output file is also read, or written twice."""
        inputs: list[str] = []
        outputs: list[tuple[str, str]] = []
        for action in self._actions:
            value = getattr(args, action.dest, None)
            if not action.option_strings:
                texts = value if isinstance(value, list) else [value]
                inputs += [text for text in texts if text and os.path.exists(text)]
            elif action.metavar == WRITTEN and value:
                outputs.append((action.option_strings[0], value))
        for number, (option, path) in enumerate(outputs):
            if any(same_file(text, path) for text in inputs):
                self.error(f"{option} would overwrite '{path}', which is read: name another file")
            for other, second in outputs[:number]:
                if same_file(path, second):
                    self.error(f"{other} and {option} would both write '{path}': name another file")

    def _refuse_unknown(self, argv: Sequence[str]) -> None:
        """Raise :class:`UsageError` at an option that does not exist; argparse names all that it does not know."""
        known = [option for action in self._actions for option in action.option_strings]
        for text in argv:
            option = text.partition("=")[0]
            if option.startswith("--") and option not in known and " " not in text:
                self.error(f"unknown option '{option}'{did_you_mean(option, known)}")


def _unmark(value: Any) -> Any:
    if isinstance(value, list):
        return [_unmark(item) for item in value]
    return value.removeprefix(_MARK) if isinstance(value, str) else value


def complain(sentence: object) -> None:
    """Print one sentence on stderr, after flushing stdout."""
    sys.stdout.flush()
    say(f"rtamt: {sentence}", file=sys.stderr, flush=True)
