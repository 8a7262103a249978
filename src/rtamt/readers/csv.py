"""CSV files: a header row that names the columns, then a row of values for each sample."""

from __future__ import annotations

import csv
from contextlib import suppress
from itertools import chain, islice
from math import isinf, isnan
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.errors import TraceError, shown
from rtamt.lazy.dataclasses import dataclass
from rtamt.lazy.modules import np
from rtamt.lazy.patterns import lazy_pattern
from rtamt.readers.dates import EXAMPLE, is_date
from rtamt.signals.time_columns import column_name, unit_called

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Sequence
    from typing import TextIO

    from rtamt.signals.arrays import FloatArray

DELIMITERS = (",", ";", "\t", "|")

#: The parts of a header in which a delimiter is a character of a name, as in "x [m,n]".
_ENCLOSED = lazy_pattern(r'"(?:[^"]|"")*"|\[[^\]]*\]|\([^)]*\)')

BLOCK = 65_536  # lines at a time: enough to keep numpy busy, little enough to keep memory flat
_CELLS = 2**22  # at a time, where lines are long
#: Characters of a line: the end of a log that was cut off may be any number of zeros.
LONGEST_LINE = 2**26


@dataclass(frozen=True, slots=True)
class Header:
    """The names of the columns, and how the file is written."""

    file: str
    names: tuple[str, ...]
    delimiter: str
    line: int  # of the file, in which the header ends

    def error(self, line: int, problem: str, variable: str | None = None) -> TraceError:
        """Return an error with its place in the file."""
        return TraceError(f"{self.file}, line {line}: {problem}", variable=variable)


@dataclass(frozen=True, slots=True)
class Column:
    """A selected column: its name in the result, its position in the file, and whether it may contain NaN, or text."""

    name: str
    position: int
    skip_nan: bool = False
    lenient: bool = False


def lines_of(file: TextIO, name: str, before: int = 0) -> Iterator[str]:
    """Yield the lines of a file; raise :class:`TraceError` at one without an end. ``before``: lines read before."""
    number = before
    while line := file.readline(LONGEST_LINE):
        number += 1
        if len(line) == LONGEST_LINE:
            raise TraceError(
                f"{name}, line {number}: the line has {LONGEST_LINE:,} characters or more; the file is damaged, or no "
                f"CSV: export it again"
            )
        yield line


# ---- the header ----------------------------------------------------------------------------------


def read_header(lines: Iterator[str], file: str, before: int = 0) -> tuple[Header, Iterator[str]]:
    """Read the row that names the columns; return it, and the lines after it. ``before``: lines read before.

    Where the first row is all numbers, a comment right above it has the names: numpy writes such files.
    """
    first, comment, count, chosen = "", "", before, None
    for first in lines:
        count += 1
        if count == 1 and (chosen := separator(first)):
            continue
        if not first.isspace() and not first.startswith("#"):
            break
        comment = first.lstrip("#") if first.startswith("#") else ""
    else:
        raise TraceError(f"'{file}' is empty: it needs a row of column names, then a row for each sample")
    if chosen is None:
        delimiter, lines = _delimiter(first, lines, file, count)
    else:
        delimiter = chosen
    reader = csv.reader(chain([first], lines), delimiter=delimiter, skipinitialspace=True)
    try:
        cells = next(reader)
    except csv.Error as error:
        raise TraceError(f"{file}, line {count - 1 + reader.line_num}: {_reason(error)}") from None
    header = Header(file, tuple(map(column_name, cells)), delimiter, count - 1 + reader.line_num)
    if not all(is_value(cell) for cell in header.names if cell):
        return header, lines
    names = tuple(map(column_name, comment.split(delimiter)))
    if len(names) == len(cells) and all(names):
        return Header(file, names, delimiter, count - 1), chain([first], lines)
    raise header.error(
        header.line,
        f"expected a row of column names, such as time,x; got '{first.strip()}': put the names above it",
    )


def _delimiter(header: str, lines: Iterator[str], file: str, number: int) -> tuple[str, Iterator[str]]:
    """Return the delimiter of a header, and the lines after it; raise :class:`TraceError` where several are possible.

    Of those between names, it is the one that gives the next row as many cells. ``number``: of the header's line.
    """
    outside = _ENCLOSED.sub("", header)
    found = [each for each in DELIMITERS if each in outside] or [
        each for each in DELIMITERS if each in header
    ]
    if not found or found in ([","], [";"], ["\t"]):
        return (found or DELIMITERS)[0], lines
    read = []
    for row in lines:
        read.append(row)
        if not row.isspace() and not row.startswith("#"):
            break
    lines = chain(read, lines)
    if not read:  # of a stream, the header comes alone
        return max(found, key=header.count), lines
    alike = [each for each in found if _cells(header, each) == _cells(read[-1], each)]
    if len(alike) > 1:
        either = " or ".join("a tab" if each == "\t" else f"'{each}'" for each in alike)
        raise TraceError(
            f"{file}, line {number}: the columns of '{header.strip()}' may be separated by {either}: name it in a "
            f"first line, such as 'sep={next(filter(str.strip, alike))}', or quote the names that contain another"
        )
    if not alike and found == ["|"]:
        return DELIMITERS[0], lines
    return max(alike or found, key=header.count), lines


def _cells(line: str, delimiter: str) -> int:
    return len(next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), ()))


def separator(line: str) -> str | None:
    """Return the delimiter that the first line of a file names, as spreadsheets read and write it.

    >>> separator("sep=;"), separator("sep"), separator("sep=ab")
    (';', None, None)
    """
    name, _, delimiter = line.rstrip("\r\n").partition("=")
    return delimiter if name.lower() == "sep" and delimiter in DELIMITERS else None


def _listing(header: Header) -> str:
    shown = header.names[:12]
    more = len(header.names) - len(shown)
    return ", ".join(shown) + (f" and {more} more" if more else "")


# ---- the rows ------------------------------------------------------------------------------------


def plain(block: list[str], header: Header, columns: Sequence[Column]) -> FloatArray | None:
    """Return the values of a block of lines, one row for each column; None if anything is unusual."""
    text = "".join(block)
    if '"' in text or "#" in text or not columns or any(not line or line.isspace() for line in block):
        return None
    if {line.count(header.delimiter) for line in block} != {len(header.names) - 1}:
        return None
    with suppress(ValueError):
        positions = [column.position for column in columns]
        values = np.loadtxt(block, delimiter=header.delimiter, usecols=positions, comments=None, ndmin=2)
        # A number beyond the range of a double is infinite here; only its text distinguishes it from infinity.
        skipped = [column.skip_nan for column in columns]
        if not np.isinf(values).any() and not np.isnan(values[:, np.logical_not(skipped)]).any():
            return np.ascontiguousarray(values.T)
    return None  # the slow way finds the cell that is no number


def block_of(header: Header) -> int:
    """Return the number of lines that are read at a time."""
    return max(1, min(BLOCK, _CELLS // len(header.names)))


def blocks(lines: Iterator[str], header: Header) -> Iterator[list[tuple[int, list[str]]]]:
    """Yield the rows after the header, many at a time, each with its line: as many cells as there are columns."""
    checked = rows(lines, header, header.line)
    while block := list(islice(checked, block_of(header))):
        for line, row in block:
            check_width(row, header, line)
        yield block


def rows(lines: Iterator[str], header: Header, before: int) -> Iterator[tuple[int, list[str]]]:
    """Yield the cells of each row with its line; ``before``: lines of the file before these.

    An empty line is no row, but in a file of one column a missing sample, unless none follows.
    """
    taken: list[str] = []  # the lines of one row
    empty: list[int] = []  # lines of a file of one column that may be missing samples

    def kept() -> Iterator[str]:
        for line in lines:
            taken.append(line)
            yield line

    reader = csv.reader(kept(), delimiter=header.delimiter, skipinitialspace=True)
    try:
        for row in reader:
            line = before + reader.line_num
            blank = len(row) <= 1 and not any(map(str.strip, taken))
            if len(taken) > 1:
                _check_quotes(taken, header, line)
            taken.clear()
            if blank and len(header.names) == 1:
                empty.append(line)
            if blank or (row[0][:1] == "#" and is_comment(row, header, line)):
                continue
            if empty:
                yield from ((each, [""]) for each in empty)
                empty.clear()
            yield line, row
    except csv.Error as error:
        raise header.error(before + reader.line_num, _reason(error)) from None


def _reason(error: csv.Error) -> str:
    """Return what is wrong with a row, by the error of its reader."""
    if str(error).startswith("field larger"):
        most = f"{csv.field_size_limit():,}"
        return f"a cell has more than {most} characters: close the quote that it begins with, or leave its column out"
    return str(error)


def _check_quotes(lines: Sequence[str], header: Header, last: int) -> None:
    """Raise :class:`TraceError` if a quote that nothing closes has joined rows; ``last``: the last of their lines."""
    try:
        next(csv.reader(lines, delimiter=header.delimiter, skipinitialspace=True, strict=True))
    except csv.Error:
        first = last - len(lines) + 1
        raise header.error(
            first,
            f"a cell begins with a quote that nothing closes before line {last}: close it, or write it twice in quotes",
        ) from None


def is_comment(row: Sequence[str], header: Header, line: int) -> bool:
    """Return whether a row is a comment; raise :class:`TraceError` if it may be a sample as well, as in ``#N/A,1``."""
    if not row[0].startswith("#"):
        return False
    if (
        row[0][1:2].strip()
        and len(row) == len(header.names)
        and any(is_value(cell.strip()) for cell in row[1:])
    ):
        raise header.error(
            line,
            f"{shown(row[0])} may begin a sample or a comment: begin no sample with '#', and a comment with '# '",
        )
    return True


def check_width(row: list[str], header: Header, line: int) -> None:
    """Raise :class:`TraceError` unless a row has a cell for each column."""
    if len(row) != len(header.names):
        count = f"{len(row)} value{'s' * (len(row) != 1)}"
        raise header.error(line, f"{count}, but {len(header.names)} columns ({_listing(header)})")


def numbers(row: list[str], header: Header, line: int, columns: Collection[Column]) -> list[float]:
    """Return the numbers of one row, those of ``columns``."""
    check_width(row, header, line)
    return [
        number(row[column.position], header.names[column.position], header, line, nan=column.skip_nan)
        for column in columns
    ]


def number(text: str, name: str, header: Header, line: int, *, nan: bool = False) -> float:
    """Return the number in one cell; ``nan``: whether NaN is one."""
    text = text.strip()
    if not is_number(text):
        expected = f"'{name}' is '{text}', expected a number"
        if text.lower() in _MISSING:
            raise header.error(line, f"{expected}; where a sample is missing, leave the cell empty", name)
        if _is_like_date(text):
            raise header.error(
                line, f"{expected}; write dates as in {EXAMPLE}, times since a start in seconds", name
            )
        hint = " with a decimal point" if is_number(text.replace(",", ".")) else ""
        unit = text.strip("[]() ")
        if line == header.line + 1 and unit_called(unit) is not None:
            hint = f"; if the line holds units, write them behind the names, such as '{name} [{unit}]', and delete it"
        raise header.error(line, f"{expected}{hint}", name)
    value = float(text)
    if isinf(value) and any(character.isdigit() for character in text):
        raise header.error(
            line, f"'{name}' is {shown(text)}, beyond the range of a double; infinity is written inf", name
        )
    if isnan(value) and not nan:
        raise header.error(line, f"'{name}' is NaN: fill the gap or leave the sample out", name)
    return value


#: How programs write that there is no number.
_MISSING = frozenset(
    "- -- ? . na n/a <na> #n/a #nv null none nil #null! #div/0! #value! #ref! #num! 1.#ind -1.#ind 1.#qnan -1.#qnan "
    "nan(ind) -nan(ind) missing".split()
)


def _is_like_date(text: str) -> bool:
    """Return whether a text may be a date, or a time of day, in another way than dates are written here."""
    return text[:1].isdigit() and not is_date(text) and any(text.count(mark) > 1 for mark in ":-/")


#: How CSV files write truth.
BOOLEANS = MappingProxyType({"true": True, "false": False})


def is_boolean(text: str) -> bool:
    """Return whether the text of a cell is true or false, in any case."""
    return text.lower() in BOOLEANS


def truth(text: str, name: str, header: Header, line: int) -> bool:
    """Return the Boolean in a cell; raise :class:`TraceError` if it is not one."""
    value = BOOLEANS.get(text.lower())
    if value is None:
        raise header.error(line, f"'{name}' is '{text}', expected true or false", name)
    return value


def is_value(text: str) -> bool:
    """Return whether the text of a cell is a number, a Boolean or a date, and no name."""
    return is_number(text) or is_boolean(text) or is_date(text)


def is_number(text: str) -> bool:
    """Return whether the text of a cell is a decimal number, ``inf`` or ``nan``.

    >>> [text for text in ("1e-3", "-inf", "1_000", "0x10", "\u0661", "") if is_number(text)]
    ['1e-3', '-inf']
    """
    if "_" in text or not text.isascii():  # Python's 1_000, and digits of other scripts
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True
