"""``rtamt lint``: check specification files without a recording, for editors, hooks and CI jobs."""

from __future__ import annotations

import os
from argparse import Namespace
from typing import TYPE_CHECKING

from rtamt.cli.command import (
    CommandError,
    add_ignore_option,
    add_specification_options,
    add_time_option,
    json_text,
    read_library,
    read_specification,
    warn,
    warnings_of,
)
from rtamt.cli.parser import ERROR, OK, VIOLATED, complain
from rtamt.cli.terminal import say
from rtamt.errors import SpecificationError, StlError, line_and_column
from rtamt.language.lint import RULES
from rtamt.rewrite.check import check_online
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    import argparse

    from rtamt.language.formula import Span
    from rtamt.specification import Specification

_DESCRIPTION = """\
Check specification files without evaluating them. Report each error: what is wrong, where (line, column and a
caret) and how to fix it. Warn about valid but probably unintended formulas, such as a sum of a speed and a
distance. A file without formulas is checked as one that others import.

Exit code: 0 all files are valid, 2 some have errors; with --strict, 1 if there are only warnings.
--json prints one object per line: {"file", "severity", "code", "message", "line", "column", "end_line",
"end_column"}. "end_column" is the column after the last character; "code" is null if the text is not a
specification."""

_EPILOG = """\
With --period, bounds must be whole numbers of periods. With --online, formulas with unbounded future are
errors, because no monitor can run them.

Warnings, with the codes for --ignore: {warnings}.

examples:
  rtamt lint examples/request_grant/spec.stl
  rtamt lint ros/rtamt4ros/specs/*.stl --online --period 100ms"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG.format(warnings=", ".join(f"{rule.code} ({rule.about})" for rule in RULES))
    add_specification_options(parser)
    parser.add_argument("more", metavar="SPEC", nargs="*", help="more specifications")
    add_time_option(parser)
    parser.add_argument("--online", action="store_true", help="reject formulas that a monitor cannot run")
    add_ignore_option(parser)
    parser.add_argument("--strict", action="store_true", help="exit with 1 if there are warnings")
    parser.add_argument("--quiet", action="store_true", help="print errors only")
    parser.add_argument("--json", action="store_true", help="print JSON, one object per line")


def run(args: argparse.Namespace) -> int:
    """Read every file; report each that is wrong."""
    files = [args.spec, *args.more]
    codes = [_lint(file, args) for file in files]
    if not args.quiet and not args.json and not any(codes):
        say(f"{len(files)} {'file has' if len(files) == 1 else 'files have'} no errors or warnings")
    worst = max(codes)
    return OK if worst == VIOLATED and not args.strict else worst


def _lint(file: str, args: argparse.Namespace) -> int:
    """Check a file and print what is wrong with it; return 2 where there are errors, 1 where there are warnings."""
    try:
        found = warnings_of(_check(file, args), args.ignore)
    except StlError as error:
        if args.json:
            say(_as_json(file, "error", None, *_place(error)))
        else:
            complain(error)
        return ERROR
    if args.quiet:
        shown = ("error", "warning") if args.strict else ("error",)
        found = [each for each in found if each.severity in shown]
    if args.json:
        for each in found:
            say(_as_json(file, each.severity, each.code, each.message, each.text, each.span))
    else:
        warn(found, file)
    if any(each.severity == "error" for each in found):
        return ERROR
    return VIOLATED if any(each.severity == "warning" for each in found) else OK


def _place(error: StlError) -> tuple[str, str | None, Span | None]:
    """Return the message of an error, and its position if it is one in the text."""
    cause = error.__cause__ or error
    if isinstance(cause, SpecificationError):
        return cause.message, cause.text, cause.span
    return str(cause), None, None


def _as_json(
    file: str, severity: str, code: str | None, message: str, text: str | None, span: Span | None
) -> str:
    row: dict[str, object] = {"file": file, "severity": severity, "code": code, "message": message}
    if text is not None and span is not None:
        begin, end = line_and_column(text, span.start), line_and_column(text, span.end)
        row |= dict(zip(("line", "column", "end_line", "end_column"), (*begin, *end), strict=True))
    return json_text(row)


def _check(file: str, args: argparse.Namespace) -> Specification:
    if not os.path.isfile(file):
        raise CommandError(f"there is no file '{file}'; 'rtamt info' looks at a formula in quotes")
    try:
        spec = read_specification(Namespace(**{**vars(args), "spec": file}), args.time, runs=False)
    except CommandError:
        library = read_library(args, args.time, file)
        if library is None:
            raise
        return library
    try:
        _check_formula(spec, online=args.online)
    except StlError as error:
        raise CommandError(f"{file}: {error}") from error
    return spec


def _check_formula(spec: Specification, *, online: bool) -> None:
    if spec.period is not None:
        Discrete(spec.period).check(spec.formula, spec.text)
    if online:
        check_online(spec.formula, spec.text)
