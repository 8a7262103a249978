"""The solver against brute force on many formulas: ``python -m tests.laws.analysis_soak 10000 [SEED]``.

Each formula is different. Every failure is printed; the exit code is 1 if there is one.
"""

from __future__ import annotations

import sys
from collections import Counter
from time import process_time

from hypothesis import HealthCheck, Phase, given, seed, settings

from rtamt.analysis.encoder import NotCoveredError
from rtamt.errors import StlError
from tests.laws.analysis_grid import COVERED, by_force, by_solver


def main(count: int, first: int = 0) -> int:
    """Compare ``count`` formulas, and return the number of failures."""
    known: set[str] = set()
    checked: Counter[str] = Counter()
    failures: list[str] = []

    def compare(formula: object) -> None:
        text = str(formula)
        if text in known or checked["formulas"] == count:
            return
        known.add(text)
        try:
            found, shown = by_solver(formula), by_force(formula)
        except NotCoveredError:
            checked["not covered"] += 1
            return
        except StlError:  # it has no value on some trace
            checked["undefined on some trace"] += 1
            return
        except AssertionError as error:  # the engine has another verdict on a trace of the solver
            failures.append(text)
            print(error, flush=True)
            return
        checked["formulas"] += 1
        checked["questions"] += 2 * len(found)
        checked["traces replayed"] += sum(map(sum, found))
        if found != shown:
            failures.append(text)
            print(f"{text}\n  solver {found}\n  traces {shown}", flush=True)

    begin, part = process_time(), 0
    while checked["formulas"] < count:
        drawn = settings(
            max_examples=min(1000, count),
            deadline=None,
            database=None,
            phases=(Phase.generate,),
            suppress_health_check=list(HealthCheck),
        )(given(COVERED)(compare))
        seed(first + part)(drawn)()
        part += 1
        so_far = f"{checked['formulas']:>9,} formulas, {len(failures)} failures"
        print(f"{so_far}, {process_time() - begin:.0f} s", flush=True)
    for name, cases in sorted(checked.items()):
        print(f"{cases:>9,}  {name}")
    return len(failures)


if __name__ == "__main__":
    sys.exit(1 if main(*map(int, sys.argv[1:])) else 0)
