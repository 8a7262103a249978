"""Write the results of a check as JUnit, SARIF or HTML, one module per format.

An HTML page is made while the check runs, so that it needs no result to stay in memory.
"""

from __future__ import annotations

from importlib import import_module
from types import MappingProxyType
from typing import TYPE_CHECKING

from rtamt.cli.command import write_output

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from rtamt.cli.outcome import Outcome, Requirement

    Report = Callable[[Sequence[Requirement], Sequence[Outcome]], str]

#: Option of ``rtamt check``, which is the module of the format, to the name of the format, and the function that makes
#: the text of the file. An HTML page has none: it is written while the check runs.
REPORTS: Mapping[str, tuple[str, str | None]] = MappingProxyType(
    {
        "junit": ("JUnit XML", "as_junit"),
        "sarif": ("SARIF 2.1.0", "as_sarif"),
        "html": ("an interactive HTML page", None),
    }
)


def write_report(
    kind: str, path: str, requirements: Sequence[Requirement], outcomes: Sequence[Outcome]
) -> None:
    """Write the report of a kind in :data:`REPORTS` that is written at the end."""
    function = REPORTS[kind][1]
    assert function is not None
    make: Report = getattr(import_module(f"{__name__}.{kind}"), function)
    write_output(path, make(requirements, outcomes))
