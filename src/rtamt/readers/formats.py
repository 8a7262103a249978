"""THE LIST of file formats: a row for each kind of file, with the function that opens it."""

from __future__ import annotations

import importlib
import os
import stat
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.errors import TraceError, UsageError, did_you_mean
from rtamt.lazy.dataclasses import dataclass
from rtamt.readers.source import guarded, opening

if TYPE_CHECKING:
    from collections.abc import Callable
    from contextlib import AbstractContextManager

    from rtamt.readers.source import Source


@dataclass(frozen=True, slots=True)
class Format:
    """A kind of file.

    ``opener``: module and function, imported when such a file is read. ``sheets``: whether a file may
    hold several tables, of which the opener takes one by its name. ``recovers``: how the names of files end
    that the opener can read up to their damage, on request.
    """

    name: str
    suffixes: tuple[str, ...]
    opener: str
    sheets: bool = False
    recovers: str = ""

    def guard(self, path: str) -> AbstractContextManager[None]:
        """Convert the errors of the library to error messages."""
        if self.recovers and path.lower().endswith(self.recovers):
            return opening(path, self.name, "read it as far as possible with recover=True (--recover)")
        return opening(path, self.name)

    def open(self, path: str, sheet: str | None = None, recover: bool = False) -> Source:
        """Open a file of this kind. Whatever its library raises, now or when the samples are read, is a sentence."""
        module, function = self.opener.split(":")
        opener: Callable[..., Source] = getattr(importlib.import_module(f"rtamt.readers.{module}"), function)
        if sheet is not None and not self.sheets:
            raise UsageError(f"'{path}' is {self.name}, which has no sheets; leave the sheet out")
        if recover and not (self.recovers and path.lower().endswith(self.recovers)):
            raise UsageError(f"only MCAP files are read up to their damage; leave out recover for '{path}'")
        choice = {"sheet": sheet} if self.sheets else {"recover": recover} if self.recovers else {}
        guard = partial(self.guard, path)
        with guard():
            # Libraries have words of their own for links to nothing, folders and files that do not exist.
            if stat.S_ISDIR(os.stat(path).st_mode) and self is not BAG:
                raise IsADirectoryError
            source = opener(path, **choice)
        return guarded(source, guard)


#: A bag has a table for each topic; a specification's annotations select the topics. ROS 2 records
#: folders: such files, or parts of them, and metadata.yaml.
MCAP = ".mcap"
BAG = Format("ROS bag", (".bag", ".db3", MCAP), "rosbag:open_bag", recovers=MCAP)

FORMATS = (
    Format("CSV", (".csv", ".tsv", ".txt"), "csv_source:open_csv"),
    Format("Parquet", (".parquet", ".pq"), "arrow:open_parquet"),
    Format("Arrow", (".arrow", ".feather", ".ipc"), "arrow:open_arrow"),
    Format("Excel", (".xlsx", ".xlsm"), "excel:open_excel", sheets=True),
    Format("PX4 ULog", (".ulg",), "ulog:open_ulog"),
    Format("MDF", (".mf4", ".mdf"), "mdf:open_mdf"),
    BAG,
)

#: How compressed files of a bag end.
_PACKED = (".zstd", ".zst")

_TO_PYTHON = (
    "load it in Python, and give its arrays to rtamt.read as a dict, such as {'time': t, 'speed': v}, or export it as "
    "CSV"
)
_JSON = "'rtamt monitor SPEC < FILE' reads lines of JSON, and rtamt.read a frame of pandas or polars"
_DATABASE = (
    "'--sql sqlite:///FILE --query TEXT' reads a database, in Python rtamt.read('sqlite:///FILE', query=...)"
)
_BUS = "decode the messages into signals, such as with asammdf, and export these as MDF or CSV"
#: What to do with other files of measurements, by how their names end.
_ELSEWHERE = MappingProxyType(
    dict.fromkeys((".gz", ".bz2", ".xz", ".zip", ".7z", ".tar", ".tgz", *_PACKED), "unpack it first")
    | dict.fromkeys((".mat", ".h5", ".hdf5", ".nc", ".pkl", ".npz", ".npy", ".tdms"), _TO_PYTHON)
    | dict.fromkeys((".blf", ".asc", ".trc"), _BUS)
    | dict.fromkeys((".json", ".jsonl", ".ndjson"), _JSON)
    | dict.fromkeys((".db", ".sqlite", ".sqlite3"), _DATABASE)
    | dict.fromkeys((".xls", ".xlsb", ".ods"), "save it as .xlsx or .csv")
)

SUFFIXES = {suffix: known for known in FORMATS for suffix in known.suffixes}


#: What ROS 2 puts into the folder of a bag.
METADATA = "metadata.yaml"


def is_bag(path: str) -> bool:
    """Return whether a path is that of a ROS bag: by its name, or a folder as ROS 2 records it."""
    suffix = os.path.splitext(path)[1].lower()
    return suffix in BAG.suffixes or (suffix not in SUFFIXES and os.path.isdir(path))


def format_of(path: str) -> Format:
    """Return the format that follows from a file's name; raise :class:`TraceError` if there is none."""
    if is_bag(path):
        return BAG
    stem, suffix = os.path.splitext(path.lower())
    if suffix in _PACKED and is_bag(stem):
        raise TraceError(
            f"'{path}' is a compressed file of a bag: give the bag's folder, in which metadata.yaml is, or unpack it"
        )
    if suffix not in SUFFIXES:
        known = ", ".join(SUFFIXES)
        raise TraceError(
            f"cannot tell how to read '{path}': its name ends in none of {known}{_hint(path, suffix)}"
        )
    return SUFFIXES[suffix]


def _hint(path: str, suffix: str) -> str:
    """Return the end of the message about a file that is in none of the formats."""
    if os.path.basename(path) == METADATA:
        return f"; give the folder of the bag, '{os.path.dirname(path) or '.'}'"
    if path in ("-", "/dev/stdin"):
        return "; 'rtamt monitor' reads samples from stdin"
    if suffix in _ELSEWHERE:
        return f"; {_ELSEWHERE[suffix]}"
    return did_you_mean(suffix, SUFFIXES) if suffix else ""
