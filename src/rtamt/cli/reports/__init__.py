"""Write the results of a check as JUnit, SARIF or HTML, one module per format.

An HTML page is made while the check runs, so that it needs no result to stay in memory.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.cli.command import write_output
from rtamt.cli.reports.html import HtmlReport
from rtamt.cli.reports.junit import as_junit
from rtamt.cli.reports.sarif import as_sarif

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.cli.outcome import Outcome, Requirement

    Report = Callable[[Sequence[Requirement], Sequence[Outcome]], str]

#: Option of ``rtamt check`` to the name of the format and what makes the text of the file. An HTML page has none:
#: it is written while the check runs.
REPORTS: Mapping[str, tuple[str, Report | None]] = MappingProxyType(
    {
        "junit": ("JUnit XML", as_junit),
        "sarif": ("SARIF 2.1.0", as_sarif),
        "html": ("an interactive HTML page", None),
    }
)


def write_report(
    make: Report, path: str, requirements: Sequence[Requirement], outcomes: Sequence[Outcome]
) -> None:
    """Write the report that a function makes."""
    write_output(path, make(requirements, outcomes))


__all__ = ["REPORTS", "HtmlReport", "write_report"]
