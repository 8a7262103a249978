"""The time of an update of ``rtamt play``: of the evaluation alone, and from the request to the drawn page in Chromium.

    python benchmarks/play.py [SAMPLES]

Run on an idle machine. The figure to reach: 50 ms for 10^4 samples.
"""

from __future__ import annotations

import math
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.unit.html_report.browser import chromium

from rtamt.play.request_handler import RequestHandler

TEXT = "always(req >= 3 -> eventually[0:5](gnt >= 3))"
ROUNDS = 40


def main(samples: int) -> None:
    """Measure, and print a table."""
    waves = [[math.sin(i / 50) * 4 + 1, math.sin((i - 20) / 50) * 4 + 2] for i in range(samples)]
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        path = Path(folder, "waves.csv")
        rows = "".join(f"{i},{req:.4f},{gnt:.4f}\n" for i, (req, gnt) in enumerate(waves))
        path.write_text(f"time,req,gnt\n{rows}")
        print(f"{samples} samples of two signals, {TEXT}; medians of {ROUNDS} (and the range)")
        wall, processor = zip(*alone(path), strict=True)
        shown("evaluation and explanation in the worker", *wall)
        shown("the same, processor time", *processor)
        shown("request, answer and drawing in Chromium", *in_page(path, Path(folder, "profile")))


def shown(what: str, *times: float) -> None:
    """Print one row."""
    print(f"{what:<45} {statistics.median(times):6.1f} ms ({min(times):.1f} to {max(times):.1f} ms)")


def alone(path: Path) -> list[tuple[float, float]]:
    """Return the times of the answers without a server, in milliseconds: of the clock, and of the processor."""
    handler, file = RequestHandler(), {"number": 1, "path": str(path), "name": path.name}
    message = {"text": TEXT, "time": "discrete", "duration": 0, "recording": 1, "width": 700}
    handler.answer("evaluate", message, file)  # reads the file
    found = []
    for _ in range(ROUNDS):
        begun, used = time.perf_counter(), time.process_time()
        handler.answer("evaluate", message, file)
        found.append(((time.perf_counter() - begun) * 1e3, (time.process_time() - used) * 1e3))
    return found


def in_page(path: Path, profile: Path) -> list[float]:
    """Return the times that the page measures, from sending a request until its answer is drawn."""
    command = [sys.executable, "-m", "rtamt", "play", TEXT, str(path), "--no-browser"]
    found = []
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server, chromium(profile) as tab:
        assert server.stdout is not None
        tab.open(server.stdout.readline().strip())
        updates = "Number(document.documentElement.dataset.updates || 0)"
        for number in range(ROUNDS + 3):
            text = TEXT.replace("gnt >= 3", f"gnt >= {3 + number / 100}")
            before = tab.run(updates)
            edit = f"e => {{ e.value = '{text}'; e.dispatchEvent(new Event('input')); }}"
            tab.run(f"({edit})(document.getElementById('text'))")
            while tab.run(updates) == before:
                time.sleep(0.01)
            time.sleep(0.5)  # the replay that follows is over
            found.append(float(tab.run("document.documentElement.dataset.took")))
        server.terminate()
    return found[3:]


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 10_000)
