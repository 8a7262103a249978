"""``rtamt falsify``: search for inputs that make a plant violate its requirement."""

from __future__ import annotations

import json
import sys
from typing import TYPE_CHECKING

from rtamt.cli.command import json_number
from rtamt.cli.parameters import add_set_option, assigned
from rtamt.cli.parser import OK, VIOLATED
from rtamt.cli.terminal import Progress, paint, say, use_color
from rtamt.errors import UsageError
from rtamt.lazy.dataclasses import replace
from rtamt.plot.saving import save

if TYPE_CHECKING:
    import argparse

    from rtamt.search.log import Evaluation

_DESCRIPTION = """\
Simulate a plant repeatedly with inputs chosen by an optimizer, until its requirement is
violated or the budget is used up.

Exit code: 0 no violation found, 1 violated, 2 error."""

_EPILOG = """\
The problem is a TOML file:

  specification = "speed.stl"     # or formula = "always[0:30](speed <= 120)"
  plant = "plants:transmission"   # module:function next to the file, or an .fmu
  duration = 30                   # seconds of simulated time
  period = "10ms"
  [inputs]
  throttle = { kind = "piecewise_constant", points = 7, low = 0, high = 100 }
  brake = { low = 0, high = 325 } # or piecewise_linear, step, pulse, sine
  [search]
  optimizer = "cma"               # or differential_evolution, dual_annealing,
  budget = 300                    # optuna, sobol, random
  seed = 1

--record stores every simulation; the same command resumes an interrupted search.

examples:
  rtamt falsify examples/cruise/problem.toml
  rtamt falsify examples/cruise/problem.toml --optimizer sobol --budget 20 --json"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    parser.add_argument("problem", metavar="PROBLEM", help="a TOML file")
    add_set_option(parser)
    parser.add_argument("--optimizer", metavar="NAME", help="the optimizer; replaces that of the file")
    parser.add_argument(
        "--budget", metavar="N", type=int, help="the maximum number of simulations; replaces that of the file"
    )
    parser.add_argument("--seed", metavar="N", type=int, help="the random seed; replaces that of the file")
    parser.add_argument("--workers", metavar="N", type=int, help="the number of parallel simulations")
    parser.add_argument(
        "--record", metavar="FILE", help="store every simulation in this file, and resume from it"
    )
    parser.add_argument(
        "--plot", metavar="FILE", help="plot the robustness over the simulations (png, svg, pdf)"
    )
    parser.add_argument(
        "--json", action="store_true", help="print each simulation as JSON, one object per line"
    )
    parser.add_argument(
        "--color", default="auto", metavar="{auto,always,never}", help="colour (default: auto, on a terminal)"
    )


def run(args: argparse.Namespace) -> int:
    """Search, and print the findings."""
    # Only this command needs them, and the others start faster without.
    from rtamt.search import falsify
    from rtamt.search.config import load_search

    color = use_color(args.color, sys.stdout)
    search = load_search(args.problem)
    (spec,) = assigned([search.problem.spec], args.set)
    settings = dict(search.settings)
    for name in ("optimizer", "budget", "seed", "workers", "record"):
        if getattr(args, name) is not None:
            settings[name] = getattr(args, name)
    least = float("inf")
    with Progress() as progress:

        def show(evaluation: Evaluation) -> None:
            nonlocal least
            least = min(least, evaluation.robustness)
            progress.show(f"simulation {evaluation.number + 1}, least robustness {least:.6g}")
            if args.json:
                progress.clear()
                say(_line(evaluation))

        found = falsify(replace(search.problem, spec=spec), progress=show, **settings)
    if not args.json:
        say(paint(str(found), "bad" if found.falsified else "good", color), color=color)
    if args.plot:
        axes = found.plot()
        try:
            save(axes.figure, args.plot, 120)
        except (OSError, ValueError) as error:
            raise UsageError(f"cannot write the plot '{args.plot}': {error}") from error
    return VIOLATED if found.falsified else OK


def _line(evaluation: Evaluation) -> str:
    return json.dumps({
        "simulation": evaluation.number,
        "robustness": json_number(evaluation.robustness),
        "satisfied": evaluation.satisfied,
        "stopped": evaluation.stopped,
        "point": dict(evaluation.point),
    })  # fmt: skip
