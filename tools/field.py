"""Every log in a folder: read, profiled, evaluated, plotted and reported, with a table of what came of each.

    make field LOGS=~/flights

For each file whose format ``rtamt`` reads: the trace as ``rtamt info`` shows it, then for its signal with the most
samples the requirement that it never leaves its first half (a requirement that most logs violate, so that
explanation, plot and report have something to show), each step through the command line that users have. Output is
in build/field. The exit code is 1 if a step fails in another way than with one sentence.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import rtamt
from rtamt.readers.formats import SUFFIXES

HERE = Path(__file__).resolve().parent.parent
#: Exit codes of a command that did its work, and of one that rejected the file.
_DONE, _REJECTED = (0, 1), 2


def main(folder: Path, out: Path) -> int:
    """Go through all logs; return the exit code."""
    logs = sorted(path for path in folder.rglob("*") if path.suffix.lower() in SUFFIXES and path.is_file())
    if not logs:
        print(f"error: there is no log in '{folder}'; formats: {', '.join(SUFFIXES)}", file=sys.stderr)
        return 1
    out.mkdir(parents=True, exist_ok=True)
    print(f"{'log':<40}  {'signals':>7}  {'samples':>9}  {'seconds':>7}  outcome")
    failed = 0
    for number, log in enumerate(logs):
        begin = time.perf_counter()
        signals, samples, outcome = _one(log, out / f"{number:03}_{log.stem}")
        failed += outcome.startswith("FAILED")
        name = str(log.relative_to(folder))[-40:]
        print(
            f"{name:<40}  {signals:>7}  {samples:>9,}  {time.perf_counter() - begin:7.1f}  {outcome}",
            flush=True,
        )
    print(f"\n{len(logs)} logs, {failed} failed; plots and reports are in {out}")
    return 1 if failed else 0


def _one(log: Path, stem: Path) -> tuple[int, int, str]:
    """Return the number of signals and samples of a log, and what came of it."""
    try:
        trace = rtamt.read(log)
    except rtamt.StlError as error:
        return 0, 0, f"rejected: {error}"
    except Exception as error:  # noqa: BLE001 - what this is to find
        return 0, 0, f"FAILED to read: {type(error).__name__}: {error}"
    samples = sum(len(trace[name].values) for name in trace)
    timed = [name for name in trace if _can_be_plotted(trace, name)]
    if not timed:
        return len(trace.names), samples, "read; no finite signal with increasing timestamps changes"
    name = max(timed, key=lambda each: len(trace[each].values))
    values = trace[name].values
    quoted = '"' + name.replace('"', '""') + '"'
    middle = (float(values.min()) + float(values.max())) / 2
    formula = f"always({quoted} <= {middle!r})"
    steps = {
        "info": [],
        "explain": [formula, "--time", "dense"],
        "plot": [formula, "--time", "dense", "-o", f"{stem}.png"],
        "report": [formula, "--time", "dense", "-o", f"{stem}.html"],
    }
    for command, arguments in steps.items():
        spec, *options = arguments or [str(log)]
        files = [] if command == "info" else [str(log)]
        line = [sys.executable, "-m", "rtamt", command, spec, *files, *options]
        done = subprocess.run(line, capture_output=True, text=True, check=False)
        if done.returncode == _REJECTED and "internal error" not in done.stderr:
            return len(trace.names), samples, f"{command} rejects it: {done.stderr.strip().splitlines()[0]}"
        if done.returncode not in _DONE or "Traceback" in done.stderr:
            return len(trace.names), samples, f"FAILED in {command}: {done.stderr.strip()[-200:]}"
    return len(trace.names), samples, "read, explained, plotted, reported"


def _can_be_plotted(trace: rtamt.Trace, name: str) -> bool:
    """Return whether a signal changes, and whether its timestamps were set."""
    times, values = trace.channel(name).times, trace[name].values
    if times is None or len(values) < 2:
        return False
    return bool(np.isfinite(values).all() and values.min() < values.max() and (times[1:] > times[:-1]).all())


if __name__ == "__main__":
    if len(sys.argv) != 2:
        print("usage: make field LOGS=FOLDER", file=sys.stderr)
        sys.exit(2)
    sys.exit(main(Path(sys.argv[1]).expanduser(), HERE / "build" / "field"))
