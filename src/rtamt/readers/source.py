"""What every reader makes of its file, whatever the format.

::

    Source          a recording: a file, a query, a frame
      └── Table     columns that share a clock: one in a CSV file, one for each topic of a flight log
            └── Field    a column: what the source calls it, its name in formulas, its unit
"""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from rtamt import extras
from rtamt.errors import TraceError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    import numpy as np
    from numpy.typing import NDArray

    #: Values of one column as the source has them; a masked value is a missing one.
    Raw = NDArray[Any]

#: Samples that are read at a time where a recording is read in chunks.
CHUNK = 65_536


@dataclass(frozen=True, slots=True)
class Field:
    """A column.

    ``kind``: "number", "time" (dates, stamps of a known unit), "text", or "" while unknown. ``skip_nan``:
    whether a NaN in it is a missing value, and no mistake.
    """

    column: str
    name: str
    unit: str = ""
    kind: str = ""
    skip_nan: bool = field(default=False, compare=False)


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """Columns that share a clock; read once, whole or in chunks."""

    fields: tuple[Field, ...]
    #: Fields to their values, in the same order.
    load: Callable[[Sequence[Field]], list[Raw]]
    #: The same, some :data:`CHUNK` rows at a time; None where the format has to be read whole.
    chunks: Callable[[Sequence[Field]], Iterator[list[Raw]]] | None = None
    #: The field that is known to hold the time stamps; None where it has to be found by its name.
    clock: Field | None = None
    #: The line or row of the source in which the first sample stands, for messages.
    first_row: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Source:
    """A recording that is ready to be read."""

    name: str
    tables: tuple[Table, ...]
    #: The date and time (UTC) of time 0.
    origin: np.datetime64 | None = None
    #: What was left out, a sentence each.
    notes: tuple[str, ...] = ()
    close: Callable[[], None] | None = None


def library(module: str, what: str) -> Any:
    """Import a library of the extra ``data``; raise :class:`UsageError` where it is not there."""
    return extras.library(module, f"reading {what}", "data")


@contextmanager
def opening(path: str, what: str, *failures: type[Exception]) -> Iterator[None]:
    """Turn what goes wrong while a file is read into one sentence.

    ``what``: the format. ``failures``: what its library raises at a file that is not of that format.
    """
    try:
        yield
    except FileNotFoundError:
        raise TraceError(f"there is no file '{path}'") from None
    except IsADirectoryError:
        raise TraceError(f"'{path}' is a directory, expected a file") from None
    except failures as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise TraceError(f"'{path}' cannot be read as {what}: {reason}") from None
    except OSError as error:
        raise TraceError(f"cannot read '{path}': {error.strerror or error}") from None
