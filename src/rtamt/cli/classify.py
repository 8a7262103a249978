"""``rtamt classify``: a short list of rules that separates good recordings from bad ones."""

from __future__ import annotations

import os
import sys
from typing import TYPE_CHECKING

from rtamt.cli.command import (
    CommandError,
    add_budget_options,
    add_specification_options,
    is_trace,
    json_text,
    options,
    read_specifications,
    write_output,
)
from rtamt.cli.parser import OK, VIOLATED
from rtamt.cli.reading_options import add_reading_options, recording
from rtamt.cli.recordings import save_figure
from rtamt.cli.terminal import Progress, say, table, width_of
from rtamt.readers.sql import shown

if TYPE_CHECKING:
    import argparse
    from collections.abc import Sequence

    from rtamt.mining import Classifier
    from rtamt.signals.trace import Trace

_DESCRIPTION = """\
Learn a short list of rules that separates good recordings from bad ones:
"if always(speed <= 42.1) then good, else bad".
Each rule is a template over a signal, or a pair of signals, with a threshold. The accuracy is that of cross-validation,
on recordings from which the rules were not learned, together with that of always choosing the majority class.

Exit code: 0 rules were learned, 1 no rule is better than the class of most recordings, 2 error."""

_EPILOG = """\
A folder means all recordings in it. The templates are bounds that hold always, at some time, from some time on,
within each window or throughout some window, and bounds of changes and of differences of two signals; windows last a
tenth and a quarter of the shortest recording. A signal may be infinite; templates without a value on some recording,
such as the change of an infinite signal, are left out. SPEC has other templates instead: requirements with one
parameter each, a threshold. --rules-file writes the rules as a specification that is satisfied where a recording is
good.

--json prints one object: {"rules": [{"formula", "class", "covered"}], "default", "accuracy", "baseline", "training",
"folds", "seed", "templates", "undefined", "recordings": [{"name", "class", "predicted"}], "specification"}.

examples:
  rtamt classify --good logs/good/*.csv --bad logs/bad/*.csv
  rtamt classify --good good/*.csv --bad bad/*.csv --rules 2 --rules-file rules.stl
  rtamt classify templates.stl --good good/*.csv --bad bad/*.csv -o rules.png"""


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.description = _DESCRIPTION
    parser.epilog = _EPILOG
    add_specification_options(parser, nargs="?")
    parser.add_argument(
        "--good",
        metavar="TRACE",
        nargs="+",
        required=True,
        help="good recordings: files, and folders of them",
    )
    parser.add_argument(
        "--bad", metavar="TRACE", nargs="+", required=True, help="bad recordings: files, and folders of them"
    )
    add_reading_options(parser)
    group = options(parser, "what is learned")
    group.add_argument(
        "--signal",
        metavar="NAME",
        action="append",
        help="a signal of the templates, by default all that every recording has; repeatable",
    )
    group.add_argument("--rules", metavar="N", type=int, default=3, help="at most so many rules (default: 3)")
    group.add_argument(
        "--folds", metavar="N", type=int, default=5, help="the parts of the cross-validation (default: 5)"
    )
    group.add_argument("--seed", metavar="N", type=int, default=0, help="the seed of the parts (default: 0)")
    add_budget_options(group)
    parser.add_argument("--json", action="store_true", help="print JSON")
    parser.add_argument("--rules-file", metavar="FILE", help="write the rules as a specification")
    parser.add_argument("-o", "--output", metavar="FILE", help="plot the recordings by rule (png, svg, pdf)")


def run(args: argparse.Namespace) -> int:
    """Read the recordings, learn the rules, print them."""
    from rtamt.mining import classify

    if args.sql is not None:
        raise CommandError("'rtamt classify' reads many recordings, and --sql is one; give files")
    templates = None if args.spec is None else read_specifications(args, "discrete", [args.spec])
    if templates is not None and args.signal:
        raise CommandError(
            f"'{args.spec}' has the templates; leave out --signal, which chooses those of others"
        )
    good, bad = _files(args.good, "--good"), _files(args.bad, "--bad")
    both = next((name for name in good if name in bad), None)
    if both is not None:
        raise CommandError(f"'{both}' is given as good and as bad; leave it out once")
    with Progress() as progress:
        read = _read(args, good + bad, progress)
        found = classify(
            {name: read[name] for name in map(shown, good)},
            {name: read[name] for name in map(shown, bad)},
            signals=args.signal,
            templates=templates,
            rules=args.rules,
            folds=args.folds,
            seed=args.seed,
            evaluations=args.evaluations,
            timeout=args.timeout,
            progress=lambda made: progress.show(f"{made} evaluations") if made % 50 == 0 else None,
            period=args.period,
        )
    if args.json:
        say(json_text(found.to_dict()))
    else:
        _print(found)
    if args.output is not None:
        save_figure(found.plot(), args.output)
    if args.rules_file is not None:
        write_output(args.rules_file, found.text)
    return OK if found.rules else VIOLATED


def _files(given: Sequence[str], option: str) -> list[str]:
    """Return the recordings in files and folders."""
    found: list[str] = []
    for path in given:
        if os.path.isdir(path) and not is_trace(path):
            inside = [os.path.join(path, name) for name in sorted(os.listdir(path))]
            traces = [name for name in inside if is_trace(name)]
            if not traces:
                raise CommandError(f"{option}: there is no recording in the folder '{path}'")
            found += traces
        else:
            found.append(path)
    twice = next((name for place, name in enumerate(found) if name in found[:place]), None)
    if twice is not None:
        raise CommandError(f"'{twice}' is given twice; leave it out once")
    return found


def _read(args: argparse.Namespace, files: Sequence[str], progress: Progress) -> dict[str, Trace]:
    found = {}
    for number, file in enumerate(files):
        progress.bar(number, len(files), file)
        found[shown(file)] = recording(args, file)
    return found


def _print(found: Classifier) -> None:
    good = sum(found.recordings.values())
    without = f" ({found.undefined} left out: without a value on some recording)" if found.undefined else ""
    say(
        f"{good} good and {len(found.recordings) - good} bad recordings, {found.templates} templates{without}"
    )
    say()
    if found.rules:
        say(str(found))
    else:
        say("no rule is better than the class of most recordings")
    say()
    rows = [
        ("", "accuracy"),
        (f"cross-validated, {found.folds} folds, seed {found.seed}", f"{found.accuracy:.1%}"),
        ("class of most recordings", f"{found.baseline:.1%}"),
        ("on the recordings it was learned from", f"{found.training:.1%}"),
    ]
    say(table(rows, right=[1]))
    wrong = [(n, "good" if g else "bad") for n, g in found.recordings.items() if found.predicted[n] != g]
    if found.rules and wrong:
        say()
        say(table([("wrong", "is"), *wrong], width=width_of(sys.stdout)))
    if found.rules:
        say()
        say(found.text.rstrip())
