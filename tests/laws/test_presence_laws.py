"""``valid(x)`` is a Boolean that was recorded beside x: offline, online, in any order of arrival."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt

TEXTS = (
    "valid(x)",
    "valid(x) -> x > 1",
    "not valid(x) until[0:2] y > 0",
    "always[0:1](valid(x) or once[1:2] not valid(y))",
    "once[0:2](valid(x) and x > y) and eventually[0:1] valid(y)",
    "historically[0:2] valid(x) xor y > x",
    "(if valid(x) then x else y) > 1",
)
NUMBERS = st.one_of(st.none(), st.integers(-3, 3).map(float))


@st.composite
def cases(draw):
    n = draw(st.integers(1, 7))
    columns = {name: draw(st.lists(NUMBERS, min_size=n, max_size=n)) for name in ("x", "y")}
    text = draw(st.sampled_from(TEXTS))
    return text, columns, draw(st.sampled_from(["cpp", "python"]))


def specifications_of(text, backend):
    """Return the formula, and the same with recorded Booleans in place of valid(x) and valid(y)."""
    plain = text.replace("valid(x)", "vx").replace("valid(y)", "vy")
    declared = f"float x float y bool vx bool vy {plain}"
    return rtamt.parse(text, backend=backend), rtamt.parse(declared, backend=backend)


def beside(columns, spec):
    """Return columns with Booleans of what is there."""
    there = {f"v{name}": [float(v is not None) for v in values] for name, values in columns.items()}
    return {name: {**columns, **there}[name] for name in spec.input_names}


def bounds(spec, data, **settings):
    found = spec.evaluate({name: data[name] for name in spec.input_names}, **settings).intervals
    return found.lower.tolist(), found.upper.tolist()


@given(cases())
def test_offline_presence_is_a_recorded_boolean(case):
    text, columns, backend = case
    spec, recorded = specifications_of(text, backend)
    data = {**columns, **beside(columns, recorded)}
    assert bounds(spec, data) == bounds(recorded, data)


@given(cases())
def test_offline_presence_in_dense_time_is_that_of_the_last_sample(case):
    text, columns, backend = case
    spec, recorded = specifications_of(text, backend)
    times = list(range(len(columns["x"])))
    data = {**columns, **beside(columns, recorded)}
    data = {name: (times, values) for name, values in data.items()}
    assert bounds(spec, data, time="dense") == bounds(recorded, data, time="dense")


def bounds_by_instant(changes):
    return {t: each.interval for each in changes for t in range(int(each.begin), int(each.end) + 1)}


@settings(max_examples=50)
@given(cases(), st.data())
def test_online_bounds_are_those_of_a_recorded_boolean_in_any_order_of_arrival(case, data):
    text, columns, backend = case
    spec, recorded = specifications_of(text, backend)
    names = spec.input_names
    rows = [{name: columns[name][t] for name in names} for t in range(len(columns["x"]))]
    there = beside(columns, recorded)
    ordered, told = spec.monitor(verdict="interval"), recorded.monitor(verdict="interval")
    every, all_told = {}, {}
    for t, row in enumerate(rows):
        ordered.update(t, **row)
        told.update(t, **{name: there[name][t] for name in recorded.input_names})
        every |= bounds_by_instant(ordered.changes())
        all_told |= bounds_by_instant(told.changes())
    every |= bounds_by_instant(ordered.finish())
    all_told |= bounds_by_instant(told.finish())
    assert every == all_told
    late = spec.monitor(verdict="interval", lateness=2)
    # Each sample is late by at most two: sort by the time plus up to two.
    order = sorted(range(len(rows)), key=lambda t: t + data.draw(st.sampled_from((0, 1.9))))
    lately = {}
    for t in order:
        late.update(t, **{name: value for name, value in rows[t].items() if value is not None})
        lately |= bounds_by_instant(late.changes())
    lately |= bounds_by_instant(late.finish())
    assert late.samples == len(rows)
    # What was known before the trace had begun is told by the monitor itself.
    lately |= {t: late.interval(t) for t in range(len(rows)) if t not in lately}
    assert lately == every
