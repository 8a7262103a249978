"""The texts that all reports share."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from rtamt.cli.command import json_number

if TYPE_CHECKING:
    from rtamt.cli.outcome import Outcome, Requirement
    from rtamt.signals.episodes import Episode


def sentence(outcome: Outcome, requirement: Requirement) -> str:
    """Return the outcome of one requirement on one recording, as a sentence."""
    if outcome.error:
        return outcome.error
    if outcome.unchecked:
        return f"{outcome.requirement}, {outcome.trace}: {outcome.unchecked}"
    description = requirement.written.description
    name = f"{outcome.requirement} ({description})" if description else outcome.requirement
    text = f"{name} is {outcome.verdict} by {outcome.trace}: robustness {outcome.robustness_text}"
    text = f"{text}, first violated at {outcome.moment}" if outcome.moment else text
    return "; ".join([text, *outcome.notes])


def robustness_members(outcome: Outcome) -> dict[str, Any]:
    """Return the robustness as members of a JSON object; its bounds too, if later samples were not read."""
    if outcome.bounds is None:
        return {"robustness": json_number(outcome.robustness)}
    lower, upper = outcome.bounds.lower, outcome.bounds.upper
    return {
        "robustness": json_number(lower) if lower == upper else None,
        "lower": json_number(lower),
        "upper": json_number(upper),
    }


def episodes_members(outcome: Outcome) -> dict[str, Any]:
    """Return the episodes of violation as members of a JSON object, if they are known."""
    if outcome.episodes is None:
        return {}
    count, worst, first = outcome.episodes.count, outcome.episodes.worst, outcome.episodes.first
    shown = None if worst is None else _episode(worst)
    return {"episodes": {"count": count, "worst": shown, "first": [_episode(each) for each in first]}}


def _episode(episode: Episode) -> dict[str, Any]:
    return {
        "begin": episode.begin,
        "end": episode.end,
        "worst": json_number(episode.worst),
        "at": episode.at,
    }
