"""The door to the compiled core: asked for when it is needed, with a clear answer where it is not built."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import UsageError

if TYPE_CHECKING:
    from types import ModuleType


def core() -> ModuleType:
    """Return the compiled core; raise :class:`UsageError` where it is not installed."""
    try:
        from rtamt.engine import _core
    except ImportError as error:
        raise UsageError(
            f"the compiled core cannot be loaded ({error}); install the package with a C++ compiler at hand, "
            f"or use backend='python'"
        ) from None
    return _core
