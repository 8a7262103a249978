"""What all reports say in the same words."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from rtamt.cli.command import short
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.epoch import date_text, is_epoch

if TYPE_CHECKING:
    from rtamt.cli.runner import Outcome, Requirement


def moment(outcome: Outcome) -> str:
    """Return when a requirement was first violated, a time since 1970 as a date; "" where it was not."""
    when = outcome.first_violation
    if when is None:
        return ""
    if isinstance(when, str):
        return date_text(Fraction(nanoseconds_of(np.datetime64(when)) or 0, 10**9))
    if is_epoch(float(when)):
        return date_text(Fraction(str(when)))
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
