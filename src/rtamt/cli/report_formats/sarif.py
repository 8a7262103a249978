"""SARIF 2.1.0, which code hosts show next to the code: one rule per requirement, one result per recording."""

from __future__ import annotations

import os
from pathlib import PurePath
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import rtamt
from rtamt.cli.command import json_text
from rtamt.cli.report_formats.messages import robustness_members, sentence
from rtamt.cli.terminal import printed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.cli.outcome import Outcome, Requirement

_SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"


def as_sarif(requirements: Sequence[Requirement], outcomes: Sequence[Outcome]) -> str:
    """Return the report: a violation is a failed result, a failed evaluation a notification."""
    rules = [_rule(requirement) for requirement in requirements]
    numbers = {requirement.label: i for i, requirement in enumerate(requirements)}
    errors = [outcome for outcome in outcomes if outcome.error]
    run = {
        "tool": {"driver": {"name": "rtamt", "version": rtamt.__version__, "rules": rules}},
        "invocations": [
            {
                "executionSuccessful": not errors,
                "toolExecutionNotifications": [
                    {
                        "level": "error",
                        "message": {"text": outcome.error},
                        "associatedRule": {"id": outcome.requirement, "index": numbers[outcome.requirement]},
                        "locations": [_location(outcome.trace)],
                    }
                    for outcome in errors
                ],
            }
        ],
        "results": [
            _result(outcome, numbers[outcome.requirement], requirements)
            for outcome in outcomes
            if not outcome.error
        ],
    }
    return json_text({"$schema": _SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2) + "\n"


def _rule(requirement: Requirement) -> dict[str, Any]:
    formula, description = printed(requirement.spec.formula), requirement.written.description
    rule = {"id": requirement.label, "shortDescription": {"text": description or formula}}
    return {**rule, "fullDescription": {"text": formula}} if description else rule


def _result(outcome: Outcome, number: int, requirements: Sequence[Requirement]) -> dict[str, Any]:
    violated, when = outcome.verdict == "violated", outcome.first_violation
    result = {
        "ruleId": outcome.requirement,
        "ruleIndex": number,
        "kind": "notApplicable" if outcome.unchecked else "fail" if violated else "pass",
        "level": requirements[number].written.severity if violated else "none",
        "message": {
            "text": "\n".join(filter(None, (sentence(outcome, requirements[number]), outcome.explanation)))
        },
        "locations": [_location(outcome.trace)],
        "properties": {} if outcome.unchecked else {**robustness_members(outcome), "firstViolation": when},
    }
    if os.path.isfile(requirements[number].given):
        result["relatedLocations"] = [_location(requirements[number].given)]
    return result


def _location(path: str) -> dict[str, Any]:
    uri = path if "://" in path else quote(os.fsencode(PurePath(path).as_posix()))
    return {"physicalLocation": {"artifactLocation": {"uri": uri}}}
