"""JUnit XML, which CI servers show as tests: a suite for each requirement, a case for each recording."""

from __future__ import annotations

from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

from rtamt.cli.report_formats.messages import sentence
from rtamt.cli.terminal import printed
from rtamt.lazy.patterns import lazy_pattern

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.cli.outcome import Outcome, Requirement

#: Characters that XML cannot hold, not even escaped.
_FORBIDDEN = lazy_pattern("[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")


def as_junit(requirements: Sequence[Requirement], outcomes: Sequence[Outcome]) -> str:
    """Return the report; a violation is a failure, a failed evaluation an error.

    What a recording does not have the signals for is skipped.
    """
    root = ET.Element("testsuites", {"name": "rtamt", **_counts(outcomes)})
    for requirement in requirements:
        mine = [outcome for outcome in outcomes if outcome.requirement == requirement.label]
        suite = ET.SubElement(root, "testsuite", {"name": _text(requirement.label), **_counts(mine)})
        for outcome in mine:
            case = ET.SubElement(
                suite,
                "testcase",
                classname=_text(requirement.label),
                name=_text(outcome.trace),
                time=f"{outcome.seconds:.6f}",
            )
            if outcome.unchecked:
                ET.SubElement(case, "skipped", message=_text(outcome.unchecked))
            elif outcome.verdict != "satisfied":
                kind = "failure" if outcome.verdict == "violated" else "error"
                problem = ET.SubElement(
                    case, kind, type=outcome.verdict, message=_text(sentence(outcome, requirement))
                )
                problem.text = _text(outcome.explanation or printed(requirement.spec.formula))
            if outcome.notes:
                ET.SubElement(case, "system-out").text = _text("\n".join(outcome.notes))
    ET.indent(root)
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{ET.tostring(root, encoding="unicode")}\n'


def _counts(outcomes: Sequence[Outcome]) -> dict[str, str]:
    verdicts = [outcome.verdict for outcome in outcomes]
    return {
        "tests": str(len(verdicts)),
        "failures": str(verdicts.count("violated")),
        "errors": str(verdicts.count("error")),
        "skipped": str(verdicts.count("unchecked")),
        "time": f"{sum(outcome.seconds for outcome in outcomes):.6f}",
    }


def _text(text: str) -> str:
    return _FORBIDDEN.sub("?", text)
