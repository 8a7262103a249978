"""``rtamt explain``: which instants of which signals are responsible for the verdict on a recording."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from rtamt.cli.command import (
    OK,
    VIOLATED,
    Command,
    CommandError,
    add_specification_options,
    add_stamp_options,
    add_time_option,
    read_specification,
    read_trace,
)
from rtamt.cli.terminal import Progress
from rtamt.engine.ticks import NANOSECOND, TimeScale
from rtamt.errors import StlError

if TYPE_CHECKING:
    import argparse

    from rtamt.engine.trace import Trace
    from rtamt.explain.report import Explanation
    from rtamt.specification import Specification

_DESCRIPTION = """\
Tell why a recording satisfies or violates a requirement: the critical point (the predicate
and the instant whose value is, up to sign, the robustness) and the implicant (the intervals of
predicates that alone force the verdict, whatever the signals do elsewhere).

Exit code: 0 satisfied, 1 violated, 2 it could not be explained."""

_EPILOG = """\
A trace is a CSV file, as for 'rtamt check'. A predicate is quoted with what it was worth: above 0 it
held, below 0 it failed.

--json prints one object: {"trace", "formula", "time", "satisfied", "robustness", "critical", "implicant"}.
An interval of the implicant that never ends has the end null; its end belongs to it if "closed".
JSON has no infinities: they are the strings "inf" and "-inf".

examples:
  rtamt explain examples/request_grant/spec.stl examples/request_grant/c_violated.csv
  rtamt explain "always((req >= 3) -> eventually[0:5](gnt >= 3))" log.csv --at 2.5 --time dense
  rtamt explain requirement.stl log.csv --json"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    parser.add_argument("trace", metavar="TRACE", help="a CSV file")
    add_time_option(parser)
    add_instant_option(parser)
    add_stamp_options(parser, "column")
    parser.add_argument("--json", action="store_true", help="print JSON")


def add_instant_option(parser: argparse.ArgumentParser) -> None:
    """Add the instant whose verdict is explained; see :func:`instant`."""
    parser.add_argument("--at", metavar="T", type=float, help="seconds: the instant (default: the first)")


def run(args: argparse.Namespace) -> int:
    """Evaluate the trace and explain what comes of it."""
    spec = read_specification(args, args.time)
    with Progress() as progress:
        progress.show(args.trace)
        data = read_trace(spec, args.trace, args.time_column, args.time_unit)
        try:
            explanation = spec.evaluate(data).explain(instant(args.at, spec, data))
        except StlError as error:
            raise CommandError(f"{args.trace}: {error}") from error
    print(_as_json(args.trace, explanation) if args.json else explanation)
    return OK if explanation.satisfied else VIOLATED


def instant(at: float | None, spec: Specification, data: Trace) -> Any:
    """Return what ``--at`` says, in seconds, as the recording tells time."""
    if at is not None and spec.time == "dense" and isinstance(data.start, np.integer):
        (tick,) = TimeScale(NANOSECOND, "seconds").ticks([at], "--at")
        return tick
    return at


def _as_json(trace: str, explanation: Explanation) -> str:
    return json.dumps({"trace": trace, **explanation.to_dict()}, default=str)  # dates are texts


COMMAND = Command("explain", "tell which instants of which signals decide the verdict", configure, run)
