"""What a user does on the page of ``rtamt play`` in a browser, and what the page shows."""

import time

WORD = "document.querySelector('#verdict .word').textContent"
NUMBERS = (
    "Object.fromEntries([...document.querySelectorAll('#numbers dt')]"
    ".map(t => [t.textContent, t.nextSibling.textContent]))"
)
PROBLEM = "document.getElementById('problem').textContent"
TEXT = "document.getElementById('text').value"
LABEL, VALUE = "getAttribute('aria-label')", "getAttribute('aria-valuetext')"
HANDLES = f"[...document.querySelectorAll('.handle')].map(h => [h.{LABEL}, h.{VALUE}])"
FOCUSED = f"document.activeElement.{LABEL} + ': ' + document.activeElement.{VALUE}"


def open_page(browser, url):
    browser.errors.clear()
    browser.requests.clear()
    browser.open("about:blank")
    browser.open(url)
    until(browser, f"{WORD} === 'Violated' || {WORD} === 'Satisfied'")
    return browser


def until(page, condition):
    """Wait until an expression is true, and return its value."""
    end = time.monotonic() + 30
    while time.monotonic() < end:
        found = page.run(condition)
        if found:
            return found
        time.sleep(0.02)
    raise AssertionError(f"not true within half a minute: {condition}; problem: {page.run(PROBLEM)}")


def write(page, text):
    page.run("document.getElementById('text').select()")
    page.send("Input.insertText", text=text)


def press(page, key, **more):
    for kind in ("keyDown", "keyUp"):
        page.send("Input.dispatchKeyEvent", type=kind, key=key, code=key, **more)


def place(page, selector, number=0):
    """The middle of an element that is scrolled into view."""
    return page.run(
        f"(() => {{ const e = document.querySelectorAll('{selector}')[{number}]; e.scrollIntoView({{block: 'center'}});"
        " const b = e.getBoundingClientRect(); return [b.left + b.width / 2, b.top + b.height / 2]; })()"
    )


def drag(page, start, end):
    page.mouse("mousePressed", *start, button="left", buttons=1, clickCount=1)
    page.mouse("mouseMoved", *end, button="left", buttons=1)
    page.mouse("mouseReleased", *end, button="left", clickCount=1)


def click(page, selector, number=0):
    x, y = place(page, selector, number)
    page.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    page.mouse("mouseReleased", x, y, button="left", clickCount=1)
