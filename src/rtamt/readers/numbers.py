"""The values of a column as numbers, and which of them are missing."""

from __future__ import annotations

from decimal import Decimal
from math import isinf, nan
from numbers import Integral
from typing import TYPE_CHECKING, Any

from rtamt.errors import TraceError, shown
from rtamt.language.value_types import Enumeration
from rtamt.lazy.modules import np
from rtamt.signals.arrays import TOO_LARGE, is_masked, number_expected, number_of
from rtamt.signals.coding import encoded_value

if TYPE_CHECKING:
    from rtamt.readers.source import Field, Raw


#: Doubles hold all integers up to this one.
EXACT = 2**53


def numbers_of(raw: Raw, field: Field, source: str, before: int = 0, *, copy: bool = True) -> tuple[Any, Any]:
    """Return float64 values and a mask of the missing ones (None: none); raise :class:`TraceError` at no number.

    ``copy``: whether the values may not share memory with ``raw``.
    """
    missing = np.ma.getmaskarray(raw) if is_masked(raw) else None
    plain = np.ma.getdata(raw) if is_masked(raw) else np.asarray(raw)
    if plain.dtype.kind in "fiub":
        with np.errstate(over="ignore"):
            numbers = plain.astype(np.float64, copy=copy)
        if plain.dtype.kind == "f" and plain.dtype.itemsize > 8:
            beyond = np.flatnonzero(np.isinf(numbers) & ~np.isinf(plain))
            if len(beyond):
                raise _no_number(plain[beyond[0]], field, source, before + int(beyond[0]))
        return numbers, missing
    if plain.dtype.kind == "U" and isinstance(field.type, Enumeration):
        plain = plain.astype(object)
    if plain.dtype.kind != "O":
        raise _no_number(plain[0] if len(plain) else plain.dtype, field, source, before)
    absent = np.array([value is None for value in plain], dtype=bool)
    missing = absent if missing is None else missing | absent
    values = np.zeros(len(plain))
    for i in np.flatnonzero(~missing):
        value = encoded_value(
            plain[i], field.column, field.type, f"sample {before + i} of {source}", before + int(i)
        )
        number = double_of(value)
        if number is None:
            raise _no_number(value, field, source, before + int(i))
        values[i] = number
    return values, missing


def double_of(value: Any) -> float | None:
    """Return a number as the nearest double, also a Decimal; None for anything else or if it is too large.

    >>> double_of(Decimal("0.5")), double_of(Decimal("sNaN")), double_of(Decimal("1e400")), double_of("1")
    (0.5, nan, None, None)
    """
    if not isinstance(value, Decimal):
        return number_of(value)
    if value.is_nan():
        return nan  # float() rejects a signaling one
    number = float(value)
    return None if isinf(number) and value.is_finite() else number


def problem_of(value: object, of: str = "") -> str:
    """Return the problem of a value for which :func:`double_of` has no double; ``of``: what numbers are expected."""
    return TOO_LARGE if isinstance(value, Decimal) else number_expected(value, of)


def is_whole(value: object) -> bool:
    """Return whether a number is an integer, also a Decimal without a fraction.

    >>> is_whole(1), is_whole(Decimal("1.00")), is_whole(Decimal("0.5")), is_whole(1.0)
    (True, True, False, False)
    """
    if isinstance(value, Decimal):
        return value.is_finite() and value == value.to_integral_value()
    return isinstance(value, Integral)


def is_rounded(value: int) -> bool:
    """Return whether no double holds an integer, which is in the range of doubles.

    >>> is_rounded(2**53), is_rounded(2**53 + 1), is_rounded(2**54)
    (False, True, False)
    """
    return not -EXACT <= value <= EXACT and int(float(value)) != value


def rounded(raw: Raw) -> Any:
    """Return which values are integers that no double holds, a mask; None: none.

    >>> rounded(np.array([2**53, 2**53 + 1, -(2**63)]))
    array([False,  True, False])
    """
    plain = np.ma.getdata(raw) if is_masked(raw) else np.asarray(raw)
    if not len(plain):
        return None
    if plain.dtype.kind == "O":
        large = [is_whole(value) and is_rounded(int(value)) for value in plain]
        return np.array(large, dtype=bool) if any(large) else None
    if plain.dtype.kind not in "iu" or plain.dtype.itemsize < 8:
        return None
    if int(plain.min()) >= -EXACT and int(plain.max()) <= EXACT:
        return None
    numbers = plain.astype(np.float64)
    # The greatest integers are rounded to one that this type does not hold.
    too_large = numbers >= (2.0**63 if plain.dtype.kind == "i" else 2.0**64)
    changed = np.where(too_large, 0.0, numbers).astype(plain.dtype) != plain
    return changed if changed.any() else None


def _no_number(value: Any, field: Field, source: str, row: int) -> TraceError:
    return TraceError(
        f"'{field.column}' of {source} is {shown(value)} at sample {row}, {problem_of(value)}",
        variable=field.name,
        index=row,
    )
