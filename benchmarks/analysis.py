"""How long `rtamt analyze` takes for each of the Lockheed Martin challenge problems: processor time, 200 samples.

    python benchmarks/analysis.py [SECONDS]

SECONDS: the limit of each question, by default that of the command.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import rtamt
from rtamt.analysis import analyze

PROBLEMS = Path(__file__).parents[1] / "examples" / "requirements" / "lockheed_martin"


def main() -> None:
    """Print a table."""
    settings = {"limit": float(sys.argv[1])} if len(sys.argv) > 1 else {}
    analyze(rtamt.parse("x > 0"), samples=2)  # loads the solver
    print(f"{'problem':<24} {'requirements':>12} {'answers':>8} {'findings':>9} {'open':>5} {'seconds':>8}")
    for path in sorted(PROBLEMS.glob("*.stl")):
        spec = rtamt.load(path)
        begin = time.process_time()
        found = analyze(spec, **settings)
        seconds = time.process_time() - begin
        print(
            f"{path.stem:<24} {len(spec.requirements):>12} {len(found.conclusions):>8} {len(found.findings):>9} "
            f"{len(found.unanswered):>5} {seconds:>8.2f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
