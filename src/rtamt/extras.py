"""Optional imports: the libraries of extras, and the message classes that a specification names.

A specification may come from an untrusted author, so its imports are restricted:

- only from modules called ``<package>.msg``, like ROS messages;
- only from packages that are on the module path deliberately: a package in the current directory, which
  Python searches by default, is rejected unless Python code has already imported it;
- only from packages with a module ``msg``: no other package is imported to find out;
- only message classes: those of ROS 1 (``genpy.Message``) and of ROS 2, which have
  ``get_fields_and_field_types``. Nothing else in a module is called.
"""

from __future__ import annotations

import importlib
import os
import re
import sys
from importlib.machinery import PathFinder

from rtamt.errors import UsageError, did_you_mean
from rtamt.lazy.patterns import lazy_pattern
from rtamt.lazy.typing import Any

_MESSAGE_MODULE = lazy_pattern(r"([A-Za-z]\w*)\.msg", re.ASCII)
_MESSAGE_CLASS = lazy_pattern(r"[A-Za-z]\w*", re.ASCII)


def library(module: str, what: str, extra: str) -> Any:
    """Import a library of one of the extras; raise :class:`UsageError` if it is not installed.

    ``what``: the feature that needs it, the beginning of the message.
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
    spec = PathFinder.find_spec(package)  # finds a package without executing it
    if spec is None:
        return False
    places = list(spec.submodule_search_locations or ()) or [spec.origin or ""]
    here = os.path.realpath(os.curdir)
    return any(os.path.realpath(os.path.dirname(os.path.abspath(place))) == here for place in places)


def _has_no_messages(package: str, module: str) -> bool:
    """Return whether a package is on the module path and has no messages, without executing it."""
    # A package may span several folders, such as ROS overlays, which it joins when it is executed.
    specs = [spec for entry in sys.path if (spec := PathFinder.find_spec(package, [entry])) is not None]
    places = [place for spec in specs for place in spec.submodule_search_locations or ()]
    return bool(specs) and PathFinder.find_spec(module, places) is None


def _is_message(found: object) -> bool:
    if not isinstance(found, type):
        return False
    genpy = sys.modules.get("genpy")  # imported by every ROS 1 message module
    return hasattr(found, "get_fields_and_field_types") or (
        genpy is not None and issubclass(found, genpy.Message)
    )
