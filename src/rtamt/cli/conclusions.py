"""The answers of analyses as ``rtamt analyze`` and ``rtamt diff`` show them: text, JSON and plots."""

from __future__ import annotations

import os
import re
import sys
from typing import TYPE_CHECKING

from rtamt.cli.command import OUTPUT, CommandError, json_number, json_text, options
from rtamt.cli.parser import ERROR, OK, VIOLATED
from rtamt.cli.terminal import paint, say, use_color
from rtamt.language.units.durations import format_duration
from rtamt.plot.axes import matplotlib
from rtamt.plot.saving import save

if TYPE_CHECKING:
    import argparse

    from rtamt.analysis import Analysis, Conclusion


def add_analysis_options(parser: argparse.ArgumentParser) -> None:
    """Add the limits of traces and queries, and the output options."""
    parser.add_argument(
        "--samples", metavar="N", type=int, default=200, help="the greatest length of traces (default: 200)"
    )
    parser.add_argument(
        "--limit",
        metavar="SECONDS",
        type=float,
        default=10.0,
        help="how long one question may take (default: 10)",
    )
    group = options(parser, OUTPUT)
    group.add_argument("--json", action="store_true", help="print JSON, one object per line and answer")
    group.add_argument(
        "--plot", metavar="FOLDER", help="write a plot of the trace of each answer that has one"
    )
    group.add_argument(
        "--color", choices=("auto", "always", "never"), default="auto", help="colour the output"
    )


def show(name: str, analysis: Analysis, args: argparse.Namespace) -> int:
    """Print the answers about a specification, write their plots, and return the exit code."""
    plots = {} if args.plot is None else _plot(name, analysis, args.plot)
    if args.json:
        for each in analysis.conclusions:
            say(json_text(_row(name, each, plots.get(each))))
        for note in analysis.notes:
            say(json_text({"file": name, "note": note}))
    else:
        _print(name, analysis, plots, use_color(args.color, sys.stdout))
    # Where no requirement is covered, nothing is known to be sound.
    unknown = analysis.unanswered or (analysis.notes and not analysis.conclusions)
    return VIOLATED if analysis.findings else ERROR if unknown else OK


def _print(name: str, analysis: Analysis, plots: dict[Conclusion, str], color: bool) -> None:
    step = format_duration(analysis.period)
    samples, answers = _count(analysis.samples, "sample"), _count(len(analysis.conclusions), "answer")
    say(f"{name}: traces up to {samples} of {step}, {answers}")
    for mark, kind, found in (
        ("finding", "violated", analysis.findings),
        ("open", "warning", analysis.unanswered),
    ):
        for each in found:
            say(f"  {paint(mark, kind, color)}: {each}", color=color)
            if each in plots:
                say(f"    {plots[each]}")
    for note in analysis.notes:
        say(f"  note: {note}")


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _row(name: str, conclusion: Conclusion, plot: str | None) -> dict[str, object]:
    row: dict[str, object] = {
        "file": name,
        "question": conclusion.question,
        "requirements": [each for each in conclusion.names if each],
        "holds": conclusion.holds,
        "finding": conclusion.finding,
        "sentence": conclusion.sentence,
    }
    witness = conclusion.witness
    if witness is not None:
        row["confirmed"] = witness.confirmed
        row["margin"] = json_number(witness.margin) if witness.confirmed else None
        row["trace"] = {column: values.tolist() for column, values in witness.data.items()}
    if plot is not None:
        row["plot"] = plot
    return row


def _plot(name: str, analysis: Analysis, folder: str) -> dict[Conclusion, str]:
    """Write the plots of the confirmed traces, and return their files."""
    found: dict[Conclusion, str] = {}
    stem = os.path.splitext(os.path.basename(name.rpartition(" -> ")[2]))[0]
    try:
        os.makedirs(folder, exist_ok=True)
        for number, each in enumerate(analysis.conclusions, 1):
            if each.witness is None or not each.witness.confirmed:
                continue
            about = re.sub(r"[^\w.-]+", "_", "-".join((stem, *each.names[:1], each.question, str(number))))
            path = os.path.join(folder, f"{about}.png")
            figure = matplotlib().Figure()
            each.witness.plot(figure)
            save(figure, path, 110)
            found[each] = path
    except OSError as error:
        raise CommandError(f"cannot write plots into '{folder}': {error.strerror}") from None
    return found
