"""What all reports say in the same words."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import short

if TYPE_CHECKING:
    from rtamt.cli.runner import Outcome, Requirement


def sentence(outcome: Outcome, requirement: Requirement) -> str:
    """Return what came of one requirement over one recording, as a sentence."""
    if outcome.error:
        return outcome.error
    description = requirement.written.description
    name = f"{outcome.requirement} ({description})" if description else outcome.requirement
    told = f"{name} is {outcome.verdict} by {outcome.trace}: robustness {short(outcome.robustness)}"
    told = f"{told}, first violated at {outcome.moment}" if outcome.moment else told
    return "; ".join([told, *outcome.notes])
