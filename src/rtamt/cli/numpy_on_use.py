"""NumPy on the command line: imported when a command first uses it; that takes longer than most commands do."""

from __future__ import annotations

import os
import sys
from importlib.util import find_spec, module_from_spec
from threading import RLock
from types import ModuleType
from typing import Any

_LOADING = RLock()


class _Unloaded(ModuleType):
    """NumPy before its first use, which loads it into this very module."""

    def __getattr__(self, name: str) -> Any:
        with _LOADING:
            if self.__class__ is _Unloaded:
                spec = self.__spec__
                assert spec is not None
                assert spec.loader is not None
                _become(self, _Loading)
                self.__path__ = list(spec.submodule_search_locations or ())
                spec.loader.exec_module(self)
                _become(self, ModuleType)
        return getattr(self, name)


class _Loading(ModuleType):
    """NumPy while one thread loads it: the others wait for what is not there yet."""

    def __getattr__(self, name: str) -> Any:
        with _LOADING:
            if self.__class__ is _Loading:  # it is this thread that loads it
                raise AttributeError(
                    f"module '{self.__name__}' has no attribute '{name}'", name=name, obj=self
                )
        return getattr(self, name)


def _become(module: ModuleType, kind: type[ModuleType]) -> None:
    module.__class__ = kind


def load_numpy_on_use() -> None:
    """Let ``import numpy`` from now on wait for the first use; call it before anything imports NumPy."""
    spec = find_spec("numpy") if "numpy" not in sys.modules else None
    if spec is None:
        return
    # Threads that multiply matrices start with NumPy, and cost more than the rest of it; no command multiplies any.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    unloaded = module_from_spec(spec)
    del unloaded.__path__  # an import of numpy.linalg, for instance, is a use as well
    _become(unloaded, _Unloaded)
    sys.modules["numpy"] = unloaded
