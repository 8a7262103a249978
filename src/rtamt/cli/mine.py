"""``rtamt mine``: the hardest values of parameters that recordings satisfy."""

from __future__ import annotations

import sys
from shlex import quote
from typing import TYPE_CHECKING

from rtamt.cli.arguments import specification_and_traces
from rtamt.cli.command import (
    CommandError,
    add_budget_options,
    json_text,
    options,
)
from rtamt.cli.parser import OK, VIOLATED
from rtamt.cli.reading_options import add_input_options
from rtamt.cli.recordings import recordings_of, save_plot
from rtamt.cli.terminal import Progress, say, table, width_of

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from rtamt.mining import Mined

_DESCRIPTION = """\
Find the parameters of a requirement from recordings: the hardest values with which every recording satisfies it. The
formula decides whether larger or smaller values are harder. One parameter is found by bisection; of two, the Pareto
front, on which neither can be harder without a violation; of more, or with --order, the first parameter is as hard as
possible, then the second one, and so on. Every value is confirmed: the recordings satisfy the requirement with it, and
one of them violates it with the next harder value.

Exit code: 0 all values are tight, 1 some are not proven tight, 2 error."""

_EPILOG = """\
SPEC and TRACE are the same as for 'rtamt check', and traces are read in the same way; SPEC is one specification with
'parameter' declarations. Values are multiples of the resolution: by default five significant digits, and the sampling
period for a bound of an interval. Where the direction of a parameter does not follow from the formula, it needs a
range, and its value is the one with the least robustness of those that were tried: not proven tight.

--json prints one object: {"tight", "finished", "undecided", "evaluations", "parameters": [{"name", "kind", "easier",
"easiest", "hardest", "resolution"}], "points": [{"values", "tight", "harder", "violated_by"}], "recordings": [{"name",
"alone"}]}.

examples:
  rtamt mine 'parameter float level = 3  always(gnt <= level)' examples/request_grant/*.csv
  rtamt mine template.stl logs/*.csv --param limit --param within -o front.png
  rtamt mine template.stl logs/*.csv --range limit=0:60 --resolution limit=0.5"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_input_options(parser, "recordings, as for 'rtamt check'")
    group = options(parser, "what is mined")
    group.add_argument(
        "--param",
        metavar="NAME",
        action="append",
        help="a parameter to mine, by default all in the formula; repeatable, in order of priority",
    )
    group.add_argument(
        "--range",
        metavar="NAME=LOW:HIGH",
        action="append",
        default=[],
        help="where a value is looked for; repeatable",
    )
    group.add_argument(
        "--resolution",
        metavar="NAME=STEP",
        action="append",
        default=[],
        help="the step of a value; repeatable",
    )
    group.add_argument("--order", action="store_true", help="one point instead of a front: by priority")
    group.add_argument(
        "--points",
        metavar="N",
        type=int,
        default=25,
        help="how many points of a front are enough (default: 25)",
    )
    group.add_argument(
        "--optimizer",
        metavar="NAME",
        help="of 'rtamt falsify', for parameters without a known direction (default: a grid that is refined)",
    )
    group.add_argument(
        "--seed", metavar="N", type=int, default=0, help="the seed of an optimizer (default: 0)"
    )
    add_budget_options(group)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("-o", "--output", metavar="FILE", help="plot the values (png, svg, pdf)")


def run(args: argparse.Namespace) -> int:
    """Read the recordings, mine the parameters, print them."""
    from rtamt.mining import mine

    spec, traces = specification_and_traces(args, "mine")
    with Progress() as progress:
        found = mine(
            spec,
            recordings_of(args, spec, traces, progress),
            parameters=args.param,
            ranges={name: _range(text) for name, text in _pairs(args.range, "--range", "limit=0:60")},
            resolutions={
                name: _number(text, "--resolution", f"{name}=0.5")
                for name, text in _pairs(args.resolution, "--resolution", "limit=0.5")
            },
            order=args.order,
            points=args.points,
            optimizer=args.optimizer,
            seed=args.seed,
            evaluations=args.evaluations,
            timeout=args.timeout,
            progress=lambda made: progress.show(f"{made} evaluations") if made % 50 == 0 else None,
        )
    if args.json:
        say(json_text(found.to_dict()))
    else:
        _print(found, args.set)
    if args.output is not None:
        save_plot(found.plot(), args.output)
    return OK if found.tight else VIOLATED


def _pairs(texts: Sequence[str], option: str, example: str) -> list[tuple[str, str]]:
    found = []
    for text in texts:
        name, equals, value = text.partition("=")
        if not (name.strip() and equals and value.strip()):
            raise CommandError(f"{option} is '{text}'; give a parameter and what it is, such as {example}")
        found.append((name.strip(), value.strip()))
    return found


def _range(text: str) -> tuple[float, float]:
    low, _, high = text.partition(":")
    return _number(low, "--range", "limit=0:60"), _number(high, "--range", "limit=0:60")


def _number(text: str, option: str, example: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise CommandError(
            f"{option} has '{text}' where a number is expected; write {option} {example}"
        ) from None


def _print(found: Mined, given: Sequence[str]) -> None:
    """Print what was found; ``given``: values of parameters, of which those that were not mined are needed, too."""
    from rtamt.mining.region import number

    named = {1: "larger values are easier", -1: "smaller values are easier", None: "no known direction"}
    count = len(found.recordings)
    say(f"{count} recording{'' if count == 1 else 's'}, {found.evaluations} evaluations")
    say()
    names = [role.name for role in found.roles]
    if len(found.points) == 1:
        (point,) = found.points
        rows = [("parameter", "value", "next harder", "violated by", "direction")]
        for role in found.roles:
            name = role.name
            beyond = number(point.harder[name]) if name in point.harder else "-"
            by = point.violated_by.get(name) or _why(found, name)
            rows.append((name, number(point.values[name]), beyond, by, named[role.direction]))
        say(table(rows, right=[1, 2], width=width_of(sys.stdout)))
        say()
        others = [text for text in given if text.partition("=")[0].strip() not in point.values]
        sets = [*(f"{name}={number(value)}" for name, value in point.values.items()), *map(quote, others)]
        say(f"rtamt check: {' '.join(f'--set {each}' for each in sets)}")
        if len(found.alone) > 1:
            say()
            each = sorted(found.alone.items(), key=lambda pair: pair[1])
            say(
                table(
                    [("recording", f"{names[0]} alone"), *((name, number(v)) for name, v in each)], right=[1]
                )
            )
    else:
        say(f"Pareto front: {len(found.points)} points")
        say()
        lines = [(*names, "violated next by")]
        for point in found.points:
            by = ", ".join(dict.fromkeys(point.violated_by.values())) or "-"
            lines.append((*(number(point.values[name]) for name in names), by))
        say(table(lines, right=[0, 1], width=width_of(sys.stdout)))
    if not found.finished:
        say()
        say("the budget was spent: the values satisfy the requirement, and are not proven tight")
    elif found.undecided:
        say()
        say(
            f"{found.undecided:.2%} of the area between the ends may have further points; --points has more of them"
        )


def _why(found: Mined, name: str) -> str:
    (point,) = found.points
    if name in point.hardest:
        return "there is no harder value"
    if found.tried:
        return "not proven tight"
    return "end of the range" if found.finished else "budget spent"
