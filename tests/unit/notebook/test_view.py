"""Results in notebooks: the widget in a real browser, and the view that needs no widgets."""

import base64
import json
import sys
import time
import zlib
from itertools import chain, repeat

import pytest
import traitlets

import rtamt
from rtamt.notebook import view
from rtamt.notebook.static import StaticView
from rtamt.notebook.widget import ResultWidget
from tests.unit.html_report.browser import CHROMIUM, chromium

SPEC = "require low: always(x <= 3)\nrequire high: always(eventually[0:2](x >= 1))\n"

# A notebook as far as a widget sees it: a model, and an element to draw into.
NOTEBOOK = """<!DOCTYPE html><meta charset="utf-8"><body style="margin:0"><script type="module">
import widget from "data:text/javascript;base64,%s";
const listeners = new Map(), values = %s;
values._page = new DataView(Uint8Array.from(atob(values._page), (letter) => letter.charCodeAt(0)).buffer);
window.saved = 0;
window.model = {
  get: (name) => values[name],
  set: (name, value) => { values[name] = value; (listeners.get(`change:${name}`) || []).forEach((call) => call()); },
  save_changes: () => { window.saved += 1; },
  on: (names, call) => names.split(" ").forEach((n) => listeners.set(n, [...(listeners.get(n) || []), call])),
  off: (names, call) => names.split(" ").forEach((n) => listeners.set(n, listeners.get(n).filter((c) => c !== call))),
};
window.end = widget.render({ model: window.model, el: document.body });
</script>"""


@pytest.fixture(scope="module")
def result():
    return rtamt.parse(SPEC).evaluate({"x": [2, 5, 0, 1, 2, 2]})


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("notebooks")


@pytest.fixture(scope="module")
def browser(folder):
    assert CHROMIUM is not None
    with chromium(folder / "profile") as page:
        yield page


def open_page(browser, folder, widget):
    """Show a widget as a notebook does."""
    state = {name: getattr(widget, name) for name in ("height", "zoom", "cursor")}
    state["_page"] = base64.b64encode(widget._page).decode()
    code = base64.b64encode(
        ResultWidget._esm.read_bytes()
        if hasattr(ResultWidget._esm, "read_bytes")
        else str(ResultWidget._esm).encode()
    )
    path = folder / "notebook.html"
    path.write_text(NOTEBOOK % (code.decode(), json.dumps(state).replace("<", "\\u003c")), encoding="utf-8")
    browser.errors.clear()
    browser.open("about:blank")
    browser.open(path.as_uri())
    return browser


def wait(browser, condition):
    """Wait until a condition holds; what it is waits for the browser, not for a time."""
    end = time.monotonic() + 60
    while not browser.run(condition):
        assert time.monotonic() < end, (
            condition,
            browser.run("JSON.stringify([model.get('zoom'), model.get('cursor')])"),
        )
        time.sleep(0.02)


def point_until(browser, x, condition):
    """Move the mouse down the page until a condition holds, which it does over a chart, wherever that is."""
    for y in chain.from_iterable(repeat(range(150, 600, 25), 20)):
        browser.mouse("mouseMoved", x, y)
        for _ in range(10):
            if browser.run(condition):
                return
            time.sleep(0.02)
    raise AssertionError((condition, browser.run("JSON.stringify([model.get('zoom'), model.get('cursor')])")))


def test_the_page_reports_its_zoom_and_its_cursor(browser, folder, result):
    page = open_page(browser, folder, view(result))
    wait(page, "model.get('zoom').length === 2")
    assert page.run("model.get('zoom')") == pytest.approx([-0.05, 5.05])
    assert page.run("model.get('cursor')") is None
    point_until(page, 500, "model.get('cursor') !== null")
    assert page.run("model.get('cursor')") in range(6)
    assert page.run("window.saved") > 0
    assert page.errors == []


def test_what_python_sets_moves_the_page(browser, folder, result):
    page = open_page(browser, folder, view(result))
    wait(page, "model.get('zoom').length === 2")
    page.run("model.set('zoom', [1, 3]); model.set('cursor', 2)")
    point_until(page, 800, "![null, 2].includes(model.get('cursor'))")  # then the page reports what it shows
    assert page.run("model.get('zoom')") == pytest.approx([1, 3])
    page.run("model.set('height', 300)")
    assert page.run("document.querySelector('iframe').clientHeight") == 300
    assert page.errors == []


def test_a_zoom_that_is_set_before_the_view_is_shown_is_kept(browser, folder, result):
    widget = view(result)
    widget.zoom, widget.cursor = [1.0, 3.0], 2.0
    page = open_page(browser, folder, widget)
    wait(page, "document.querySelector('iframe') !== null && model.get('zoom')[0] === 1")
    assert page.run("[model.get('zoom'), model.get('cursor')]") == [[1, 3], 2]


def test_a_view_that_is_closed_listens_no_longer(browser, folder, result):
    page = open_page(browser, folder, view(result))
    wait(page, "model.get('zoom').length === 2")
    page.run("window.end(); model.set('height', 111)")
    assert page.run("document.querySelector('iframe').clientHeight") != 111


def test_a_zoom_is_two_positions_in_order(result):
    widget = view(result)
    for ends in ([3.0, 1.0], [1.0], [1.0, 2.0, 3.0]):
        with pytest.raises(
            traitlets.TraitError, match="expected two positions in seconds, the first before the second"
        ):
            widget.zoom = ends
    assert widget.zoom == []


def test_the_widget_has_html_for_readers_without_a_kernel(result):
    data, _ = view(result)._repr_mimebundle_()
    assert "application/vnd.jupyter.widget-view+json" in data
    assert "<iframe" in data["text/html"]


def test_the_state_of_the_widget_has_the_page_once_and_compressed(result):
    widget = view(result)
    state = widget.get_state()
    assert zlib.decompress(state["_page"]).decode() == widget.page
    assert len(state["_page"]) < len(widget.page) / 2
    assert sum(len(str(value)) for name, value in state.items() if name not in ("_page", "_esm")) < 2000


def test_without_anywidget_the_view_is_html(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "anywidget", None)
    monkeypatch.delitem(sys.modules, "rtamt.notebook.widget")
    shown = view(result, height=400)
    assert isinstance(shown, StaticView)
    html = shown._repr_html_()
    assert html.startswith("<table>")  # where frames are not shown
    assert 'sandbox="allow-scripts allow-downloads"' in html
    assert "<script" not in html  # all of the page is an attribute


def test_a_page_has_a_card_for_each_requirement(result):
    page = view(result).page
    assert page.count('<details class="card') == 2
    assert "&#39;x &lt;= 3&#39; fails at 1 s (-2)" in page


@pytest.mark.parametrize(
    ("height", "shown"), [(0, "0"), (-1, "-1"), (2.5, "2.5"), ("big", "'big'"), (None, "None")]
)
def test_a_height_is_a_positive_whole_number(result, height, shown):
    with pytest.raises(rtamt.UsageError, match=f"^height is {shown}, expected a whole number of pixels$"):
        view(result, height=height)


def test_a_result_that_has_only_bounds_is_rejected():
    bounds = rtamt.parse("always(x >= 3)").evaluate({"x": [5, None, 4]}, ranges={"x": (0, 9)})
    with pytest.raises(rtamt.UsageError, match="cannot view a result of missing or uncertain samples"):
        view(bounds)


def test_without_jinja2_the_message_names_the_extra(result, monkeypatch):
    monkeypatch.setitem(sys.modules, "jinja2", None)
    with pytest.raises(rtamt.UsageError, match="jinja2"):
        view(result)
