"""``rtamt export``: signals, robustness, verdicts and violations for Foxglove and Rerun."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.arguments import results_of_one
from rtamt.cli.command import (
    OUTPUT,
    CommandError,
    json_text,
    options,
    write_output,
)
from rtamt.cli.parser import OK, WRITTEN
from rtamt.cli.reading_options import add_input_options
from rtamt.cli.terminal import Progress, say
from rtamt.errors import StlError
from rtamt.telemetry.content import VERDICTS, content_of
from rtamt.telemetry.foxglove import layout_of
from rtamt.telemetry.mcap import write_content
from rtamt.telemetry.rerun import log_content

if TYPE_CHECKING:
    import argparse

_DESCRIPTION = """\
Write the signals that requirements read, and the robustness, bounds, verdict and violations of each requirement,
to files of robotics tools: MCAP (Foxglove, and every reader of MCAP) and Rerun. SPEC and TRACE are the same as for
'rtamt check'; TRACE need not be a bag. MCAP requires mcap: pip install 'rtamt[telemetry]'. Rerun requires
rerun-sdk: pip install 'rtamt[rerun]'.

Exit code: 0 written, 2 error."""

_EPILOG = """\
Messages in MCAP are JSON with schemas, on the topics /rtamt/summary, /rtamt/signals/NAME and
/rtamt/requirements/NAME/{robustness,interval,verdict,violations}. They are logged at the times of the trace, to
the nanosecond: since 1970 if it has dates or such timestamps, else since 0. In NAME, characters other than letters,
digits, '_' and '-' become '_'. --layout writes a layout of Foxglove for these topics: in Foxglove, choose 'Import
layout from file'.

--bounds adds the topic 'known' of each requirement: the bounds of the robustness at the start, as known after
each sample.

To copy a ROS bag and add topics with ROS messages, use 'rtamt check SPEC BAG -o out.mcap'.

examples:
  rtamt export examples/request_grant/spec.stl examples/request_grant/c_violated.csv -o build/c.mcap
  rtamt export requirement.stl log.csv -o verdicts.mcap --layout layout.json
  rtamt export requirement.stl log.csv --time dense --rerun verdicts.rrd"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_input_options(parser, "one recording, as for 'rtamt check'")
    group = options(parser, OUTPUT)
    group.add_argument("-o", "--output", metavar=WRITTEN, help="write an MCAP file")
    group.add_argument(
        "--layout", metavar=WRITTEN, help="write a layout of Foxglove for the MCAP file (JSON)"
    )
    group.add_argument("--rerun", metavar=WRITTEN, help="write a recording of Rerun (.rrd)")
    group.add_argument(
        "--bounds",
        action="store_true",
        help="also write the bounds of the robustness at the start, as known after each sample",
    )


def run(args: argparse.Namespace) -> int:
    """Evaluate the trace and write the files."""
    if args.output is args.layout is args.rerun is None:
        raise CommandError("there is nothing to write; name a file, such as -o verdicts.mcap")
    if args.output is not None and not args.output.lower().endswith(".mcap"):
        raise CommandError(f"--output is '{args.output}', which is no MCAP file; write to a file .mcap")
    if args.rerun is not None and not args.rerun.lower().endswith(".rrd"):
        raise CommandError(f"--rerun is '{args.rerun}', which is no recording of Rerun; write to a file .rrd")
    with Progress() as progress:
        progress.show("evaluating")
        evaluated = results_of_one(args, "export")
        try:
            content = content_of(evaluated.results, bounds=args.bounds)
            if args.output is not None:
                progress.show(f"writing {args.output}")
                write_content(content, args.output)
            if args.rerun is not None:
                progress.show(f"writing {args.rerun}")
                log_content(content, args.rerun)
        except StlError as error:
            raise CommandError(f"{evaluated.trace}: {error}") from error
    if args.layout is not None:
        write_output(args.layout, f"{json_text(layout_of(content), indent=2)}\n")
    verdicts = [finding.verdict for finding in content.findings]
    counted = ", ".join(f"{verdicts.count(one)} {one}" for one in VERDICTS if one in verdicts)
    for path in (args.output, args.layout, args.rerun):
        if path is not None:
            say(f"{path}: {counted}")
    if evaluated.notes:
        say(evaluated.listed_notes.lstrip("\n"))
    return OK
