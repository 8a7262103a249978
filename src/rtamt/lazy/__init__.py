"""What the standard library and NumPy do at import, done at first use, so that a program starts faster.

===========  ======================================================================
module       purpose
===========  ======================================================================
typing       names of annotations, without the module :mod:`typing`
modules      :mod:`numpy` and :mod:`datetime`, imported when they are first used
functions    functions of modules that are imported when one of them is called
patterns     regular expressions, compiled when they are first used
dataclasses  data classes, whose methods are made when they are first called
tuples       named tuples, whose constructor is compiled once a class has instances
===========  ======================================================================
"""

import sys

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from types import ModuleType
    from typing import Any


def import_module(name: str) -> "ModuleType":
    """Return a module by its full name, as :func:`importlib.import_module` does, which imports :mod:`warnings`, too."""
    __import__(name)
    return sys.modules[name]


def attributes(module: str, modules: "Mapping[str, str]") -> "Callable[[str], Any]":
    """Return the ``__getattr__`` of a module whose attributes are imported on first use.

    ``modules``: the full name of the module that defines each attribute.
    """

    def attribute(name: str) -> "Any":
        if name not in modules:
            raise AttributeError(f"module '{module}' has no attribute '{name}'")
        found = getattr(import_module(modules[name]), name)
        setattr(sys.modules[module], name, found)
        return found

    return attribute
