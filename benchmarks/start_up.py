"""How long a tool takes from the start of a process to its import and first verdict: ``python benchmarks/start_up.py``.

    python benchmarks/start_up.py [PROCESSES] [--into RESULTS.md]

Each tool runs the program below, which is what a user writes: import the tool, read the formula, give it samples
until it reports a verdict, print that. The clock is read after the import and after the verdict, which includes what a
tool loads on first use. The formula is always[0:5](a >= 3), of Reelay historically[0:5](a >= 3), since
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
from datetime import date
from operator import attrgetter
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    #: Reads the processor times of the starts of a tool.
    Measure = Callable[["Start"], list[float]]

PEERS = Path(__file__).parents[1] / "conformance" / "peers"
#: Python reads the bytecode of all that a tool imports: it is written before the clock runs (`compiled`).
ENV = ("env", "-u", "PYTHONDONTWRITEBYTECODE")
#: Everything that the interpreter of a tool imports but its standard library, which came compiled.
IMPORTED = "import sys, site; print(*site.getsitepackages(), *sys.path, sep='\\n')"
SOURCE = Path(__file__).parents[1] / "src"
PROCESSES = 31
ALONE = "Python alone"
HEADER = "## Start-up: from the start of a process to its import and first verdict"

#: By the label of a tool in the report; the first line imports it.
PROGRAMS = {
    "this": """\
import rtamt
monitor = rtamt.parse("always[0:5](a >= 3)").monitor()
for t in range(6):
    verdict = monitor.update(t, a=4.0)
""",
    "RTAMT": """\
import rtamt
monitor = rtamt.StlDiscreteTimeSpecification()
monitor.declare_var("a", "float")
monitor.spec = "always[0:5](a >= 3)"
monitor.parse()
monitor.pastify()
for t in range(6):
    verdict = monitor.update(t, [("a", 4.0)])
""",
    "Reelay": """\
from reelay import discrete_timed_monitor
monitor = discrete_timed_monitor(pattern="historically[0:5] {a >= 3}", semantics="robustness", condense=False)
for t in range(6):
    verdict = monitor.update({"a": 4.0})
verdict = verdict["value"]
""",
    "STLRom": """\
import stlrom
driver = stlrom.STLDriver()
driver.parse_string("signal a\\nphi0 := a[t] >= 3\\nphi1 := alw_[0,5] phi0\\n")
for t in range(6):
    driver.add_sample([float(t), 4.0])
verdict = driver.get_monitor("phi1").eval_rob(0.0)
""",
    "mstlo": """\
import mstlo_python as mstlo
monitor = mstlo.Monitor(mstlo.parse_formula("G[0,5](a >= 3)"), semantics="DelayedQuantitative")
for t in range(6):
    verdict = monitor.update("a", 4.0, float(t)).verdicts()
verdict = verdict[0][1]
""",
    "py-metric-temporal-logic": """\
import mtl
verdict = mtl.parse("G[0, 5](a)")({"a": [(float(t), 1.0) for t in range(6)]}, quantitative=True)
""",
}
#: What follows the import and what ends each program. Processor time counts from the start of the process.
IMPORTED_NOW = "from time import process_time\nimported = process_time()\n"
REPORT = "print(verdict, imported, process_time(), flush=True)\n"
#: What each program prints: all have evaluated the formula.
VERDICT = 1.0


@dataclass
class Start:
    """The starts of a tool: processor time to its import, to the verdict and of the whole process; elapsed time."""

    imported: list[float] = field(default_factory=list)
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
    programs = {ALONE: (interpreters["this"], f"\nverdict = {VERDICT}\n")}
    programs |= {label: (python, PROGRAMS[label]) for label, python in interpreters.items()}
    environment = {name: text for name, text in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    found = {label: Start() for label in programs}
    with tempfile.TemporaryDirectory() as empty:  # python -c also looks for modules in its working folder
        for _ in range(processes + 1):
            for label, (python, program) in programs.items():
                begin = time.perf_counter()
                first, rest = program.split("\n", 1)
                process = subprocess.Popen(
                    [python, "-c", f"{first}\n{IMPORTED_NOW}{rest}{REPORT}"],
                    stdout=subprocess.PIPE,
                    env=environment,
                    cwd=empty,
                )
                assert process.stdout is not None
                verdict, imported, processor = map(float, process.stdout.readline().split())
                found[label].elapsed.append(time.perf_counter() - begin)
                _, status, used = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(status)
                process.stdout.close()
                assert process.returncode == 0, label
                assert verdict == VERDICT, label
                found[label].imported.append(imported)
                found[label].processor.append(processor)
                found[label].whole.append(used.ru_utime + used.ru_stime)
    for start in found.values():  # the first loaded the files for the others, too
        del start.imported[0], start.processor[0], start.whole[0], start.elapsed[0]
    return found


#: Of which processor times tools are compared, from the start of the process on.
TO_IMPORT: Measure = attrgetter("imported")
TO_VERDICT: Measure = attrgetter("processor")


def ratios(starts: Mapping[str, Start], measure: Measure) -> dict[str, float]:
    """Return how many times the processor time of ours each other tool takes: the medians of the ratios."""
    ours = measure(starts["this"])
    return {
        label: median(theirs / own for theirs, own in zip(measure(start), ours, strict=True))
        for label, start in starts.items()
        if label not in ("this", ALONE)
    }


def section(starts: Mapping[str, Start]) -> str:
    """Return the section of the report."""
    alone_imported, alone = median(starts[ALONE].imported), median(starts[ALONE].processor)
    count = len(starts[ALONE].processor)
    lines = [
        HEADER,
        "",
        f"Medians of {count} interleaved processes of each tool, which run what a user writes",
        "(`benchmarks/start_up.py`): import the tool, read `always[0:5](a >= 3)`, give it six samples, print the",
        "verdict. Every tool is installed from its wheel or source package into an environment of its own, ours too;",
        "the bytecode of all is cached. The first columns are processor time from the start of the process until the",
        "tool is imported and until it has given the verdict, each with what of it is beyond that of Python alone.",
        "Ours loads parser, compiler and core on first use: what a program waits for is the verdict.",
        f"Measured on {date.today()}; the load average was {os.getloadavg()[0]:.0f}.",
        "",
        "| tool | imported | beyond Python | to the verdict | beyond Python | whole process | elapsed |",
        "|---|---:|---:|---:|---:|---:|---:|",
    ]
    for label, start in starts.items():
        imported, own, *others = map(median, (start.imported, start.processor, start.whole, start.elapsed))
        both = ((imported, imported - alone_imported), (own, own - alone))
        cells = [cell for time, beyond in both for cell in (_ms(time), "" if label == ALONE else _ms(beyond))]
        lines.append(f"| {' | '.join((label, *cells, *map(_ms, others)))} |")
    return "\n".join(lines)


def _ms(seconds: float) -> str:
    return f"{seconds * 1e3:.1f} ms"


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
        print(new, "")
        for name, measured in (("import", TO_IMPORT), ("verdict", TO_VERDICT)):
            print(
                *(f"{name}, {label}: {ratio:.2f}×" for label, ratio in ratios(starts, measured).items()),
                sep="\n",
            )
        return
    arguments.into.write_text(
        _with_section(arguments.into.read_text(encoding="utf-8"), new), encoding="utf-8"
    )


if __name__ == "__main__":
    main()
