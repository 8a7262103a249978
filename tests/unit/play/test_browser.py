"""The page of ``rtamt play`` in a real browser: typing, drawing, recordings, accessibility."""

from importlib.resources import files

import pytest

from tests.unit.html_report.browser import CHROMIUM
from tests.unit.play.page_actions import (
    FOCUSED,
    HANDLES,
    NUMBERS,
    PROBLEM,
    TEXT,
    WORD,
    click,
    drag,
    open_page,
    place,
    press,
    until,
    write,
)

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: apt-get install chromium")


def test_the_example_is_evaluated_explained_and_replayed_without_another_server(page, address):
    assert page.run(NUMBERS) == {"Robustness": "−2", "First violation": "18 s", "Critical point": "18 s"}
    assert "'gnt >= 3' fails from 18 s to 23 s" in page.run("document.getElementById('why').textContent")
    until(page, "document.querySelectorAll('.run-bad').length === 3")
    assert (
        until(page, "document.getElementById('now').textContent")
        == "All samples: robustness −2, decided at 23 s"
    )
    origin = address[: address.index("/", 8)]
    assert page.requests
    assert {url[: len(origin)] for url in page.requests if url.startswith("http")} == {origin}
    assert page.errors == []


def test_typing_evaluates_and_a_mistake_is_marked_at_its_place(page):
    write(page, "always(gnt <= 9)")
    until(page, f"{WORD} === 'Satisfied'")
    write(page, "always(gnt <= )")
    until(page, "document.querySelector('#mirror .error')?.textContent === ')'")
    assert page.run(PROBLEM) == "Column 15: expected an operand after '<=', got ')'"
    assert page.run("document.getElementById('text').getAttribute('aria-invalid')") == "true"
    assert page.run("document.getElementById('result').classList.contains('stale')")
    write(page, "always(gnt <= 3)")
    until(page, f"{WORD} === 'Violated'")
    assert page.run("document.querySelector('#mirror .error')") is None
    assert page.run("document.getElementById('text').getAttribute('aria-invalid')") == "false"
    assert page.errors == []


def test_an_answer_that_comes_after_the_text_has_changed_is_dropped(page):
    page.run(
        "window.held = []; window.real = window.fetch; window.fetch = (url, options) => String(url) === 'ask/evaluate'"
        " ? new Promise(done => held.push(() => done(real(url, options)))) : real(url, options);"
        "window.seen = []; new MutationObserver(() => seen.push(document.getElementById('problem').textContent))"
        ".observe(document.getElementById('problem'), {childList: true})"
    )
    write(page, "always(gnt <= )")
    until(page, "held.length === 1")
    write(page, "always(gnt <= 9)")
    page.run("window.fetch = real; held[0]()")
    until(page, f"{WORD} === 'Satisfied'")
    assert page.run("seen.every(text => text.startsWith('Horizon'))")
    assert page.errors == []


def test_without_the_server_a_sentence_is_shown(page):
    page.run("window.fetch = () => Promise.reject(new TypeError('Failed to fetch'))")
    write(page, "always(gnt <= 9)")
    until(page, "document.getElementById('problem').classList.contains('wrong')")
    assert page.run(PROBLEM) == "the server does not answer: is 'rtamt play' still running?"


def test_words_are_completed_from_operators_and_signals(page):
    write(page, "hist")
    until(page, "!document.getElementById('words').hidden")
    assert page.run("document.querySelector('#words [aria-selected=true] b').textContent") == "historically"
    press(page, "Enter")
    page.send("Input.insertText", text="(re")
    until(page, "document.querySelector('#words [aria-selected=true] b')?.textContent === 'req'")
    press(page, "Tab")
    page.send("Input.insertText", text=" >= -1)")
    until(page, f"{WORD} === 'Satisfied'")
    assert page.run(TEXT) == "historically(req >= -1)"
    page.send("Input.insertText", text=" and on")
    until(page, "!document.getElementById('words').hidden")
    press(page, "Escape")
    assert page.run("document.getElementById('words').hidden")


def test_new_variables_get_a_signal(page):
    write(page, "always(temperature >= -1)")
    until(page, "document.querySelector('#charts h3')?.textContent === 'temperature'")
    until(page, f"{WORD} === 'Satisfied'")
    write(page, "always(level >= -1)")
    until(page, "document.querySelector('#charts h3')?.textContent === 'level'")
    click(page, ".signal-head button", 1)
    until(page, "document.querySelectorAll('.handle').length === 2")
    write(page, "always(temperature <= 1)")
    until(page, "document.querySelector('#charts h3')?.textContent === 'temperature'")
    write(page, "always(level <= 2)")
    until(page, "document.querySelectorAll('.handle').length === 2")  # what was drawn stays
    click(page, "#link")
    until(page, "document.documentElement.dataset.link")
    decoded = (
        "import('./page/link.js').then(m => m.decode(document.documentElement.dataset.link.split('#')[1]))"
    )
    assert page.run(f"{decoded}.then(saved => Object.keys(saved.signals))") == ["req", "gnt", "level"]


def test_a_variable_may_be_called_like_a_method_of_every_object(page):
    write(page, "always(valueOf <= 2 and constructor > -1)")
    until(page, "document.querySelector('#charts h3')?.textContent === 'valueOf'")
    until(page, f"{WORD} === 'Satisfied'")
    assert page.run("document.querySelectorAll('.handle').length") == 2
    assert page.errors == []


def test_points_are_dragged_and_the_verdict_follows(page):
    x, y = place(page, ".handle", 3)
    assert page.run(HANDLES)[3] == ["req, point 4 of 5", "5 at 18 s"]
    low = page.run("document.querySelectorAll('.handle')[4].getBoundingClientRect().top")
    drag(page, (x, y), (x, low + 5))
    until(page, f"{WORD} === 'Satisfied'")
    assert page.run(HANDLES)[3][1].endswith(" at 18 s")
    assert page.errors == []


def test_drawing_over_a_chart_sets_points(page):
    (x, y), (end, _) = place(page, ".handle", 2), place(page, ".handle", 3)
    drag(page, (x + 60, y - 20), (end - 40, y - 20))
    until(page, "document.querySelectorAll('.handle[aria-label^=req]').length === 7")
    assert page.errors == []


def test_points_are_moved_added_and_removed_by_keys(page):
    page.run("document.querySelector('.handle').focus()")
    for _ in range(3):
        press(page, "ArrowRight")
    assert page.run(FOCUSED) == "req, point 4 of 5: 5 at 18 s"
    press(page, "ArrowRight", modifiers=8)
    assert page.run(FOCUSED) == "req, point 4 of 5: 5 at 19 s"
    press(page, "ArrowUp")
    assert float(page.run("document.activeElement.getAttribute('aria-valuenow')")) > 5
    press(page, "Insert")
    assert page.run(FOCUSED).startswith("req, point 5 of 6: ")
    for _ in range(2):
        press(page, "Delete")
    until(page, f"{WORD} === 'Satisfied'")
    assert page.run(FOCUSED) == "req, point 3 of 4: 0 at 6 s"


def test_a_point_is_dragged_by_touch(page):
    page.send("Emulation.setTouchEmulationEnabled", enabled=True)
    x, y = place(page, ".handle", 3)
    low = page.run("document.querySelectorAll('.handle')[4].getBoundingClientRect().top")
    page.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
    page.send("Input.dispatchTouchEvent", type="touchMove", touchPoints=[{"x": x + 2, "y": (y + low) / 2}])
    page.send("Input.dispatchTouchEvent", type="touchMove", touchPoints=[{"x": x, "y": low + 5}])
    page.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    page.send("Emulation.setTouchEmulationEnabled", enabled=False)
    until(page, f"{WORD} === 'Satisfied'")


def test_shapes_replace_a_signal(page):
    click(page, ".signal-head button", 2)
    until(page, "document.querySelectorAll('.handle[aria-label^=req]').length > 20")
    assert page.run("document.querySelectorAll('.signal-head button')[3].textContent") == "lines"
    click(page, ".signal-head button", 1)
    until(page, "document.querySelectorAll('.handle[aria-label^=req]').length === 2")


def test_scrubbing_shows_what_the_monitor_knew(page):
    until(page, "document.querySelectorAll('.run-bad').length === 3")
    page.run("document.getElementById('at').focus()")
    page.run(
        "(() => { const e = document.getElementById('at'); e.value = 667; e.dispatchEvent(new Event('input')); })()"
    )
    until(page, "document.querySelectorAll('.whisker').length > 0")
    assert page.run("document.getElementById('now').textContent") == (
        "After 20.01 s: robustness between −∞ and 1, not decided yet, 3 pending"
    )
    assert page.run("document.querySelectorAll('.run-open').length") == 3
    assert page.run("document.querySelectorAll('.run-later').length") == 10
    assert page.run("document.getElementById('at').getAttribute('aria-valuetext')").startswith(
        "After 20.01 s"
    )
    assert page.errors == []


def test_a_recording_is_loaded_and_a_broken_one_is_a_sentence(page, folder):
    document = page.send("DOM.getDocument")["root"]["nodeId"]
    found = page.send("DOM.querySelector", nodeId=document, selector="#upload")["nodeId"]
    page.send("DOM.setFileInputFiles", nodeId=found, files=[str(folder / "broken.csv")])
    until(page, "!document.getElementById('toast').hidden")
    assert "broken.csv" in page.run("document.getElementById('toast').textContent")
    page.send("DOM.setFileInputFiles", nodeId=found, files=[str(folder / "speeds.csv")])
    until(page, "document.getElementById('problem').classList.contains('wrong')")
    assert page.run(PROBLEM) == "speeds.csv has no 'req'; signals: speed"
    write(page, "always( <= 48)")
    page.run("document.getElementById('text').setSelectionRange(7, 7)")
    click(page, "#columns button")
    until(page, f"{NUMBERS}.Robustness === '−1'")
    assert page.run(TEXT) == "always(speed <= 48)"
    assert page.run(NUMBERS)["First violation"] == "4.9 s"
    assert page.run("document.getElementById('source').textContent") == "speeds.csv · 200 samples"
    click(page, "#link")
    link = until(page, "document.documentElement.dataset.link")
    base = page.run("location.href").partition("#")[0]
    open_page(page, f"{base}#{link.partition('#')[2]}")
    assert page.run(TEXT) == "always(speed <= 48)"
    assert page.run(NUMBERS)["Robustness"] == "−1"
    assert page.run("document.getElementById('source').textContent") == "speeds.csv · 200 samples"
    click(page, "#draw")
    until(page, "document.querySelectorAll('.handle').length > 0")


def test_a_counterexample_is_drawn(page):
    write(page, "always[0:2](req >= 3 -> eventually[0:2](gnt >= 3)) and eventually[0:2](req >= 4)")
    until(page, "document.getElementById('problem').textContent.startsWith('Horizon 4 s')")
    click(page, "[data-wanted=witness]")
    until(page, f"{WORD} === 'Satisfied'")
    assert "satisfies it" in page.run("document.getElementById('answer').textContent")
    click(page, "[data-wanted=counterexample]")
    until(page, f"{WORD} === 'Violated'")
    assert page.errors == []


def test_everything_that_is_operated_has_a_name_and_the_verdict_is_announced(page):
    nodes = page.send("Accessibility.getFullAXTree")["nodes"]
    named = {"button", "combobox", "slider", "textbox", "spinbutton", "radio", "link"}
    operated = [node for node in nodes if node.get("role", {}).get("value") in named and not node["ignored"]]
    assert len(operated) > 20
    assert [node for node in operated if not node.get("name", {}).get("value")] == []
    assert page.run("document.getElementById('verdict').getAttribute('aria-live')") == "polite"


def test_the_rules_of_axe_hold_in_every_state_of_the_page(page):
    rules = files("axe_core_python").joinpath("axe.min.js").read_text()
    found = (
        "axe.run(document, {resultTypes: ['violations']}).then(({violations}) => violations.map("
        "({id, nodes}) => [id, nodes.map(({html}) => html.slice(0, 200))]))"
    )

    def check_accessibility(state):
        assert (state, page.run(found)) == (state, [])

    until(page, "document.querySelectorAll('.run-bad').length === 3")
    page.run(f"{rules};0")
    check_accessibility("start")
    click(page, "#zoom-in")
    page.run("(e => { e.value = 667; e.dispatchEvent(new Event('input')); })(document.getElementById('at'))")
    until(page, "document.querySelectorAll('.whisker').length > 0")
    check_accessibility("zoomed, at an instant")
    write(page, "always(req >= 3 -> ev")
    until(page, "!document.getElementById('words').hidden")
    until(page, "document.getElementById('result').classList.contains('stale')")
    check_accessibility("completion and an error")
    click(page, "#theme")
    check_accessibility("dark")
    write(page, "require A: always(req <= 5); require B: always(gnt <= 5)")
    until(page, "document.querySelectorAll('#requirements button').length === 2")
    check_accessibility("two requirements")
    page.run("navigator.clipboard.writeText = () => Promise.reject(new Error('not allowed'))")
    click(page, "#link")
    until(page, "document.getElementById('sharing').open")
    check_accessibility("a dialog")
    click(page, "#sharing button")
    page.run("sessionStorage.clear()")


@pytest.mark.parametrize("width", [320, 390, 768, 1280])
def test_nothing_is_wider_than_the_window(page, width):
    page.send(
        "Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1, mobile=False
    )
    try:
        until(page, f"innerWidth === {width}")
        until(page, "document.querySelector('.chart').getBoundingClientRect().right <= innerWidth")
        assert page.run("document.scrollingElement.scrollWidth <= innerWidth")
    finally:
        page.send("Emulation.clearDeviceMetricsOverride")


def test_the_theme_is_that_of_the_system_until_it_is_switched(page):
    theme = "document.documentElement.dataset.theme"
    page.send("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark"}])
    until(page, f"{theme} === 'dark'")
    click(page, "#theme")
    assert page.run(theme) == "light"
    page.run("sessionStorage.clear()")
    page.send("Emulation.setEmulatedMedia", features=[])
