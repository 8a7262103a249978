"""The keys and columns of a batch for a fleet; keys are integers, texts or bytes. And how many keys there may be."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from operator import methodcaller
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, UsageError, shown
from rtamt.lazy.modules import np
from rtamt.signals.arrays import is_frame, is_mapping

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: No fleet has as many keys.
MOST = 2**31

#: By type of keys, the character at their end that an array of numpy loses: two keys would be one.
_PADDED: dict[type, Any] = {str: "\0", bytes: b"\0"}


def capacity_of(given: Any) -> int:
    """Return a number of keys; raise :class:`UsageError` for anything else."""
    if isinstance(given, bool) or not isinstance(given, int | np.integer) or given < 1:
        raise UsageError(f"capacity is {shown(given)}, expected a number of keys, at least 1")
    if given >= MOST:
        raise UsageError(f"capacity is {shown(given)}, expected a number of keys below 2**31")
    return int(given)


def keys_of(keys: Any) -> NDArray[Any]:
    """Return keys as an array of int64, texts or bytes; raise :class:`TraceError` for anything else."""
    if keys.__class__ is np.ndarray and keys.dtype == np.int64 and keys.ndim == 1 and keys.flags.c_contiguous:
        plain: NDArray[Any] = keys
        return plain
    given = keys
    if isinstance(keys, np.ma.MaskedArray):
        masked = np.ma.getmaskarray(keys)
        if masked.any():
            raise _masked_error(int(masked.argmax()))
        keys = given = keys.data
    if not isinstance(keys, np.ndarray):
        if isinstance(keys, str | bytes | bytearray | Mapping) or not isinstance(keys, Iterable):
            raise _no_keys(given)
        keys = list(keys)
        kinds = {type(key) for key in keys}
        if type(np.ma.masked) in kinds:
            raise _masked_error([key is np.ma.masked for key in keys].index(True))
        if len(kinds) > 1:
            names = ", ".join(sorted(kind.__name__ for kind in kinds))
            raise TraceError(f"the keys are of several types ({names}): give integers, texts, or bytes")
        if not keys:
            return np.empty(0, np.int64)
        if kinds <= _PADDED.keys() and any(map(methodcaller("endswith", _PADDED[kinds.pop()]), keys)):
            raise TraceError(
                "a key ends with the character 0, with which numpy pads texts and bytes: give integers, or texts "
                "such as key.hex()"
            )
    try:
        found = np.asarray(keys)
    except (TypeError, ValueError):
        found = np.empty(0, object)
    if found.dtype.kind == "O" and isinstance(given, np.ndarray) and found.ndim == 1:
        return keys_of(found.tolist())
    if found.ndim != 1 or found.dtype.kind not in "iuUS":
        beyond = [key for key in keys if isinstance(key, int) and not -(2**63) <= key < 2**63]
        raise _beyond(beyond[0]) if beyond else _no_keys(given)
    if found.dtype.kind == "u" and found.size and int(found.max()) >= 2**63:
        raise _beyond(int(found.max()))
    if found.dtype.kind in "iu":
        return np.ascontiguousarray(found, np.int64)
    return np.ascontiguousarray(found, found.dtype.newbyteorder("="))


def _no_keys(given: Any) -> TraceError:
    return TraceError(f"the keys are {shown(given)}, expected a sequence of integers, texts, or bytes")


def _beyond(key: int) -> TraceError:
    return TraceError(f"the key {key} is beyond 64 bits with a sign; give it as text")


def _masked_error(index: int) -> TraceError:
    return TraceError(f"the key at index {index} of the batch is masked: leave the sample out")


def is_padded(key: Any) -> bool:
    """Return whether a key ends with the character that an array of numpy loses."""
    return type(key) in _PADDED and key.endswith(_PADDED[type(key)])


def columns_of(columns: Any) -> dict[str, Any]:
    """Return the columns of a batch by variable; of a table, which also holds keys and times, only some are meant."""
    if is_mapping(columns):
        return dict(columns)
    fields = getattr(getattr(columns, "dtype", None), "names", None)
    table = fields or is_frame(columns) or hasattr(columns, "column_names")
    advice = "; give {name: table[name] for name in spec.input_names}" if table else ""
    kind = "a structured array" if fields else type(columns).__name__
    raise TraceError(f"expected a mapping from variable to values, got {kind}{advice}")
