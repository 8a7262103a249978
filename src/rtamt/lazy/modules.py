"""Modules that are imported when they are first used.

Every module takes ``np`` and ``dt`` from here. A monitor of plain numbers needs neither, and the import of NumPy takes
longer than ours. A module that uses one of them where it is defined would import it with itself.

>>> from rtamt.lazy.modules import dt, np
>>> int(np.array([1, 2]).sum()), dt.timedelta(minutes=1).total_seconds()
(3, 60.0)
"""

from __future__ import annotations

from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import datetime as dt

    import numpy as np
else:
    from types import ModuleType

    from rtamt.lazy import import_module

    class Unloaded(ModuleType):
        """A module that becomes a copy of the one it names, as fast to read, with the first name that is read of it."""

        def __getattr__(self, name: str) -> Any:
            loaded = import_module(self.__name__)
            self.__dict__.update(vars(loaded))
            self.__class__ = ModuleType
            return getattr(loaded, name)

    dt = Unloaded("datetime")
    np = Unloaded("numpy")

__all__ = ["dt", "np"]
