"""Create the images of README.md and the documentation in docs/images: `make images`."""

from __future__ import annotations

import base64
import contextlib
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

import rtamt
from rtamt.cli import main

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.unit.docs.pages import FILES, Page
from tests.unit.html_report.browser import chromium
from tools import patterns, signal_patterns, walkthrough

from rtamt.analysis import diff
from rtamt.mining import mine
from rtamt.notebook import view
from rtamt.notebook.static import StaticView

IMAGES = Path(__file__).parents[1] / "docs" / "images"

#: Pages of docs/how-to, with the plot that the page writes and shows.
HOW_TO = {
    "convert": "pump.png",
    "describe": "described.png",
    "lint": "ranges.png",
    "mutate": "matrix.png",
    "simulators": "drive.png",
}

README = "always((req >= 3) -> eventually[0:2](gnt >= 3))"
FIVE = {"time": [0, 1, 2, 3, 4], "req": [0, 6, 0, 0, 0], "gnt": [0, 0, 0, 1, 7]}

SPEC = "asked = req >= 3; always(asked -> eventually[0:5](gnt >= 3))"
DATA = {"req": [0, 6, 6, 0, 0, 0, 0, 0, 0, 5, 0, 0], "gnt": [0, 0, 0, 0, 4, 4, 0, 0, 0, 0, 1, 2]}
#: Two grants are missing, and the others are measured with an error.
PARTLY_KNOWN = {**DATA, "gnt": [0, 0, 0, 0, None, None, 0, 0, 0, 0, 1, 2]}
DENSE = {"req": [[0, 0], [2, 6], [4, 0], [10, 0]], "gnt": [[0, 0], [6, 6], [8, 0], [10, 0]]}


def draw() -> None:
    """Draw them all."""
    IMAGES.mkdir(exist_ok=True)
    discrete = rtamt.parse(SPEC).evaluate(DATA)
    dense = rtamt.parse(SPEC.replace("5", "2"), time="dense").evaluate(DENSE)
    save(rtamt.parse(README).evaluate(FIVE).plot(rows=3, figure=Figure()), "plot.png")
    save(dense.plot(rows=3, figure=Figure()), "plot_dense.png")
    known = {"ranges": {"gnt": (0, 6)}, "uncertainty": {"gnt": 0.5}}
    save(rtamt.parse(SPEC).evaluate(PARTLY_KNOWN, **known).plot(rows=3, figure=Figure()), "plot_bounds.png")
    save(discrete.plot_tree(figure=Figure()), "tree.png")
    walkthrough.draw(IMAGES / "early.gif")
    patterns.draw(IMAGES)
    signal_patterns.draw(IMAGES)
    analysis()
    failed_test()
    mining()
    how_to()
    learning()
    notebook()
    gallery()
    reports()
    play()


def analysis() -> None:
    """Draw the trace on which the two versions of docs/how-to/analyze.md disagree."""
    page = (IMAGES.parent / "how-to" / "analyze.md").read_text(encoding="utf-8")
    old, new = (rtamt.parse(text) for text in re.findall(r"```stl title=.*?\n(.*?)```", page, re.DOTALL))
    found = next(each for each in diff(old, new, samples=60).findings if each.witness is not None)
    save(found.witness.plot(Figure()), "analyze.png")


def failed_test() -> None:
    """Run the tests of docs/how-to/pytest.md, one of which fails and is plotted."""
    page = (IMAGES.parent / "how-to" / "pytest.md").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        for name, text in re.findall(r"```\w+ title=\"(.*?)\"\n(.*?)```", page, re.DOTALL):
            Path(folder, name).write_text(text, encoding="utf-8")
        run = [sys.executable, "-m", "pytest", "-q", "--stl-plots=plots"]
        subprocess.run(run, cwd=folder, check=False, stdout=subprocess.DEVNULL)
        (plot,) = Path(folder).glob("plots/*.png")
        shrink(plot)
        shutil.move(plot, IMAGES / "pytest.png")


def mining() -> None:
    """Draw the front of docs/how-to/mine.md, from the recordings of that page."""
    page = (IMAGES.parent / "how-to" / "mine.md").read_text(encoding="utf-8")
    record, template = (
        re.search(begin + r"\n(.*?)```", page, re.DOTALL)
        for begin in ("```python", '```stl title="settle.stl"')
    )
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        exec(compile(record[1], "mine.md", "exec"), {})  # noqa: S102 - our own page
        recordings = {path.name: rtamt.read(path) for path in sorted(Path(folder).glob("step*.csv"))}
        found = mine(rtamt.parse(template[1]), recordings, resolutions={"band": 0.01}, points=8)
    save(found.plot().figure, "mine.png")


def how_to() -> None:
    """Run pages of docs/how-to, and keep the plot that each one writes."""
    for name, plot in HOW_TO.items():
        page = IMAGES.parent / "how-to" / f"{name}.md"
        with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
            Path("examples").symlink_to(IMAGES.parents[1] / "examples")
            if (FILES / name).is_dir():
                shutil.copytree(FILES / name, folder, dirs_exist_ok=True)
            Page(page.name, page.read_text(encoding="utf-8")).run()
            shrink(Path(plot))
            shutil.move(plot, IMAGES / f"{name}.png")


def learning() -> None:
    """Draw the learning curves of docs/how-to/learning.md, from the table that training wrote."""
    folder = IMAGES.parents[1] / "examples" / "learning"
    image = IMAGES / "learning.png"
    subprocess.run([sys.executable, folder / "plot.py", folder / "curves.csv", image], check=True)
    shrink(image)


def notebook() -> None:
    """Photograph the view of docs/how-to/notebooks.md."""
    page = (IMAGES.parent / "how-to" / "notebooks.md").read_text(encoding="utf-8")
    names: dict[str, object] = {}
    for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL):
        exec(compile(block, "notebooks.md", "exec"), names)  # noqa: S102 - our own page
    shown = view(names["result"], height=900)
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "view.html")
        file.write_text(
            f"<!DOCTYPE html><body>{StaticView(shown.page, '', 900)._repr_html_()}", encoding="utf-8"
        )
        with chromium(Path(folder, "profile")) as browser:
            browser.send(
                "Emulation.setDeviceMetricsOverride", width=900, height=920, deviceScaleFactor=1, mobile=False
            )
            browser.open(file.as_uri())
            time.sleep(1)  # the frame draws its charts
            browser.screenshot(IMAGES / "notebook.png")
    shrink(IMAGES / "notebook.png")


def gallery() -> None:
    """Run the code of the gallery, which writes its images to the current directory."""
    page = (IMAGES.parent / "how-to" / "gallery.md").read_text(encoding="utf-8")
    names: dict[str, object] = {}
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL):
            exec(compile(block, "gallery.md", "exec"), names)  # noqa: S102 - our own page
        for path in Path(folder).glob("gallery_*.png"):
            shrink(path)
            shutil.move(path, IMAGES / path.name)


def save(figure: Figure, name: str) -> None:
    """Write a figure."""
    figure.savefig(IMAGES / name, dpi=90)
    shrink(IMAGES / name)


def reports() -> None:
    """Draw a report of one requirement, of ten on six traces, and of 10^6 samples, as a browser shows them."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder, contextlib.chdir(folder):
        Path("response.stl").write_text(f"specification response; {SPEC}")
        rows = zip(range(12), DATA["req"], DATA["gnt"], strict=True)
        Path("drive.csv").write_text("time,req,gnt\n" + "".join(f"{t},{req},{gnt}\n" for t, req, gnt in rows))
        photograph(["response.stl", "drive.csv"], "report.png", (1000, 1500))
        limits = [80, 85, 88, 92, 97, 101, 104, 109, 115, 120]
        Path("limits.stl").write_text(
            "".join(
                f'require SPEED-{i} "back below {limit} km/h within 5 s":'
                f" always(speed >= {limit} -> eventually[0:5](speed <= {limit}));\n"
                for i, limit in enumerate(limits, 1)
            )
        )
        traces = []
        for k in range(6):
            traces.append(f"drive_{k + 1}.csv")
            speed = 80 + (18 + 5 * k) * np.sin(np.arange(3000) / (18 + 9 * k)) * np.sin(
                np.arange(3000) / 700 + k
            )
            Path(traces[-1]).write_text(
                "time,speed\n" + "".join(f"{i / 10},{v:.2f}\n" for i, v in enumerate(speed))
            )
        photograph(["limits.stl", *traces, "--period", "100ms"], "report_matrix.png", (1000, 640))
        speed = (
            np.random.default_rng(1).normal(0, 0.4, 1_000_000) + 80 + 9 * np.sin(np.arange(1_000_000) / 3000)
        )
        speed[432_100:432_160] = 97 + np.arange(60) / 40
        np.savetxt(
            "long.csv",
            np.c_[np.arange(1_000_000) / 100, speed],
            "%.6g",
            ",",
            header="time,speed",
            comments="",
        )
        Path("long.stl").write_text("require LIMIT: always(speed >= 95 -> eventually[0:200ms](speed <= 95));")
        photograph(
            ["long.stl", "long.csv", "--period", "10ms"], "report_zoom.png", (1000, 760),
            "document.querySelector('.go[data-go^=\"0 \"] button').click();"
            "document.getElementById('theme').click();"
            "press('a'); for (let i = 0; i < 12; i++) press('ArrowRight'); press('b');"
            "document.querySelector('body > header').hidden = document.querySelector('main section').hidden = true;",
        )  # fmt: skip


def photograph(arguments: list[str], name: str, size: tuple[int, int], script: str = "") -> None:
    """Write what a browser shows of a report; ``script`` runs when its card is drawn."""
    page = Path("report.html").resolve()
    main(["report", *arguments, "-o", str(page)])
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile, chromium(Path(profile)) as tab:
        width, height = size
        tab.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )
        tab.open(page.as_uri())
        time.sleep(4)
        if script:
            tab.run(
                "const press = (key) => document.querySelector('.body')"
                f".dispatchEvent(new KeyboardEvent('keydown', {{key}})); {script}"
            )
            time.sleep(2)
        (IMAGES / name).write_bytes(base64.b64decode(tab.send("Page.captureScreenshot")["data"]))
    shrink(IMAGES / name)


def play() -> None:
    """Draw the page of `rtamt play` with its example, at an instant at which some verdicts are pending."""
    command = [sys.executable, "-m", "rtamt", "play", "--no-browser"]
    ready = "document.querySelectorAll('.run-bad').length > 0"
    scrub = "(e => { e.value = 667; e.dispatchEvent(new Event('input')); })(document.getElementById('at'))"
    with (
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile,
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server,
        chromium(Path(profile)) as tab,
    ):
        assert server.stdout is not None
        tab.send(
            "Emulation.setDeviceMetricsOverride", width=1200, height=1150, deviceScaleFactor=1, mobile=False
        )
        tab.open(server.stdout.readline().strip())
        for script, condition in (("0", ready), (scrub, "document.querySelectorAll('.whisker').length > 0")):
            tab.run(script)
            while not tab.run(condition):
                time.sleep(0.05)
        (IMAGES / "play.png").write_bytes(base64.b64decode(tab.send("Page.captureScreenshot")["data"]))
        server.terminate()
    shrink(IMAGES / "play.png", 256)


def shrink(path: Path, colors: int = 64) -> None:
    """Reduce an image to few colors; 64 are enough for plots."""
    Image.open(path).convert("RGB").quantize(colors).save(path, optimize=True)


if __name__ == "__main__":
    draw()
