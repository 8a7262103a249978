"""The formats that ``rtamt check`` writes with ``--output``, by the suffix of the file."""

from __future__ import annotations

import os

from rtamt.cli.command import CommandError

#: Of the robustness of one trace: a table, or a copy of the bag.
ROBUSTNESS = (".csv", ".mcap")
#: Of the verdicts of many recordings.
VERDICTS = (".parquet", ".csv")


def format_of(output: str, formats: tuple[str, ...], what: str) -> str:
    """Return the suffix of a file; raise :class:`CommandError` if it is none of the formats.

    >>> format_of("rho.CSV", ROBUSTNESS, "write the robustness")
    '.csv'
    """
    suffix = os.path.splitext(output)[1].lower()
    if suffix not in formats:
        raise CommandError(f"--output is '{output}'; {what} to a file {' or '.join(formats)}")
    return suffix
