"""Shared parts of commands: options, the specification, and the printing of values."""

from __future__ import annotations

import os
import re
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from rtamt.cli.language import add_language_option, read_language
from rtamt.cli.parameters import add_set_option, assigned
from rtamt.cli.parser import complain
from rtamt.errors import BoundError, SpecificationError, StlError, UsageError, choices, did_you_mean, readable
from rtamt.files import is_device, nearest_file, open_text, write_bytes, write_text
from rtamt.language.formula import Apply, postorder
from rtamt.language.parsing.lexer import NAME
from rtamt.language.units.durations import UNITS, decimal
from rtamt.lazy.modules import np
from rtamt.lazy.patterns import lazy_pattern
from rtamt.readers.formats import METADATA, SUFFIXES
from rtamt.rewrite.semantics import SEMANTICS
from rtamt.settings import check_backend, require_backend
from rtamt.signals.datetimes import nanoseconds_of
from rtamt.signals.time_domains import DEFAULT, DOMAINS, time_domain
from rtamt.specification_loader import load, pack, packs, parse

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterable, Mapping, Sequence

    from rtamt.lint.found import LintWarning
    from rtamt.settings import Settings
    from rtamt.specification import Specification


NO_STAMPS = "dense time needs a column of timestamps: call it 'time', or name it with --time-column"

#: The optional prefix of the name of a pack.
PACK = "pack:"
_SPECIFICATION_SUFFIXES = (".stl",)
#: Titles under which the help lists options.
SPECIFICATION, READING, OUTPUT = "the specification", "reading recordings", "output"
METRICS = "metrics (pip install 'rtamt[metrics]')"
#: What SPEC is for most commands.
_SPECIFICATION = "a specification file (.stl), a pack ('rtamt packs' lists them), or a formula in quotes"

_LIKE_A_PATH = lazy_pattern(r"[\w.~:\\/-]*[\\/][\w.~:\\/-]*")


class CommandError(StlError):
    """A command cannot continue; the message is complete, including the file name."""


def options(parser: argparse.ArgumentParser, title: str) -> argparse._ArgumentGroup:
    """Return the group of options that the help lists under a title."""
    found = next((group for group in parser._action_groups if group.title == title), None)
    return found or parser.add_argument_group(title)


#: What the options of a specification are where they are not given.
SPECIFICATION_DEFAULTS: Mapping[str, Any] = MappingProxyType(
    {
        "period": None,
        "unit": "s",
        "backend": "cpp",
        "semantics": "standard",
        "set": [],
        "language": None,
        "time": DEFAULT,
    }
)


def add_specification_options(
    parser: argparse.ArgumentParser, nargs: str | None = None, what: str = _SPECIFICATION
) -> None:
    """Add SPEC and the options for reading it; ``nargs``: "?" where it may be left out; ``what`` it may be."""
    parser.add_argument("spec", metavar="SPEC", nargs=nargs, help=what)
    group = options(parser, SPECIFICATION)
    group.add_argument(
        "--period", metavar="DURATION", help="the sampling period: seconds, or with a unit, such as 100ms"
    )
    units = ", ".join(UNITS)
    group.add_argument("--unit", default="s", help=f"the unit of bounds without a unit: {units} (default: s)")
    group.add_argument(
        "--backend",
        default="cpp",
        metavar="{cpp,python}",
        help="cpp: the compiled core (default); python: the executable definition, slow",
    )
    group.add_argument(
        "--semantics",
        default="standard",
        metavar="NAME",
        help=f"the value of predicates: {', '.join(SEMANTICS)} (default: standard); "
        f"the specification declares which variables are inputs",
    )
    add_set_option(group)
    add_language_option(group)


def add_time_option(parser: argparse.ArgumentParser) -> None:
    """Add the choice of the time domain."""
    options(parser, SPECIFICATION).add_argument(
        "--time",
        default=DEFAULT,
        metavar=f"{{{','.join(DOMAINS)}}}",
        help="; ".join(f"{name}: {domain.summary}" for name, domain in DOMAINS.items())
        + f" (default: {DEFAULT})",
    )


def add_ignore_option(parser: argparse.ArgumentParser) -> None:
    """Add which warnings are silenced; see :func:`warnings_of`."""
    options(parser, OUTPUT).add_argument(
        "--ignore",
        metavar="CODE",
        action="append",
        default=[],
        type=_code,
        help="silence a warning by its code, such as RT105 ('rtamt lint --help' lists them); repeatable",
    )


def _code(given: str) -> str:
    """Return the code of a warning; :class:`argparse.ArgumentTypeError` for anything else."""
    from argparse import ArgumentTypeError

    from rtamt.lint.rules import CODES

    if given not in CODES:
        raise ArgumentTypeError(f"there is no code '{given}'{choices(given, CODES, 'codes')}")
    return given


def warnings_of(spec: Specification, ignored: Sequence[str]) -> list[LintWarning]:
    """Return the warnings about a specification that are not silenced."""
    return [warning for warning in spec.warnings if warning.code not in ignored]


def warn(found: Iterable[LintWarning], given: str) -> None:
    """Print warnings about a specification of the command line on stderr."""
    place = f"{given}: " if os.path.isfile(given) else ""
    for warning in found:
        complain(f"{place}{warning.severity} {warning}")


def add_verdict_option(parser: argparse.ArgumentParser) -> None:
    """Add the choice of what a compiled program reports."""
    parser.add_argument(
        "--verdict",
        choices=("delayed", "interval"),
        default="delayed",
        help="delayed: robustness and verdict of every sample, one horizon later; interval: bounds and verdict at the "
        "start of the trace, valid for every continuation (default: delayed)",
    )


def add_worst_case_option(parser: argparse.ArgumentParser) -> None:
    """Add the choice of constant time a sample."""
    parser.add_argument(
        "--worst-case",
        action="store_true",
        help="for real-time use: no sample takes longer than others, whatever the bounds (discrete time)",
    )


def add_budget_options(group: argparse._ActionsContainer) -> None:
    """Add what limits the work."""
    group.add_argument(
        "--evaluations",
        metavar="N",
        type=int,
        default=1_000_000,
        help="stop after so many evaluations of a recording (default: 1000000)",
    )
    group.add_argument("--timeout", metavar="SECONDS", type=float, help="stop after so many seconds")


def add_stamp_options(parser: argparse.ArgumentParser, what: str) -> None:
    """Add the options for the column and unit of timestamps; ``what``: a column, or a key."""
    group = options(parser, READING)
    group.add_argument("--time-column", metavar="NAME", help=f"the {what} of timestamps; '' for none")
    group.add_argument(
        "--time-unit",
        metavar="UNIT",
        choices=tuple(UNITS),
        help=f"the unit of numeric timestamps: {', '.join(UNITS)} (default: the unit in the header, else s)",
    )


def is_trace(path: str | None) -> bool:
    """Return whether a text is a file of recordings, or a bag's folder; a ``.txt`` may be a specification as well."""
    if path is None:
        return False
    return (os.path.isfile(path) and _is_called_like_a_trace(path)) or os.path.isfile(
        os.path.join(path, METADATA)
    )


def _is_called_like_a_trace(path: str) -> bool:
    return os.path.splitext(path)[1].lower() in set(SUFFIXES) - {".txt"}


def read_specification(args: argparse.Namespace, time: str, *, runs: bool = True) -> Specification:
    """Read SPEC: the file of that name, else the text itself; ``time``: the name of a time domain."""
    return read_specifications(args, time, [args.spec], runs=runs)[0]


def read_specifications(
    args: argparse.Namespace, time: str, given: Sequence[str], *, runs: bool = True
) -> list[Specification]:
    """Read several files or texts; each name of ``--set`` must be a parameter of one of them.

    ``runs``: whether the back end is needed.
    """
    specs = [_read(args, time, spec, runs=runs) for spec in given]
    for spec in specs:
        rule = spec.document.sampling
        if args.period is not None and rule is not None and spec.period != rule.period:
            complain(f"--period {args.period} replaces that of '{rule}' in the specification")
    try:
        return assigned(specs, args.set)
    except BoundError as error:
        raise CommandError(f"{' '.join(f'--set {each}' for each in args.set)}: {error}") from error


def read_library(args: argparse.Namespace, time: str, file: str) -> Specification | None:
    """Read a file that only declares what others import, with a formula at its end; None for any other file."""
    options, (folder, name) = settings_of(args, time, runs=False), os.path.split(os.path.abspath(file))
    try:
        parse(f'import "{name}"\ntrue', folder=folder, **options)
        with open_text(file) as text:
            spec = parse(f"{text.read()}\ntrue", folder=folder, **options)
    except SpecificationError:
        return None
    document = spec.document
    named = (
        document.declarations,
        document.definitions,
        document.templates,
        document.tables,
        document.enumerations,
    )
    return spec if any(named) or document.groups else None


def assumes_period(spec: Specification, time_column: str | None) -> bool:
    """Return whether samples without timestamps are 1 s apart by default, and a formula has bounds in time or a rate.

    ``time_column``: that of the options, "" for none.
    """
    if time_column is not None or spec.period is not None or not spec.domain.sampled:
        return False
    return any(
        node.op.timed or (node.interval is not None and not node.interval.implied)
        for node in postorder(spec.formula)
        if isinstance(node, Apply)
    )


def settings_of(args: argparse.Namespace, time: str, *, runs: bool) -> Settings:
    """Return the settings of specifications that the arguments choose."""
    domain = time_domain(time, args.period)
    check_backend(args.backend)
    try:
        if runs:
            require_backend(args.backend, domain)
    except UsageError as error:
        raise CommandError(f"{error}; on the command line: --backend python") from None
    if args.period is not None and domain.period is None:
        raise CommandError(f"{time} time has no sampling period: leave out --period, or --time {time}")
    return {
        "period": args.period,
        "unit": args.unit,
        "backend": args.backend,
        "time": time,
        "semantics": args.semantics,
        "language": read_language(args.language),
    }


def _read(args: argparse.Namespace, time: str, spec: str, *, runs: bool) -> Specification:
    options = settings_of(args, time, runs=runs)
    if is_trace(spec):
        raise CommandError(f"'{spec}' is a trace; the specification comes before the traces")
    name = find_pack(spec)
    if name is not None:
        try:
            return pack(name, **options)
        except SpecificationError as error:
            raise CommandError(f"{spec}: {error}") from error
    if not os.path.exists(spec) and NAME.fullmatch(spec) and os.path.isfile(f"{spec}.stl"):
        raise CommandError(
            f"there is no file '{spec}'; did you mean {spec}.stl? (if a formula is meant, put it in parentheses)"
        )
    if not os.path.exists(spec) and NAME.fullmatch(spec) and did_you_mean(spec, packs()):
        raise CommandError(
            f"there is no pack '{spec}'{choices(spec, packs(), 'packs')} (if a formula is meant, put it in parentheses)"
        )
    if os.path.isfile(spec):
        try:
            return load(spec, **options)
        except SpecificationError as error:
            raise CommandError(f"{spec}: {error}") from error
    if os.path.isdir(spec):
        raise CommandError(f"'{spec}' is a directory, expected a specification file or a formula")
    if is_device(spec):
        raise CommandError(f"'{spec}' is a device, expected a specification file or a formula")
    called = spec.lower().endswith(_SPECIFICATION_SUFFIXES) or _is_called_like_a_trace(spec)
    if called or _LIKE_A_PATH.fullmatch(spec):
        raise CommandError(
            f"there is no file '{spec}'{nearest_file(spec)} (if a formula is meant, put it in parentheses)"
        )
    if not spec.strip():
        raise CommandError("the specification is empty; give a file or a formula, such as 'always(x >= 3)'")
    return parse(spec, **options)


def read_text(path: str, encoding: str = "utf-8-sig", newline: str | None = None) -> str:
    """Return the text of a specification file; raise :class:`CommandError` if it cannot be read."""
    try:
        with open_text(path, encoding, newline) as file:
            return file.read()
    except OSError as error:
        raise CommandError(f"cannot read '{path}': {error.strerror or error}") from None
    except UnicodeDecodeError as error:
        raise CommandError(
            f"'{path}' is not UTF-8 text (byte {error.start}); is it a specification?"
        ) from None


def find_pack(spec: str) -> str | None:
    """Return the pack that SPEC names, None if it names none; a file of the same name is an error."""
    if spec.startswith(PACK):
        return spec.removeprefix(PACK)
    if spec not in packs():
        return None
    if os.path.exists(spec):
        raise CommandError(
            f"'{spec}' is a pack and a file in this folder; write {PACK}{spec} for the pack, or ./{spec} for the file"
        )
    return spec


def write_output(path: str, content: str | bytes) -> None:
    """Write an output file completely or not at all; an error is one sentence."""
    try:
        if isinstance(content, str):
            write_text(path, content)
        else:
            write_bytes(path, content)
    except OSError as error:
        raise CommandError(f"cannot write '{path}': {error.strerror or error}") from None


def json_text(value: Any, **options: Any) -> str:
    r"""Return JSON; bytes of file names that are not UTF-8 are written out, since no JSON text can hold them.

    A Decimal is a number with all its digits.

    >>> print(json_text({"trace": "caf\udce9.csv", "time": Decimal("1700000000.100000001")}))
    {"trace": "caf\\xe9.csv", "time": 1700000000.100000001}
    """
    import json
    from uuid import uuid4

    mark = uuid4().hex  # which no text contains
    return re.sub(f'"{mark}(.*?)"', r"\1", json.dumps(_readable(value, mark), **options))


def _readable(value: Any, mark: str) -> Any:
    if isinstance(value, dict):
        return {_readable(key, mark): _readable(inner, mark) for key, inner in value.items()}
    if isinstance(value, (list, tuple)):
        return [_readable(inner, mark) for inner in value]
    if isinstance(value, Decimal):
        return f"{mark}{value}"
    return readable(value) if isinstance(value, str) else value


def json_number(value: float) -> float | str:
    """Return a number as JSON can hold it: JSON has no infinities, so they are text; no minus before zero.

    >>> json_number(float("-inf")), json_number(2.5), json_number(-0.0)
    ('-inf', 2.5, 0.0)
    """
    return value + 0.0 if isfinite(value) else str(value)


def stamp_text(time: Any) -> str:
    """Return a time as text: a date, or seconds with every nanosecond.

    >>> stamp_text(np.float64(0.1)), stamp_text(np.timedelta64(1700000000100000001, "ns"))
    ('0.1', '1700000000.100000001')
    """
    if isinstance(time, np.timedelta64):
        return str(decimal(Fraction(nanoseconds_of(time) or 0, 10**9)))
    return str(time) if isinstance(time, np.datetime64) else repr(float(time))


def short(value: float) -> str:
    """Return a number for display: six digits, no minus before zero.

    >>> short(3.0), short(-0.0), short(float("inf"))
    ('3', '0', 'inf')
    """
    return f"{value + 0.0:.6g}"
