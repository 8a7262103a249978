"""``rtamt monitor``: samples on stdin, robustness on stdout as soon as it is known."""

from __future__ import annotations

import sys
from contextlib import nullcontext
from typing import TYPE_CHECKING, Any, TypeAlias

from rtamt.cli.command import (
    METRICS,
    CommandError,
    add_specification_options,
    add_stamp_options,
    add_time_option,
    add_worst_case_option,
    assumes_period,
    options,
    read_specification,
)
from rtamt.cli.delayed_feeds import EventFeed, SampleFeed
from rtamt.cli.early_feeds import CausationFeed, EagerFeed, IntervalFeed, StartFeed
from rtamt.cli.held_feed import HeldFeed
from rtamt.cli.inexact import Inexact, rejected
from rtamt.cli.json_lines import STDIN, line_error
from rtamt.cli.live_view import Live
from rtamt.cli.parser import ERROR, OK, complain
from rtamt.cli.robustness_lines import Output
from rtamt.cli.stdin_reader import Samples, lines_of
from rtamt.cli.stream_members import StreamMembers
from rtamt.cli.terminal import printed
from rtamt.errors import TraceError
from rtamt.metrics import add_metrics_options, exported
from rtamt.rewrite.check import unbounded_future
from rtamt.signals.data_errors import possible_times
from rtamt.signals.sampling import HeldSampler
from rtamt.signals.sampling_period import TOLERANCE
from rtamt.verdicts.early.at_start import StartMonitor
from rtamt.verdicts.early.causation import CausationMonitor
from rtamt.verdicts.early.interval import CORRECTIONS
from rtamt.verdicts.modes import DELAYED, MODES

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from rtamt.metrics import Metrics
    from rtamt.specification import Specification

_DESCRIPTION = """\
Monitor a stream of samples. Each line of input is one sample; each line of output is the robustness
at one instant, printed as soon as the formula's horizon has passed. The remaining lines
follow at the end of the input."""

_EPILOG = """\
input: JSON objects, one per line, or CSV with a header row. Variables that the formula does not read are
ignored. Timestamps are found and read as in files (see 'rtamt check --help'): in time, t, timestamp,
stamp or datetime, with an optional unit ('t [ms]', 'time_ms'), else in the only column of dates. Without
timestamps, samples are one period apart. A stream does not reveal its period in advance: --period sets it
(default: 1 s; timestamps must then be 1 s apart). Fields: {"req": {"value": 3}} or {"req.value": 3}.
Members of groups may come and go: in discrete time, one that is left out, null or an empty cell is absent; in dense
time null or an empty cell ends its presence, and its samples arrive before those of the other variables, or with them.

With --time dense, signals change at any instant, and each has its own time base: a JSON object may contain only
some of the variables, a cell of CSV may be empty, and a line of output is printed for every change and for the
last known instant.

output: {"time": 0.0, "robustness": 3.0}; with several requirements also the robustness of each, by name:
{"time": 0.0, "robustness": 3.0, "requirements": {"R1": 3.0, "R2": 4.5}}. In dense time, a requirement appears
once all variables that it reads have started. The time is in seconds, or a date if the input has dates.
Infinities are the strings "inf" and "-inf", because JSON has none, also in the input. With --semantics boolean,
a line also has the verdict: {"time": 0.0, "robustness": "inf", "satisfied": true}.

--verdict eager prints {"time": 0.0, "satisfied": false, "decided_at": 2.0} as soon as no later sample can
change whether the formula holds, with --explain also "causes": [{"variable": "x", "time": 2.0, "value": -1.0}], a
minimal set of samples that decides it. --verdict interval prints bounds of the robustness whenever they change:
{"time": 0.0, "lower": -1.0, "upper": "inf", "final": false}. An object with "until" applies to all samples up to
that one, in dense time to all instants before it. --verdict causation prints by how much each sample alone
violates and satisfies the formula at the start of the trace: {"time": 0.0, "violation": -1.0, "satisfaction":
"-inf"}, or "inf" and "-inf" if it does not contribute. In dense time, the last line describes the end of the trace,
with "final": true. A formula with unbounded future is monitored at the start of the trace, even without --verdict:
{"time": 12.3, "lower": "-inf", "upper": -1.0, "status": "violated since 12.3 s"}; the other states are "open" and
"can no longer be violated".

With --verdict eager and interval, also without --verdict where the future is unbounded, samples may be inexact: in JSON
{"time": 0, "x": [4.8, 5.0]} was measured with an error, and in discrete time null, in CSV an empty cell, is a missing
sample. In dense time null and an empty cell are no sample, as in files: the variable holds its value. If it is
unknown from then on, give its bounds, such as ["-inf", "inf"]. With --lateness samples may arrive in any order, with
some of the variables; with --on-correction replay, a line of bounds that a correction contradicts has
"retracted": true.

An invalid line ends the monitor with exit code 2. With --keep-going it is reported and skipped, and the exit
code at the end is 2. A skipped sample leaves a gap, which --tolerance inf allows: the next sample then takes its
place.

--live draws on the terminal (stderr): the verdict, the robustness so far (for unbounded future its bounds at
the start, with --verdict interval those at the latest samples), the lowest value and the latest samples with
their units. The output on stdout does not change. It requires the package rich: pip install 'rtamt[cli]'.

examples:
  echo '{"time": 0, "x": 5}' | rtamt monitor "x >= 3"
  rtamt monitor "(req >= 3) -> eventually[0:5](gnt >= 3)" < examples/request_grant/c_violated.csv
  tail -f log.jsonl | rtamt monitor "historically[0:1](speed <= 30)" --period 100ms --keep-going
  tail -f log.jsonl | rtamt monitor "speed <= 30" --live > robustness.jsonl"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser)
    add_time_option(parser)
    add_stamp_options(parser, "key or column")
    parser.add_argument(
        "--tolerance",
        type=float,
        metavar="FRACTION",
        help="the allowed deviation of the gap between samples, as a fraction of the period "
        f"(default: {TOLERANCE} with --period, else 0)",
    )
    parser.add_argument(
        "--verdict",
        choices=tuple(MODES),
        help="; ".join(f"{mode.name}: {mode.doc}" for mode in MODES.values()) + f" (default: {DELAYED})",
    )
    parser.add_argument(
        "--lateness",
        metavar="DURATION",
        help="with --verdict interval, how late a sample may arrive, such as 2s (default: samples are in order)",
    )
    parser.add_argument(
        "--on-correction",
        choices=CORRECTIONS,
        help="with --verdict interval, how a sample that contradicts an earlier one is handled: reject it, or replay "
        f"the trace with it and report retracted bounds (default: {CORRECTIONS[0]})",
    )
    parser.add_argument(
        "--explain",
        action="store_true",
        help="with --verdict eager, print the samples that decided each verdict",
    )
    add_worst_case_option(parser)
    add_metrics_options(options(parser, METRICS))
    parser.add_argument(
        "--live", action="store_true", help="draw verdict, robustness and values on the terminal"
    )
    parser.add_argument("--keep-going", action="store_true", help="report invalid lines and continue")


def run(args: argparse.Namespace) -> int:
    """Read samples until the end of input, print what becomes known."""
    with exported(args) as metrics:
        return _run(args, metrics)


def _run(args: argparse.Namespace, metrics: Metrics | None) -> int:
    if args.tolerance is not None and not args.tolerance >= 0:
        raise CommandError(f"the tolerance is {args.tolerance:g}; give a fraction of the period, such as 0.1")
    spec = read_specification(args, args.time)
    if spec.groups:
        _check_quantified(spec, args)
    late = bool(_lateness(args))
    own_times = spec.domain.own_time_bases
    if own_times and args.tolerance is not None:
        raise CommandError("dense time has no sampling period: leave out --tolerance, or --time dense")
    live = _live(spec) if args.live else None
    output = Output(
        verdicts=spec.semantics == "boolean", live=live, metrics=metrics, name=spec.name or "requirement"
    )
    names = tuple(spec.requirements) if len(spec.requirements) > 1 else ()
    watched: Feed
    early = _early(spec, args, live)
    if early is not None:
        if metrics is not None:
            raise CommandError(
                f"metrics are those of the robustness: leave out --metrics and --otlp, or use --verdict {DELAYED}"
            )
        watched = early
    elif own_times:
        monitor: Any = spec.monitor(watch=names)
        watched = EventFeed(monitor, output, names)
    else:
        watched = _watch(spec, args.tolerance, output, names)
    rule = spec.domain.sampling(spec.sampling)
    held = rule is not None and rule.hold
    if held and late:
        raise CommandError(f"'{rule}' samples the stream in order: leave out --lateness and --on-correction")
    if rule is not None and held:
        sampler = HeldSampler(watched.monitor.input_names, rule, spec.period or rule.period)
        watched = HeldFeed(watched, sampler)
    samples = Samples(
        watched.monitor.input_names,
        args.time_column,
        dense=own_times or held,
        unit=args.time_unit,
        binding=spec.binding,
        types=spec.types,
        skip_nan=held and rule is not None and rule.skip_nan,
        members=StreamMembers(spec.groups) if spec.groups else None,
        inexact=Inexact() if held or spec.groups else _inexact(early, late=late),
    )
    if sys.stdin is None:
        raise CommandError(f"{STDIN} is closed: give one JSON object per line, or CSV with a header row")
    if sys.stdin.isatty():
        complain("reading samples from the terminal, one JSON object per line; Ctrl-D ends")
    with nullcontext() if live is None else live:
        assumed = assumes_period(spec, args.time_column)
        return _follow(
            watched, samples, live, metrics, assumed=assumed, late=late, keep_going=args.keep_going
        )


def _follow(
    watched: Feed,
    samples: Samples,
    live: Live | None,
    metrics: Metrics | None,
    *,
    assumed: bool,
    late: bool,
    keep_going: bool,
) -> int:
    """Feed the monitor from stdin until the end of input; return the exit code.

    ``assumed``: whether nothing determines the period of samples without timestamps, and it matters. ``late``: whether
    the monitor may hold back the first samples until no earlier one can arrive.
    """
    code, noted, taken = OK, False, 0
    for number, line in lines_of(sys.stdin.buffer):
        try:
            sample = samples.read(line, number)
        except TraceError as error:
            problem = str(error)
        else:
            while samples.conversions:
                complain(f"note: {STDIN}: {samples.conversions.pop(0)}")
            if assumed and sample is not None:
                assumed = sample[0] is None
                if assumed and samples.possible_times is not None:
                    raise line_error(number, str(possible_times(samples.possible_times)))
                if assumed and not noted:
                    complain(f"note: {STDIN}: the samples have no timestamps and are taken to be 1 s apart")
                    noted = True
            problem = watched.take(*sample, number) if sample is not None else ""
            taken += sample is not None and not problem
            if live is not None and sample is not None and not problem:
                live.units.update(samples.units)
                live.sample(sample[1], whole=samples.members is not None)
        if metrics is not None and (problem or sample is not None):
            metrics.count("rtamt_rejected_total" if problem else "rtamt_samples_total")
        if problem:
            complain(problem)
            code = ERROR
            if not keep_going:
                return code
    problem = watched.finish() if isinstance(watched, HeldFeed) else ""
    if not (watched.monitor.samples or (late and taken)) and not problem:
        raise CommandError(f"{STDIN} has no samples: give one JSON object per line, or CSV with a header row")
    if problem:
        complain(problem)
        return ERROR
    if not isinstance(watched, HeldFeed):
        watched.finish()
    return code


def _check_quantified(spec: Specification, args: argparse.Namespace) -> None:
    """Raise :class:`CommandError` for options that monitors of quantifiers do not support."""
    rule = spec.domain.sampling(spec.sampling)
    early = args.verdict not in {None, DELAYED}
    unfit = (
        [f"--verdict {args.verdict}"] if early and spec.domain.part(f"members_{args.verdict}") is None else []
    )
    unfit += [f"--{name.replace('_', '-')}" for name in _lateness(args)]
    unfit += [f"'{rule}'"] if rule is not None and rule.hold else []
    for what in unfit:
        raise CommandError(
            f"the formula quantifies over '{next(iter(spec.groups))}', whose members come and go, and 'rtamt monitor' "
            f"does not support {what} for it: leave that out, or check recordings with 'rtamt check'"
        )


def _lateness(args: argparse.Namespace) -> dict[str, Any]:
    """Return the options for samples out of order that were given, as settings of the monitor."""
    given = {"lateness": args.lateness, "on_correction": args.on_correction}
    return {name: setting for name, setting in given.items() if setting is not None}


def _inexact(early: EarlyFeed | None, *, late: bool) -> Inexact:
    """Return how missing samples and bounds are handled."""
    if early is None or isinstance(early, CausationFeed):
        return rejected()
    return Inexact(taken=True, late=late)


def _early(spec: Specification, args: argparse.Namespace, live: Live | None) -> EarlyFeed | None:
    """Return the printer of early results, if they are requested, or if the horizon is infinite."""
    verdict = args.verdict
    if args.explain and verdict != "eager":
        raise CommandError("--explain explains verdicts before the horizon: use it with --verdict eager")
    has_bounds = not spec.groups or spec.domain.part("members_interval") is not None
    unbounded = unbounded_future(spec.formula) is not None
    at_start = verdict in {None, "interval"} and unbounded and has_bounds
    lateness = _lateness(args)
    for name in lateness:
        if args.live:
            raise CommandError(f"--live draws samples in order: leave it out, or --{name.replace('_', '-')}")
        if not at_start and verdict != "interval":
            raise CommandError(
                f"--{name.replace('_', '-')} is for bounds, which late samples change: use --verdict interval, or "
                f"leave it out"
            )
    if not at_start and verdict in {None, DELAYED}:
        return None
    if at_start:
        return StartFeed(StartMonitor(spec, tolerance=args.tolerance, **lateness), live, late=bool(lateness))
    if args.live and verdict != "interval":
        raise CommandError(
            f"--live draws the robustness; leave it out, or use --verdict {DELAYED} or --verdict interval"
        )
    settings: dict[str, Any] = {"explain": True} if args.explain else {}
    settings |= {"worst_case": True} if args.worst_case else {}
    settings |= lateness
    monitor: Any = spec.monitor(verdict=verdict, tolerance=args.tolerance, **settings)
    if isinstance(monitor, CausationMonitor):
        return CausationFeed(monitor)
    if verdict == "interval":
        return IntervalFeed(monitor, live, late=bool(lateness))
    return EagerFeed(monitor, spec.types, explain=args.explain)


def _watch(spec: Specification, tolerance: float | None, output: Output, names: Sequence[str]) -> SampleFeed:
    monitor = spec.monitor(tolerance=TOLERANCE if tolerance is None else tolerance, watch=names)
    return SampleFeed(monitor, output, names, assumed=spec.period is None and tolerance is None)


def _live(spec: Specification) -> Live:
    if not sys.stderr.isatty():
        raise CommandError("--live draws on a terminal, and stderr is none: leave it out")
    return Live(printed(spec.formula), units=spec.units, types=spec.types)


#: What takes the samples, and prints what becomes known.
EarlyFeed: TypeAlias = EagerFeed | IntervalFeed | StartFeed | CausationFeed
Feed: TypeAlias = SampleFeed | EventFeed | EarlyFeed | HeldFeed
