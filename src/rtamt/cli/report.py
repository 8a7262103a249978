"""``rtamt report``: requirements and recordings as one interactive page."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.arguments import each_requirement, requirements_and_traces, variables_of
from rtamt.cli.outcome import count_verdicts, exit_code
from rtamt.cli.parser import complain
from rtamt.cli.reading_options import add_input_options, add_instant_option, reading_of
from rtamt.cli.report_formats.html import HtmlReport
from rtamt.cli.runner import outcomes
from rtamt.cli.terminal import Progress, say
from rtamt.lazy.dataclasses import replace

if TYPE_CHECKING:
    import argparse

    from rtamt.cli.outcome import Outcome

_DESCRIPTION = """\
Write one HTML file about every requirement on every trace: a matrix of verdicts, and for each cell the
explanation, the signals, and the robustness of the formula and of its sub-formulas. The page needs no
network and no server; verdicts and explanations are readable without scripts. Requires jinja2:
pip install 'rtamt[report]'. 'rtamt check --html' writes the same page.

Exit code: 0 all satisfied, 1 some violated, 2 some could not be evaluated."""

_EPILOG = """\
SPEC and TRACE are the same as for 'rtamt check'. In the page, filter, sort and search the matrix, and open a
cell. Drag over a chart to zoom time or values, and double-click to reset; Ctrl and the wheel, or the keys
+ - 0, zoom as well; arrow keys step from sample to sample. Click to set mark A, Shift-click to set mark B. The
page contains every sample, compressed, up to 96 MB; beyond that, long lines are stored as the range of their
values in each 1/1500 of the time and drawn as boxes. Signals that no requirement reads can be added to any
chart; they share another 16 MB, and 'About this report' states what did not fit.

examples:
  rtamt report examples/request_grant/spec.stl examples/request_grant/*.csv -o build/report.html
  rtamt report "always(alarm -> eventually[0:70ms](stop))" events.csv --time dense -o report.html"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_input_options(parser, "a recording; more SPECs (.stl) may precede it")
    add_instant_option(parser)
    parser.add_argument("-o", "--output", metavar="FILE", required=True, help="the page to write")


def run(args: argparse.Namespace) -> int:
    """Evaluate every requirement over every trace, write the page."""
    given, traces = requirements_and_traces(args, "report")
    requirements = each_requirement(given)
    reading = reading_of(args, variables_of(requirements), whole=True)
    page = HtmlReport("rtamt report", given, requirements, traces, reading, args.at)
    found: list[Outcome] = []
    pairs = len(requirements) * len(traces)
    with Progress() as progress:
        for outcome in outcomes(given, traces, reading):
            progress.bar(len(found), pairs, outcome.trace)
            if outcome.error:
                progress.clear()
                complain(outcome.error)
            page.add(outcome)
            found.append(replace(outcome, result=None))
    page.write(args.output)
    say(f"{args.output}: {count_verdicts([outcome.verdict for outcome in found])}")
    return exit_code(found)
