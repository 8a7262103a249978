"""Links of the page in a real browser: copying, restoring and rejecting them."""

import base64
import zlib

import pytest

from tests.unit.html_report.browser import CHROMIUM
from tests.unit.play.page_actions import HANDLES, TEXT, WORD, click, open_page, until, write

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here: apt-get install chromium")


def test_a_link_contains_the_text_the_signals_and_the_settings(page):
    write(page, "always(level <= 2)")
    until(page, "document.querySelector('#charts h3')?.textContent === 'level'")
    click(page, ".signal-head button", 1)
    page.run("document.querySelector('input[value=dense]').click()")
    until(page, f"{WORD} === 'Satisfied' && document.querySelectorAll('.handle').length === 2")
    handles = page.run(HANDLES)
    click(page, "#link")
    link = until(page, "document.documentElement.dataset.link")
    base = page.run("location.href").partition("#")[0]
    assert base.split("/")[3] not in link  # the token stays here
    open_page(page, f"{base}#{link.partition('#')[2]}")
    assert page.run(TEXT) == "always(level <= 2)"
    assert page.run("document.querySelector('input[name=time]:checked').value") == "dense"
    assert page.run(HANDLES) == handles


def test_a_link_that_the_browser_does_not_copy_is_shown(page):
    page.run("navigator.clipboard.writeText = () => Promise.reject(new Error('not allowed'))")
    click(page, "#link")
    until(page, "document.getElementById('sharing').open")
    assert page.run("document.getElementById('shared').value === document.documentElement.dataset.link")
    click(page, "#sharing button")
    until(page, "!document.getElementById('sharing').open")
    assert page.errors == []


def test_a_damaged_link_is_a_sentence(browser, address):
    open_page(browser, f"{address}#1nonsense")
    assert (
        browser.run("document.getElementById('toast').textContent")
        == "The link is damaged: the page starts without it."
    )


def link_of(text):
    packed = zlib.compressobj(wbits=-15)
    data = packed.compress(text.encode()) + packed.flush()
    return "#1" + base64.urlsafe_b64encode(data).decode().rstrip("=")


@pytest.mark.parametrize(
    "text",
    [
        "5",
        '{"text": 5}',
        '{"signals": {"x": {"hold": true, "points": []}}}',
        '{"signals": {"x": {"hold": true, "points": [[1, 0], [0, 0]]}}}',
        '{"recording": {"name": "a.csv", "bytes": "!"}}',
        '{"view": [2, 1]}',
        f'{{"text": "{" " * 100_000_000}"}}',
    ],
    ids=["number", "text", "no points", "disorder", "bytes", "view", "bomb"],
)
def test_a_link_with_other_data_leaves_no_broken_page(browser, address, text):
    open_page(browser, f"{address}{link_of(text)}")
    assert (
        browser.run("document.getElementById('toast').textContent")
        == "The link is damaged: the page starts without it."
    )
    assert browser.errors == []
