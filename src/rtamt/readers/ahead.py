"""Chunks of a recording, read in a thread while those before are evaluated."""

from __future__ import annotations

from queue import Queue
from threading import Event, Thread
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from collections.abc import Iterator

T = TypeVar("T")

#: Chunks that are read before they are requested.
_DEPTH = 2


def ahead(items: Iterator[T]) -> Iterator[T]:
    """Yield the items of ``items``, and raise its errors; a thread is some items ahead.

    It pays where items are made without the GIL. The thread ends with the iterator, however that ends.

    >>> list(ahead(iter("abc")))
    ['a', 'b', 'c']
    """
    queue: Queue[T | _End] = Queue(_DEPTH)
    stopped = Event()

    def read() -> None:
        try:
            for item in items:
                queue.put(item)
                if stopped.is_set():
                    return
        except BaseException as error:  # noqa: BLE001 - raised where the items are requested
            queue.put(_End(error))
        else:
            queue.put(_End(None))

    thread = Thread(target=read, name="rtamt-reader", daemon=True)
    thread.start()
    try:
        while not isinstance(item := queue.get(), _End):
            yield item
        if item.error is not None:
            raise item.error
    finally:
        stopped.set()
        while thread.is_alive():
            while not queue.empty():  # the thread may wait for a place
                queue.get()
            thread.join(0.01)


class _End:
    """The end of the items, or the error that ended them."""

    def __init__(self, error: BaseException | None) -> None:
        self.error = error
