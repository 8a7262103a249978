"""Open files and views in other tools, and draw docs/images/foxglove.png, rerun.png and jupyterlab.png: `make viewers`.

Foxglove Studio is its last public version, from npm, in the Chromium of the other images; Rerun is the viewer of
rerun-sdk, in a virtual screen with a software renderer. Their files are those of docs/how-to/telemetry.md. The notebook
in JupyterLab has the code of docs/how-to/notebooks.md.
"""

from __future__ import annotations

import base64
import contextlib
import os
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any

import nbformat
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
PORT = 18_182


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
        _until(tab, "document.body?.innerText.includes('satisfied')")
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


def jupyterlab(folder: Path) -> None:
    """Photograph JupyterLab after a cell has moved the view of another one."""
    page = (ROOT / "docs" / "how-to" / "notebooks.md").read_text(encoding="utf-8")
    code = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    notebook = nbformat.v4.new_notebook(
        metadata={"kernelspec": {"name": "python3", "display_name": "Python 3"}}
    )
    notebook.cells = [
        nbformat.v4.new_code_cell(code[0] + "shown"),
        nbformat.v4.new_code_cell(code[1].strip()),
    ]
    nbformat.write(notebook, folder / "brakes.ipynb")
    settings = {
        "ServerApp.port": PORT, "ServerApp.root_dir": folder, "IdentityProvider.token": "",
        "LabApp.check_for_updates_class": "jupyterlab.NeverCheckForUpdate",
    }  # fmt: skip
    command = [sys.executable, "-m", "jupyter", "lab", "--no-browser", "--allow-root"]
    command += [f"--{name}={value}" for name, value in settings.items()]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as server:
        try:
            _answers(PORT)
            with chromium(folder / "profile-jupyter") as tab:
                _run_cells(tab, f"http://127.0.0.1:{PORT}/doc/tree/brakes.ipynb", len(notebook.cells))
                box = tab.run("document.querySelector('.jp-NotebookPanel').getBoundingClientRect().toJSON()")
                clip = {**{name: box[name] for name in ("x", "y", "width")}, "height": 1080, "scale": 1}
                picture = base64.b64decode(tab.send("Page.captureScreenshot", clip=clip)["data"])
        finally:
            server.terminate()
    (IMAGES / "jupyterlab.png").write_bytes(picture)
    shrink(IMAGES / "jupyterlab.png", 128)


def _answers(port: int) -> None:
    """Wait until a server listens."""
    until = time.monotonic() + SECONDS
    while time.monotonic() < until:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port)):
            return
        time.sleep(0.5)
    raise AssertionError(f"nothing listens on port {port}")


def _run_cells(tab: Any, url: str, count: int) -> None:
    """Run the cells of a notebook one by one, and scroll to its view."""
    size = {"width": 1200, "height": 1320}  # with the list of files, which is cut off
    tab.send("Emulation.setDeviceMetricsOverride", **size, deviceScaleFactor=1, mobile=False)
    tab.send("Page.navigate", url=url)
    _until(tab, f"document.querySelectorAll('.jp-CodeCell').length === {count}")
    for number in range(count):
        cell = f"document.querySelectorAll('.jp-CodeCell')[{number}]"
        prompt = f"{cell}.querySelector('.jp-InputPrompt').textContent"
        while not tab.run(f"/[*\\d]/.test({prompt})"):  # a kernel that starts ignores keys
            tab.run(f"{cell}.querySelector('.cm-content').focus()")
            for kind in ("keyDown", "keyUp"):  # Shift and Enter
                tab.send(
                    "Input.dispatchKeyEvent",
                    type=kind,
                    key="Enter",
                    code="Enter",
                    modifiers=8,
                    windowsVirtualKeyCode=13,
                )
            time.sleep(2)
        _until(tab, f"/\\d/.test({prompt})")
        _until(tab, "document.querySelector('.jp-OutputArea iframe')?.srcdoc.length > 1000")
        time.sleep(3)  # the frame draws its charts
    tab.run("document.querySelector('.jp-CodeCell').scrollIntoView()")
    time.sleep(1)


def _until(tab: Any, condition: str) -> None:
    until = time.monotonic() + SECONDS
    while not tab.run(condition):
        assert time.monotonic() < until, condition
        time.sleep(0.3)


def draw() -> None:
    """Draw all, or those that are named."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as name:
        folder = Path(name)
        export(folder)
        for each in (foxglove, rerun, jupyterlab):
            if each.__name__ in (sys.argv[1:] or [each.__name__]):
                each(folder)


if __name__ == "__main__":
    draw()
