"""How long a tool takes from the start of a process to its first verdict: ``python benchmarks/start_up.py``.

    python benchmarks/start_up.py [PROCESSES] [--into RESULTS.md]

Each tool runs the program below, which is what a user writes: import the tool, read the formula, give it samples
until it reports a verdict, print that. The formula is always[0:5](a >= 3), of Reelay historically[0:5](a >= 3), since
it has no future operators. The programs need no adapter and no protocol. Every tool has an environment of its own with
the same interpreter, ours with the wheel (``own_wheel.py``); all bytecode is written before the first start. The
processes of the tools are interleaved, and the first of each is not counted.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

PEERS = Path(__file__).parents[1] / "conformance" / "peers"
#: Python reads the bytecode of all that a tool imports: it is written before the clock runs (`compiled`).
ENV = ("env", "-u", "PYTHONDONTWRITEBYTECODE")
#: Everything that the interpreter of a tool imports but its standard library, which came compiled.
IMPORTED = "import sys, site; print(*site.getsitepackages(), *sys.path, sep='\\n')"
SOURCE = Path(__file__).parents[1] / "src"
PROCESSES = 31
ALONE = "Python alone"
HEADER = "## Start-up: from the start of a process to its first verdict"

#: By the label of a tool in the report.
PROGRAMS = {
    "this": """
import rtamt
monitor = rtamt.parse("always[0:5](a >= 3)").monitor()
for t in range(6):
    verdict = monitor.update(t, a=4.0)
""",
    "RTAMT": """
import rtamt
monitor = rtamt.StlDiscreteTimeSpecification()
monitor.declare_var("a", "float")
monitor.spec = "always[0:5](a >= 3)"
monitor.parse()
monitor.pastify()
for t in range(6):
    verdict = monitor.update(t, [("a", 4.0)])
""",
    "Reelay": """
from reelay import discrete_timed_monitor
monitor = discrete_timed_monitor(pattern="historically[0:5] {a >= 3}", semantics="robustness", condense=False)
for t in range(6):
    verdict = monitor.update({"a": 4.0})
verdict = verdict["value"]
""",
    "STLRom": """
import stlrom
driver = stlrom.STLDriver()
driver.parse_string("signal a\\nphi0 := a[t] >= 3\\nphi1 := alw_[0,5] phi0\\n")
for t in range(6):
    driver.add_sample([float(t), 4.0])
verdict = driver.get_monitor("phi1").eval_rob(0.0)
""",
    "mstlo": """
import mstlo_python as mstlo
monitor = mstlo.Monitor(mstlo.parse_formula("G[0,5](a >= 3)"), semantics="DelayedQuantitative")
for t in range(6):
    verdict = monitor.update("a", 4.0, float(t)).verdicts()
verdict = verdict[0][1]
""",
    "py-metric-temporal-logic": """
import mtl
verdict = mtl.parse("G[0, 5](a)")({"a": [(float(t), 1.0) for t in range(6)]}, quantitative=True)
""",
}
#: The end of each program. Processor time counts from the start of the process.
REPORT = "from time import process_time\nprint(verdict, process_time(), flush=True)\n"
#: What each program prints: all have evaluated the formula.
VERDICT = 1.0


@dataclass
class Start:
    """The starts of a tool: processor time to its verdict and of the whole process, and until the verdict was read."""

    processor: list[float] = field(default_factory=list)
    whole: list[float] = field(default_factory=list)
    elapsed: list[float] = field(default_factory=list)


def compiled(python: str) -> None:
    """Compile the modules of a tool's environment and its adapter to bytecode, as an installation does."""
    said = subprocess.run([*ENV, python, "-c", IMPORTED], check=True, capture_output=True, text=True).stdout
    found = {path for path in said.splitlines() if path.endswith("-packages")}
    folders = [*sorted(found), str(PEERS), *([str(SOURCE)] if python == sys.executable else [])]
    # A package may hold a template or test that is no valid Python; it is not imported either.
    subprocess.run([*ENV, python, "-m", "compileall", "-qq", *folders], check=False)


def measure(interpreters: Mapping[str, str], processes: int) -> dict[str, Start]:
    """Start every tool so many times; ``interpreters``: by label. All environments must be compiled."""
    programs = {ALONE: (interpreters["this"], f"verdict = {VERDICT}\n")}
    programs |= {label: (python, PROGRAMS[label]) for label, python in interpreters.items()}
    environment = {name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    found = {label: Start() for label in programs}
    with tempfile.TemporaryDirectory() as empty:  # python -c also looks for modules in its working folder
        for _ in range(processes + 1):
            for label, (python, program) in programs.items():
                begin = time.perf_counter()
                process = subprocess.Popen(
                    [python, "-c", program + REPORT], stdout=subprocess.PIPE, env=environment, cwd=empty
                )
                assert process.stdout is not None
                verdict, processor = map(float, process.stdout.readline().split())
                found[label].elapsed.append(time.perf_counter() - begin)
                _, status, used = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(status)
                process.stdout.close()
                assert process.returncode == 0, label
                assert verdict == VERDICT, label
                found[label].processor.append(processor)
                found[label].whole.append(used.ru_utime + used.ru_stime)
    for start in found.values():
        del start.processor[0], start.whole[0], start.elapsed[0]  # they loaded the files for the others, too
    return found


def ratios(starts: Mapping[str, Start]) -> dict[str, float]:
    """Return how many times the processor time of ours each other tool takes: the medians of the ratios."""
    ours = starts["this"].processor
    return {
        label: median(theirs / own for theirs, own in zip(start.processor, ours, strict=True))
        for label, start in starts.items()
        if label not in ("this", ALONE)
    }


def section(starts: Mapping[str, Start]) -> str:
    """Return the section of the report."""
    alone = median(starts[ALONE].processor)
    count = len(starts[ALONE].processor)
    lines = [
        HEADER,
        "",
        f"Medians of {count} interleaved processes of each tool, which run what a user writes",
        "(`benchmarks/start_up.py`): import the tool, read `always[0:5](a >= 3)`, give it six samples, print the",
        "verdict. Every tool is installed from its wheel or source package into an environment of its own, ours too;",
        "the bytecode of all is cached. The first columns are processor time from the start of the process to the",
        "verdict, and what of it is beyond that of Python alone.",
        f"The load average was {os.getloadavg()[0]:.0f}.",
        "",
        "| tool | to the verdict | beyond Python | whole process | elapsed |",
        "|---|---:|---:|---:|---:|",
    ]
    for label, start in starts.items():
        own, whole, elapsed = map(median, (start.processor, start.whole, start.elapsed))
        beyond = "" if label == ALONE else f"{(own - alone) * 1e3:.1f} ms"
        lines.append(
            f"| {label} | {own * 1e3:.1f} ms | {beyond} | {whole * 1e3:.1f} ms | {elapsed * 1e3:.1f} ms |"
        )
    return "\n".join(lines)


def _with_section(text: str, new: str) -> str:
    """Return a report with this section in place of its last version."""
    before, _, rest = text.partition("\n## Start-up")
    return f"{before.rstrip()}\n\n{new}\n{rest[rest.index(chr(10) + '## ') :]}"


def main() -> None:
    """Print the section, or put it into a report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("processes", type=int, nargs="?", default=PROCESSES)
    parser.add_argument("--into", type=Path, help="the report whose section is replaced")
    arguments = parser.parse_args()
    sys.path.insert(0, str(PEERS))
    import own_wheel
    import peers

    interpreters = {"this": own_wheel.python()}
    interpreters |= {peer.label: str(peer.python) for peer in peers.PEERS if peer.installed}
    for python in interpreters.values():
        compiled(python)
    starts = measure(interpreters, arguments.processes)
    new = section(starts)
    if arguments.into is None:
        print(new, "", *(f"{label}: {ratio:.2f}×" for label, ratio in ratios(starts).items()), sep="\n")
        return
    arguments.into.write_text(
        _with_section(arguments.into.read_text(encoding="utf-8"), new), encoding="utf-8"
    )


if __name__ == "__main__":
    main()
