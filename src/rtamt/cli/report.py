"""``rtamt report``: requirements and recordings as one interactive page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.arguments import each_requirement, requirements_and_traces, variables_of
from rtamt.cli.check import CODES
from rtamt.cli.command import (
    Command,
    CommandError,
    add_specification_options,
    add_time_option,
    complain,
    write_output,
)
from rtamt.cli.reading_options import add_instant_option, add_reading_options, instant, reading_of
from rtamt.cli.reports.html import formulas, row
from rtamt.cli.runner import outcomes
from rtamt.cli.terminal import Progress, say
from rtamt.errors import StlError
from rtamt.plot.scene import scene
from rtamt.report import Card, page

if TYPE_CHECKING:
    import argparse

    from rtamt.report import Row

_DESCRIPTION = """\
Write one HTML file about every requirement over every recording: the verdicts, and for each the signals,
the robustness of the formula and of its sub-formulas, where they do not hold, and what decides the verdict.
Nothing else is needed to read it: no network, no server, and no scripts for what is text.

Exit code: 0 all satisfied, 1 some violated, 2 some could not be evaluated."""

_EPILOG = """\
SPEC and TRACE are as for 'rtamt check'. In the page: drag over a chart to zoom in, double-click to see
all; Ctrl and the wheel, or + - 0, zoom; arrow keys go from sample to sample. Sentences of the explanation
lead to their instants. Of a large recording each line keeps the first, lowest, highest and last point
of every two-thousandth of the time, so that no peak is lost.

examples:
  rtamt report examples/request_grant/spec.stl examples/request_grant/*.csv -o build/report.html
  rtamt report "always(alarm -> eventually[0:70ms](stop))" events.csv --time dense -o report.html"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    parser.add_argument("traces", metavar="TRACE", nargs="*", help="a recording; before it more SPECs (.stl)")
    add_time_option(parser)
    add_instant_option(parser)
    add_reading_options(parser)
    parser.add_argument("-o", "--output", metavar="FILE", required=True, help="the page to write")


def run(args: argparse.Namespace) -> int:
    """Evaluate every requirement over every trace, write the page."""
    given, traces = requirements_and_traces(args, "report")
    requirements = each_requirement(given)
    reading = reading_of(args, variables_of(requirements), whole=True)
    rows: list[Row] = []
    cards: dict[Row, Card] = {}
    codes = []
    pairs = len(requirements) * len(traces)
    with Progress() as progress:
        for outcome in outcomes(given, traces, reading):
            progress.bar(len(rows), pairs, outcome.trace)
            told = row(outcome)
            if outcome.result is None:
                progress.clear()
                complain(outcome.error)
            else:
                try:
                    seen = scene(outcome.result, instant(args.at, outcome.result))
                except StlError as error:
                    raise CommandError(f"{outcome.trace}: {error}") from error
                cards[told] = Card.of(told, seen)
            rows.append(told)
            codes.append(CODES[outcome.verdict])
    write_output(args.output, page("rtamt report", formulas(requirements), rows, cards))
    verdicts = [told.verdict for told in rows]
    say(f"{args.output}: " + ", ".join(f"{verdicts.count(v)} {v}" for v in CODES if v in verdicts))
    return max(codes)


COMMAND = Command("report", "write an interactive page: signals, robustness, explanations", configure, run)
