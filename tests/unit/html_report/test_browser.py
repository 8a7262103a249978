"""The page of ``rtamt report`` in a real browser."""

import re
import time
from importlib.resources import files

import numpy as np
import pytest

from rtamt.cli import main
from tests.unit.html_report.browser import CHROMIUM, chromium

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: apt-get install chromium")

SMALL = "time,req,gnt,speed [m/s]\n0,0,0,1\n1,6,0,2.5\n2,0,0,3\n3,0,1,4\n4,0,7,5\n"
SPEC = "asked = req >= 3; always(asked -> eventually[0:2](gnt >= 3))"
N = 40_000

SETTLED = (
    "new Promise(done => setTimeout(() => requestAnimationFrame(() => requestAnimationFrame(done)), 60))"
)
BAR = "document.querySelector('details[open] .tools output').textContent"
NOTES = "[...document.querySelectorAll('details[open] .legend > .quiet')].map(note => note.textContent)"
CARDS = "[...document.querySelectorAll('details.card')].filter(card => card.checkVisibility())"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("pages")


@pytest.fixture(scope="module")
def page(folder):
    with chromium(folder / "profile") as page:
        page.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(folder))
        yield page


def open_page(page, path, fragment=""):
    page.errors.clear()
    page.requests.clear()
    page.open("about:blank")
    page.open(path.as_uri() + fragment)
    page.run(SETTLED)
    return page


def press(page, name):
    page.run(
        f"[...document.querySelectorAll('details[open] .tools button')].find(b => b.textContent === '{name}').click()"
    )
    page.run(SETTLED)


def key(page, name):
    page.run(
        f"document.querySelector('details[open] .body').dispatchEvent(new KeyboardEvent('keydown', {{key: '{name}'}}))"
    )
    page.run(SETTLED)


def plot(page, number=0):
    """The place of a chart's plotting area."""
    return page.run(
        f"(() => {{ const b = document.querySelectorAll('details[open] .u-over')[{number}].getBoundingClientRect();"
        " return [b.left, b.top, b.width, b.height]; })()"
    )


@pytest.fixture(scope="module")
def small(folder):
    (folder / "answer.stl").write_text(SPEC)
    for name, text in (("a & <b>.csv", SMALL), ("good.csv", SMALL.replace("6", "2"))):
        (folder / name).write_text(text)
    paths = [str(folder / name) for name in ("answer.stl", "good.csv", "a & <b>.csv")]
    assert main(["report", *paths, "-o", str(folder / "small.html")]) == 1
    return folder / "small.html"


@pytest.fixture(scope="module")
def large(folder):
    x = np.round(np.sin(np.arange(N) / 300) + np.random.default_rng(1).normal(0, 0.01, N), 4)
    x[12_345] = -7.25
    rows = "\n".join(f"{i / 100},{value}" for i, value in enumerate(x))
    (folder / "large.csv").write_text(f"time,x\n{rows}\n")
    paths = [str(folder / "large.csv"), "-o", str(folder / "large.html")]
    assert main(["report", "always(x >= -2)", "--period", "10ms", *paths]) == 1
    return folder / "large.html"


def test_the_violated_card_is_open_and_the_others_are_drawn_when_they_are_opened(page, small):
    open_page(page, small)
    assert page.run("document.querySelectorAll('details[open].card').length") == 1
    assert page.run("document.querySelectorAll('canvas').length") == 8
    page.run("document.querySelectorAll('details.card > summary')[1].click()")
    page.run(SETTLED)
    assert page.run("document.querySelectorAll('canvas').length") > 8
    assert page.errors == []
    assert set(page.requests) == {small.as_uri()}


@pytest.mark.parametrize(("low", "high", "ticks"), [(-49.7, 42.1, [-25, 0, 25]), (-1, 2, [-1, 0, 1, 2])])
def test_an_axis_of_values_has_two_ticks_or_more(page, low, high, ticks):
    script = files("rtamt.html_report").joinpath("times.js").read_text(encoding="utf-8")
    assert page.run(f"(() => {{ {script}\nreturn valueTicks({low}, {high}); }})()") == ticks


def test_charts_zoom_together_and_double_click_shows_all(page, small):
    open_page(page, small)
    assert page.run(BAR) == "0 s to 4 s"
    left, top, width, height = plot(page)
    page.drag(left + 0.4 * width, left + 0.6 * width, top + height / 2)
    page.mouse("mouseMoved", 5, 2)
    page.run(SETTLED)
    low, high = (float(number) for number in re.findall(r"[\d.]+", page.run(BAR)))
    assert 1 < low < high < 3
    press(page, "all")
    assert page.run(BAR) == "0 s to 4 s"


def test_two_marks_have_a_difference_and_keys_go_from_sample_to_sample(page, small):
    open_page(page, small)
    press(page, "violation")
    key(page, "a")
    for _ in range(2):
        key(page, "ArrowRight")
    key(page, "b")
    assert page.run(BAR) == "3 s · A 1 s · B 3 s · B−A 2 s"
    values = page.run(
        "[...document.querySelectorAll('details[open] .legend .value')].map(v => v.textContent)"
    )
    assert values[:2] == ["0  A 6  B 0  B−A −6", "1  A 0  B 1  B−A 1"]
    press(page, "clear")
    assert page.run(BAR) == "3 s"


def test_a_legend_hides_its_line_and_any_signal_can_be_added(page, small):
    open_page(page, small)
    page.run("document.querySelector('details[open] .legend .line').click()")
    assert (
        page.run("document.querySelector('details[open] .legend .line').getAttribute('aria-pressed')")
        == "false"
    )
    choose = """(() => {
        const select = document.querySelector('details[open] .legend select');
        select.dispatchEvent(new Event('focus'));
        const names = [...select.options].map(option => option.textContent);
        select.value = 'gnt';
        select.dispatchEvent(new Event('change'));
        return names;
    })()"""
    names = page.run(choose)
    assert names[:2] == ["add signal…", "gnt"]
    assert "robustness of gnt >= 3" in names
    page.run(SETTLED)
    legend = "[...document.querySelector('details[open] .legend').querySelectorAll('.line')].map(l => l.textContent)"
    assert page.run(legend) == ["req", "gnt"]
    assert page.errors == []


def test_a_signal_that_no_requirement_reads_can_be_added(page, small):
    open_page(page, small)
    page.run("""(() => {
        const select = document.querySelector('details[open] .legend select');
        select.dispatchEvent(new Event('focus'));
        select.value = 'speed [m/s]';
        select.dispatchEvent(new Event('change'));
    })()""")
    page.run(SETTLED)
    for _ in range(2):
        key(page, "ArrowRight")
    values = "[...document.querySelector('details[open] .legend').querySelectorAll('.value')].map(v => v.textContent)"
    assert page.run(values) == ["0", "3"]
    assert page.run("document.querySelector('details[open] [role=img]').ariaLabel").startswith(
        "req from 0 to 6; speed"
    )
    assert page.errors == []


def test_a_zoom_into_many_samples_shows_each_of_them(page, large, folder):
    open_page(page, large)
    assert all("samples a pixel: lowest and highest drawn" in note for note in page.run(NOTES))
    press(page, "violation")
    assert set(page.run(NOTES)) == {""}
    page.run("document.querySelector('details[open] .plot').scrollIntoView()")
    press(page, "CSV")
    for _ in range(100):
        files = list(folder.glob("*.csv"))
        saved = [file for file in files if file.read_text().startswith("time [s],x,")]
        if saved:
            break
        time.sleep(0.05)
    rows = [row.split(",") for row in saved[0].read_text().splitlines()]
    assert rows[0] == ["time [s]", "x", "always(x >= -2)", "x >= -2"]
    times = [float(row[0]) for row in rows[1:]]
    assert 20 < len(times) < 200
    recorded = dict(line.split(",") for line in (folder / "large.csv").read_text().splitlines()[1:])
    for row in rows[1:]:
        assert float(recorded[row[0]]) == float(row[1])
        assert float(row[3]) == float(row[1]) + 2
    assert ["123.45", "-7.25"] in [row[:2] for row in rows]
    assert page.errors == []


def test_a_link_opens_its_card_at_its_time(page, small):
    open_page(page, small)
    good = page.run("document.querySelectorAll('details.card')[1].id")
    open_page(page, small, f"#{good}@1..3")
    assert page.run("[...document.querySelectorAll('details.card')].map(c => c.open)") == [True, True]
    bars = page.run("[...document.querySelectorAll('.tools output')].map(o => o.textContent)")
    assert bars[1] == "1 s to 3 s"
    press(page, "link")
    assert re.search(r"answer.stl/.*a%20%26%20%3Cb%3E.csv@-?[\d.]+\.\.[\d.]+$", page.run("location.hash"))


def test_two_hundred_cards_load_quickly_and_are_filtered_searched_and_sorted(page, folder):
    x = np.sin(np.arange(1000) / 9) * 20
    (folder / "sine.csv").write_text("time,x\n" + "".join(f"{i},{v:.3f}\n" for i, v in enumerate(x)))
    (folder / "many.stl").write_text(
        "".join(f'require R{i} "limit {i / 4}": always(x <= {i / 4});\n' for i in range(200))
    )
    paths = [str(folder / name) for name in ("many.stl", "sine.csv")]
    main(["check", "--quiet", *paths, "--html", str(folder / "many.html")])
    open_page(page, folder / "many.html")
    (took,) = page.run("performance.getEntriesByType('navigation').map(entry => entry.loadEventEnd)")
    assert took < 5000  # 0.4 s on a machine without other work
    assert page.run("document.querySelectorAll('canvas').length") < 10
    names = page.run("[...document.querySelectorAll('#matrix tbody tr')].map(row => row.dataset.name)")
    assert names[:2] == ["R0", "R1"]
    page.run("document.querySelector('[data-verdict=violated]').click()")
    assert page.run(f"{CARDS}.length") == 120
    page.run("""(() => { const search = document.getElementById('search');
        search.value = 'r102 LIMIT'; search.dispatchEvent(new Event('input')); })()""")
    assert page.run(f"{CARDS}.map(card => card.querySelector('b').textContent)") == ["R102"]
    assert page.run("document.getElementById('found').textContent") == "1 of 200"
    page.run("""(() => { const sort = document.getElementById('sort');
        sort.value = 'robustness'; sort.dispatchEvent(new Event('change')); })()""")
    assert page.errors == []


def test_dark_and_light_and_paper(page, small):
    open_page(page, small)
    background = "getComputedStyle(document.body).backgroundColor"
    assert page.run(background) == "rgb(255, 255, 255)"
    page.run("document.getElementById('theme').click()")
    page.run(SETTLED)
    assert page.run(background) == "rgb(15, 19, 24)"
    printed = page.send("Page.printToPDF")["data"]
    assert len(printed) > 10_000
    page.run(SETTLED)
    assert page.run(background) == "rgb(15, 19, 24)"
    assert page.errors == []


def test_charts_are_described_to_those_who_do_not_see_them(page, small):
    open_page(page, small)
    labels = page.run(
        "[...document.querySelectorAll('details[open] [role=img]')].map(chart => chart.ariaLabel)"
    )
    assert labels[0] == "req from 0 to 6"
    assert "does not hold from" in labels[-2]
    assert labels[-1].startswith("robustness at the start from ")
    named = "e.ariaLabel || e.textContent.trim() || e.labels?.length"
    controls = "[...document.querySelectorAll('button, select, input')]"
    assert page.run(f"{controls}.filter(e => !({named})).length") == 0


def test_assistive_technology_finds_a_name_for_every_control(page, small):
    open_page(page, small)
    nodes = [
        (node["role"]["value"], node.get("name", {}).get("value", "").strip())
        for node in page.send("Accessibility.getFullAXTree")["nodes"]
        if not node["ignored"]
    ]
    controls = {"button", "link", "combobox", "searchbox", "DisclosureTriangle", "heading"}
    assert [node for node in nodes if node[0] in controls and not node[1]] == []
    found = {role for role, _ in nodes}
    assert controls | {"main", "table"} <= found
    assert "req from 0 to 6" in [
        name for role, name in nodes if role in ("image", "img")
    ]  # as browsers call it
    assert ("searchbox", "Search") in nodes
    assert ("link", "Skip to the results") in nodes


def test_real_keys_reach_the_results_from_the_start_of_the_page(page, small):
    open_page(page, small)
    for kind in ("rawKeyDown", "keyUp"):
        page.send("Input.dispatchKeyEvent", type=kind, key="Tab", code="Tab", windowsVirtualKeyCode=9)
    assert page.run("document.activeElement.textContent") == "Skip to the results"
    assert page.run("getComputedStyle(document.activeElement).outlineStyle") != "none"


def test_a_narrow_touch_screen_needs_no_horizontal_scrolling(page, small):
    page.send("Emulation.setDeviceMetricsOverride", width=390, height=800, deviceScaleFactor=2, mobile=True)
    page.send("Emulation.setTouchEmulationEnabled", enabled=True)
    try:
        open_page(page, small)
        assert page.run("document.documentElement.scrollWidth") == 390
        left, _, width, _ = plot(page)
        assert 0 < left < left + width <= 390
        assert page.errors == []
    finally:
        page.send("Emulation.setTouchEmulationEnabled", enabled=False)
        page.send("Emulation.clearDeviceMetricsOverride")


def test_members_and_booleans_are_read_by_name(page, folder):
    (folder / "modes.stl").write_text(
        "enum Mode { MANUAL, AUTO = 4 } input Mode mode input bool p always(p -> mode == AUTO)"
    )
    (folder / "modes.csv").write_text("time,mode,p\n0,AUTO,1\n1,MANUAL,0\n2,MANUAL,1\n")
    paths = [str(folder / name) for name in ("modes.stl", "modes.csv")]
    assert main(["report", *paths, "-o", str(folder / "modes.html")]) == 1
    open_page(page, folder / "modes.html")
    labels = page.run("[...document.querySelectorAll('.plot')].map(plot => plot.getAttribute('aria-label'))")
    assert labels[:2] == ["p from false to true", "mode from MANUAL to AUTO"]
    press(page, "violation")
    values = page.run("[...document.querySelectorAll('.legend .value')].map(value => value.textContent)")
    assert values[:2] == ["true", "MANUAL"]
    assert page.errors == []


def test_seconds_after_an_epoch_time_have_no_digits_of_rounding(page, folder):
    rows = "".join(f"{1_700_000_000 + i / 10:.1f},{5 - i / 4}\n" for i in range(22))
    (folder / "epoch.csv").write_text(f"time,x\n{rows}")
    (folder / "epoch.stl").write_text("always(x >= 0)")
    paths = [str(folder / name) for name in ("epoch.stl", "epoch.csv")]
    assert main(["report", *paths, "-o", str(folder / "epoch.html")]) == 1
    open_page(page, folder / "epoch.html")
    assert "2023-11-14 22:13:22.1 (+2.1 s)" in page.run("document.querySelector('details[open]').textContent")
    press(page, "violation")
    assert page.run(BAR) == "2023-11-14 22:13:22.1 (+2.1 s)"
