"""``rtamt convert``: requirements of other tools as specification files, and the other way round."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.command import (
    SPECIFICATION_DEFAULTS,
    CommandError,
    add_specification_options,
    read_specification,
    read_text,
    write_output,
)
from rtamt.cli.parser import OK, VIOLATED, WRITTEN, complain
from rtamt.cli.terminal import say
from rtamt.errors import UsageError
from rtamt.interchange import FORMATS, format_named
from rtamt.language.units.durations import positive_period
from rtamt.signals.time_domains import DEFAULT

if TYPE_CHECKING:
    import argparse

    from rtamt.interchange import Conversion

_DESCRIPTION = """\
Convert requirements of another tool to a specification file, or a specification file to requirements of that tool.
A requirement that the other language cannot express is left out and reported with the reason.

Exit code: 0 all requirements are converted, 1 some are not, 2 error."""

_EPILOG = """\
formats: {formats}

With --from, --period is the sampling period that the specification declares. Where the two languages differ in what
these requirements mean, a note says so.

examples:
  rtamt convert examples/fret/pump.txt --from fret --period 500ms -o build/pump.stl
  rtamt convert examples/request_grant/spec.stl --to fret --component arbiter -o build/arbiter.json"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG.format(
        formats="; ".join(f"{name} ({each.about})" for name, each in FORMATS.items())
    )
    add_specification_options(
        parser,
        what="with --from: a file of that format; with --to: a specification file, a pack or a formula",
    )
    parser.add_argument("--from", dest="source", metavar="FORMAT", help="the format of the file that is read")
    parser.add_argument(
        "--to", dest="target", metavar="FORMAT", help="the format of the file that is written"
    )
    parser.add_argument(
        "--component", metavar="NAME", help="with --to: the component that the requirements are about"
    )
    parser.add_argument(
        "-o", "--output", metavar=WRITTEN, help="the file to write (default: standard output)"
    )


def run(args: argparse.Namespace) -> int:
    """Convert, write, and report what is left out."""
    if (args.source is None) == (args.target is None):
        raise UsageError("give the other format: --from FORMAT to read it, or --to FORMAT to write it")
    found = _read(args) if args.source is not None else _write(args)
    for name, reason in found.rejected:
        complain(f"{args.spec}: {name} is left out: {reason}")
    if not found.converted:
        raise CommandError(f"{args.spec}: no requirement can be converted")
    if args.output is None:
        for note in found.notes:
            complain(f"{args.spec}: note: {note}")
        say(found.text.rstrip("\n"), exact=True)
    else:
        write_output(args.output, found.text)
        count, left = len(found.converted), len(found.rejected)
        say(f"{args.output}: {count} of {count + left} requirements")
        for note in found.notes:
            say(f"note: {note}")
    return VIOLATED if found.rejected else OK


def _read(args: argparse.Namespace) -> Conversion:
    if args.component is not None:
        raise UsageError("--component is for --to: the file that is read names its components")
    for name, default in SPECIFICATION_DEFAULTS.items():
        if name not in ("period", "time") and getattr(args, name) != default:
            raise UsageError(
                f"--{name} is for --to: it is about specifications, and --from reads another format"
            )
    text = read_text(args.spec)
    period = None if args.period is None else positive_period(args.period)
    try:
        return format_named(args.source).read(text, period)
    except UsageError as error:
        raise CommandError(f"{args.spec}: {error}") from error


def _write(args: argparse.Namespace) -> Conversion:
    return format_named(args.target).write(read_specification(args, DEFAULT), args.component)
