"""The last result, so that looking closer at it, or at another instant, does not compute it again."""

from __future__ import annotations

from typing import TYPE_CHECKING, Generic, TypeVar

from rtamt.lazy_dataclasses import replace

if TYPE_CHECKING:
    from collections.abc import Callable

    from rtamt.play.messages import Request

T = TypeVar("T")


class Recent(Generic[T]):
    """What was computed last, and of which request.

    Requests that differ only in what is seen of the result (``width``, ``view`` and ``at``) have the same.
    """

    def __init__(self) -> None:
        self._kept: tuple[Request, T] | None = None

    def keep(self, request: Request, found: T) -> T:
        """Keep what was computed for a request in place of what was kept; return it."""
        self._kept = _without_view(request), found
        return found

    def of(self, request: Request, compute: Callable[[], T]) -> T:
        """Return what is kept of a request, else compute and keep it."""
        if self._kept is not None and self._kept[0] == _without_view(request):
            return self._kept[1]
        return self.keep(request, compute())


def _without_view(request: Request) -> Request:
    return replace(request, width=0, view=None, at=None)
