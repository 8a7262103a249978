"""The paper's listings, tables and figures, with this library, with RTAMT where it is installed, beside the claims.

    python examples/paper/reproduce.py [--quick]

writes build/paper/REPORT.md and the figures beside it. `make peers` installs RTAMT into an environment of its own;
without it its columns say so. The two case studies have programs of their own, which are run and quoted.
"""

from __future__ import annotations

import json
import os
import platform
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import figures

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
OUT = ROOT / "build" / "paper"
RTAMT = ROOT / "build" / "peers" / "rtamt" / "bin" / "python"

#: What each tool found: by its name, what experiments.py printed.
Found = dict[str, dict[str, Any]]


@dataclass(frozen=True)
class Case:
    """A case study: the paper's claim, the program that checks it, and the images that it draws into ``folder``."""

    title: str
    claim: str
    program: str
    arguments: tuple[str, ...]
    folder: str
    figures: tuple[str, ...]


CASES = (
    Case(
        "The service robot in ROS: which component's specification falls first",
        "without a fault all four specifications keep a robustness above 0; with a fault in the planner its "
        "specification is violated first, then that of the system, and a collision with a desk follows. The robot has "
        "a footprint of 450 mm in diameter, an omnidirectional drive and 0.22 m/s at most (the table of the paper), "
        "and so has the base that is simulated here",
        "examples/service_robot/run.py",
        ("--fault", "planner", "--seed", "3", "--plots", "{folder}"),
        "robot",
        ("robustness.png", "scene.png"),
    ),
    Case(
        "The aircraft elevators in Simulink: sensitivity and falsification",
        "16 simulations over amplitude and frequency of the pilot's command give a heat map that shows critical "
        "regions; a global optimizer lowers the robustness step by step until the requirement is violated",
        "examples/elevator/run.py",
        ("{folder}",),
        "elevator",
        ("sensitivity.png", "falsification.png"),
    ),
)
CLAIMS = {
    "a": {"robustness": 3, "output robustness": 3, "input vacuity": 0},
    "b": {"robustness": 1, "output robustness": "inf", "input vacuity": 1},
    "c": {"robustness": -2, "output robustness": -2},
    "d": {"robustness": -1, "output robustness": -2},
}
#: The listings that need ROS, as they stand in the paper: a double of rospy, and a real master where there is one.
SCRIPTS = ["tests/paper/test_listings.py"]
ON_A_MASTER = ["tests/integration/ros/test_ros1_recorded.py", "-k", "listings"]


def measure(python: str | Path, quick: bool) -> dict[str, Any]:
    """Run experiments.py with an interpreter that has a package called rtamt."""
    command = [str(python), str(HERE / "experiments.py"), *(["--quick"] if quick else [])]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{python} failed:\n{done.stderr}")
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def report(found: Found) -> str:
    """Return the report as Markdown, in the order of the paper."""
    peer = "" if "RTAMT" in found else "\n\nRTAMT is not installed here: `make peers`, then once more."
    return "\n\n".join(
        [
            f"# The paper, run again\n\nBy `examples/paper/reproduce.py` on {platform.platform()}, Python "
            f"{platform.python_version()}, {os.cpu_count()} cores. "
            f"Times are those of the processor, on this machine.{peer}",
            table("Two behaviours of a PID controller against f <= 1.1 (the first figure)", "figure 1", found,
                  "robustness +0.048 where it is satisfied, -0.198 where it is violated. It does not publish the "
                  "controllers: these are step responses of second order that reach 1.052 and 1.298"),
            "![responses](pid.png)",
            listing("always and historically over a window (the second figure)", "figure 2", found,
                    "always[a,b] takes the infimum over [t+a, t+b], historically[a,b] over [t-b, t-a]"),
            "![operators](operators.png)",
            figure_4(found),
            "![requests and grants](interface.png)",
            table("Pastification: at how many instants the pastified formula has the same value, one horizon later",
                  "pastification", found, "for every formula of bounded future, at every instant"),
            listing("Listing 1, dense time offline", "listing 1", found, "one robustness signal; no value is printed"),
            listing("Listing 2, dense time online in two chunks", "listing 2", found,
                    "no value is printed; by its own definition 3 from t = 5 on"),
            scripts(),
            listing("Listing 8, what its monitor publishes from the horizon on: a request every 10 s, the third "
                    "without a grant", "listing 8", found, "no value is printed; by its definition 1, then -3 from "
                    "the instant on at which the third request has waited for 5 s"),
            "## The monitor as a block in Simulink\n\nThe block is in `matlab/`; "
            "`tests/integration/matlab/test_block.py` runs it in Octave, compared with the monitor in Python.",
            table("Scaling of offline monitors, seconds", "scaling", found,
                  "time grows with the samples and the length of the formula; dense time is the slower one; at most "
                  "0.5 ms a sample in Python"),
            "![offline](scaling.png)",
            table("Online monitors: seconds a sample of always[0,k](a + b >= -2)", "windows", found,
                  "the C++ back end is about 10 times as fast as Python's, more for large k, up to a million. RTAMT's "
                  "C++ back end is in none of its packages: its column is its back end in Python"),
            "![online](windows.png)",
            *(case(each) for each in CASES),
            "## What is not run again\n\nDiagrams of RTAMT's own architecture, and photographs of the robot and of "
            "its simulator.",
        ]
    ) + "\n"  # fmt: skip


def listing(title: str, key: str, found: Found, claim: str) -> str:
    """Return what a listing gives with each tool."""
    rows = "\n".join(
        f"- {tool}: `{json.dumps(values[key], ensure_ascii=False)}`" for tool, values in found.items()
    )
    return f"## {title}\n\nThe paper: {claim}.\n\n{rows}"


def figure_4(found: Found) -> str:
    """Return the table of Fig. 4: claim, and each tool."""
    lines = [
        "## Fig. 4, interface-aware semantics\n",
        "| recording | measure | paper | " + " | ".join(found) + " |",
    ]
    lines.append("|---|---|---|" + "---|" * len(found))
    for name, claims in CLAIMS.items():
        for measure_, claim in claims.items():
            values = " | ".join(
                str(v["figure 4"][name][measure_]) if isinstance(v["figure 4"], dict) else v["figure 4"]
                for v in found.values()
            )
            lines.append(f"| ({name}) | {measure_} | {claim} | {values} |")
    return "\n".join(lines)


def table(title: str, key: str, found: Found, claim: str) -> str:
    """Return a table of numbers, a column a tool."""
    lines = [f"## {title}\n", f"The paper: {claim}.\n", "| case | " + " | ".join(found) + " |"]
    lines.append("|---|" + "---:|" * len(found))
    failed = [f"{tool}: {v[key]}" for tool, v in found.items() if not isinstance(v[key], dict)]
    for name in next(v[key] for v in found.values() if isinstance(v[key], dict)):
        values = [v[key].get(name) if isinstance(v[key], dict) else None for v in found.values()]
        lines.append(f"| {name} | " + " | ".join(map(_cell, values)) + " |")
    return "\n".join([*lines, *failed])


def _cell(value: float | str | None) -> str:
    return "-" if value is None else value if isinstance(value, str) else f"{value:.3g}"


def scripts() -> str:
    """Run listings 3 to 8 as they stand in the paper, and quote how it went."""
    runs = [("over a double of rospy", SCRIPTS)]
    if shutil.which("rosmaster"):
        runs.append(("on a real master", ON_A_MASTER))
    results = []
    for where, arguments in runs:
        code, text = _run("-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments)
        last = text.strip().splitlines()[-1]
        results.append(f"- {where}: `pytest {' '.join(arguments)}` (exit code {code}): {last}")
    return "\n\n".join(
        [
            "## Listings 3 to 8, the monitor in ROS",
            "The paper: a node that monitors requests and grants every second; no value is printed. RTAMT's node needs "
            "ROS 1 beside its own environment, so that it is not run here.",
            "\n".join(results),
        ]
    )


def case(each: Case) -> str:
    """Run the program of a case study, quote what it prints, show what it draws."""
    if not (ROOT / each.program).exists():
        return f"## {each.title}\n\n`{each.program}` is not here."
    arguments = [argument.format(folder=OUT / each.folder) for argument in each.arguments]
    code, text = _run(each.program, *arguments)
    shown = " ".join((each.program, *(a.format(folder=f"build/paper/{each.folder}") for a in each.arguments)))
    said = "\n".join(line for line in text.splitlines() if not line.startswith(str(OUT)))
    images = "\n\n".join(f"![{name}]({each.folder}/{name})" for name in each.figures)
    return (
        f"## {each.title}\n\nThe paper: {each.claim}.\n\n`python {shown}` (exit code {code}):\n\n"
        f"```text\n{said}\n```\n\n{images}"
    )


def _run(*arguments: str) -> tuple[int, str]:
    done = subprocess.run([sys.executable, *arguments], cwd=ROOT, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def main() -> None:
    """Measure, draw, write."""
    quick = "--quick" in sys.argv
    found = {"this library": measure(sys.executable, quick)}
    if RTAMT.exists():
        found["RTAMT"] = measure(RTAMT, quick)
    OUT.mkdir(parents=True, exist_ok=True)
    figures.draw_all(found, OUT)
    (OUT / "REPORT.md").write_text(report(found), encoding="utf-8")
    print(OUT / "REPORT.md")


if __name__ == "__main__":
    main()
