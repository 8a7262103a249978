"""One HTML page that needs nothing else: a table of requirements and recordings."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

from rtamt.cli.command import short
from rtamt.cli.reports.words import moment
from rtamt.cli.terminal import printed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rtamt.cli.matrix import Outcome, Requirement

_STYLE = """\
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem; color: #1f2328; background: #fff; }
table { border-collapse: collapse; margin: 1rem 0; }
th, td { padding: .3rem .8rem; border-bottom: 1px solid #d1d9e0; text-align: left; vertical-align: top; }
td.number { text-align: right; font-variant-numeric: tabular-nums; }
code { font-family: ui-monospace, monospace; }
.satisfied { color: #1a7f37; } .violated { color: #d1242f; } .error { color: #9a6700; }"""

_HEAD = ("requirement", "recording", "verdict", "robustness", "first violated", "samples")


def as_html(requirements: Sequence[Requirement], outcomes: Sequence[Outcome]) -> str:
    """Return the page."""
    verdicts = [outcome.verdict for outcome in outcomes]
    counts = ", ".join(
        f"{verdicts.count(v)} {v}" for v in ("satisfied", "violated", "error") if v in verdicts
    )
    formulas = "\n".join(
        f"<tr><td>{escape(r.label)}</td><td><code>{escape(printed(r.spec.formula))}</code></td></tr>"
        for r in requirements
    )
    head = "".join(f"<th>{name}</th>" for name in _HEAD)
    rows = "\n".join(map(_row, outcomes))
    return f"""\
<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width">
<title>rtamt check: {counts}</title>
<style>
{_STYLE}
</style>
</head>
<body>
<h1>{counts}</h1>
<table>
<tr><th>requirement</th><th>formula</th></tr>
{formulas}
</table>
<table>
<tr>{head}</tr>
{rows}
</table>
</body>
</html>
"""


def _row(outcome: Outcome) -> str:
    first = f"<td>{escape(outcome.requirement)}</td><td>{escape(outcome.trace)}</td>"
    verdict = f'<td class="{outcome.verdict}">{outcome.verdict}</td>'
    if outcome.error:
        return f'<tr>{first}{verdict}<td colspan="3">{escape(outcome.error)}</td></tr>'
    numbers = (
        f'<td class="number">{short(outcome.robustness)}</td>'
        f'<td class="number">{escape(moment(outcome))}</td>'
        f'<td class="number">{outcome.samples}</td>'
    )
    return f"<tr>{first}{verdict}{numbers}</tr>"
