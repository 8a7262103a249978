"""Open exported files in Foxglove Studio and Rerun, and draw docs/images/foxglove.png and rerun.png: `make viewers`.

Foxglove Studio is its last public version, from npm, in the Chromium of the other images; Rerun is the viewer of
rerun-sdk, in a virtual screen with a software renderer. The files are those of docs/how-to/telemetry.md.
"""

from __future__ import annotations

import base64
import contextlib
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING

from PIL import Image

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.unit.html_report.browser import chromium
from tools.images import IMAGES, shrink

from rtamt.cli import main

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "build" / "foxglove"
#: Foxglove Studio with everything it loads, and the version of React that it was built for.
PACKAGES = ("@foxglove/studio-base@1.48.0", "react@17.0.2", "react-dom@17.0.2")
WIDTH, HEIGHT = 1400, 900
SECONDS = 60.0


class Ranges(SimpleHTTPRequestHandler):
    """Serves files and parts of them, as readers of MCAP ask for."""

    def log_message(self, *_: object) -> None:
        """Log nothing."""

    def end_headers(self) -> None:
        """Offer parts of files."""
        self.send_header("Accept-Ranges", "bytes")
        super().end_headers()

    def do_GET(self) -> None:
        """Answer a request for a file or a part of it."""
        path = Path(self.translate_path(self.path))
        asked = re.fullmatch(r"bytes=(\d+)-(\d*)", self.headers.get("Range", ""))
        if asked is None or not path.is_file():
            super().do_GET()
            return
        content = path.read_bytes()
        first = int(asked[1])
        part = content[first : int(asked[2]) + 1 if asked[2] else None]
        self.send_response(206)
        self.send_header("Content-Range", f"bytes {first}-{first + len(part) - 1}/{len(content)}")
        self.send_header("Content-Length", str(len(part)))
        self.end_headers()
        self.wfile.write(part)


@contextlib.contextmanager
def served(folder: Path) -> Iterator[str]:
    """Serve a folder; gives its address."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Ranges, directory=folder))
    Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield f"http://127.0.0.1:{server.server_port}"
    finally:
        server.shutdown()


def export(folder: Path) -> None:
    """Write the files of the page on telemetry."""
    page = (ROOT / "docs" / "how-to" / "telemetry.md").read_text(encoding="utf-8")
    spec, record = (
        re.search(begin + r"\n(.*?)```", page, re.DOTALL)
        for begin in ('```stl title="drive.stl"', "```python")
    )
    assert spec is not None
    assert record is not None
    with contextlib.chdir(folder):
        Path("drive.stl").write_text(spec[1], encoding="utf-8")
        exec(compile(record[1], "telemetry.md", "exec"), {})  # noqa: S102 - our own page
        files = ["-o", "drive.mcap", "--layout", "layout.json", "--rerun", "drive.rrd"]
        main(["export", "drive.stl", "drive.csv", *files])


def foxglove(folder: Path) -> None:
    """Photograph Foxglove Studio with the recording and its layout."""
    if not (FOLDER / "node_modules" / "@foxglove").is_dir():
        FOLDER.mkdir(parents=True, exist_ok=True)
        install = ["npm", "install", "--no-audit", "--no-fund", "--ignore-scripts", *PACKAGES]
        subprocess.run(install, cwd=FOLDER, check=True, stdout=subprocess.DEVNULL)
    (folder / "node_modules").symlink_to(FOLDER / "node_modules")
    shutil.copy(ROOT / "tools" / "foxglove.html", folder / "index.html")
    with served(folder) as address, chromium(folder / "profile") as tab:
        tab.send(
            "Emulation.setDeviceMetricsOverride",
            width=WIDTH,
            height=HEIGHT,
            deviceScaleFactor=1,
            mobile=False,
        )
        tab.send("Page.navigate", url=f"{address}/index.html")
        until = time.monotonic() + SECONDS
        while not tab.run("document.body?.innerText.includes('satisfied') || false"):
            assert time.monotonic() < until, "Foxglove Studio shows no verdict"
            time.sleep(0.5)
        for kind in ("mousePressed", "mouseReleased"):  # close the side bar
            tab.mouse(kind, 24, 24, button="left", clickCount=1)
        time.sleep(5)  # it draws its plots
        (IMAGES / "foxglove.png").write_bytes(base64.b64decode(tab.send("Page.captureScreenshot")["data"]))
    shrink(IMAGES / "foxglove.png", 128)


def rerun(folder: Path) -> None:
    """Photograph the viewer of Rerun with the recording and its layout."""
    viewer = Path(sys.executable).with_name("rerun")
    shot = folder / "rerun.png"
    screen = ["xvfb-run", "-a", "-s", f"-screen 0 {WIDTH}x{HEIGHT}x24"]
    options = ["--port", "auto", "--window-size", f"{WIDTH}x{HEIGHT}", "--screenshot-to", str(shot)]
    subprocess.run(
        [*screen, str(viewer), str(folder / "drive.rrd"), *options],
        check=True,
        env={**os.environ, "WGPU_BACKEND": "vulkan"},
        stderr=subprocess.DEVNULL,
        timeout=4 * SECONDS,
    )
    Image.open(shot).resize((WIDTH, HEIGHT), Image.Resampling.LANCZOS).save(IMAGES / "rerun.png")
    shrink(IMAGES / "rerun.png", 256)


def draw() -> None:
    """Draw both."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        export(folder)
        foxglove(folder)
        rerun(folder)


if __name__ == "__main__":
    draw()
