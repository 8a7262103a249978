"""Reject concurrent and reentrant calls of a monitor.

A second call may come from another thread, or from code that the first one runs: the ``__float__`` of a value,
the fields of an object, a custom operator. It is rejected, and neither call affects the other.
"""

from __future__ import annotations

from _thread import allocate_lock
from functools import wraps

from rtamt.errors import UsageError
from rtamt.lazy.typing import TYPE_CHECKING, Concatenate, ParamSpec, Protocol, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable

    P = ParamSpec("P")
    R = TypeVar("R")


class UsageGuard:
    """Admits one call at a time; raises :class:`UsageError` for a second one."""

    __slots__ = ("_lock",)

    def __init__(self) -> None:
        self._lock = allocate_lock()

    def __enter__(self) -> None:
        if not self._lock.acquire(blocking=False):
            raise in_use()

    def __exit__(self, *_: object) -> None:
        self._lock.release()

    def __reduce__(self) -> tuple[type[UsageGuard], tuple[()]]:
        return UsageGuard, ()  # a copy is not in use


class _Guarded(Protocol):
    _usage: UsageGuard


G = TypeVar("G", bound=_Guarded)


def exclusive(method: Callable[Concatenate[G, P], R]) -> Callable[Concatenate[G, P], R]:
    """Make a method hold the ``_usage`` of its object."""

    @wraps(method)
    def guarded(self: G, /, *args: P.args, **kwargs: P.kwargs) -> R:
        lock = self._usage._lock  # in half the time of ``with self._usage``
        if not lock.acquire(False):
            raise in_use()
        try:
            return method(self, *args, **kwargs)
        finally:
            lock.release()

    return guarded


def in_use() -> UsageError:
    """Return the error for a monitor that is, or has meanwhile been, used by another call."""
    return UsageError(
        "the monitor is in use by another call, from another thread or from a value or operator that calls it "
        "back; give each thread a monitor of its own"
    )
