"""One HTML page that needs nothing else: a table of requirements and recordings."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import short
from rtamt.cli.reports.messages import moment
from rtamt.cli.terminal import printed
from rtamt.report import Row, page

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from rtamt.cli.runner import Outcome, Requirement


def as_html(requirements: Sequence[Requirement], outcomes: Sequence[Outcome]) -> str:
    """Return the page; with pictures it is what ``rtamt report`` writes."""
    return page("rtamt check", formulas(requirements), [row(outcome) for outcome in outcomes])


def formulas(requirements: Sequence[Requirement]) -> Mapping[str, str]:
    """Return the text of every requirement's formula, with its description before it."""
    return {
        requirement.label: ": ".join(
            filter(None, (requirement.written.description, printed(requirement.spec.formula)))
        )
        for requirement in requirements
    }


def row(outcome: Outcome) -> Row:
    """Return what came of one requirement over one recording, for the table."""
    if outcome.error:
        return Row(outcome.requirement, outcome.trace, outcome.verdict, error=outcome.error)
    return Row(
        outcome.requirement,
        outcome.trace,
        outcome.verdict,
        short(outcome.robustness),
        moment(outcome),
        str(outcome.samples),
        notes=outcome.notes,
    )
