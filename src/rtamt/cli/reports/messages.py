"""What all reports say in the same words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import short

if TYPE_CHECKING:
    from rtamt.cli.runner import Outcome, Requirement


def moment(outcome: Outcome) -> str:
    """Return when a requirement was first violated; "" where it was not."""
    when = outcome.first_violation
    if when is None or isinstance(when, str):
        return when or ""
    return f"{str(when).removesuffix('.0')} s"  # as it was recorded, to its last digit


def sentence(outcome: Outcome, requirement: Requirement) -> str:
    """Return what came of one requirement over one recording, as a sentence."""
    if outcome.error:
        return outcome.error
    description = requirement.written.description
    name = f"{outcome.requirement} ({description})" if description else outcome.requirement
    told = f"{name} is {outcome.verdict} by {outcome.trace}: robustness {short(outcome.robustness)}"
    told = f"{told}, first violated at {moment(outcome)}" if moment(outcome) else told
    return "; ".join([told, *outcome.notes])
