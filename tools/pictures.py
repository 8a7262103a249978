"""Draws the pictures of README.md and the documentation into docs/images: `make pictures`."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

from matplotlib.figure import Figure
from PIL import Image

import rtamt
from rtamt.cli import main

IMAGES = Path(__file__).parents[1] / "docs" / "images"

README = "always((req >= 3) -> eventually[0:2](gnt >= 3))"
FIVE = {"time": [0, 1, 2, 3, 4], "req": [0, 6, 0, 0, 0], "gnt": [0, 0, 0, 1, 7]}

SPEC = "asked = req >= 3; always(asked -> eventually[0:5](gnt >= 3))"
DATA = {"req": [0, 6, 6, 0, 0, 0, 0, 0, 0, 5, 0, 0], "gnt": [0, 0, 0, 0, 4, 4, 0, 0, 0, 0, 1, 2]}
DENSE = {"req": [[0, 0], [2, 6], [4, 0], [10, 0]], "gnt": [[0, 0], [6, 6], [8, 0], [10, 0]]}


def draw() -> None:
    """Draw them all."""
    IMAGES.mkdir(exist_ok=True)
    discrete = rtamt.parse(SPEC).evaluate(DATA)
    dense = rtamt.parse(SPEC.replace("5", "2"), time="dense").evaluate(DENSE)
    save(rtamt.parse(README).evaluate(FIVE).plot(rows=3, figure=Figure()), "plot.png")
    save(dense.plot(rows=3, figure=Figure()), "plot_dense.png")
    save(discrete.plot_tree(figure=Figure()), "tree.png")
    photograph("report.png")


def save(figure: Figure, name: str) -> None:
    """Write a figure."""
    figure.savefig(IMAGES / name, dpi=90)
    shrink(IMAGES / name)


def photograph(name: str) -> None:
    """Write what a browser shows of a report."""
    browser = shutil.which("chromium")
    if browser is None:
        raise SystemExit(
            "error: the picture of the report needs Chromium; install it as root: apt-get install chromium"
        )
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        spec, log, page = (Path(folder, part) for part in ("response.stl", "drive.csv", "report.html"))
        spec.write_text(f"specification response; {SPEC}")
        rows = zip(range(12), DATA["req"], DATA["gnt"], strict=True)
        log.write_text("time,req,gnt\n" + "".join(f"{t},{req},{gnt}\n" for t, req, gnt in rows))
        main(["report", str(spec), str(log), "-o", str(page)])
        page.write_text(page.read_text().replace(f"{folder}/", ""))
        # As root there is no sandbox.
        options = [
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--hide-scrollbars",
            "--window-size=1000,1560",
        ]
        command = [browser, *options, f"--user-data-dir={folder}/profile", f"--screenshot={IMAGES / name}"]
        subprocess.run([*command, page.as_uri()], check=True, capture_output=True, timeout=120)
    shrink(IMAGES / name)


def shrink(path: Path) -> None:
    """Keep 64 colours, which is all that such pictures have."""
    Image.open(path).convert("RGB").quantize(64).save(path, optimize=True)


if __name__ == "__main__":
    draw()
