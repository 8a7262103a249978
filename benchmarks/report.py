"""Write RESULTS.md from the measurements of ``make bench``."""

from __future__ import annotations

import datetime as dt
import os
import platform
from statistics import median
from typing import TYPE_CHECKING, Any

import numpy as np
import plots
import summary
from cases import LONGEST, PATIENCE

if TYPE_CHECKING:
    from pathlib import Path

    from cases import Case

    from run import Tool


def write(
    folder: Path,
    running: list[Tool],
    absent: list[tuple[str, str]],
    many: dict[str, Any],
    machine: list[dict[str, Any]],
    facts: dict[str, Any],
) -> None:
    """Write the report into a folder, and the plots into its ``plots``."""
    folder.mkdir(exist_ok=True)
    drawn = plots.draw(folder / "plots", running)
    parts = [
        head(facts),
        summary.write(ratios(running), ready(running), machine),
        how(running, absent),
        *(table(group, running, drawn) for group in groups(running)),
        start_up(running),
        at_once(many),
        known(many),
        against_the_machine(machine),
    ]
    (folder / "RESULTS.md").write_text("\n\n".join(parts) + "\n", encoding="utf-8")


def head(facts: dict[str, Any]) -> str:
    """Return the date and the machine of the measurement."""
    before, after = facts["load"]
    return f"""# How fast

Made by `make bench` on {dt.datetime.now(dt.timezone.utc):%Y-%m-%d} in {facts["seconds"]:.0f} s:
{cpu()}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}, numpy {np.__version__}.
Load average before {before:.1f} and after {after:.1f}: where it is above 1 at the start, others used the
machine too. Figures are medians of {facts["rounds"]} interleaved round{"s" if facts["rounds"] > 1 else ""}."""


def how(running: list[Tool], absent: list[tuple[str, str]]) -> str:
    """Return the description of the method, and the missing tools."""
    tools = "\n".join(f"- {tool.version}" for tool in running if "(" not in tool.label)
    missing = "\n".join(f"- {name}: {reason}" for name, reason in absent)
    return f"""## How this was measured

Every tool runs in a separate process and a separate environment. Figures are processor times of that
process, and wall-clock times only at start-up and for threads. The cache is shared with other processes, so
ratios are more meaningful than times. The number in brackets is a tool's time divided by ours, the median of the
ratios of all rounds. Formulas are parsed and samples are converted to the input format of the tool (lists, dicts;
for ours, offline, numpy arrays) before the measurement. "Parsing" is the time of the tool's own parser, from a text
in its language to an object that is ready to run. The bytecode of all imports is written before a tool starts. `this`
online is `monitor.update(t, a=x)`, `this (step)` the positional `monitor.step(x)` for hot loops. Online,
measurements begin when the windows are full. Every answer is the complete robustness signal.

{tools}

Not measured:

{missing}
- what a cell calls too long: an evaluation beyond {LONGEST:g} s, or a window not full after {PATIENCE:g} s"""


def cpu() -> str:
    """Return the processor's name."""
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def groups(running: list[Tool]) -> list[str]:
    """Return the names of the groups of cases, in order."""
    return list(dict.fromkeys(case.group for case in cases_of(running)))


def cases_of(running: list[Tool]) -> list[Case]:
    """Return every case that some tool ran, in order."""
    return list(dict.fromkeys(case for tool in running for case in (*tool.figures, *tool.refusals)))


def ratios(running: list[Tool]) -> dict[tuple[Case, str], float]:
    """Return of every case and other tool how many times as long as ours it takes."""
    ours = running[0].figures
    return {
        (case, tool.label): median(t / o for t, o in zip(figures, ours[case], strict=False))
        for tool in running[1:]
        for case, figures in tool.figures.items()
        if ours.get(case)
    }


def table(group: str, running: list[Tool], drawn: list[str]) -> str:
    """Return the table of one group, below its plot if it has one."""
    rows = [case for case in cases_of(running) if case.group == group]
    shown = [tool for tool in running if any(case in tool.figures for case in rows)]
    refused = {
        f"{tool.label}: {reason}"
        for tool in running
        for case in rows
        if (reason := tool.refusals.get(case)) and reason.startswith(("error", "crash"))
    }
    of = ratios(running)
    what = "seconds" if group == "parsing" else "a sample" if rows[0].mode == "offline" else "an update"
    lines = [f"## {group[0].upper()}{group[1:]}, {what}", ""]
    plot = next((name for name in drawn if name == plots.file_of(group)), None)
    if plot:
        lines += [f"![{group}](plots/{plot})", ""]
    lines.append("| | | " + " | ".join(tool.label for tool in shown) + " |")
    lines.append("|---|---:|" + "---:|" * len(shown))
    for case in rows:
        cells = []
        for tool in shown:
            if case in tool.figures:
                ratio = of.get((case, tool.label))
                cells.append(
                    amount(median(tool.figures[case])) + ("" if ratio is None else f" ({ratio:.3g}×)")
                )
            else:
                reason = tool.refusals.get(case, "")
                cells.append("too long" if "longer" in reason or "not full" in reason else "")
        curve = (
            case.curve if "paper" not in group or "φ" not in case.curve else f"{case.curve} `{case.formula}`"
        )
        lines.append(f"| {curve} | {case.x:,} | " + " | ".join(cells) + " |")
    if refused:
        lines += ["", *(f"- {line}" for line in sorted(refused))]
    return "\n".join(lines)


def amount(seconds: float) -> str:
    """Return a time with three digits, in a suitable unit."""
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def ready(running: list[Tool]) -> dict[str, float]:
    """Return of every other tool how many times as long as ours it takes to start."""
    ours = median(running[0].start_up)
    return {t.label: median(t.start_up) / ours for t in running[1:] if not t.label.startswith("this")}


def start_up(running: list[Tool]) -> str:
    """Return how long each process takes to be ready: Python, the tool, and its adapter."""
    lines = ["## Start-up: Python, the tool imported, its adapter ready", "", "| tool | time |", "|---|---:|"]
    lines += [
        f"| {tool.label} | {amount(median(tool.start_up))} |" for tool in running if "(" not in tool.label
    ]
    return "\n".join(lines)


def at_once(many: dict[str, Any]) -> str:
    """Return the throughput of many formulas and of many traces."""
    lines = [
        "## Many formulas over one trace: `rtamt.evaluate_all`",
        "",
        "Compiling included, on both sides; the last column is the memory that the process has touched so far.",
        "",
        "| formulas | samples | in one program | one by one | ratio | formulas × samples a second | memory |",
        "|---:|---:|---:|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {row['formulas']:,} | {row['samples']:,} | {amount(row['together'])} | {amount(row['apart'])} | "
        f"{row['ratio']:.2f}× | {row['formulas'] * row['samples'] / row['together']:.3g} | {row['peak']:.0f} MiB |"
        for row in many["programs"]
    ]
    lines += [
        "",
        "## One formula over many traces: `rtamt.evaluate_batch`",
        "",
        "The ratio is to one thread. Short traces are checked in Python, one at a time, whatever the threads.",
        "",
        "| traces | samples each | threads | time | ratio | samples a second | memory |",
        "|---:|---:|---:|---:|---:|---:|---:|",
    ]
    lines += [
        f"| {row['traces']:,} | {row['samples']:,} | {row['threads']} | {amount(row['seconds'])} | "
        f"{row['ratio']:.2f}× | "
        f"{row['traces'] * row['samples'] / row['seconds']:.3g} | {row['peak']:.0f} MiB |"
        for row in many["batches"]
    ]
    return "\n".join(lines)


def known(many: dict[str, Any]) -> str:
    """Return what a sample of the Timescales families costs at full length."""
    rows = many["verdicts"]
    lines = [
        f"## Timescales at full length: {rows[0]['samples']:,} samples, every verdict as constructed",
        "",
        "After D. Ulus, RV 2019. Offline, a sample, data checked and copied. Each was evaluated over a trace that",
        "satisfies it and one that is violated from a known sample on; a wrong verdict would have stopped the run.",
        "",
        "| family | unit | past form | future form |",
        "|---|---:|---:|---:|",
    ]
    lines += [f"| {r['family']} | {r['unit']} | {amount(r['past'])} | {amount(r['future'])} |" for r in rows]
    return "\n".join(lines)


def against_the_machine(machine: list[dict[str, Any]]) -> str:
    """Return the engine beside loops written by hand for one formula each."""
    if not machine:
        return "## Against the machine\n\nNot measured: fused_bench is not built (`make bench` builds it)."
    lines = [
        "## Against the machine: the engine beside a fused loop written by hand",
        "",
        "Discrete time, offline, in C++, a sample; aimed at is at most 1.5×. 10,000 samples stay in the cache.",
        "",
        "| formula | samples | engine | by hand | ratio |",
        "|---|---:|---:|---:|---:|",
    ]
    lines += [
        f"| `{row['formula']}` | {row['samples']:,} | {row['engine']:.2f} ns | {row['hand']:.2f} ns | "
        f"{row['ratio']:.2f}× |"
        for row in machine
    ]
    return "\n".join(lines)
