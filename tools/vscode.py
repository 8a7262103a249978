"""Use the extension in a real Visual Studio Code, and draw docs/images/editor*.png: `make vscode`.

Visual Studio Code is code-server, which serves it as a page; npm installs it into build/vscode and compiles what it
needs, which takes minutes once. The extension is the package that users install. The language server is that of this
repository; the page is in the Chromium of the other images.
"""

from __future__ import annotations

import base64
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.unit.html_report.browser import chromium
from tools.images import IMAGES, shrink

if TYPE_CHECKING:
    from collections.abc import Iterator

ROOT = Path(__file__).parents[1]
FOLDER = ROOT / "build" / "vscode"
SERVER = FOLDER / "node_modules" / "code-server"
EXTENSION = ROOT / "editors" / "vscode" / "rtamt.vsix"

#: The last version for the Node.js 20 of Debian's and other long-term releases.
VERSION = "code-server@4.100.3"
#: The packages of code-server with a compiled part that is needed.
COMPILED = ("node-pty", "@vscode/spdlog", "native-watchdog", "@parcel/watcher")
PORT = 18_181
SECONDS = 60.0
WIDTH, HEIGHT = 1180, 720

SPECIFICATION = """\
specification cruise

input  float speed [km/h] in [0, 180]  // of the vehicle
input  float gap [m] in [0, 250]       // to the vehicle ahead
output float brake in [0, 1]

const float close = 30 [m]
near = gap < close

require REQ-1 "slows down": always(near and speed > 60 -> eventually[0:2s] brake > 0.5)
require REQ-2 "releases": always not not (gap > 100 -> brake < 0.1)
"""
SETTINGS = {
    "rtamt.command": [sys.executable, "-m", "rtamt", "lsp"],
    "workbench.startupEditor": "none",
    "workbench.colorTheme": "Default Light Modern",
    "workbench.layoutControl.enabled": False,
    "workbench.statusBar.visible": True,
    "security.workspace.trust.enabled": False,
    "chat.commandCenter.enabled": False,
    "editor.minimap.enabled": False,
    "editor.hover.delay": 100,
    "editor.occurrencesHighlight": "off",
    "editor.cursorBlinking": "solid",
    "git.enabled": False,
    "files.exclude": {"**/.vscode": True},
    "files.simpleDialog.enable": True,
    "files.autoSave": "off",
    "workbench.reduceMotion": "on",
}
#: Keys by their code in the protocol of the browser.
KEYS = {
    "Enter": 13,
    "Escape": 27,
    "End": 35,
    "Home": 36,
    "F2": 113,
    "F12": 123,
    "a": 65,
    "m": 77,
    "i": 73,
    "f": 70,
    ".": 190,
    " ": 32,
}
ALT, CONTROL, SHIFT = 1, 2, 8


def main() -> None:
    """Go through what an editor offers, check each answer, and draw the images."""
    install()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        work = Path(folder, "work")
        work.mkdir()
        (work / "cruise.stl").write_text(SPECIFICATION)
        (work / "drive.csv").write_text(recording())
        with served(Path(folder)), chromium(Path(folder, "browser")) as page:
            use(Code(page, work))


def use(code: Code) -> None:
    """Use the editor as a person would."""
    verdict = "✓ satisfied, robustness 0.4 (drive.csv)"
    code.click_on(".codelens-decoration a", "choose a recording")
    code.until_shown(".quick-input-title", "The recording on which requirements are checked")
    code.click_on(".quick-input-list .monaco-list-row", "drive.csv")
    code.until_shown(".codelens-decoration", verdict)
    code.press("m", CONTROL | SHIFT)
    code.until_shown(".markers-panel", "RT503")
    code.point_at("near and", 2)
    code.until_shown(".monaco-hover", "gap is less than close (30 m)")
    code.until(
        "document.getAnimations().every(each => each.playState === 'finished')"
    )  # it is no longer pale
    code.draw("editor.png")

    code.click("not not", 1)  # a quick fix
    code.press(".", CONTROL)
    code.until_shown(".action-widget", "Fix RT503: a double negation")
    code.press("Enter")
    code.until_shown(".view-line", "always (gap > 100")

    code.press("i", CONTROL | SHIFT)  # the layout
    code.until_shown(".view-line", "input float speed")

    code.click_on(".codelens-decoration a", "check against drive.csv")
    code.until_shown(".codelens-decoration", verdict)

    code.click("< close", 3)  # the definition
    code.press("F12")
    code.until_shown(".statusbar-item", "Ln 7, Col 13")

    code.press("F2")  # another name
    code.until("document.activeElement.classList.contains('rename-input')")
    code.write("least")
    code.press("Enter")
    code.until_shown(".view-line", "near = gap < least")

    code.click("eventually", 2)  # which has no other name
    code.press("F2")
    code.until_shown(".monaco-editor-overlaymessage", "there is no name here that can be renamed")

    code.press("End", CONTROL)  # errors, and a column of the recording
    code.write("require REQ-3: always(gap > )\nrequire REQ-4: always(spede > 3 -> en")
    code.until_shown(".suggest-widget.visible .monaco-list-row", "engine temp")
    code.until_shown(".markers-panel", "'spede' is not declared; did you mean 'speed'?")
    code.draw("editor_completion.png")
    code.click_on(".suggest-widget .monaco-list-row", "engine temp")
    code.until_shown(".view-line", 'float "engine temp"')
    code.until_shown(".view-line", '-> "engine temp"')


def recording() -> str:
    """Return a drive towards a slow vehicle, as CSV."""
    rows = ["time,speed,gap,brake,engine temp"]
    for k in range(41):
        gap = 120 - 4 * k if k < 28 else 8 + 6 * (k - 28)
        rows.append(
            f"{k / 2:g},{100 - 1.5 * k:g},{gap},{0.9 if k > 24 and gap < 40 else 0.0},{80 + k / 10:g}"
        )
    return "\n".join(rows) + "\n"


# ---- the editor ----------------------------------------------------------------------------------


class Code:
    """The page of an editor with one file."""

    def __init__(self, page: Any, work: Path) -> None:
        self.page, self.work = page, work
        page.send(
            "Emulation.setDeviceMetricsOverride",
            width=WIDTH,
            height=HEIGHT,
            deviceScaleFactor=1,
            mobile=False,
        )
        page.send("Runtime.enable")
        file = f"vscode-remote://127.0.0.1:{PORT}{work}/cruise.stl"
        page.send(
            "Page.navigate", url=f'http://127.0.0.1:{PORT}/?folder={work}&payload=[["openFile","{file}"]]'
        )

    def until(self, condition: str) -> Any:
        """Return the value of an expression of JavaScript once it is true."""
        end = time.monotonic() + SECONDS
        while not (found := self.page.run(condition)):
            if time.monotonic() > end:
                self.draw("../../build/vscode/failed.png")
                raise AssertionError(f"this does not come true in the editor: {condition}")
            time.sleep(0.05)
        return found

    def until_shown(self, selector: str, text: str) -> None:
        """Wait for an element that has a text."""
        self.until(
            f"[...document.querySelectorAll({json.dumps(selector)})].some("
            f"e => e.innerText.replaceAll('\\u00a0', ' ').includes({json.dumps(text)}))"
        )

    def press(self, key: str, modifiers: int = 0) -> None:
        """Press a key."""
        names = {".": "Period", " ": "Space"}
        one = {
            "key": key.upper() if modifiers & SHIFT else key,
            "code": f"Key{key.upper()}" if key.isalpha() and len(key) == 1 else names.get(key, key),
            "windowsVirtualKeyCode": KEYS[key],
            "modifiers": modifiers,
        }
        self.page.send("Input.dispatchKeyEvent", type="rawKeyDown", **one)
        self.page.send("Input.dispatchKeyEvent", type="keyUp", **one)

    def write(self, text: str) -> None:
        """Write a text, a character at a time."""
        for each in text:
            self.page.send("Input.dispatchKeyEvent", type="char", text="\r" if each == "\n" else each)

    def place_of(self, text: str, character: int = 0) -> tuple[float, float]:
        """Return where a character of the text is on the page."""
        found = self.until(
            f"""(() => {{
              const text = {json.dumps(text)};
              for (const line of document.querySelectorAll('.view-line')) {{
                const at = line.innerText.replaceAll('\\u00a0', ' ').indexOf(text);
                if (at < 0) continue;
                let left = at + {character};
                const walk = document.createTreeWalker(line, NodeFilter.SHOW_TEXT);
                for (let node = walk.nextNode(); node; node = walk.nextNode()) {{
                  if (left < node.length) {{
                    const range = document.createRange();
                    range.setStart(node, left); range.setEnd(node, left + 1);
                    const box = range.getBoundingClientRect();
                    return [box.x + box.width / 2, box.y + box.height / 2];
                  }}
                  left -= node.length;
                }}
              }}
              return null;
            }})()"""
        )
        return found[0], found[1]

    def point_at(self, text: str, character: int = 0) -> None:
        """Move the pointer to a character of the text."""
        x, y = self.place_of(text, character)
        self.page.mouse("mouseMoved", x - 3, y)
        self.page.mouse("mouseMoved", x, y)

    def click(self, text: str, character: int = 0) -> None:
        """Click at a character of the text."""
        x, y = self.place_of(text, character)
        self.page.mouse("mouseMoved", x, y)
        self.page.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        self.page.mouse("mouseReleased", x, y, button="left", clickCount=1)

    def click_on(self, selector: str, text: str) -> None:
        """Click on an element that has a text."""
        found = self.until(
            f"(e => e && [e.getBoundingClientRect()].map(b => [b.x + b.width / 2, b.y + b.height / 2])[0])("
            f"[...document.querySelectorAll({json.dumps(selector)})].find("
            f"e => e.innerText.replaceAll('\\u00a0', ' ').includes({json.dumps(text)})))"
        )
        self.page.mouse("mouseMoved", *found)
        self.page.mouse("mousePressed", *found, button="left", buttons=1, clickCount=1)
        self.page.mouse("mouseReleased", *found, button="left", clickCount=1)

    def draw(self, name: str) -> None:
        """Save what the page shows."""
        path = IMAGES / name
        path.write_bytes(base64.b64decode(self.page.send("Page.captureScreenshot")["data"]))
        shrink(path, 256)


@contextmanager
def served(folder: Path) -> Iterator[None]:
    """Serve Visual Studio Code with the extension; its data is in a folder."""
    data, extensions = folder / "data", folder / "extensions"
    (data / "User").mkdir(parents=True)
    (data / "User" / "settings.json").write_text(json.dumps(SETTINGS))
    command = [
        "node", str(SERVER / "out" / "node" / "entry.js"), "--user-data-dir", str(data),
        "--extensions-dir", str(extensions),
    ]  # fmt: skip
    environment = {**os.environ, "HOME": str(folder)}
    quiet: dict[str, Any] = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "env": environment}
    subprocess.run([*command, "--install-extension", str(EXTENSION)], check=True, **quiet)
    options = [
        "--auth",
        "none",
        "--bind-addr",
        f"127.0.0.1:{PORT}",
        "--disable-telemetry",
        "--disable-update-check",
    ]
    with subprocess.Popen([*command, *options], **quiet) as process:
        try:
            yield
        finally:
            process.terminate()


def install() -> None:
    """Install Visual Studio Code into build/vscode, unless it is there."""
    if not (SERVER / "installed").exists():
        FOLDER.mkdir(parents=True, exist_ok=True)
        npm(FOLDER, "install", "--ignore-scripts", "--prefix", str(FOLDER), VERSION)
        npm(FOLDER, "rebuild", "argon2")
        code = SERVER / "lib" / "vscode"
        for folder in (code, code / "extensions"):
            npm(folder, "install", "--omit=dev", "--ignore-scripts")
            (folder / "node_modules.asar").symlink_to("node_modules")
        npm(code, "rebuild", *COMPILED)
        (SERVER / "installed").touch()


def npm(folder: Path, *arguments: str) -> None:
    """Run npm in a folder."""
    subprocess.run([shutil.which("npm") or "npm", *arguments], cwd=folder, check=True)


if __name__ == "__main__":
    main()
