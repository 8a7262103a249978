"""Instructions of the hot paths, counted by callgrind, beside those that benchmarks/budget.toml grants.

    python benchmarks/instructions.py            # print the table; exit code 1 where a path exceeds its budget
    python benchmarks/instructions.py --renew    # `make budget`: write the budget for this compiler and this Python

Counts depend neither on the machine nor on its load, since valgrind presents the same processor everywhere. They
depend on the compiler and on Python: the file has a table for each pair, and with another Python the paths of the
core alone are compared. Each path runs with N and with 2N repetitions in one process; the difference is what N of them
need, without start-up. The libraries of C and of numpy are left out: their versions are not ours to choose, and what
the allocator does depends on the length of the environment.
"""

from __future__ import annotations

import argparse
import ctypes
import gc
import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from hot_paths import CORE, PATHS

from rtamt.engine.native import core

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from collections.abc import Mapping

HERE = Path(__file__).parent
BUDGET = HERE / "budget.toml"
#: What a path may need beyond its budget.
ALLOWANCE = 0.05
#: The repetitions after which nothing is left to be made once: constructors are compiled with the 17th instance.
WARM = 20
#: Programs that counting needs.
TOOLS = ("valgrind", "cc")
#: Libraries whose instructions are not counted, by a part of their paths.
FOREIGN = ("/numpy/", "/numpy.libs/", "/libc.so", "/libm.so", "/ld-linux")


# ---- counting: this file runs itself below valgrind --------------------------------------------


def run_paths(library: str) -> None:
    """Run each path with N and with 2N repetitions; each ends with a dump of counts."""
    marks = ctypes.CDLL(library)
    gc.disable()  # what a collection visits depends on all that was done before
    for repetitions, prepare in PATHS.values():
        run = prepare()
        run(max(repetitions, WARM))
        marks.start_counting()
        for factor in (1, 2):
            marks.forget()
            run(factor * repetitions)
            marks.write_counts(str(factor).encode())
        marks.stop_counting()


def count() -> dict[str, float]:
    """Return the instructions of one repetition of each path."""
    valgrind, cc = map(shutil.which, TOOLS)
    if valgrind is None or cc is None:
        raise SystemExit(
            f"error: {' or '.join(TOOLS)} was not found; as root on Debian: apt-get install valgrind gcc"
        )
    with tempfile.TemporaryDirectory() as folder:
        library = f"{folder}/callgrind.so"
        subprocess.run([cc, "-O2", "-shared", "-fPIC", "-o", library, str(HERE / "callgrind.c")], check=True)
        subprocess.run(
            [
                *(valgrind, "--quiet", "--tool=callgrind", "--instr-atstart=no", "--compress-strings=no"),
                f"--callgrind-out-file={folder}/counts",
                *(sys.executable, __file__, "--below-valgrind", library),
            ],
            check=True,
            env={**os.environ, "PYTHONHASHSEED": "0", "OPENBLAS_NUM_THREADS": "1"},
        )
        found = {}
        for number, (name, (repetitions, _)) in enumerate(PATHS.items()):
            once, twice = (counted(Path(f"{folder}/counts.{2 * number + dump}")) for dump in (1, 2))
            found[name] = (twice - once) / repetitions
    return found


def counted(dump: Path) -> int:
    """Return the instructions of a dump, without those of foreign libraries."""
    total = 0
    ours = called = False
    for line in dump.read_text().splitlines():
        if line.startswith("ob="):
            ours = not any(part in line for part in FOREIGN)
        elif line.startswith("calls="):
            called = True  # the next line repeats what is counted where it was executed
        elif line[:1] in "0123456789+-*":
            cost = line.split()[1:]
            if cost and ours and not called:
                total += int(cost[0])
            called = False
    return total


# ---- the budget ----------------------------------------------------------------------------------


def environment() -> str:
    """Return what the counts depend on: the compiler of the core, and Python."""
    compiler = re.search(
        rb"(GCC): [^\0]*?([\d.]+)\0|(clang) version ([\d.]+)", Path(core().__file__).read_bytes()
    )
    named = b" ".join(filter(None, compiler.groups())).decode() if compiler else "unknown compiler"
    return f"{named}, {platform.python_implementation()} {platform.python_version()}"


def budgets() -> dict[str, dict[str, float]]:
    """Return the budgets of each environment."""
    return tomllib.loads(BUDGET.read_text(encoding="utf-8")) if BUDGET.exists() else {}


def budget_of(name: str, tables: Mapping[str, Mapping[str, float]]) -> Mapping[str, float]:
    """Return the budget of an environment; with another Python, that of the paths in the core, which hardly run it."""
    if name in tables:
        return tables[name]
    compiler = name.partition(",")[0]
    alike = (paths for other, paths in tables.items() if other.partition(",")[0] == compiler)
    return {path: count for path, count in next(alike, {}).items() if path.startswith(CORE)}


def renew(found: Mapping[str, float]) -> None:
    """Write what was counted as the budget of this environment."""
    tables = {**budgets(), environment(): found}
    lines = [
        "# Instructions of one repetition of each hot path, by compiler and Python. Renewed by `make budget`.",
        f"# A path that needs {ALLOWANCE:.0%} more fails tests/unit/test_instruction_budget.py.",
    ]
    for name in sorted(tables):
        lines += ["", f"[{json.dumps(name)}]"]
        lines += [f"{json.dumps(path)} = {counted_as(value)}" for path, value in tables[name].items()]
    BUDGET.write_text("\n".join(lines) + "\n", encoding="utf-8")


def counted_as(value: float) -> str:
    """Write a count with as many digits as can be compared."""
    return f"{value:.1f}" if value < 1000 else f"{value:.0f}"


def over_budget(found: Mapping[str, float], budget: Mapping[str, float]) -> list[str]:
    """Return a sentence for each path that exceeds its budget or has none."""
    faults = [
        f"{path}: {counted_as(value)} instructions, {value / budget[path] - 1:.1%} over its budget of {budget[path]}"
        for path, value in found.items()
        if path in budget and value > (1 + ALLOWANCE) * budget[path]
    ]
    comparable = set(found) if any(not path.startswith(CORE) for path in budget) else set(budget)
    if comparable != set(budget):
        changed = ", ".join(sorted(comparable ^ set(budget)))
        faults.append(f"the measured paths and those of the budget differ: {changed}")
    return faults


def main() -> int:
    """Count, print and compare; return the exit code."""
    parser = argparse.ArgumentParser(description="instructions of the hot paths beside their budgets")
    parser.add_argument("--renew", action="store_true", help="write the budget of this compiler and Python")
    parser.add_argument("--below-valgrind", metavar="LIBRARY", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.below_valgrind:
        run_paths(options.below_valgrind)
        return 0
    found = count()
    budget = budget_of(environment(), budgets())
    print(f"{environment():50} {'instructions':>12} {'budget':>10} {'of it':>6}")
    for path, value in found.items():
        granted = budget.get(path)
        ratio = f"{granted:>10} {value / granted:6.3f}" if granted else ""
        print(f"{path:50} {counted_as(value):>12} {ratio}".rstrip())
    if options.renew:
        renew(found)
        return 0
    faults = over_budget(found, budget)
    if faults:
        print(
            f"error: {'; '.join(faults)}. Make the path cheaper, or justify the cost and run `make budget`.",
            file=sys.stderr,
        )
    return bool(faults)


if __name__ == "__main__":
    sys.exit(main())
