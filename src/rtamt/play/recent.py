"""A cache of the last result, for zooming and moving the cursor without a new evaluation."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from rtamt.lazy.dataclasses import replace

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.play.messages import Request

T = TypeVar("T")


class Recent(Generic[T]):
    """A cache with one entry: the last request and its result.

    Requests that differ only in ``width``, ``view`` and ``at`` share a result.
    """

    def __init__(self) -> None:
        self._kept: tuple[Request, T] | None = None

    def keep(self, request: Request, found: T) -> T:
        """Replace the entry by the result of a request, and return it."""
        self._kept = _without_view(request), found
        return found

    def of(self, request: Request, compute: Callable[[], T]) -> T:
        """Return the cached result of a request; compute and cache it if there is none."""
        if self._kept is not None and self._kept[0] == _without_view(request):
            return self._kept[1]
        return self.keep(request, compute())


def _without_view(request: Request) -> Request:
    return replace(request, width=0, view=None, at=None)
