"""A back end hidden from the fast path, because the times of its samples have to be converted first."""

from __future__ import annotations

from rtamt.lazy.typing import Any


class SlowPath:
    """Delegates everything to a back end, but is not one of the core's."""

    def __init__(self, inner: Any) -> None:
        self.inner = inner

    def __getattr__(self, name: str) -> Any:
        return getattr(self.inner, name)


def inner_of(backend: Any) -> Any:
    """Return the back end itself."""
    return backend.inner if isinstance(backend, SlowPath) else backend
