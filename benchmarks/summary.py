"""The summary of RESULTS.md: the targets, and the rows that meet or miss them."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Any

import start_up
from start_up import TO_IMPORT, TO_VERDICT

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from cases import Case
    from start_up import Measure, Start

WHY = """\
Reasons: in dense time every update returns a signal, which is an object, and both mstlo (Rust) and rtamt cost little
more than the call from Python. The time for a recording of 100 samples, 2 to 3 µs, is mostly that of the call, the
checks of the data and the objects of the result. Parsing in Rust is faster than in Python. Up to the first verdict
Python loads about a hundred modules of rtamt and the regular expressions and fractions of the standard library, and of
mstlo, Reelay and STLRom little more than a shared library."""


@dataclass(frozen=True)
class Row:
    """One comparison: its subject, its position on the curve, the ratio, and whether the target is met."""

    of: str
    at: str
    ratio: float
    met: bool


def write(
    ratios: Mapping[tuple[Case, str], float],
    starts: Mapping[str, Start],
    machine: Sequence[Mapping[str, Any]],
) -> str:
    """Compare every ratio with its target.

    ``ratios``: how many times as long as ours another tool takes. ``starts``: the start-up of each.
    ``machine``: how many times as long as a loop written by hand the engine takes.
    """
    goals = {
        "online, an update: a peer takes at least 5×": _cases(ratios, "online", 5.0),
        "offline, a sample: a peer takes at least 20×": _cases(ratios, "offline", 20.0),
        "both: no peer is faster": _cases(ratios, "online", 1.0) + _cases(ratios, "offline", 1.0),
        "parsing: no peer is faster": [
            Row(f"parsing, {case.time} time, {case.mode}, {label}", "", ratio, ratio >= 1)
            for (case, label), ratio in _peers(ratios)
            if case.group == "parsing"
        ],
        "start-up, import: no peer is faster": _starts("import", starts, TO_IMPORT),
        "start-up, first verdict, parsing included: no peer is faster": _starts(
            "first verdict", starts, TO_VERDICT
        ),
        "offline: at most 1.5× the time of a hand-written loop, from 10⁴ samples on": [
            Row(f"by hand, `{row['formula']}`", f"{row['samples']:,}", row["ratio"], row["ratio"] <= 1.5)
            for row in machine
        ],
    }
    lines = ["## Summary", "", "| target | rows | met | missed | median |", "|---|---:|---:|---:|---:|"]
    for goal, rows in goals.items():
        if not rows:
            continue
        met = sum(row.met for row in rows)
        middle = median(row.ratio for row in rows)
        lines.append(f"| {goal} | {len(rows)} | {met} | {len(rows) - met} | {middle:.3g}× |")
    for goal, rows in goals.items():
        lines += _short(goal, rows)
    if any(not row.met for rows in goals.values() for row in rows):
        lines += ["", WHY]
    return "\n".join(lines)


def _peers(ratios: Mapping[tuple[Case, str], float]) -> list[tuple[tuple[Case, str], float]]:
    return [(key, ratio) for key, ratio in ratios.items() if not key[1].startswith("this")]


def _cases(ratios: Mapping[tuple[Case, str], float], mode: str, least: float) -> list[Row]:
    return [
        Row(f"{case.mode}, {case.time} time, {_curve(case)}, {label}", f"{case.x:,}", ratio, ratio >= least)
        for (case, label), ratio in _peers(ratios)
        if case.mode == mode and case.group != "parsing"
    ]


def _starts(name: str, starts: Mapping[str, Start], measure: Measure) -> list[Row]:
    return [
        Row(f"{name}, {label}", "", ratio, ratio >= 1)
        for label, ratio in start_up.ratios(starts, measure).items()
    ]


def _curve(case: Case) -> str:
    return case.curve if case.group.startswith("Timescales") else f"`{case.curve}`"


def _short(goal: str, rows: Sequence[Row]) -> list[str]:
    """Return a line for each curve with rows that miss the target."""
    curves: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        if not row.met:
            curves[row.of].append(row)
    lines = [
        f"- {of}: " + ", ".join(f"{row.ratio:.2g}×" + (f" at {row.at}" if row.at else "") for row in short)
        for of, short in curves.items()
    ]
    return ["", f'Missed targets, "{goal}":', "", *lines] if lines else []
