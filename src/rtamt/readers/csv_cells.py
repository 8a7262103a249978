"""Columns of text to columns of numbers or dates, as exact as they are written; an empty cell is a missing value."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.errors import shown
from rtamt.language.value_types import Enumeration
from rtamt.lazy.modules import np
from rtamt.readers.csv import Header, is_boolean, is_number, number, truth
from rtamt.readers.dates import DateError, Dates, is_date

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.language.value_types import ValueType
    from rtamt.readers.source import Raw

#: From here on a double may not be the integer that was written.
LARGEST = 2.0**53


class Cells:
    """One column of a file, which grows by blocks of rows.

    What its first cell is, a number, true or false, or a date, all others must be.
    """

    def __init__(
        self,
        header: Header,
        name: str,
        dated: bool | None = None,
        *,
        skip_nan: bool = False,
        type_: ValueType | None = None,
    ) -> None:
        self._skip_nan = skip_nan
        self._enumeration = type_ if isinstance(type_, Enumeration) else None
        self._header = header
        self._name = name
        self._dated = (
            dated if self._enumeration is None else False
        )  # None: not known before the first cell that is not empty
        self._boolean = False
        self._dates = Dates()
        self._whole = True  # whether all numbers are integers that an int64 holds
        self._parts: list[Raw] = []
        self._missing: list[Raw] = []

    def extend(self, texts: Sequence[str], lines: Sequence[int]) -> None:
        """Add cells, each with its line in the file; raise :class:`TraceError` at one that is neither."""
        texts = [text.strip() for text in texts]
        missing = np.array([not text for text in texts], dtype=bool)
        given = [(text, line) for text, line in zip(texts, lines, strict=True) if text]
        if self._dated is None and given:
            self._dated, self._boolean = is_date(given[0][0]), is_boolean(given[0][0])
        values = self._of(given)
        if missing.any():
            part = np.zeros(len(texts), values.dtype)
            part[~missing] = values
            values = part
        self._parts.append(values)
        self._missing.append(missing)

    def values(self) -> Raw:
        """Return all cells: int64 where all are integers, else float64, or datetime64[ns]; masked where empty."""
        parts = self._parts
        if not self._dated:
            parts = [part.astype(np.int64 if self._whole else np.float64) for part in parts]
        result = np.concatenate(parts) if parts else np.empty(0)
        missing = np.concatenate(self._missing) if parts else np.empty(0, dtype=bool)
        return np.ma.masked_array(result, missing) if missing.any() else result

    def take(self) -> Raw:
        """Return all cells since the last call, and forget them."""
        values = self.values()
        self._parts, self._missing = [], []
        return values

    def _of(self, given: Sequence[tuple[str, int]]) -> Raw:
        if self._enumeration is not None:
            return self._codes(given, self._enumeration)
        if self._dated:
            return self._moments(given)
        return self._truths(given) if self._boolean else self._numbers(given)

    def _codes(self, given: Sequence[tuple[str, int]], enumeration: Enumeration) -> Raw:
        """Return the codes of members, which are given by name or by code."""
        values = []
        for text, line in given:
            code = enumeration.code(text)
            if code is None and not is_number(text):
                problem = f"'{self._name}' is {shown(text)}, which is {enumeration.unknown_member(text)}"
                raise self._header.error(line, problem, self._name)
            values.append(self._number(text, line) if code is None else float(code))
        self._whole = False
        return np.array(values, dtype=np.float64)

    def _truths(self, given: Sequence[tuple[str, int]]) -> Raw:
        truths = [truth(text, self._name, self._header, line) for text, line in given]
        return np.array(truths, dtype=np.float64)

    def _numbers(self, given: Sequence[tuple[str, int]]) -> Raw:
        texts = [text for text, _ in given]
        together = "".join(texts)
        try:
            values = np.array(texts, dtype=np.float64)
            plain = (self._skip_nan or not np.isnan(values).any()) and not np.isinf(values).any()
        except ValueError:
            plain = False
        if not plain or "_" in together or not together.isascii():
            values = np.array([self._number(text, line) for text, line in given])
        if self._whole and len(values):
            largest = float(np.abs(values).max())
            if largest >= LARGEST:
                exact = _integers(texts)
                self._whole = exact is not None
                return values if exact is None else exact
            self._whole = bool((values == np.rint(values)).all())
        return values

    def _number(self, text: str, line: int) -> float:
        value = number(text, self._name, self._header, line, nan=True)
        if np.isnan(value) and not self._skip_nan:
            raise self._header.error(
                line,
                f"'{self._name}' is NaN: fill the gap, or leave such samples out with skip_nan=, "
                f"on the command line --skip-nan",
                self._name,
            )
        return value

    def _moments(self, given: Sequence[tuple[str, int]]) -> Raw:
        texts = [text for text, _ in given]
        try:
            return self._dates.take(texts)
        except DateError as error:
            text, line = given[error.index]
            raise self._header.error(line, f"'{self._name}' is '{text}', {error}", self._name) from None


def _integers(texts: Sequence[str]) -> Raw | None:
    try:
        return np.array([int(text) for text in texts], dtype=np.int64)
    except (ValueError, OverflowError):
        return None
