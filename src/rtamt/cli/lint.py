"""``rtamt lint``: are these specification files all right? For editors, hooks and CI jobs, without a recording."""

from __future__ import annotations

import os
from argparse import Namespace
from typing import TYPE_CHECKING

from rtamt.cli.command import (
    CommandError,
    add_ignore_option,
    add_specification_options,
    add_time_option,
    read_specification,
    warn,
)
from rtamt.cli.parser import ERROR, OK, VIOLATED, complain
from rtamt.cli.terminal import say
from rtamt.errors import StlError
from rtamt.language.lint import RULES
from rtamt.rewrite.check import check_online
from rtamt.signals.discrete import Discrete

if TYPE_CHECKING:
    import argparse

    from rtamt.specification import Specification

_DESCRIPTION = """\
Check specification files and report each error: what, where (line, column and a caret) and how
to fix it; and warn of legal but probably unintended formulas. Nothing is evaluated.

Exit code: 0 all files are valid, 2 some are not; with --strict 1 if there are only warnings."""

_EPILOG = """\
With --period the bounds must be whole numbers of it; with --online no operator may need the whole
future, so that a monitor can run the requirement.

Warnings, by the codes that --ignore takes: {warnings}.

examples:
  rtamt lint examples/request_grant/spec.stl
  rtamt lint ros/rtamt4ros/specs/*.stl --online --period 100ms"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG.format(warnings=", ".join(f"{rule.code} ({rule.about})" for rule in RULES))
    add_specification_options(parser)
    parser.add_argument("more", metavar="SPEC", nargs="*", help="more of them")
    add_time_option(parser)
    parser.add_argument("--online", action="store_true", help="refuse what a monitor cannot run")
    add_ignore_option(parser)
    parser.add_argument("--strict", action="store_true", help="exit with 1 where there are warnings")
    parser.add_argument("--quiet", action="store_true", help="print errors only")


def run(args: argparse.Namespace) -> int:
    """Read every file; report each that is wrong."""
    files = [args.spec, *args.more]
    warnings = [_warnings(file, args) for file in files]
    if None in warnings:
        return ERROR
    if any(warnings) and args.strict:
        return VIOLATED
    if not args.quiet and not any(warnings):
        say(f"{len(files)} {'file is' if len(files) == 1 else 'files are'} right")
    return OK


def _warnings(file: str, args: argparse.Namespace) -> int | None:
    """Check a file, print what is wrong with it; return the number of warnings, None where there is an error."""
    try:
        spec = _check(file, args)
    except StlError as error:
        complain(error)
        return None
    return 0 if args.quiet and not args.strict else warn(spec, file, args.ignore)


def _check(file: str, args: argparse.Namespace) -> Specification:
    if not os.path.isfile(file):
        raise CommandError(f"there is no file '{file}'; 'rtamt info' looks at a formula in quotes")
    spec = read_specification(Namespace(**{**vars(args), "spec": file}), args.time)
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
