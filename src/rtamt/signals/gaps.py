"""Missing samples in containers: ``None``, nulls of Arrow and polars, ``pandas.NA`` and masked values."""

from __future__ import annotations

import sys
from itertools import repeat
from operator import is_

from rtamt.lazy.modules import np
from rtamt.lazy.typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    Mask = NDArray[np.bool_]

#: The classes of values in lists that are missing ones, beside None.
_ABSENT = ("NAType", "MaskedConstant")


def gaps_of(values: Any) -> Mask | None:
    """Return where samples are missing; None for containers that cannot have gaps."""
    if isinstance(values, np.ma.MaskedArray):
        return np.ma.getmaskarray(values)
    if hasattr(values, "null_count") and hasattr(values, "is_null"):  # Arrow, polars
        return np.asarray(values.is_null(), bool)
    kind = getattr(values, "dtype", None)
    if kind is not None and not isinstance(kind, np.dtype):  # a type of pandas' own
        return np.asarray(values.isna(), bool)
    if isinstance(values, list | tuple) or kind == np.dtype(object):
        return np.array([value is None or type(value).__name__ in _ABSENT for value in values], bool)
    return None


def reads_as_nan(values: Any) -> bool:
    """Return whether samples are missing that numpy would read as NaN.

    >>> reads_as_nan([5, np.ma.masked]), reads_as_nan(np.ma.array([5, 1], mask=[0, 1])), reads_as_nan([5, None])
    (True, True, False)
    """
    loaded: Any = sys.modules.get("numpy.ma")  # whoever has masked values has loaded it
    if isinstance(values, list | tuple):
        return loaded is not None and any(map(is_, values, repeat(loaded.masked)))
    if loaded is not None and isinstance(values, loaded.MaskedArray):
        return bool(values.mask.any())
    if isinstance(getattr(values, "dtype", None), np.dtype):
        return False
    gaps = gaps_of(values)
    return gaps is not None and bool(gaps.any())


def items_of(values: Any) -> list[Any]:
    """Return the values of a container one by one, missing ones as whatever it has in their place."""
    if isinstance(values, np.ma.MaskedArray):
        return list(values.filled(0))
    return list(elements_of(values))


def elements_of(values: Any) -> Iterable[Any]:
    """Return the values of a container one by one as Python has them: those of Arrow are objects of its own."""
    found: Iterable[Any] = values.to_pylist() if hasattr(values, "to_pylist") else values
    return found
