"""The page of ``rtamt play`` in a real browser: one server and one browser for all tests."""

import signal
import subprocess
import sys

import pytest

from tests.unit.html_report.browser import chromium
from tests.unit.play.page_actions import open_page


@pytest.fixture(scope="package")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("play")
    rows = "".join(f"{i / 10},{i % 50}\n" for i in range(200))
    (folder / "speeds.csv").write_text(f"time,speed [m/s]\n{rows}")
    (folder / "broken.csv").write_text("")
    return folder


@pytest.fixture(scope="package")
def address():
    command = [sys.executable, "-m", "rtamt", "play", "--no-browser"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        yield process.stdout.readline().strip()
        process.send_signal(signal.SIGINT)
        assert process.wait(30) == 0
        assert process.stderr.read() == ""


@pytest.fixture(scope="package")
def browser(folder):
    with chromium(folder / "profile") as page:
        yield page


@pytest.fixture
def page(browser, address):
    """The page as it starts, with the example evaluated."""
    return open_page(browser, address)
