"""``rtamt plot``: plot a trace, the robustness over time and the cause of the verdict."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rtamt.cli.arguments import result_of_one
from rtamt.cli.command import CommandError
from rtamt.cli.parser import OK
from rtamt.cli.reading_options import add_input_options, add_instant_option, instant
from rtamt.cli.terminal import Progress, say
from rtamt.errors import StlError
from rtamt.plot.axes import matplotlib
from rtamt.plot.figure import draw
from rtamt.plot.saving import save
from rtamt.plot.scene import scene
from rtamt.plot.tree import draw_tree

if TYPE_CHECKING:
    import argparse
    from typing import Any

_DESCRIPTION = """\
Plot the signals of a recording, the robustness of a requirement and of its sub-formulas over time, and
the cause of the verdict: the critical point and the implicant, as printed by 'rtamt explain'. Requires
matplotlib: pip install 'rtamt[plot]'."""

_EPILOG = """\
Intervals in which a formula does not hold are shaded. The implicant is yellow: its predicates on these
intervals alone force the verdict. The diamond is the critical point. --bounds draws a band between the lower
and the upper bound of the robustness at the start, as known after each sample; it narrows to the robustness.
Without -o, the plot is shown in a window.

examples:
  rtamt plot examples/request_grant/spec.stl examples/request_grant/c_violated.csv -o build/c.png
  rtamt plot "always((req >= 3) -> eventually[0:5](gnt >= 3))" log.csv --time dense -o plot.svg
  rtamt plot requirement.stl log.csv --zoom violation -o violation.png
  rtamt plot requirement.stl log.csv --from 10 --to 12.5 -o part.png
  rtamt plot requirement.stl log.csv --tree -o formula.pdf"""


#: How many formulas a plot shows, unless --rows gives another number.
_ROWS = 6


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_input_options(parser, "one recording, as for 'rtamt check'")
    add_instant_option(parser)
    parser.add_argument("-o", "--output", metavar="FILE", help="write the plot: .png, .svg, .pdf, ...")
    parser.add_argument(
        "--rows", type=int, metavar="N", help=f"the maximum number of formulas (default: {_ROWS})"
    )
    parser.add_argument(
        "--from", dest="start", metavar="TIME", help="the start of the plot, in the format of --at"
    )
    parser.add_argument("--to", dest="end", metavar="TIME", help="the end of the plot, in the format of --at")
    parser.add_argument("--zoom", metavar="{violation}", help="show the first violation and its surroundings")
    parser.add_argument(
        "--bounds",
        action="store_true",
        help="draw the bounds of the robustness at the start, as known after each sample, and the time of the verdict",
    )
    parser.add_argument("--tree", action="store_true", help="draw the formula as a tree with its values")


def run(args: argparse.Namespace) -> int:
    """Evaluate the trace and plot the results."""
    if args.rows is not None and args.rows < 1:
        raise CommandError(f"--rows is {args.rows}; give a number of formulas, 1 or more")
    _refuse_unused(args)
    figure = _window() if args.output is None else _sheet(args.output)
    with Progress() as progress:
        progress.show("evaluating")
        evaluated, result = result_of_one(args, "plot")
        if isinstance(result.known, Mapping):
            raise CommandError(
                f"{evaluated.trace}: the requirements start at different times, so that they have no plot in common; "
                "'rtamt report' plots each of them"
            )
        try:
            seen = scene(result, instant(args.at, result), bounds=args.bounds)
            ends = (instant(args.start, result, "--from"), instant(args.end, result, "--to"))
            window = seen.window(*ends, args.zoom)
        except StlError as error:
            raise CommandError(f"{evaluated.trace}: {error}") from error
    if args.tree:
        draw_tree(seen, figure)
    else:
        draw(seen, args.rows or _ROWS, figure, window)
    if args.output is None:
        matplotlib("pyplot").show()
        return OK
    try:
        evaluated.notes.extend(save(figure, args.output, 150))
    except OSError as error:
        raise CommandError(f"cannot write '{args.output}': {error.strerror}") from None
    say(f"{args.output}: {seen.verdict}{evaluated.listed_notes}")
    return OK


def _refuse_unused(args: argparse.Namespace) -> None:
    """Reject options that the plot would not show."""
    over_time = {
        "rows": args.rows, "from": args.start, "to": args.end, "zoom": args.zoom, "bounds": args.bounds or None
    }  # fmt: skip
    given = [f"--{name}" for name, value in over_time.items() if value is not None]
    if args.tree and given:
        raise CommandError(f"{given[0]} is for plots over time: leave it out, or --tree")
    if args.zoom is not None and args.start is not None and args.end is not None:
        raise CommandError("--from and --to choose what is shown: leave out --zoom")


def _window() -> Any:
    """Return a figure that can be shown in a window."""
    pyplot = matplotlib("pyplot")
    if pyplot.get_backend().lower() == "agg":
        raise CommandError("there is no display to show the plot on: name a file, such as -o plot.png")
    return pyplot.figure()


def _sheet(path: str) -> Any:
    """Return a figure that can be written to a file of this name."""
    figure = matplotlib().Figure()
    kinds = sorted(figure.canvas.get_supported_filetypes())
    suffix = Path(path).suffix.lower().removeprefix(".")
    if suffix not in kinds:
        raise CommandError(
            f"'{path}' is no image format that can be written: choose from .{', .'.join(kinds)}"
        )
    return figure
