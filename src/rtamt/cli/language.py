"""The option ``--language``: custom operators from a Python module."""

from __future__ import annotations

import importlib
import os
import sys
from typing import TYPE_CHECKING

from rtamt.errors import UsageError, shown
from rtamt.language.operators import STL, Language

if TYPE_CHECKING:
    import argparse


def add_language_option(parser: argparse._ActionsContainer) -> None:
    """Add the choice of a language."""
    parser.add_argument(
        "--language",
        metavar="MODULE:NAME",
        help="a language with custom operators: a Python module (the current directory is searched) and a name in it",
    )


def read_language(given: str | None) -> Language:
    """Return the language of this name; STL for None."""
    if given is None:
        return STL
    module, _, name = given.partition(":")
    if not module or not name:
        raise UsageError(
            f"--language is '{given}'; give a module and a name in it, such as my_operators:MINE"
        )
    here = os.getcwd()
    sys.path.insert(0, here)  # as the interpreter itself has it, and a console script has not
    try:
        language = getattr(importlib.import_module(module), name, None)
    except ModuleNotFoundError as error:
        if error.name != module:
            raise
        raise UsageError(f"there is no module '{module}' for --language {given}") from None
    finally:
        sys.path.remove(here)
    if not isinstance(language, Language):
        raise UsageError(
            f"'{name}' in the module '{module}' is {shown(language)}, expected a Language: STL.extend(...)"
        )
    return language
