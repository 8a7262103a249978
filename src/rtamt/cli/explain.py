"""``rtamt explain``: which instants of which signals are responsible for the verdict on a recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rtamt.cli.arguments import results_of_one
from rtamt.cli.command import CommandError, json_text
from rtamt.cli.outcome import plain_time
from rtamt.cli.parser import OK, VIOLATED
from rtamt.cli.reading_options import add_input_options, add_instant_option, instant
from rtamt.cli.terminal import Progress, say
from rtamt.errors import StlError
from rtamt.explain.explanation import SHORT, as_data

if TYPE_CHECKING:
    import argparse

    from rtamt.cli.arguments import Evaluated
    from rtamt.explain.explanation import Explanation

_DESCRIPTION = """\
Explain why a trace satisfies or violates a requirement: the first violation, the critical point (the predicate
and the time whose value is, up to sign, the robustness), and a sufficient cause (intervals of predicates
that force the verdict, independent of all other samples).

Exit code: 0 satisfied, 1 violated, 2 error."""

_EPILOG = """\
SPEC and TRACE are the same as for 'rtamt check', and traces are read in the same way. The number after a predicate
is its robustness. Of a cause with many intervals, those closest to the critical point are printed; --all prints all.

--json prints one object: {"trace", "formula", "time", "satisfied", "robustness", "first_violation", "critical",
"implicant"}. If SPEC has several requirements, it prints one object per line, with "requirement" as the first
key. "end" is null for an interval of the implicant that never ends; "closed" states whether an interval
contains its end. "reads" lists the samples of signals that a predicate depends on. "notes" lists what was assumed,
left out or lost of the recording, if anything.
Times are seconds, or dates if the trace has dates. Infinities are the strings "inf" and "-inf", because JSON has none.

examples:
  rtamt explain examples/request_grant/spec.stl examples/request_grant/c_violated.csv
  rtamt explain "always((req >= 3) -> eventually[0:5](gnt >= 3))" log.csv --at 2500ms --time dense
  rtamt explain requirement.stl log.csv --json"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_input_options(parser, "one recording")
    add_instant_option(parser)
    parser.add_argument("--all", action="store_true", help="print every interval of the cause")
    parser.add_argument("--json", action="store_true", help="print JSON")


def run(args: argparse.Namespace) -> int:
    """Evaluate the trace and explain the results."""
    with Progress() as progress:
        progress.show("evaluating")
        evaluated = results_of_one(args, "explain")
        try:
            explanations = {
                name: part.explain(instant(args.at, part)) for name, part in evaluated.results.items()
            }
        except StlError as error:
            raise CommandError(f"{evaluated.trace}: {error}") from error
    alone = len(explanations) == 1
    if args.json:
        for name, explanation in explanations.items():
            say(_as_json({} if alone else {"requirement": name}, evaluated, explanation))
    else:
        texts = {
            name: explanation.text(None if args.all else SHORT) for name, explanation in explanations.items()
        }
        whole = "\n\n".join(text if alone else f"{name}: {text}" for name, text in texts.items())
        say(f"{whole}\n{evaluated.listed_notes}" if evaluated.notes else whole)
    return OK if all(explanation.satisfied for explanation in explanations.values()) else VIOLATED


def _as_json(of: dict[str, str], evaluated: Evaluated, explanation: Explanation) -> str:
    notes = {"notes": evaluated.notes} if evaluated.notes else {}
    return json_text({**of, "trace": evaluated.trace, **as_data(explanation, plain_time), **notes})
