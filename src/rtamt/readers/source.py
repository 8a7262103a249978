"""The interface of all readers, independent of the format.

::

    Source          a recording: a file, a query, a frame
      └── Table     columns that share their timestamps: one in a CSV file, one for each topic of a flight log
            └── Field    a column: what the source calls it, its name in formulas, its unit
"""

from __future__ import annotations

import errno
import os
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from rtamt import extras
from rtamt.errors import StlError, TraceError
from rtamt.files import nearest_file
from rtamt.lazy.dataclasses import dataclass, field, replace

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
    from contextlib import AbstractContextManager

    import numpy as np
    from numpy.typing import NDArray

    from rtamt.language.value_types import ValueType

    #: Values of one column as the source has them; a masked value is a missing one.
    Raw = NDArray[Any]

#: Samples that are read at a time where a recording is read in chunks.
CHUNK = 65_536


@dataclass(frozen=True, slots=True)
class Field:
    """A column.

    ``kind``: "number", "time" (dates, timestamps of a known unit), "text", or "" while unknown. ``skip_nan``:
    whether a NaN in it is a missing value, and no mistake. ``type``: of the variable, if its values may be names.
    ``alias``: another name, which listings leave out. ``axis``: whether it looks like timestamps, whatever its name.
    ``rising``: whether its first numbers increase, as far as they are known. ``lenient``: whether cells of CSV files
    may be no numbers, and are then NaN.
    """

    column: str
    name: str
    unit: str = ""
    kind: str = ""
    skip_nan: bool = field(default=False, compare=False)
    type: ValueType | None = field(default=None, compare=False)
    alias: str = field(default="", compare=False)
    axis: bool = field(default=False, compare=False)
    rising: bool = field(default=True, compare=False)
    lenient: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns that share their timestamps; read once, whole or in chunks."""

    fields: tuple[Field, ...]
    #: Fields to their values, in the same order.
    load: Callable[[Sequence[Field]], list[Raw]]
    #: The same, some :data:`CHUNK` rows at a time; None where the format has to be read whole.
    chunks: Callable[[Sequence[Field]], Iterator[list[Raw]]] | None = None
    #: The field that is known to hold the timestamps; None where it has to be found by its name.
    time_field: Field | None = None
    #: Whether the format defines the unit of that field.
    has_unit: bool = False
    #: Whether the arrays of chunks are new ones, which nothing else reads or changes.
    fresh: bool = False
    #: What ``load`` had to leave out, a sentence each; empty until then.
    losses: list[str] = field(default_factory=list)
    #: What a column loses if it is read as the timestamps, a sentence each; None where it loses nothing.
    losses_of_times: Callable[[Field], Sequence[str]] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """A recording that is ready to be read."""

    name: str
    tables: tuple[Table, ...]
    #: The date and time (UTC) of time 0.
    origin: np.datetime64 | None = None
    #: What was left out, a sentence each.
    notes: tuple[str, ...] = ()
    #: What the recording should have and has not, because it is damaged: a sentence each.
    losses: tuple[str, ...] = ()
    close: Callable[[], None] | None = None
    #: Places of tables, with fields of each, to the values of all of them, some at a time, in the order in which they
    #: were recorded; None where tables cannot be read side by side.
    in_one_pass: Callable[[Sequence[tuple[int, Sequence[Field]]]], Iterator[list[list[Raw]]]] | None = None
    #: Gives the tables at some places the same clock, before they are read, and returns the places of those that have
    #: another one than when they are read alone; None where they always have one.
    align: Callable[[Sequence[int]], frozenset[int]] | None = None
    #: The tables with all columns that begin with one of some texts, None: with all, also those that only later rows
    #: have; None where the tables have all from the beginning.
    complete: Callable[[Collection[str] | None], tuple[Table, ...]] | None = None

    def completed(self, names: Collection[str] | None) -> Source:
        """Return the source with all its columns of these names, or beginnings of names; None: with all columns."""
        return self if self.complete is None else replace(self, tables=self.complete(names))

    @property
    def signals(self) -> set[str]:
        """The names of all columns."""
        fields = [field for table in self.tables for field in table.fields]
        return {name for field in fields for name in (field.column, field.name)}.union(self.aliases)

    @property
    def aliases(self) -> dict[str, str]:
        """The names of columns by their other names."""
        return {field.alias: field.name for table in self.tables for field in table.fields if field.alias}

    @property
    def in_chunks(self) -> bool:
        """Whether it can be read in chunks."""
        return self.in_one_pass is not None or (len(self.tables) == 1 and self.tables[0].chunks is not None)


def library(module: str, what: str) -> Any:
    """Import a library of the extra ``data``; raise :class:`UsageError` if it is not installed."""
    return extras.library(module, f"reading {what}", "data")


# ---- errors of libraries -------------------------------------------------------------------------

#: Errors of the operating system that a library causes only if numbers in the file are wrong.
_WRONG_NUMBERS = (None, errno.EINVAL, errno.EOVERFLOW, errno.EFBIG)
#: What our own code raises by mistake only, never at the contents of a file.
_BUGS = (AssertionError, AttributeError, NameError, NotImplementedError, TypeError)
#: Characters of a library's own message that are shown.
_SHOWN = 200


@contextmanager
def opening(path: str, what: str, remedy: str = "copy or export it again") -> Iterator[None]:
    """Convert the errors of a format library to error messages. ``what``: the format.

    Our own errors pass, and so do our own bugs: they are no damage of the file.
    """
    try:
        yield
    except StlError:
        raise
    except FileNotFoundError as error:
        raise missing_file(str(error.filename or path)) from None
    except IsADirectoryError:
        raise TraceError(f"'{path}' is a directory, expected a file") from None
    except Exception as error:
        if isinstance(error, OSError) and error.errno not in _WRONG_NUMBERS:
            raise TraceError(f"cannot read '{path}': {error.strerror or error}") from None
        if isinstance(error, _BUGS) and is_our_error(error):
            raise
        raise damaged(path, what, reason(error), remedy) from error


def damaged(path: str, what: str, why: str, remedy: str = "copy or export it again") -> TraceError:
    """Return the error for a file that is no valid one of its format, ``what``."""
    return TraceError(
        f"'{path}' cannot be read as {what}: {why}; the file is damaged, incomplete or of another kind: {remedy}"
    )


def missing_file(path: str) -> TraceError:
    """Return the error for what is no file: nothing, with the nearest name in its folder, or something else."""
    if os.path.isdir(path):
        return TraceError(f"'{path}' is a directory, expected a file")
    if os.path.exists(path):
        return TraceError(f"'{path}' is a pipe or a device, expected a file")
    if os.path.islink(path):
        return TraceError(f"'{path}' is a link to '{os.readlink(path)}', which does not exist")
    return TraceError(f"there is no file '{path}'{nearest_file(path)}")


def guarded(source: Source, guard: Callable[[], AbstractContextManager[None]]) -> Source:
    """Return a source that reads its tables under ``guard``: libraries read most of a file only then."""
    in_one_pass, complete = source.in_one_pass, source.complete

    def completed(names: Collection[str] | None) -> tuple[Table, ...]:
        assert complete is not None
        with guard():
            return tuple(_guard(table, guard) for table in complete(names))

    def side_by_side(wanted: Sequence[tuple[int, Sequence[Field]]]) -> Iterator[list[list[Raw]]]:
        assert in_one_pass is not None
        with guard():
            yield from in_one_pass(wanted)

    return replace(
        source,
        tables=tuple(_guard(table, guard) for table in source.tables),
        in_one_pass=None if in_one_pass is None else side_by_side,
        complete=None if complete is None else completed,
    )


def _guard(table: Table, guard: Callable[[], AbstractContextManager[None]]) -> Table:
    chunked = table.chunks

    def load(wanted: Sequence[Field]) -> list[Raw]:
        with guard():
            return table.load(wanted)

    def chunks(wanted: Sequence[Field]) -> Iterator[list[Raw]]:
        assert chunked is not None
        with guard():
            yield from chunked(wanted)

    return replace(table, load=load, chunks=None if chunked is None else chunks)


def is_our_error(error: BaseException) -> bool:
    """Return whether an exception was raised by code of this package, and not in a library that it called."""
    from traceback import walk_tb

    name = ""
    for frame, _ in walk_tb(error.__traceback__):
        name = frame.f_globals.get("__name__", "")
    return name.partition(".")[0] == "rtamt"


def reason(error: BaseException) -> str:
    r"""Return the error of a library as part of a sentence: one short line without control characters.

    >>> reason(ValueError("bad\n\x1bblock.")), reason(KeyError(17)), reason(MemoryError())
    ('bad \\x1bblock', 'unexpected contents (KeyError: 17)', 'it needs more memory than there is')
    """
    if isinstance(error, MemoryError):
        return "it needs more memory than there is"
    if isinstance(error, RecursionError):
        return "it is nested too deeply"
    said = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    line = printable(" ".join(said.split()).rstrip("."))
    if " " in line:
        return line
    return f"unexpected contents ({type(error).__name__}{': ' if line else ''}{line})"


def printable(text: str) -> str:
    """Return a text as a message shows it: control characters as Python writes them, and never pages of it."""
    text = "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text[: _SHOWN + 1])
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}..."


def damage(complaints: Iterable[str], until: str = "") -> tuple[str, ...]:
    """Return a note on a damaged file that was read as far as possible: the first complaint of its library."""
    lines = list(dict.fromkeys(line.strip() for line in complaints if line.strip()))
    if not lines:
        return ()
    more = f" (and {len(lines) - 1} more)" if len(lines) > 1 else ""
    return (f"the file is damaged, read {until}as far as possible: {printable(lines[0])}{more}",)
