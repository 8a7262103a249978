"""``rtamt lint``: check specification files without a recording, for editors, hooks and CI jobs."""

from __future__ import annotations

import contextlib
import io
import os
import sys
from argparse import Namespace
from functools import partial
from typing import TYPE_CHECKING

from rtamt.cli.command import (
    CommandError,
    add_ignore_option,
    add_specification_options,
    add_time_option,
    json_text,
    read_library,
    read_specification,
    settings_of,
    warn,
    write_output,
)
from rtamt.cli.language import read_language
from rtamt.cli.parser import ERROR, OK, VIOLATED, complain
from rtamt.cli.terminal import encodable, say
from rtamt.errors import BoundError, SpecificationError, StlError, line_and_column
from rtamt.language.parsing.imports import Library
from rtamt.language.parsing.specfile import parse_document
from rtamt.language.units.durations import positive_period
from rtamt.lint.fix import with_fixes
from rtamt.lint.report import findings
from rtamt.lint.rules import ALL, SHORTER, UNUSED
from rtamt.rewrite.check import check_online

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator

    from rtamt.language.document import Document
    from rtamt.language.formula import Span
    from rtamt.lint.found import LintWarning
    from rtamt.specification import Specification

#: Files for which starting one more process pays, and those that a process takes at once.
_WORTH_A_PROCESS, _AT_ONCE = 300, 25

_DESCRIPTION = """\
Check specification files without evaluating them. Report every error of each file: what is wrong, where (line,
column and a caret) and how to fix it. Warn about valid but probably unintended formulas, such as a sum of a speed
and a distance, or a limit outside the declared range of a signal. A file without formulas is checked as one that
others import.

Exit code: 0 all files are valid, 2 some have errors; with --strict, 1 if there are only warnings.
--json prints one object per line: {"file", "severity", "code", "message", "fixable", "line", "column", "end_line",
"end_column"}. "end_column" is the column after the last character; "code" is null if the text is not a
specification."""

_EPILOG = """\
With --period, bounds must be whole numbers of periods. With --online, formulas with unbounded future are
errors, because no monitor can run them.

--fix rewrites the files: each finding that has a fix is fixed, comments and layout are kept, and every formula
keeps its meaning.

Warnings, with the codes for --ignore: {warnings}.
A comment in the text silences one, too: // lint: ignore[RT105]

examples:
  rtamt lint examples/request_grant/spec.stl
  rtamt lint limits.stl --fix
  rtamt lint ros/rtamt4ros/specs/*.stl --online --period 100ms"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG.format(warnings=", ".join(f"{rule.code} ({rule.about})" for rule in ALL))
    add_specification_options(parser, what="a specification file (.stl)")
    parser.add_argument("more", metavar="SPEC", nargs="*", help="more files")
    add_time_option(parser)
    parser.add_argument("--online", action="store_true", help="reject formulas that a monitor cannot run")
    parser.add_argument(
        "--fix", action="store_true", help="rewrite the files without the findings that have a fix"
    )
    add_ignore_option(parser)
    parser.add_argument("--strict", action="store_true", help="exit with 1 if there are warnings")
    parser.add_argument("--quiet", action="store_true", help="print errors only")
    parser.add_argument("--json", action="store_true", help="print JSON, one object per line")


def run(args: argparse.Namespace) -> int:
    """Read every file; report each that is wrong."""
    files = [args.spec, *args.more]
    codes = list(_codes(files, args))
    if not args.quiet and not args.json and not any(codes):
        say(f"{len(files)} {'file has' if len(files) == 1 else 'files have'} no errors or warnings")
    worst = max(codes)
    return OK if worst == VIOLATED and not args.strict else worst


def _codes(files: list[str], args: argparse.Namespace) -> Iterator[int]:
    """Check files, and print what is wrong with them in their order: many files in a process for each core."""
    count = min(os.cpu_count() or 1, len(files) // _WORTH_A_PROCESS)
    if count <= 1 or args.fix:  # a file that is fixed may be imported by others
        yield from (_lint(file, args) for file in files)
        return
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import get_context

    plain = Namespace(**{name: value for name, value in vars(args).items() if not callable(value)})
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        for code, out, errors in pool.map(partial(_lint_in_process, args=plain), files, chunksize=_AT_ONCE):
            sys.stdout.write(encodable(out, sys.stdout))
            sys.stdout.flush()
            sys.stderr.write(errors)
            yield code


def _lint_in_process(file: str, args: Namespace) -> tuple[int, str, str]:
    """Check a file in another process: return its code, and what is to be printed."""
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        code = _lint(file, args)
    return code, out.getvalue(), errors.getvalue()


def _lint(file: str, args: argparse.Namespace) -> int:
    """Check a file and print what is wrong with it; return 2 where there are errors, 1 where there are warnings."""
    wrong: list[StlError] = []
    try:
        found = _findings(file, args)
    except StlError as error:
        found = _short_bounds(file, args) if isinstance(error.__cause__, BoundError) else []
        short = {each.span for each in found}
        wrong = [each for each in _all_errors(error, file, args) if _place(each)[2] not in short]
    for one in wrong:
        if args.json:
            say(_as_json(file, "error", None, *_place(one)))
        else:
            complain(one)
    found = [each for each in found if each.code not in args.ignore]
    if args.quiet:
        shown = ("error", "warning") if args.strict else ("error",)
        found = [each for each in found if each.severity in shown]
    if args.json:
        for each in found:
            say(
                _as_json(
                    file, each.severity, each.code, each.message, each.text, each.span, each.fix is not None
                )
            )
    else:
        warn(found, file)
    if wrong or any(each.severity == "error" for each in found):
        return ERROR
    return VIOLATED if any(each.severity == "warning" for each in found) else OK


def _all_errors(error: StlError, file: str, args: argparse.Namespace) -> list[StlError]:
    """Return all errors of the text that has this one; only this one if it is not about the text alone."""
    cause = error.__cause__
    if not isinstance(cause, SpecificationError) or cause.text is None:
        return [error]
    from rtamt.text_errors import errors_of

    folder = os.path.dirname(file) or os.curdir
    found: list[StlError] = [error]
    for each in errors_of(cause.text, cause, folder=folder, **settings_of(args, args.time, runs=False)):
        if str(each) != str(cause):
            found.append(CommandError(f"{file}: {each}"))
            found[-1].__cause__ = each
    return found


def _place(error: StlError) -> tuple[str, str | None, Span | None]:
    """Return the message of an error, and its position if it is one in the text."""
    cause = error.__cause__ or error
    if isinstance(cause, SpecificationError):
        return cause.message, cause.text, cause.span
    return str(cause), None, None


def _as_json(
    file: str,
    severity: str,
    code: str | None,
    message: str,
    text: str | None,
    span: Span | None,
    fixable: bool = False,
) -> str:
    row: dict[str, object] = {
        "file": file,
        "severity": severity,
        "code": code,
        "message": message,
        "fixable": fixable,
    }
    if text is not None and span is not None:
        begin, end = line_and_column(text, span.start), line_and_column(text, span.end)
        row |= dict(zip(("line", "column", "end_line", "end_column"), (*begin, *end), strict=True))
    return json_text(row)


def _findings(file: str, args: argparse.Namespace) -> list[LintWarning]:
    """Return the warnings about a file, after fixing it if requested."""
    if not os.path.isfile(file):
        raise CommandError(f"there is no file '{file}'; 'rtamt info' looks at a formula in quotes")
    library = False
    try:
        spec = read_specification(Namespace(**{**vars(args), "spec": file}), args.time, runs=False)
    except CommandError:
        found = read_library(args, args.time, file)
        if found is None:
            raise
        spec, library = found, True
    if args.online and not library:
        try:
            check_online(spec.formula, spec.text)
        except StlError as error:
            raise CommandError(f"{file}: {error}") from error
    if args.fix and any(each.fix for each in spec.warnings) and _mend(file, spec, args, library=library):
        return _findings(file, Namespace(**{**vars(args), "fix": False}))
    return [each for each in spec.warnings if not (library and each.code == UNUSED)]


def _short_bounds(file: str, args: argparse.Namespace) -> list[LintWarning]:
    """Return the findings about bounds that no specification with this sampling period may have."""
    period = None if args.period is None else positive_period(args.period)
    try:
        document = _parse(_text_of(file), file, args)
    except SpecificationError:  # the bound is wrong whatever the period is
        return []
    found = findings(document, read_language(args.language), period)
    return [each for each in found if each.code == SHORTER]


def _mend(file: str, spec: Specification, args: argparse.Namespace, *, library: bool) -> bool:
    """Rewrite a file without the findings that have a fix; return whether there were any."""
    text, ending = _text_of(file), "\ntrue" if library else ""
    found = with_fixes(
        _parse(text + ending, file, args),
        lambda new: _parse(new, file, args),
        spec.language,
        period=spec.period,
        ignored=args.ignore,
    )
    if not found.codes:
        return False
    write_output(file, found.text.removesuffix(ending).encode())
    if not args.json and not args.quiet:
        count = len(found.codes)
        codes = ", ".join(dict.fromkeys(sorted(found.codes)))
        say(f"{file}: {count} {'finding' if count == 1 else 'findings'} fixed ({codes})")
    return True


def _text_of(file: str) -> str:
    """Return a file's characters as they are, with the ends of its lines."""
    with open(file, encoding="utf-8", newline="") as opened:
        return opened.read()


def _parse(text: str, file: str, args: argparse.Namespace) -> Document:
    folder = os.path.dirname(file) or os.curdir
    return parse_document(
        text, language=read_language(args.language), unit=args.unit, library=Library(folder)
    )
