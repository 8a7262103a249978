"""Zooming and moving the charts of the page in a real browser."""

import pytest

from tests.unit.html_report.browser import CHROMIUM
from tests.unit.play.page_actions import (
    FOCUSED,
    HANDLES,
    NUMBERS,
    WORD,
    click,
    open_page,
    place,
    press,
    until,
    write,
)

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: apt-get install chromium")


SEEN = "document.getElementById('seen').textContent"


def ends(page):
    """The time that is seen."""
    begin, end = page.run(SEEN).split(" to ")
    return float(begin.removesuffix(" s")), float(end.removesuffix(" s"))


def turn(page, x, y, **more):
    page.mouse("mouseWheel", x, y, **{"deltaX": 0, "deltaY": 0, **more})


def test_the_wheel_zooms_around_the_pointer_and_the_drawing_moves_with_it(page):
    x, y = place(page, ".handle", 3)  # at 18 s
    turn(page, x, y, deltaY=-400, modifiers=2)
    until(page, SEEN)
    assert ends(page) == pytest.approx((9, 24), abs=0.05)
    assert place(page, '.handle[aria-valuetext="5 at 18 s"]')[0] == pytest.approx(x, abs=1)
    times = page.run("[...document.querySelectorAll('#online .time')].map(t => Number(t.textContent))")
    assert (min(times), max(times)) == (10, 20)
    turn(page, x, y, deltaX=200)
    until(page, f"parseFloat({SEEN}) > 10")
    assert ends(page)[1] - ends(page)[0] == pytest.approx(15, rel=1e-2)
    turn(page, x, y, deltaY=4000, modifiers=2)
    until(page, f"{SEEN} === ''")
    assert page.run("document.getElementById('everything').disabled")
    assert page.errors == []


def test_buttons_and_keys_zoom_and_move(page):
    for number, seen in (
        (3, "7.5 s to 22.5 s"),
        (3, "11.25 s to 18.75 s"),
        (1, "15 s to 22.5 s"),
        (0, "11.25 s to 18.75 s"),
        (2, "7.5 s to 22.5 s"),
        (4, ""),
    ):
        click(page, "#zoom button", number)
        assert page.run(SEEN) == seen
    page.run("document.querySelector('.handle').focus()")
    for key, seen in (
        ("+", "7.5 s to 22.5 s"),
        ("]", "11.25 s to 26.25 s"),
        ("[", "7.5 s to 22.5 s"),
        ("-", ""),
    ):
        press(page, key, text=key)
        assert page.run(SEEN) == seen
    page.run("document.getElementById('at').focus()")
    press(page, "+", text="+")
    assert page.run(SEEN) == "7.5 s to 22.5 s"
    press(page, "0", text="0")
    assert page.run(SEEN) == ""
    # A point that is chosen by keys comes into view.
    page.run("document.querySelector('.handle').focus()")
    press(page, "+", text="+")
    page.run("document.querySelector('.handle').focus()")
    press(page, "Home")
    assert page.run(SEEN) == "0 s to 15 s"
    assert page.run(FOCUSED) == "req, point 1 of 5: 0 at 0 s"
    assert page.errors == []


def test_two_fingers_zoom_and_undo_what_the_first_one_drew(page):
    page.send("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=2)
    handles = page.run(HANDLES)
    x, y = place(page, ".handle", 1)
    a, b = {"x": x + 60, "y": y + 20, "id": 1}, {"x": x + 160, "y": y + 20, "id": 2}
    page.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[a])
    page.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[a, b])
    wide = [{**a, "x": a["x"] - 50}, {**b, "x": b["x"] + 50}]
    page.send("Input.dispatchTouchEvent", type="touchMove", touchPoints=wide)
    page.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    page.send("Emulation.setTouchEmulationEnabled", enabled=False)
    until(page, f"{SEEN} !== ''")
    begin, end = ends(page)
    assert end - begin == pytest.approx(15, rel=0.02)  # twice as far apart: half of the time
    click(page, "#everything")
    until(page, f"{SEEN} === ''")
    assert page.run(HANDLES) == handles
    assert page.errors == []


def test_a_drag_with_shift_moves_the_view_and_draws_nothing(page):
    click(page, "#zoom-in")
    handles = page.run("document.querySelectorAll('.handle').length")
    x, y = place(page, "#charts .chart")
    page.mouse("mousePressed", x, y + 20, button="left", buttons=1, clickCount=1, modifiers=8)
    page.mouse("mouseMoved", x + 100, y + 20, button="left", buttons=1, modifiers=8)
    page.mouse("mouseReleased", x + 100, y + 20, button="left", clickCount=1, modifiers=8)
    begin, end = ends(page)
    assert begin < 7.5
    assert end - begin == pytest.approx(15, rel=1e-2)
    click(page, "#everything")
    assert page.run("document.querySelectorAll('.handle').length") >= handles
    assert page.run(f"{WORD}") == "Violated"
    assert page.run(HANDLES)[3] == ["req, point 4 of 5", "5 at 18 s"]


def test_the_view_follows_the_cursor_and_is_part_of_a_link(page, address):
    until(page, "document.querySelectorAll('.run-bad').length === 3")
    click(page, "#zoom-in")
    click(page, "#zoom-in")
    assert page.run(SEEN) == "11.25 s to 18.75 s"
    page.run("(e => { e.value = 100; e.dispatchEvent(new Event('input')); })(document.getElementById('at'))")
    until(page, f"{SEEN} === '0 s to 7.5 s'")
    # What is known is said of the cursor, wherever the view is.
    until(page, "document.getElementById('now').textContent.startsWith('After 3 s: robustness between')")
    said = page.run("document.getElementById('now').textContent")
    click(page, "#later")
    click(page, "#later")
    assert page.run("document.getElementById('now').textContent") == said
    seen = page.run(SEEN)
    click(page, "#link")
    link = until(page, "document.documentElement.dataset.link")
    open_page(page, f"{address}#{link.partition('#')[2]}")
    until(page, f"{SEEN} === '{seen}'")
    assert page.errors == []


def test_a_zoomed_recording_shows_its_samples(page, folder):
    rows = "".join(f"{i / 100},{i % 7}\n" for i in range(18_000))
    (folder / "long.csv").write_text(f"time,x\n{rows}")
    write(page, "always(x <= 5)")
    document = page.send("DOM.getDocument")["root"]["nodeId"]
    found = page.send("DOM.querySelector", nodeId=document, selector="#upload")["nodeId"]
    page.send("DOM.setFileInputFiles", nodeId=found, files=[str(folder / "long.csv")])
    until(page, "document.getElementById('source').textContent.startsWith('long.csv')")
    until(page, f"{NUMBERS}.Robustness === '−1'")
    assert page.run("document.querySelectorAll('#charts .dot').length") == 0
    for _ in range(12):
        click(page, "#zoom-in")
    # 4.4 of 18 000 samples are seen, and one at each side.
    until(page, "document.querySelectorAll('#charts .dot').length === 6")
    until(page, "document.querySelectorAll('.run-good, .run-bad').length <= 7")
    click(page, "#everything")
    until(page, "document.querySelectorAll('#charts .dot').length === 0")
    assert page.errors == []
