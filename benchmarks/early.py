"""What an update costs before the horizon: eager verdicts and bounds, by the length of the bounds.

    python benchmarks/early.py [SAMPLES [dense]]
    python benchmarks/early.py --into benchmarks/RESULTS.md [SAMPLES]   # `make bench`: replaces the section there

Microseconds of processor time an update from Python, the verdicts in it included, beside the delayed mode. With
``pip install mstlo-python stlrom``, or for ``--into`` after ``make peers``, also those of mstlo's verdicts and
intervals and of STLRom's bounds at the start, for lengths up to 1000.
The aims: eager 0.3 µs for three operators; bounds at the start 0.3 µs; at every sample 1 µs for
one window, 3 µs for two nested. Each flat from bounds of 10 to 100 000.
"""

from __future__ import annotations

import argparse
import datetime as dt
import os
import platform
import sys
import time
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from typing import Any

FORMULAS = (
    "always[0:{k}](x >= -2)",
    "eventually[0:{k}] always[0:{k}](x >= -2)",
    "always[0:{k}](x >= 1 -> eventually[0:{k}](y >= 1))",
    "(x >= -2) until[0:{k}] (y >= 1)",
    "(x >= -2) since[0:{k}] (y >= 1)",
)
#: The same in the language of mstlo, as far as it has them.
IN_MSTLO = {
    FORMULAS[0]: "G[0, {k}](x >= -2)",
    FORMULAS[1]: "F[0, {k}](G[0, {k}](x >= -2))",
    FORMULAS[2]: "G[0, {k}]((x >= 1) -> (F[0, {k}](y >= 1)))",
    FORMULAS[3]: "(x >= -2) U[0, {k}] (y >= 1)",
}
#: The same in that of STLRom; it has no `since`, and its process ends with `until`.
IN_STLROM = {
    FORMULAS[0]: "p := x[t] >= -2; phi := alw_[0, {k}] p",
    FORMULAS[1]: "p := x[t] >= -2; a := alw_[0, {k}] p; phi := ev_[0, {k}] a",
    FORMULAS[2]: "p := x[t] >= 1; q := y[t] >= 1; e := ev_[0, {k}] q; i := p => e; phi := alw_[0, {k}] i",
}
#: From a peer to its package, and to the module of that.
PEERS = {"mstlo": "mstlo-python", "STLRom": "stlrom"}
MODULES = {"mstlo": "mstlo_python", "STLRom": "stlrom"}
LONGEST_OF_PEERS = 1_000
ENVIRONMENTS = Path(__file__).parents[1] / "build" / "peers"
HEADER = "## Verdicts before the horizon, an update"
LENGTHS = (10, 100, 1_000, 10_000, 100_000)
MODES: Mapping[str, dict[str, str]] = {
    "delayed": {},
    "eager": {"verdict": "eager"},
    "start": {"verdict": "interval", "at": "start"},
    "every": {"verdict": "interval", "at": "every"},
}


#: Seconds by which a late sample comes at most after the newest one, and the lateness of its monitor.
LATE = 8.0, "10s"


def cost(formula: str, settings: Mapping[str, str], samples: int, *, late: float = 0.0) -> float:
    """Return the microseconds of an update, the least of three runs; ``late``: by how many seconds samples come."""
    random = np.random.default_rng(1)
    spec = rtamt.parse(formula)
    names = spec.input_names
    columns = [random.normal(size=samples).tolist() for _ in names]
    order = (np.arange(samples) + random.uniform(0, late, size=samples)).argsort(kind="stable").tolist()
    columns = [[column[i] for i in order] for column in columns]
    times = [float(t) for t in order]
    best = float("inf")
    for _ in range(3):
        update = spec.monitor(**settings).update
        begin = time.process_time()
        if len(names) == 1:
            for t, x in zip(times, columns[0], strict=True):
                update(t, x=x)
        else:
            for t, x, y in zip(times, *columns, strict=True):
                update(t, x=x, y=y)
        best = min(best, time.process_time() - begin)
    return best / samples * 1e6


def late_costs(samples: int, domain: Mapping[str, str]) -> list[tuple[str, list[float]]]:
    """Return the cost of bounds at every sample of samples in order, without and with a lateness, and of late ones."""
    costs = []
    for formula in FORMULAS:
        text, settings = formula.format(k=LENGTHS[2]), {**MODES["every"], **domain}
        within = {**settings, "lateness": LATE[1]}
        runs = (settings, 0.0), (within, 0.0), (within, LATE[0])
        costs.append((text, [cost(text, each, samples, late=late) for each, late in runs]))
    return costs


def mstlo_cost(formula: str, k: int, semantics: str, samples: int) -> float:
    """Return the microseconds of a sample of all variables: one run, its windows full for the second half at least."""
    module = import_module("mstlo_python")
    update: Callable[..., Any] = module.Monitor(module.parse_formula(formula), semantics=semantics).update
    names = [name for name in "xy" if name in formula]
    rows = np.random.default_rng(1).normal(size=(min(samples, max(3_000, 2 * k)), len(names))).tolist()
    begin = time.process_time()
    for i, row in enumerate(rows):
        t = float(i)
        for name, value in zip(names, row, strict=True):
            update(name, value, t).verdicts()
    return (time.process_time() - begin) / len(rows) * 1e6


def stlrom_cost(formula: str, k: int, samples: int) -> float:
    """Return the microseconds of a sample and of the bounds at the start: one run of two horizons at most."""
    module = import_module("stlrom")
    names = [name for name in "xy" if name in formula]
    driver = module.STLDriver()
    if not driver.parse_string("\n".join([f"signal {', '.join(names)}", *formula.split("; "), ""])):
        raise ValueError(f"STLRom does not parse {formula}")
    driver.set_interpol("PREVIOUS")
    monitor = driver.get_monitor("phi")
    rows = np.random.default_rng(1).normal(size=(min(samples, max(1_000, 2 * k)), len(names))).tolist()
    begin = time.process_time()
    for i, row in enumerate(rows):
        monitor.add_sample([float(i), *row])
        monitor.eval_rob(0.0)
        monitor.get_lower_rob()
        monitor.get_upper_rob()
    return (time.process_time() - begin) / len(rows) * 1e6


def at_start(samples: int, domain: Mapping[str, str]) -> list[tuple[str, float]]:
    """Return the cost of bounds at the start of formulas with unbounded future."""
    formulas = ("always(x >= -2)", "eventually(x >= 5)", "(x >= -2) until (y >= 5)")
    return [(formula, cost(formula, {**MODES["start"], **domain}, samples)) for formula in formulas]


# ---- the section of the results ------------------------------------------------------------------


def section(samples: int) -> str:
    """Return the section of RESULTS.md."""
    begin, load = time.perf_counter(), os.getloadavg()[0]
    rows = list(_rows(samples))
    unbounded = [f"{each:.2f} µs for `{formula}`" for formula, each in at_start(samples, {})]
    late = [
        f"| `{text}` | {' | '.join(f'{a:.2f} / {b:.2f}' for a, b in zip(steps, dense, strict=True))} |"
        for (text, steps), (_, dense) in zip(
            late_costs(samples, {}), late_costs(samples // 2, {"time": "dense"}), strict=True
        )
    ]
    spent = time.perf_counter() - begin
    peers = [f"{name} {version(package)}" for name, package in PEERS.items() if find_spec(MODULES[name])]
    return "\n".join(
        [
            HEADER,
            "",
            f"Made by `python benchmarks/early.py --into benchmarks/RESULTS.md {samples}` on "
            f"{dt.datetime.now(dt.timezone.utc):%Y-%m-%d} in {spent:.0f} s, with",
            f"Python {platform.python_version()}{''.join(f', {each}' for each in peers)}. Load average before "
            f"{load:.1f} and after {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores.",
            "Microseconds of processor time for an update from Python with its results, the least of three runs over "
            f"{samples:,} samples (dense time: half as many) of",
            'noise, one second apart; columns with two figures: discrete / dense time. "at the start" and "at every '
            'instant" are bounds. Peers have',
            "dense time and run once, over two horizons, at least 3,000 samples (mstlo, verdicts and intervals of "
            "every instant; an",
            "update has one variable, so that a sample of two is two updates) or 1,000 samples (STLRom, bounds at the "
            "start; its process",
            "ends with `until`). A window longer than the trace never passes.",
            "",
            "| formula | k | delayed | eager | mstlo | at the start | STLRom | at every instant | mstlo |",
            "|---|---:|---:|---:|---:|---:|---:|---:|---:|",
            *rows,
            "",
            f"Bounds at the start with unbounded future, in discrete time: {', '.join(unbounded)}.",
            "",
            f"Bounds at every instant of samples that may be late, with a lateness of {LATE[1]}, beside those of a "
            f"monitor without one;",
            f"late samples come up to {LATE[0]:g} s after the newest:",
            "",
            "| formula | in order, no lateness | in order | late |",
            "|---|---:|---:|---:|",
            *late,
        ]
    )


def _rows(samples: int) -> Iterator[str]:
    for formula in FORMULAS:
        for k in LENGTHS:
            text = formula.format(k=k)
            ours = {
                mode: " / ".join(
                    f"{cost(text, {**settings, **domain}, size):.2f}"
                    for domain, size in (({}, samples), ({"time": "dense"}, samples // 2))
                )
                for mode, settings in MODES.items()
            }
            peer = k <= LONGEST_OF_PEERS
            mstlo, stlrom = IN_MSTLO.get(formula), IN_STLROM.get(formula)
            theirs = {"EagerQualitative": "", "Rosi": ""}
            if peer and mstlo and find_spec("mstlo_python"):
                theirs = {each: f"{mstlo_cost(mstlo.format(k=k), k, each, samples):.3g}" for each in theirs}
            known = (
                f"{stlrom_cost(stlrom.format(k=k), k, samples):.3g}"
                if peer and stlrom and find_spec("stlrom")
                else ""
            )
            cells = (f"`{formula}`", f"{k:,}", ours["delayed"], ours["eager"], theirs["EagerQualitative"])
            cells += (ours["start"], known, ours["every"], theirs["Rosi"])
            yield f"| {' | '.join(cells)} |"


def with_section(text: str, new: str) -> str:
    """Return a report with this section in place of its last version, or at its end."""
    before, found, rest = text.partition(f"{HEADER}\n")
    after = rest[rest.index("\n## ") :] if "\n## " in rest else ""
    return f"{before.rstrip()}\n\n{new}\n{after}" if found else f"{text.rstrip()}\n\n{new}\n"


def table(samples: int, domain: Mapping[str, str]) -> None:
    """Print a row for each formula and length."""
    peer = ("EagerQualitative", "Rosi") if find_spec("mstlo_python") else ()
    print(f"{'formula':<52} {'k':>7}", *(f"{mode:>8}" for mode in MODES), *(f"{each:>16}" for each in peer))
    for formula in FORMULAS:
        for k in LENGTHS:
            row = [cost(formula.format(k=k), {**settings, **domain}, samples) for settings in MODES.values()]
            text = IN_MSTLO.get(formula) if k <= LONGEST_OF_PEERS else None
            theirs = [mstlo_cost(text.format(k=k), k, each, samples) for each in peer if text]
            cells = [*(f"{each:8.2f}" for each in row), *(f"{each:16.2f}" for each in theirs)]
            print(f"{formula:<52} {k:>7}", *cells, flush=True)
    for formula, each in at_start(samples, domain):
        print(f"{formula:<52} {'':>7} {'':>8} {'':>8} {each:8.2f}")
    print("at every sample: in order without a lateness, in order, late")
    for formula, costs in late_costs(samples, domain):
        print(f"{formula:<52} {'':>7}", *(f"{each:8.2f}" for each in costs), flush=True)


def main() -> None:
    """Print the table, or put its section into a report."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("samples", type=int, nargs="?", default=300_000)
    parser.add_argument("time", nargs="?")
    parser.add_argument("--into", type=Path, help="the report whose section is replaced")
    arguments = parser.parse_args()
    if arguments.into is None:
        table(arguments.samples, {"time": arguments.time} if arguments.time else {})
        return
    for package in PEERS.values():  # `make peers`: each in an environment of its own
        sys.path += map(str, ENVIRONMENTS.glob(f"{package}/lib/python*/site-packages"))
    new = section(arguments.samples)
    arguments.into.write_text(with_section(arguments.into.read_text(encoding="utf-8"), new), encoding="utf-8")


if __name__ == "__main__":
    main()
