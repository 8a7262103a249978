"""What need not be installed: libraries that only some programs need, and the message classes a text names.

A specification is text, which somebody else may have written, so that it imports very little:

- only from modules called ``<package>.msg``, as the messages of ROS are;
- only from packages that lie on the module path by choice: one that is found in the current directory, where
  Python looks by itself, is refused unless Python code has imported it already;
- only from packages that have a module ``msg``: no other package is imported to find out;
- only message classes: those of ROS 1 (``genpy.Message``) and of ROS 2, which have
  ``get_fields_and_field_types``. Nothing else of a module is called.
"""

from __future__ import annotations

import importlib
import os
import re
import sys
from importlib.machinery import PathFinder
from typing import Any

from rtamt.errors import UsageError, did_you_mean

_MESSAGE_MODULE = re.compile(r"([A-Za-z]\w*)\.msg", re.ASCII)
_MESSAGE_CLASS = re.compile(r"[A-Za-z]\w*", re.ASCII)


def library(module: str, what: str, extra: str) -> Any:
    """Import a library that an extra of ours installs; raise :class:`UsageError` where it is not there.

    ``what``: what needs it, the beginning of the sentence.
    """
    try:
        return importlib.import_module(module)
    except ImportError as error:
        package = (error.name or module).split(".")[0]
        raise UsageError(
            f"{what} needs the package '{package}', which is not installed: pip install 'rtamt[{extra}]'"
        ) from None


def message_class(module: str, name: str) -> type:
    """Import the message class that a specification names; raise :class:`UsageError` for anything else."""
    package = message_package(module, name)
    if module not in sys.modules and _is_in_current_directory(package):
        raise UsageError(
            f"the message package '{package}' lies in the current directory, from which a specification does not "
            f"import: run the program in another directory, or import '{module}' in Python code first"
        )
    hint = "is the workspace built, and its setup file sourced?"
    if module not in sys.modules and _has_no_messages(package, module):
        raise UsageError(f"'{package}' is no message package: it has no module 'msg'; {hint}")
    try:
        loaded = importlib.import_module(module)
    except ImportError as error:
        raise UsageError(f"the message module '{module}' cannot be imported: {error}; {hint}") from error
    if not hasattr(loaded, name):
        raise UsageError(f"'{module}' has no '{name}'{did_you_mean(name, vars(loaded))}")
    found = getattr(loaded, name)
    if not _is_message(found):
        raise UsageError(
            f"'{name}' of '{module}' is no message class; a specification imports nothing but those"
        )
    result: type = found
    return result


def message_package(module: str, name: str) -> str:
    """Return the package of a message type; raise :class:`UsageError` unless a specification may import it."""
    match = _MESSAGE_MODULE.fullmatch(module)
    if match is None:
        raise UsageError(
            f"a specification imports from message packages only, such as std_msgs.msg, and not '{name}' "
            f"from '{module}'"
        )
    if _MESSAGE_CLASS.fullmatch(name) is None:
        raise UsageError(f"'{name}' cannot be the name of a message class in '{module}'")
    return match[1]


def _is_in_current_directory(package: str) -> bool:
    spec = PathFinder.find_spec(package)  # finds a package without running it
    if spec is None:
        return False
    places = list(spec.submodule_search_locations or ()) or [spec.origin or ""]
    here = os.path.realpath(os.curdir)
    return any(os.path.realpath(os.path.dirname(os.path.abspath(place))) == here for place in places)


def _has_no_messages(package: str, module: str) -> bool:
    """Tell whether a package lies on the module path and has no messages, without running it."""
    # A package of several folders, such as a workspace over another one, joins them when it is run.
    specs = [spec for entry in sys.path if (spec := PathFinder.find_spec(package, [entry])) is not None]
    places = [place for spec in specs for place in spec.submodule_search_locations or ()]
    return bool(specs) and PathFinder.find_spec(module, places) is None


def _is_message(found: object) -> bool:
    if not isinstance(found, type):
        return False
    genpy = sys.modules.get("genpy")  # which every module of messages for ROS 1 imports
    return hasattr(found, "get_fields_and_field_types") or (
        genpy is not None and issubclass(found, genpy.Message)
    )
