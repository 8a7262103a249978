"""The paper's listings, tables and figures, with this library, with RTAMT where it is installed, beside the claims.

    python examples/paper/reproduce.py [--quick]

writes build/paper/REPORT.md and the figures beside it. `make peers` installs RTAMT into an environment of its own;
without it its columns say so. The two case studies have programs of their own, which are run and quoted.
"""

from __future__ import annotations

import json
import os
import platform
import subprocess
import sys
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
OUT = ROOT / "build" / "paper"
RTAMT = ROOT / "build" / "peers" / "rtamt" / "bin" / "python"
CASES = {
    "The service robot in ROS": "examples/service_robot/run.py",
    "The aircraft elevator in Simulink": "examples/elevator/run.py",
}
CLAIMS = {
    "a": {"robustness": 3, "output robustness": 3, "input vacuity": 0},
    "b": {"robustness": 1, "output robustness": "inf", "input vacuity": 1},
    "c": {"robustness": -2, "output robustness": -2},
    "d": {"robustness": -1, "output robustness": -2},
}
COLORS = {"this library": "#1f77b4", "RTAMT": "#ff7f0e"}


def measure(python: str | Path, quick: bool) -> dict[str, Any]:
    """Run experiments.py with an interpreter that has a package called rtamt."""
    command = [str(python), str(HERE / "experiments.py"), *(["--quick"] if quick else [])]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{python} failed:\n{done.stderr}")
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def report(found: dict[str, dict[str, Any]]) -> str:
    """Return the report as Markdown."""
    peer = "" if "RTAMT" in found else "\n\nRTAMT is not installed here: `make peers`, then once more."
    return "\n\n".join(
        [
            f"# The paper, run again\n\nBy `examples/paper/reproduce.py` on {platform.platform()}, Python "
            f"{platform.python_version()}, {os.cpu_count()} cores. Times are this machine's.{peer}",
            listing("Listing 1, dense time offline", "listing 1", found, "one robustness signal; no value is printed"),
            listing("Listing 2, dense time online in two chunks", "listing 2", found,
                    "no value is printed; by its own definition 3 from t = 5 on"),
            figure_4(found),
            table("Scaling of offline monitors, seconds", "scaling", found,
                  "time grows with the samples and the length of the formula; dense time is the slower one"),
            "![offline](scaling.png)",
            table("Online monitors, Python and C++: seconds a sample of always[0,k](a + b >= -2)", "windows", found,
                  "the C++ back end is about 10 times as fast as Python's, more for large k"),
            "![online](windows.png)",
            *(case(title, path) for title, path in CASES.items()),
        ]
    ) + "\n"  # fmt: skip


def listing(title: str, key: str, found: dict[str, dict[str, Any]], claim: str) -> str:
    """Return what a listing gives with each tool."""
    rows = "\n".join(f"- {tool}: `{json.dumps(values[key])}`" for tool, values in found.items())
    return f"## {title}\n\nThe paper: {claim}.\n\n{rows}"


def figure_4(found: dict[str, dict[str, Any]]) -> str:
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


def table(title: str, key: str, found: dict[str, dict[str, Any]], claim: str) -> str:
    """Return a table of times, a column a tool."""
    lines = [f"## {title}\n", f"The paper: {claim}.\n", "| case | " + " | ".join(found) + " |"]
    lines.append("|---|" + "---:|" * len(found))
    failed = [f"{tool}: {v[key]}" for tool, v in found.items() if not isinstance(v[key], dict)]
    for name in next(v[key] for v in found.values() if isinstance(v[key], dict)):
        values = [v[key].get(name) if isinstance(v[key], dict) else None for v in found.values()]
        lines.append(f"| {name} | " + " | ".join("-" if s is None else f"{s:.3g}" for s in values) + " |")
    return "\n".join([*lines, *failed])


def case(title: str, path: str) -> str:
    """Run the program of a case study and quote what it prints."""
    if not (ROOT / path).exists():
        return f"## {title}\n\n`{path}` is not here."
    done = subprocess.run([sys.executable, path], cwd=ROOT, capture_output=True, text=True, check=False)
    return f"## {title}\n\n`python {path}` (exit code {done.returncode}):\n\n```text\n{done.stdout}{done.stderr}```"


def draw_scaling(found: dict[str, dict[str, Any]]) -> None:
    """Draw the offline figure: time over samples, a line a formula and tool."""
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    for axes, domain in zip(figure.subplots(1, 2, sharey=True), ("discrete", "dense"), strict=True):
        for tool, values in found.items():
            if not isinstance(values["scaling"], dict):
                continue
            lines: dict[str, list[tuple[int, float]]] = {}
            for name, took in values["scaling"].items():
                kind, formula, size = name.split()
                if kind == domain:
                    lines.setdefault(formula, []).append((int(size), took))
            for style, (formula, points) in zip(("-", "--", "-.", ":"), lines.items(), strict=True):
                axes.loglog(
                    *zip(*points, strict=True),
                    style,
                    color=COLORS[tool],
                    marker=".",
                    label=f"{formula}, {tool}",
                )
        axes.set_title(f"{domain} time")
        axes.set_xlabel("samples")
    figure.axes[0].set_ylabel("seconds")
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside right upper", fontsize=7)
    figure.savefig(OUT / "scaling.png", dpi=150)


def draw_windows(found: dict[str, dict[str, Any]]) -> None:
    """Draw the online figure: time a sample over the bound."""
    figure = Figure(figsize=(5, 3.4), layout="constrained")
    axes = figure.subplots()
    for tool, values in found.items():
        if isinstance(values["windows"], dict):
            axes.loglog([int(k) for k in values["windows"]], list(values["windows"].values()), marker="o",
                        color=COLORS[tool], label=tool)  # fmt: skip
    axes.set_xlabel("k")
    axes.set_ylabel("seconds a sample")
    axes.legend()
    figure.savefig(OUT / "windows.png", dpi=150)


def main() -> None:
    """Measure, draw, write."""
    quick = "--quick" in sys.argv
    found = {"this library": measure(sys.executable, quick)}
    if RTAMT.exists():
        found["RTAMT"] = measure(RTAMT, quick)
    OUT.mkdir(parents=True, exist_ok=True)
    draw_scaling(found)
    draw_windows(found)
    (OUT / "REPORT.md").write_text(report(found), encoding="utf-8")
    print(OUT / "REPORT.md")


if __name__ == "__main__":
    main()
