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
    from types import ModuleType


def import_module(name: str) -> "ModuleType":
    """Return a module by its full name, as :func:`importlib.import_module` does, which imports :mod:`warnings`, too."""
    __import__(name)
    return sys.modules[name]
