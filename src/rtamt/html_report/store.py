"""The arrays of a page: compressed, each once, as text that a script of the page decodes when it is needed."""

from __future__ import annotations

import zlib
from base64 import b64encode
from hashlib import sha256
from typing import TYPE_CHECKING, Any

from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Bytes of compressed samples in one page: a browser loads them in about a second.
BUDGET = 96 * 2**20


@dataclass(frozen=True, slots=True)
class Blob:
    """One array: its type in the page (f8, f4, u4), its length, and its bytes, compressed, in base64."""

    kind: str
    length: int
    text: str


class Store:
    """Arrays that the cards of a page refer to by number."""

    def __init__(self, budget: int = BUDGET) -> None:
        self.blobs: list[Blob] = []
        self._numbers: dict[bytes, int] = {}
        self._budget = self._left = budget

    def within(self, budget: int) -> Store:
        """Return a store that puts arrays into the same page within a separate budget."""
        other = Store(budget)
        other.blobs, other._numbers = self.blobs, self._numbers
        return other

    def has_room(self, share: float) -> bool:
        """Return whether more than a share of the budget is left."""
        return self._left > share * self._budget

    def put(self, values: NDArray[Any], share: float | None = None) -> int | None:
        """Return the number of an array, equal ones being one.

        ``share``: the part of what room was left at the start that must remain; where there is no room, nothing is
        stored, and the result is None. Without ``share`` the array is stored in any case.
        """
        if share is not None and not self.has_room(share):
            return None
        array = np.ascontiguousarray(values)
        if array.dtype == np.float64:
            with np.errstate(over="ignore"):
                single = array.astype(np.float32)
            if (single == array).all():
                array = single
        kind = f"{array.dtype.kind}{array.dtype.itemsize}"
        key = sha256(kind.encode() + array.tobytes()).digest()
        if key not in self._numbers:
            # Bytes of equal weight side by side compress better: those of neighbours are often the same.
            weights = array.astype(array.dtype.newbyteorder("<"), copy=False).view(np.uint8)
            packed = zlib.compress(weights.reshape(-1, array.dtype.itemsize).T.tobytes(), 5)
            if share is not None and len(packed) > self._left - share * self._budget:
                return None
            self._left -= len(packed)
            self._numbers[key] = len(self.blobs)
            self.blobs.append(Blob(kind, len(array), b64encode(packed).decode()))
        return self._numbers[key]
