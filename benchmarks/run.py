"""``make bench``: measure all tools, and write RESULTS.md and plots.

    python benchmarks/run.py [--quick] [--out FOLDER]

Each tool runs in a process of its own, in its own environment (``make peers``). Rounds are interleaved:
every tool is asked one case before anybody is asked the next, and all cases before the next round, so
that a drift of the machine's speed touches all alike. What is quoted are medians, and medians of ratios.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import time
from collections import defaultdict
from pathlib import Path
from statistics import median
from typing import Any

from cases import LIMIT, LONGEST, Case, cases  # first: it says where the modules below are

from asking import Talk, tree  # isort: skip
from peers import HERE, PEERS  # isort: skip

import own_wheel
import start_up
from start_up import ENV, compiled

from rtamt.language.parsing.parser import parse_formula

ROUNDS = 5
PATIENCE = 10.0  # seconds for an answer
SLOWEST = 1.0  # the limit of one update in seconds, extrapolated from the previous case
FOLDER = Path(__file__).parent
FUSED = FOLDER.parent / "build" / "bench" / "benchmarks" / "fused_bench"


class Tool:
    """One tool: the process that is asked, and what came of each case, round by round."""

    def __init__(self, label: str, command: list[str], env: dict[str, str] | None = None) -> None:
        compiled(command[0])
        settings = [f"{name}={value}" for name, value in (env or {}).items()]
        self.python = command[0]
        self.talk = Talk([*ENV, *settings, *command], PATIENCE)
        self.label = label
        self.version = self.talk.peer
        self.figures: dict[Case, list[float]] = defaultdict(list)
        self.refusals: dict[Case, str] = {}

    def ask(self, case: Case, before: Case | None, limit: float) -> None:
        """Time a case, unless it was refused or, by the smaller one before it, would take too long."""
        if case in self.refusals or (case.tools and self.label not in (*case.tools, "this (step)")):
            return
        if self.label == "this (python)" and not case.tools:
            return
        if self.label == "this (step)" and (case.mode, case.time) != ("online", "discrete"):
            return
        if before is not None and self._too_long(case, before):
            return
        workload = {**case.workload, "limit": limit}
        if self.label == "RTAMT" and case.time == "discrete" and "warm" in workload:
            workload["warm"] = 0  # its windows are full, of infinities, from the start
        answer = self.talk.ask(
            {
                "formula": tree(parse_formula(case.formula)),
                "time": case.time,
                "mode": case.mode,
                "workload": workload,
            }
        )
        if "seconds" in answer:
            self.figures[case].append(answer["seconds"])
        else:
            ((kind, reason),) = answer.items()
            self.refusals[case] = reason if kind == "unsupported" else f"{kind}: {reason}"

    def _too_long(self, case: Case, before: Case) -> bool:
        if before in self.refusals:
            self.refusals[case] = self.refusals[before]
        elif before in self.figures:
            one = median(self.figures[before])
            if case.mode == "offline" and "n" in case.workload:
                sizes = case.workload["n"], before.workload["n"]
                # If a tool's cost per sample has grown, it is assumed to keep growing.
                growth = self._growth(before)
                if one * growth * sizes[0] > LONGEST:
                    self.refusals[case] = f"longer than {LONGEST:g} s"
            elif one * case.x / before.x > SLOWEST:
                self.refusals[case] = f"longer than {SLOWEST:g} s an update"
        return case in self.refusals

    def _growth(self, case: Case) -> float:
        smaller = [c for c in self.figures if c.key == case.key and c.x < case.x]
        if not smaller:
            return 1.0
        last = max(smaller, key=lambda c: c.x)
        # For small traces the cost of the call dominates, so they predict nothing.
        return max(1.0, median(self.figures[case]) / median(self.figures[last])) if last.x >= 1000 else 1.0


def tools(alone: bool, quick: bool) -> tuple[list[Tool], list[tuple[str, str]]]:
    """Start every tool; return those that run, and of the others why they do not.

    Ours is the wheel; to try everything quickly, what runs this.
    """
    this = [sys.executable if quick else own_wheel.python(), str(HERE / "ask_this.py")]
    running = [Tool("this", this), Tool("this (python)", this, {"RTAMT_BENCH_BACKEND": "python"})]
    running.insert(1, Tool("this (step)", this, {"RTAMT_BENCH_STEP": "1"}))
    absent = [("RTAMT's C++ back end", "in no wheel or source package on PyPI")]
    for peer in () if alone else PEERS:
        if not peer.installed:
            absent.append((peer.name, peer.why_not()))
            continue
        running.append(Tool(peer.label, peer.command()))
    return running, absent


def measure(running: list[Tool], quick: bool) -> int:
    """Ask every tool every case, round after round; return how many rounds there were."""
    asked = cases(quick)
    for tool in running:  # what is loaded at first use
        tool.ask(asked[-1], None, 0.01)
        tool.figures.clear()
        tool.refusals.clear()
    rounds = 1 if quick else ROUNDS
    for done in range(rounds):
        last: dict[tuple[str, str, str, str], Case] = {}
        for number, case in enumerate(asked):
            print(f"round {done + 1}: {number} of {len(asked)} ", end="\r", file=sys.stderr, flush=True)
            for tool in running:
                tool.ask(case, last.get(case.key), 0.01 if quick else LIMIT)
            last[case.key] = case
    return rounds


def fused(quick: bool) -> list[dict[str, Any]]:
    """Run the engine beside loops written by hand; samples in the cache, and in memory."""
    rows = []
    for samples in (10_000,) if quick else (10_000, 100_000, 1_000_000):
        command = [str(FUSED), str(samples), "5" if quick else "31"]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        rows += [{"samples": samples, **json.loads(line)} for line in said.splitlines()]
    return rows


def main() -> None:
    """Measure, and write the report and the plots."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="small sizes, one round: does everything run?")
    parser.add_argument("--alone", action="store_true", help="ask no other tool")
    parser.add_argument("--out", type=Path, default=FOLDER, help="folder for RESULTS.md and plots")
    arguments = parser.parse_args()
    import report

    begin, load = time.perf_counter(), os.getloadavg()
    running, absent = tools(arguments.alone, arguments.quick)
    rounds = measure(running, arguments.quick)
    interpreters = {tool.label: tool.python for tool in running if "(" not in tool.label}
    starts = start_up.measure(interpreters, 1 if arguments.quick else start_up.PROCESSES)
    command = [sys.executable, str(FOLDER / "many.py"), *(["--quick"] if arguments.quick else [])]
    many = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    machine = fused(arguments.quick) if FUSED.exists() else []
    for tool in running:
        tool.talk.close()
    facts = {
        "rounds": rounds,
        "seconds": time.perf_counter() - begin,
        "load": (load[0], os.getloadavg()[0]),
    }
    report.write(arguments.out, running, absent, starts, many, machine, facts)
    early = [sys.executable, str(FOLDER / "early.py"), "1000" if arguments.quick else "100000"]
    subprocess.run([*early, "--into", str(arguments.out / "RESULTS.md")], check=True)
    print(f"written: {arguments.out / 'RESULTS.md'}", file=sys.stderr)


if __name__ == "__main__":
    main()
