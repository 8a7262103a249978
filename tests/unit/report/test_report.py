"""The page of ``rtamt report``: what it says without scripts, and how it behaves in a real browser."""

import json
import re
from html.parser import HTMLParser

import numpy as np
import pytest

import rtamt
from rtamt.cli import main
from rtamt.plot.scene import scene
from rtamt.report.data import data_of
from tests.unit.report.browser import CHROMIUM, chromium

ROWS = "time,req,gnt\n0,0,0\n1,6,0\n2,0,0\n3,0,1\n4,0,7\n"
SPEC = "asked = req >= 3; always(asked -> eventually[0:2](gnt >= 3))"


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    (folder / "answer.stl").write_text(SPEC)
    (folder / "bad & <b>.csv").write_text(ROWS)
    (folder / "good.csv").write_text(ROWS.replace("6", "2"))
    paths = [str(folder / name) for name in ("answer.stl", "bad & <b>.csv", "good.csv")]
    assert main(["report", *paths, "-o", str(folder / "report.html")]) == 1
    return folder / "report.html"


class Text(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.text, self.links, self.hidden = "", [], False
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        self.hidden = tag in ("script", "style")
        self.links += [value for name, value in attributes if name in ("src", "href") and value]

    def handle_endtag(self, _tag):
        self.hidden = False

    def handle_data(self, data):
        self.text += "" if self.hidden else data


def test_everything_can_be_read_without_scripts_and_nothing_is_loaded(report):
    page = Text(report.read_text())
    for sentence in (
        "1 satisfied, 1 violated",
        "violated by 2 at 0 s",
        "'gnt >= 3' is -2 at 3 s: the robustness follows it from -3 to 3",
        "'req >= 3' held at 1 s (3)",
        "asked = req >= 3",
        "bad & <b>.csv",
    ):
        assert sentence in page.text
    assert all(link.startswith("#") for link in page.links)


def test_a_trace_that_cannot_be_read_is_a_row_of_the_table(tmp_path, capsys):
    path = tmp_path / "report.html"
    assert main(["report", "x >= 3", str(tmp_path / "no.csv"), "-o", str(path)]) == 2
    told = capsys.readouterr()
    assert told.err == f"rtamt: there is no file '{tmp_path / 'no.csv'}'\n"
    assert told.out == f"{path}: 1 error\n"
    assert "1 error" in Text(path.read_text()).text


def test_a_page_that_cannot_be_written_is_one_sentence(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "log.csv").write_text(ROWS)
    assert main(["report", "req >= 0", "log.csv", "-o", "no/report.html"]) == 2
    assert capsys.readouterr().err == "rtamt: cannot write 'no/report.html': No such file or directory\n"


def test_a_large_recording_is_small_in_the_page_and_keeps_its_peaks():
    x = np.sin(np.arange(300_000))
    x[123_456] = -77
    data = data_of(scene(rtamt.parse("always(x >= -2)").evaluate({"x": x})))
    text = json.dumps(data, allow_nan=False)
    assert len(text) < 1_000_000
    assert min(data["panels"][0]["lines"][0]["y"]) == -77
    assert data["nodes"][1]["fails"] == [[123_455.5, 123_456.5]]


def test_infinities_are_text_and_dates_are_milliseconds():
    stamps = np.datetime64("2026-03-01T12:00") + np.arange(3) * np.timedelta64(1, "s")
    data = data_of(scene(rtamt.parse("prev(x >= 3)").evaluate({"time": stamps, "x": [5, 1, 4]})))
    assert data["nodes"][0]["line"]["y"] == ["inf", 2.0, -2.0]
    assert (data["dated"], data["origin"]) == (True, 1_772_366_400_000.0)


# ---- in a browser --------------------------------------------------------------------------------

needs_browser = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: apt-get install chromium")

SHOWN = (
    "[...document.querySelectorAll('#card-1 details svg')].filter(chart => chart.checkVisibility()).length"
)
PLACE = """(() => {
    const box = document.querySelector('#card-1 .chart svg').getBoundingClientRect();
    return [box.left, box.top, box.width];
})()"""
SETTLED = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
TIME = "document.querySelector('#card-1 output').textContent"


@needs_browser
def test_charts_zoom_fold_and_follow_the_explanation_in_a_real_browser(report, tmp_path):
    with chromium(tmp_path) as page:
        page.open(report.as_uri())
        assert page.run(TIME) == "0 s to 4 s"
        assert page.run(SHOWN) == 5

        left, top, width = page.run(PLACE)
        page.drag(left + 0.4 * width, left + 0.6 * width, top + 40)
        page.mouse("mouseMoved", left + 0.5 * width, 2)
        low, high = (float(number) for number in re.findall(r"[\d.]+", page.run(TIME)))
        assert 1 < low < high < 3
        page.run(
            "[...document.querySelectorAll('#card-1 .tools button')].find(b => b.textContent === 'all').click()"
        )
        assert page.run(TIME) == "0 s to 4 s"

        page.run("document.querySelectorAll('#card-1 summary')[1].click()")
        page.run(SETTLED)
        assert page.run(SHOWN) == 1
        page.run("[...document.querySelectorAll('#card-1 a.go')].at(-1).click()")
        page.run(SETTLED)
        assert page.run(SHOWN) == 5
        assert page.run(TIME) == "1 s"

        page.run("document.querySelector('#card-1').focus()")
        page.send("Input.dispatchKeyEvent", type="keyDown", key="ArrowRight")
        assert page.run(TIME) == "2 s"
        told = page.run("[...document.querySelectorAll('#card-1 details .told')].map(t => t.textContent)")
        assert told == ["4", "4", "−3", "4", "−3"]
        page.screenshot(tmp_path / "page.png")
        assert page.errors == []
        assert page.requests == [report.as_uri()]
