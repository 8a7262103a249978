"""``rtamt mutate``: is a requirement tight? Change it a little, and see whether the recordings notice."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from rtamt.cli.arguments import specification_and_traces
from rtamt.cli.command import json_text
from rtamt.cli.parser import OK, VIOLATED
from rtamt.cli.reading_options import add_input_options
from rtamt.cli.recordings import recordings_of, save_plot
from rtamt.cli.terminal import Progress, say, table, width_of

if TYPE_CHECKING:
    import argparse

    from rtamt.mutation import Mutation

_DESCRIPTION = """\
Change a requirement in one place at a time: another operator, a constant that is a tenth larger or smaller, a bound
that is. Evaluate each of these mutants on recordings. A recording kills a mutant if the verdicts of the mutant and
of its requirement differ on it. A mutant that survives shows what no recording tests: a limit that may be too loose,
or a case that was never recorded.

Exit code: 0 all mutants are killed, 1 some survive, 2 error."""

_EPILOG = """\
SPEC and TRACE are the same as for 'rtamt check', and traces are read in the same way; SPEC is one specification.
Mutants that are trivially equal to their requirement are left out. The table lists those that survive, with --all
every mutant and what kills it. "alone" counts the mutants that no other recording kills.

--json prints one object: {"score", "mutants": [{"name", "requirement", "kind", "change", "line", "column",
"killed_by"}], "recordings": [{"name", "kills", "alone"}]}.

examples:
  rtamt mutate examples/request_grant/spec.stl examples/request_grant/*.csv
  rtamt mutate requirement.stl logs/*.csv --all
  rtamt mutate requirement.stl logs/*.csv -o matrix.png"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_input_options(parser, "recordings, as for 'rtamt check'")
    parser.add_argument("--all", action="store_true", help="list every mutant, not only those that survive")
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument(
        "-o", "--output", metavar="FILE", help="plot which recording kills which mutant (png, svg, pdf)"
    )


def run(args: argparse.Namespace) -> int:
    """Read the recordings, evaluate the mutants, print what survives."""
    from rtamt.mutation import mutate

    spec, traces = specification_and_traces(args, "mutate")
    with Progress() as progress:
        recordings = recordings_of(args, spec, traces, progress)
        progress.show("evaluating")
        found = mutate(spec, recordings)
    if args.json:
        say(json_text(found.to_dict()))
    else:
        _print(found, every=args.all)
    if args.output is not None:
        save_plot(found.plot(), args.output)
    return VIOLATED if found.survivors else OK


def _print(found: Mutation, *, every: bool) -> None:
    survivors, width = found.survivors, width_of(sys.stdout)
    dead = len(found.mutants) - len(survivors)
    count = len(found.recordings)
    recordings = f"{count} recording{'' if count == 1 else 's'}"
    say(f"{dead} of {len(found.mutants)} mutants killed by {recordings}: score {found.score:.0%}")
    rows: list[tuple[str, ...]] = [("mutant", "requirement", "line", "change", "killed by")]
    for mutant in found.mutants if every else survivors:
        killers = found.killers(mutant)
        by = "survives" if not killers else killers[0] if len(killers) == 1 else f"{len(killers)} recordings"
        line = "" if mutant.line is None else f"{mutant.line}:{mutant.column}"
        rows.append((mutant.name, mutant.requirement, line, mutant.change, by))
    if len(found.specification.requirements) == 1:
        rows = [(name, *rest) for name, _, *rest in rows]
    if len(rows) > 1:
        say()
        say(table(rows, width=width))
    say()
    kills = found.to_dict()["recordings"]
    lines = [(each["name"], str(each["kills"]), str(each["alone"])) for each in kills]
    say(table([("recording", "kills", "alone"), *lines], right=[1, 2], width=width))
