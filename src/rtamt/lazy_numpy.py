"""NumPy, imported when it is first used: a monitor of plain numbers needs none, and its import takes longer than ours.

Every module takes ``np`` from here. A module that uses it where it is defined would import NumPy with itself.

>>> from rtamt.lazy_numpy import np
>>> int(np.array([1, 2]).sum())
3
"""

from __future__ import annotations

from rtamt.lazy_typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np
else:
    from importlib import import_module
    from types import ModuleType

    class Unloaded(ModuleType):
        """A module that becomes a copy of the one it names, as fast to read, with the first name that is read of it."""

        def __getattr__(self, name: str) -> Any:
            loaded = import_module(self.__name__)
            self.__dict__.update(vars(loaded))
            self.__class__ = ModuleType
            return getattr(loaded, name)

    np = Unloaded("numpy")

__all__ = ["np"]
