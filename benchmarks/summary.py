"""The head of RESULTS.md: the targets, how many rows meet them, and which do not."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from cases import Case

WHY = """\
Why these: in dense time an update answers with a signal, an object for each update, and mstlo (Rust) pays little
more than the call from Python, as ours does; a recording of 100 samples costs the call and the checks of the data,
10 to 60 µs, of which the core takes 3 to 5; a formula that is parsed in Rust is ready sooner than one parsed in
Python; numpy takes longer to load than we do, and than tools that need none; a fused loop reads each sample once,
the engine once an operator, from the cache."""


@dataclass(frozen=True)
class Row:
    """One comparison: what it is of, where on its curve, and how it ends."""

    of: str
    at: str
    ratio: float
    met: bool


def write(
    ratios: Mapping[tuple[Case, str], float], ready: Mapping[str, float], machine: Sequence[Mapping[str, Any]]
) -> str:
    """Compare every ratio with its target.

    ``ratios``: how many times as long as ours another tool takes. ``ready``: the same at start-up.
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
        "start-up: no peer is faster": [
            Row(f"start-up, {label}", "", ratio, ratio >= 1) for label, ratio in ready.items()
        ],
        "offline: at most 1.5× of a loop by hand, from 10⁴ samples on": [
            Row(f"by hand, `{row['formula']}`", f"{row['samples']:,}", row["ratio"], row["ratio"] <= 1.5)
            for row in machine
        ],
    }
    lines = ["## In short", "", "| aimed at | rows | met | not met | median |", "|---|---:|---:|---:|---:|"]
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


def _curve(case: Case) -> str:
    return case.curve if case.group.startswith("Timescales") else f"`{case.curve}`"


def _short(goal: str, rows: Sequence[Row]) -> list[str]:
    """Return a line for each curve with rows that fall short."""
    curves: dict[str, list[Row]] = defaultdict(list)
    for row in rows:
        if not row.met:
            curves[row.of].append(row)
    lines = [
        f"- {of}: " + ", ".join(f"{row.ratio:.2g}×" + (f" at {row.at}" if row.at else "") for row in short)
        for of, short in curves.items()
    ]
    return ["", f'Not met, of "{goal}":', "", *lines] if lines else []
