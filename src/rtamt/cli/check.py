"""``rtamt check``: does each recording satisfy the requirement? The exit code serves a CI job."""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rtamt.cli.command import (
    ERROR,
    OK,
    VIOLATED,
    Command,
    CommandError,
    add_specification_options,
    add_stamp_options,
    add_time_option,
    complain,
    json_number,
    read_specification,
    read_trace,
    short,
    stamp_text,
)
from rtamt.cli.terminal import Progress, printed, table, use_color
from rtamt.engine.signals import Recording
from rtamt.errors import StlError
from rtamt.language.units import format_duration

if TYPE_CHECKING:
    import argparse

    from rtamt.engine.dense_evaluate import DenseRecording
    from rtamt.results import Result
    from rtamt.specification import Specification

_DESCRIPTION = """\
Evaluate recordings against a requirement: the robustness at the first instant (how far
the recording is from violating the requirement, or below 0 from satisfying it) and the verdict.

Exit code: 0 all satisfied, 1 some violated, 2 some could not be evaluated."""

_EPILOG = """\
A trace is a CSV file whose header names the columns. Time stamps are in the column called time, t,
timestamp, stamp or datetime; without one, samples are one period apart. They are dates (ISO 8601) or
numbers: seconds, or the unit in the header ('t [ms]') or of --time-unit; integers too large for
seconds are ms, us or ns since 1970. Columns that the formula does not read may hold anything.

With --time dense a value holds until the next one, and time stamps may lie anywhere; a variable has
no sample where its cell is empty. Then -o writes the robustness where it changes, and at the end.

--json prints one object a line: {"trace", "satisfied", "robustness", "samples", "period"}, or
{"trace", "error"}. The period of dense time is null. JSON has no infinities: they are the
strings "inf" and "-inf".

examples:
  rtamt check examples/request_grant/spec.stl examples/request_grant/*.csv
  rtamt check "always((req >= 3) -> eventually[0:5](gnt >= 3))" log.csv --json
  rtamt check "always[0:500ms](speed <= 30)" drive.csv --period 100ms -o robustness.csv
  rtamt check "always(alarm -> eventually[0:70ms](stop))" events.csv --time dense
  rtamt check examples/request_grant/spec.stl examples/request_grant/b_vacuous.csv --semantics input_vacuity"""


@dataclass(frozen=True, slots=True)
class Outcome:
    """What came of one trace: a result, or the reason why there is none."""

    trace: str
    verdict: str  # satisfied, violated or error
    result: Result | None = None
    error: str = ""


_KINDS = {"satisfied": "good", "violated": "bad", "error": "error"}
_CODES = {"satisfied": OK, "violated": VIOLATED, "error": ERROR}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    parser.add_argument("traces", metavar="TRACE", nargs="+", help="a CSV file")
    add_time_option(parser)
    add_stamp_options(parser, "column")
    parser.add_argument("-o", "--output", metavar="FILE", help="write the robustness at every sample as CSV")
    parser.add_argument("--json", action="store_true", help="print JSON, one object a line")
    parser.add_argument("--quiet", action="store_true", help="print errors only: the exit code has it all")
    parser.add_argument(
        "--color", default="auto", metavar="{auto,always,never}", help="colour (default: auto, on a terminal)"
    )


def run(args: argparse.Namespace) -> int:
    """Evaluate every trace, print what came of it."""
    color = use_color(args.color, sys.stdout)
    if args.output is not None and len(args.traces) > 1:
        raise CommandError(f"--output takes the robustness of one trace, got {len(args.traces)} traces")
    spec = read_specification(args, args.time)
    outcomes: list[Outcome] = []
    with Progress() as progress:
        for number, trace in enumerate(args.traces, 1):
            label = f"{number}/{len(args.traces)} {trace}"
            progress.show(label)
            outcome = _evaluate(spec, trace, args.time_column, args.time_unit)
            outcomes.append(outcome)
            if outcome.error:
                progress.clear()
                complain(outcome.error)
            if args.json and not args.quiet:
                progress.clear()
                print(_as_json(outcome), flush=True)
    if not args.json and not args.quiet and any(outcome.result for outcome in outcomes):
        print(_as_table(spec, outcomes, color))
    if args.output is not None and outcomes[0].result is not None:
        _write(outcomes[0].result, args.output)
    return max(_CODES[outcome.verdict] for outcome in outcomes)


def _evaluate(spec: Specification, trace: str, time_column: str | None, time_unit: str | None) -> Outcome:
    try:
        data = read_trace(spec, trace, time_column, time_unit)
    except StlError as error:
        return Outcome(trace, "error", error=str(error))
    try:
        result = spec.evaluate(data)
        return Outcome(trace, "satisfied" if result.satisfied else "violated", result)
    except StlError as error:
        return Outcome(trace, "error", error=f"{trace}: {error}")


def _as_json(outcome: Outcome) -> str:
    result = outcome.result
    if result is None:
        return json.dumps({"trace": outcome.trace, "error": outcome.error})
    return json.dumps(
        {
            "trace": outcome.trace,
            "satisfied": outcome.verdict == "satisfied",
            "robustness": json_number(result.robustness),
            "samples": _samples(result.trace),
            "period": float(result.trace.period) if isinstance(result.trace, Recording) else None,
        }
    )


def _as_table(spec: Specification, outcomes: list[Outcome], color: bool) -> str:
    rows = [("trace", "samples", "period", "robustness", "verdict")]
    for outcome in outcomes:
        cells = ("-", "-", "-")
        if outcome.result is not None:
            trace = outcome.result.trace
            period = format_duration(trace.period) if isinstance(trace, Recording) else "dense"
            cells = (str(_samples(trace)), period, short(outcome.result.robustness))
        rows.append((outcome.trace, *cells, outcome.verdict))
    kinds = [_KINDS[outcome.verdict] for outcome in outcomes]
    formula = printed(spec.formula)
    title = f"{spec.name}: {formula}" if spec.name else formula
    text = f"{title}\n\n{table(rows, right=(1, 2, 3), kinds=kinds, color=color)}"
    if len(outcomes) > 1:
        verdicts = [outcome.verdict for outcome in outcomes]
        counts = [f"{verdicts.count(verdict)} {verdict}" for verdict in _CODES if verdict in verdicts]
        text += f"\n\n{', '.join(counts)}"
    return text


def _samples(trace: Recording | DenseRecording) -> int:
    """Return the number of samples; in dense time that of the instants at which any variable has one."""
    if isinstance(trace, Recording):
        return len(trace)
    return len(np.unique(np.concatenate([ticks for ticks, _ in trace.columns.values()])))


def _write(result: Result, path: str) -> None:
    rows = zip(map(stamp_text, result.signal.times), result.signal.values.tolist(), strict=True)
    try:
        with open(path, "w", encoding="utf-8", newline="") as file:
            file.write("time,robustness\n")
            file.writelines(f"{time},{value!r}\n" for time, value in rows)
    except OSError as error:
        raise CommandError(f"cannot write '{path}': {error.strerror}") from None


COMMAND = Command("check", "evaluate recordings: robustness and verdict", configure, run)
