"""``rtamt check``: evaluate every requirement on every recording; the exit code fails a CI job."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING, Any

from rtamt.cli.arguments import each_requirement, requirements_and_traces, share_clock, variables_of
from rtamt.cli.command import (
    OUTPUT,
    CommandError,
    add_ignore_option,
    json_text,
    options,
    stamp_text,
    warn,
    warnings_of,
    write_output,
)
from rtamt.cli.outcome import count_verdicts, exit_code
from rtamt.cli.parser import complain
from rtamt.cli.reading_options import add_input_options, reading_of
from rtamt.cli.report_formats import REPORTS, write_report
from rtamt.cli.report_formats.messages import episodes_members, robustness_members
from rtamt.cli.runner import outcomes
from rtamt.cli.terminal import Progress, printed, say, table, use_color, width_of
from rtamt.cli.written_formats import ROBUSTNESS, format_of
from rtamt.errors import escaped
from rtamt.language.units.durations import format_duration
from rtamt.lazy.dataclasses import replace
from rtamt.lazy.modules import np
from rtamt.signals.sampling_period import merged

if TYPE_CHECKING:
    import argparse
    from collections.abc import Iterator, Mapping, Sequence

    from rtamt.cli.outcome import Outcome, Requirement
    from rtamt.cli.reading_options import Reading
    from rtamt.cli.report_formats.html import HtmlReport
    from rtamt.results import Result
    from rtamt.signals.signal import Signal

_DESCRIPTION = """\
Evaluate every requirement on every recording: the robustness at the first instant (how far the recording
is from violating the requirement or, if negative, from satisfying it) and the verdict.

Exit code: 0 all satisfied, 1 some violated, 2 some could not be evaluated. Requirements whose optional signals
a recording lacks are unchecked and do not affect the exit code."""

_EPILOG = """\
SPEC is a file (.stl), a pack of requirements ('rtamt packs' lists them) or a formula in quotes; more files
and packs may follow. A trace is a CSV, Parquet, Arrow, Excel, PX4 ULog or MDF file, a ROS bag (.bag, .db3,
.mcap, or the folder that ROS 2 records), or
the rows of a query (--sql URL --query TEXT). Timestamps are in the column called time, t, timestamp,
stamp or datetime; without such a column, samples are one period apart. Timestamps are dates (ISO 8601) or
numbers, in seconds, in the unit of the header ('t [ms]'), or in --time-unit. Numbers too large for seconds
are an error. Columns that no formula reads may contain anything.
'rtamt info TRACE' lists the signals of a file, and what was inferred.

With --time dense, a value holds until the next sample, and samples may have any timestamps; an empty cell is a
missing sample. NaN is an error in both time domains unless --skip-nan excludes it; --hold-for limits how long
the previous value holds instead. With --time dense, -o writes the robustness at every change and at the end.

In a bag, the annotations of SPEC select the topics ('@ topic(req, rtamt/req)'). In discrete time, a bag is
sampled as in a node: the latest message of each topic, every --period. Without --period, all of these topics
must have the same timestamps, one period apart; then each message is a sample. -o out.mcap copies the bag and
adds the topics for robustness and verdicts that SPEC names.

The table has one row per requirement: the formulas after 'require ID "text" severity WORD:' in SPEC or,
without any 'require', the formulas that no other formula uses.

A requirement is unchecked if it reads an optional variable ('optional input float v') that the trace does not
have; its row shows what is missing. This does not affect the exit code unless nothing in a trace was
checked: then it is 2.

Valid but probably unintended formulas in SPEC cause a warning on stderr, with a code for --ignore. Warnings do
not affect the exit code. 'rtamt lint' prints the same warnings.

Files of 16 MB and more are read in chunks, with constant memory, if the future of the formula is bounded (except for
always and eventually at its top) and the outcome is that of the whole file; files of 256 MB and more also if it may
differ: the period is that of the first chunk, and --junit and --sarif do not explain violations. Many files are read
on all cores.

--early stops reading once the verdict and the first violation are decided. The verdict is that of the whole
recording, the robustness lies within the printed bounds, and later samples are not checked. Formats that cannot
be read in part are read completely, but evaluated only as far as the verdict needs. In discrete time, the end of
a recording may change early verdicts of some formulas ('rtamt info' reports this); these are checked on the whole
recording.

--engine checks very many recordings: on this machine (local), or on Ray or Spark. SPEC may be a folder of .stl files;
recordings are files, folders, patterns, and addresses that fsspec reads. It prints how many recordings satisfy each
requirement; -o writes the table, a row for each recording and requirement, as Parquet or CSV. A damaged recording
becomes rows with its error. --manifest remembers results: a recording is checked again if it, the requirements or the
options have changed; after a crash, the same command continues. --manifest alone selects the local engine.

--json prints one object per line: {"requirement", "trace", "satisfied", "robustness", "first_violation",
"samples", "period", "episodes"}, with "description" and "severity" for formulas after 'require'; or
{"requirement", "trace", "error"}, or {"requirement", "trace", "unchecked"} with the reason.
"episodes" is an object {"count", "worst", "first"}: the number of maximal runs in which the robustness is
below 0, the worst, and the first 100 as [{"begin", "end", "worst", "at"}]. For 'always f' it is the robustness of
f. The key is absent if chunks or --early do not determine the episodes. "first_violation" is
the first instant at which f does not hold for 'always f', the earliest of the parts for a conjunction, and the
first instant of the trace for all other formulas: in seconds, or a date if the trace has dates; null if there is
none. In dense time, "period" is null. Infinities are the strings "inf" and "-inf", because JSON has none. With
--early, decided requirements also have "lower", "upper" and "decided_at"; "robustness" is null unless both
bounds are equal. The --junit and --sarif reports have the same content.

examples:
  rtamt check examples/request_grant/spec.stl examples/request_grant/*.csv
  rtamt check "always((req >= 3) -> eventually[0:5](gnt >= 3))" log.csv --json
  rtamt check "always[0:500ms](speed <= 30)" drive.csv --period 100ms -o robustness.csv
  rtamt check "always(alarm -> eventually[0:70ms](stop))" events.csv --time dense
  rtamt check examples/request_grant/spec.stl examples/request_grant/b_vacuous.csv --semantics input_vacuity
  rtamt check specs/*.stl logs/*.csv --junit report.xml --html report.html
  rtamt check "always(v >= 14)" flight.ulg --time dense --name "v=battery_status[1].voltage_v"
  rtamt check px4 flight.ulg --set tilt_error=10
  rtamt check examples/request_grant 'examples/request_grant/*.csv' --engine local
  rtamt check limits.stl --sql sqlite:///log.db --query "select time, speed from log"
"""


#: Notes below a table.
_NOTES = 10
_KINDS = {"satisfied": "good", "violated": "bad", "unchecked": "error", "error": "error"}


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_input_options(parser, "a recording; more SPECs (.stl) may precede it")
    group = options(parser, OUTPUT)
    group.add_argument(
        "-o",
        "--output",
        metavar="FILE",
        help="write the robustness at every sample: CSV, or (.mcap) a copy of the bag with additional topics",
    )
    group.add_argument("--json", action="store_true", help="print JSON, one object per line")
    for kind, (name, _) in REPORTS.items():
        group.add_argument(f"--{kind}", metavar="FILE", help=f"write a report as {name}")
    parser.add_argument(
        "--early",
        action="store_true",
        help="stop reading a recording once its verdicts are decided and its end cannot change them",
    )
    parser.add_argument(
        "--jobs",
        type=int,
        metavar="N",
        help="the number of processes (default: one per core, if faster)",
    )
    parser.add_argument(
        "--engine",
        metavar="{local,ray,spark}",
        help="check very many recordings: files, folders, patterns and addresses such as 's3://bucket/*.parquet'",
    )
    parser.add_argument(
        "--manifest",
        metavar="FILE",
        help="remember results, so that only new or changed recordings are checked, also after a crash",
    )
    add_ignore_option(parser)
    group.add_argument("--quiet", action="store_true", help="print errors only")
    group.add_argument(
        "--color", default="auto", metavar="{auto,always,never}", help="colour (default: auto, on a terminal)"
    )


def _page(
    given: Sequence[Requirement], rows: Sequence[Requirement], traces: Sequence[str], reading: Reading
) -> HtmlReport:
    """Return the page that is written while the check runs."""
    from rtamt.cli.report_formats.html import HtmlReport

    return HtmlReport("rtamt check", given, rows, traces, reading)


def run(args: argparse.Namespace) -> int:
    """Evaluate every requirement on every trace, and print the outcomes."""
    if args.engine is not None or args.manifest is not None:
        from rtamt.cli.many import run as run_many

        return run_many(args)
    color = use_color(args.color, sys.stdout)
    given, traces = requirements_and_traces(args, "check")
    for each in [] if args.quiet else given:
        warnings = warnings_of(each.spec, args.ignore)
        warn([one for one in warnings if one.severity != "note"], each.given)
    _check_output(args.output, given, traces)
    requirements = each_requirement(given)
    rows = {requirement.label: requirement for requirement in requirements}
    pairs = len(requirements) * len(traces)
    if args.jobs is not None and args.jobs < 1:
        raise CommandError(f"--jobs is {args.jobs}; give a number of processes, 1 or more")
    whole = args.output is not None or args.html is not None
    if whole and args.early:
        option = "--output" if args.html is None else "--html"
        raise CommandError(
            f"--early reads no more than the verdicts need, and {option} shows all: leave one out"
        )
    explained = args.junit is not None or args.sarif is not None
    reading = reading_of(args, variables_of(requirements), whole=whole, early=args.early, explained=explained)
    _check_clocks(args.output, given[0], traces[0], reading)
    page = None if args.html is None else _page(given, requirements, traces, reading)
    found: list[Outcome] = []
    complaints = {""}  # several requirements may have one reason
    with Progress() as progress:
        progress.show(f"0/{pairs}")
        for outcome in outcomes(given, traces, reading, args.jobs):
            if page is not None:
                page.add(outcome)
            found.append(outcome if args.output is not None else replace(outcome, result=None))
            if outcome.error not in complaints:
                complaints.add(outcome.error)
                progress.clear()
                complain(outcome.error)
            if args.json and not args.quiet:
                progress.clear()
                say(_as_json(outcome, rows[outcome.requirement]), flush=True)
            progress.bar(len(found), pairs, outcome.trace)
    if not args.json and not args.quiet and any(not outcome.error for outcome in found):
        say(_as_table(requirements, found, color), color=color)
    results = {outcome.requirement: outcome.result for outcome in found if outcome.result is not None}
    if args.output is not None and results and not any(outcome.error for outcome in found):
        _write_results(args.output, results, rows, (given[0], traces[0], reading))
    for kind, (_, at_end) in REPORTS.items():
        path = getattr(args, kind)
        if at_end is not None and path is not None:
            write_report(kind, path, requirements, found)
    if page is not None:
        page.write(args.html)
    return exit_code(found)


def _check_output(output: str | None, given: Sequence[Requirement], traces: Sequence[str]) -> None:
    """Raise where the robustness cannot be written: it is that of one trace, in a format that we write."""
    if output is None:
        return
    if output.lower().endswith((".bag", ".db3")):
        raise CommandError(f"--output is '{output}', but bags are written as MCAP: write to a file .mcap")
    if os.path.splitext(output)[1]:  # without one, such as /dev/stdout, it is a table
        format_of(output, ROBUSTNESS, "write the robustness")
    if len(given) * len(traces) > 1:
        what = (
            f"{len(traces)} traces"
            if len(given) == 1
            else f"{len(given)} requirements and {len(traces)} traces"
        )
        raise CommandError(f"--output takes the robustness of one trace, got {what}")


def _check_clocks(output: str | None, requirement: Requirement, trace: str, reading: Reading) -> None:
    """Raise where a table cannot have the robustness of all requirements, because their times have no order."""
    if output is not None and _is_table(output) and not share_clock(requirement, trace, reading):
        raise CommandError(
            f"'{output}' cannot have the robustness of requirements that read topics with different clocks: write "
            f"one file for each requirement"
        )


def _is_table(output: str) -> bool:
    return not output.lower().endswith(".mcap")


def _as_json(outcome: Outcome, requirement: Requirement) -> str:
    row: dict[str, Any] = {"requirement": outcome.requirement, "trace": outcome.trace}
    written = requirement.written
    more = {"description": written.description, "severity": written.severity} if written.explicit else {}
    if outcome.error:
        return json_text({**row, "error": outcome.error})
    if outcome.unchecked:
        return json_text({**row, "unchecked": outcome.unchecked, **more})
    row |= {
        "satisfied": outcome.verdict == "satisfied",
        **robustness_members(outcome),
        "first_violation": outcome.first_violation,
        "samples": outcome.samples,
        "period": None if outcome.period is None else float(outcome.period),
        **episodes_members(outcome),
        **more,
        **({} if outcome.bounds is None else {"decided_at": outcome.decided_at}),
        **({"notes": outcome.notes} if outcome.notes else {}),
    }
    return json_text(row)


def _as_table(requirements: Sequence[Requirement], found: Sequence[Outcome], color: bool) -> str:
    rows = [("requirement", "trace", "samples", "period", "robustness", "first violation", "verdict")]
    for outcome in found:
        cells = ("-", "-", "-", "-")
        if outcome.result_known:
            period = requirements[0].spec.time if outcome.period is None else format_duration(outcome.period)
            cells = (str(outcome.samples), period, outcome.robustness_text, outcome.moment or "-")
        rows.append((outcome.requirement, outcome.trace, *cells, outcome.verdict))
    kinds = [_KINDS[outcome.verdict] for outcome in found]
    if len(requirements) > 1:
        text = table(rows, (2, 3, 4, 5), kinds, color, width_of(sys.stdout))
    else:
        spec = requirements[0].spec
        title = f"{spec.name}: {printed(spec.formula)}" if spec.name else printed(spec.formula)
        alone = table([row[1:] for row in rows], (1, 2, 3, 4), kinds, color, width_of(sys.stdout))
        text = f"{escaped(title)}\n\n{alone}"
    episodes = [
        f"{f'{outcome.requirement}, ' if len(requirements) > 1 else ''}{outcome.trace}: {outcome.episodes_text}"
        for outcome in found
        if outcome.verdict == "violated" and _says_more(outcome)
    ]
    if episodes:
        text += "\n\n" + "\n".join(episodes)
    unchecked = [
        f"{outcome.requirement}, {outcome.trace}: {outcome.unchecked}"
        for outcome in found
        if outcome.unchecked
    ]
    if unchecked:
        text += "\n\n" + "\n".join(unchecked)
    notes = list(
        dict.fromkeys(f"note: {outcome.trace}: {note}" for outcome in found for note in outcome.notes)
    )
    if notes:
        text += "\n\n" + "\n".join(notes[:_NOTES])
    if len(notes) > _NOTES:
        text += f"\nnote: {len(notes) - _NOTES} more notes are in the output of --json"
    if len(found) > 1:
        text += f"\n\n{count_verdicts([outcome.verdict for outcome in found])}"
    return text


def _says_more(outcome: Outcome) -> bool:
    """Return whether episodes add to the row of the table, which has the first violation."""
    found = outcome.episodes
    return (
        found is not None
        and found.worst is not None
        and (found.count > 1 or found.worst.begin != found.worst.end)
    )


def _write_results(
    path: str,
    results: Mapping[str, Result],
    rows: Mapping[str, Requirement],
    checked: tuple[Requirement, str, Reading],
) -> None:
    """Write the robustness of each result: columns of a table, or topics of a copy of the bag that was ``checked``."""
    if _is_table(path):
        names = {label: row.written.name if len(rows) > 1 else "robustness" for label, row in rows.items()}
        _write({names[label]: result for label, result in results.items()}, path)
        return
    from rtamt.cli.bag import write_bag

    write_bag(*checked, results, path)


def _write(results: Mapping[str, Result], path: str) -> None:
    """Write a column of robustness for each result; a cell is empty where one has no sample."""
    times = merged([result.signal.times for result in results.values()])
    columns = [_cells(result.signal, times) for result in results.values()]
    rows = zip(map(stamp_text, times), *columns, strict=True)
    lines = [",".join(["time", *results]), *(",".join(row) for row in rows)]
    write_output(path, "".join(f"{line}\n" for line in lines))


def _cells(signal: Signal, times: np.ndarray[Any, Any]) -> Iterator[str]:
    values = iter(signal.values.tolist())
    return (repr(next(values)) if here else "" for here in np.isin(times, signal.times).tolist())
