"""Recordings in files to columns of numbers: one reader for each kind of file, chosen by suffix."""

from __future__ import annotations

from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.errors import TraceError, did_you_mean
from rtamt.readers.csv import read_csv

if TYPE_CHECKING:
    import os
    from collections.abc import Callable, Iterable, Mapping

    from rtamt.engine.signals import FloatArray

#: Suffix of a file to the function that reads it.
READERS = MappingProxyType({".csv": read_csv, ".tsv": read_csv, ".txt": read_csv})


def read(
    path: str | os.PathLike[str],
    names: Iterable[str] | None = None,
    *,
    time_column: str | None = None,
    progress: Callable[[int], None] | None = None,
) -> Mapping[str, FloatArray]:
    r"""Read a recording; what comes out is what ``Specification.evaluate`` takes.

    ``names``: the columns that are wanted (default: all); others may hold anything. ``time_column``:
    the column of time stamps, by default the first that is called time, t, timestamp or stamp; ``""``
    for none. ``progress`` is called now and then with the number of samples read so far.

    Returns a mapping from name to n numbers (float64), with ``"time"`` in seconds where the file has
    time stamps. Raises :class:`TraceError` that names the file, the line and the column.

    >>> import pathlib, tempfile
    >>> from rtamt.readers import read
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = pathlib.Path(folder, "log.csv")
    ...     _ = path.write_text("t [ms],x\n0,5\n100,4\n")
    ...     read(path)
    {'time': array([0. , 0.1]), 'x': array([5., 4.])}
    """
    suffix = Path(path).suffix.lower()
    reader = READERS.get(suffix)
    if reader is None:
        known, hint = ", ".join(READERS), did_you_mean(suffix, READERS)
        raise TraceError(f"cannot tell how to read '{path}': its name ends in none of {known}{hint}")
    return reader(path, names, time_column=time_column, progress=progress)


__all__ = ["READERS", "read", "read_csv"]
