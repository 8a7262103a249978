"""The signal patterns against their definitions in words: loops over samples, and values computed by hand."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tools import signal_patterns

import rtamt

ROOT = Path(__file__).parents[3]
LIBRARY = ROOT / "src" / "rtamt" / "library" / "signals.stl"


# ---- the definitions: x is an array, p a list of instants, durations are numbers of samples -------------------


def constant(x, _p, tolerance, window):
    return all(np.ptp(x[max(t - window, 0) : t + 1]) <= tolerance for t in range(len(x)))


def increases(x, p, duration):
    return all(x[u] >= x[u - 1] for t in p for u in range(t + 1, min(t + duration, len(x) - 1) + 1))


def bounded_rate(x, _p, limit, window):
    return all(abs(x[t] - x[max(t - window, 0)]) <= limit * window for t in range(len(x)))


def spike(x, _p, amplitude, width):
    # The ends are exactly a width apart; the first value stands for those before it.
    for t in range(len(x)):
        begin = max(t - width, 0)
        for s in range(begin, t + 1):
            if x[s] - x[begin] >= amplitude and x[s] - x[t] >= amplitude:
                return True
    return False


def ups(x, level, amplitude):
    """Return the instants at which a relay with hysteresis switches on, after it was switched off once."""
    found, on, armed = [], False, False
    for t, value in enumerate(x):
        if value < level - amplitude:
            on, armed = False, True
        elif value > level + amplitude and armed and not on:
            on = True
            found.append(t)
    return found


def most_swings(x, level, amplitude, window):
    return max(sum(t - window <= u <= t for u in ups(x, level, amplitude)) for t in range(len(x)))


def oscillates(x, _p, level, amplitude, times, window):
    return most_swings(x, level, amplitude, window) >= times


def no_oscillation(x, _p, level, amplitude, times, window):
    return most_swings(x, level, amplitude, window) <= times


def oscillation_period(x, _p, level, amplitude, shortest, longest):
    return all(shortest <= gap <= longest for gap in np.diff(ups(x, level, amplitude)))


def rise_time(x, _p, low, high, limit):
    starts = [t for t in range(1, len(x)) if x[t - 1] < low <= x[t]]
    return all(max(x[t : t + limit + 1]) >= high for t in starts)


def fall_time(x, p, high, low, limit):
    return rise_time(-x, p, -high, -low, limit)


def overshoot(x, p, target, amount, duration):
    return all(max(x[t : t + duration + 1]) <= target + amount for t in p)


def undershoot(x, p, target, amount, duration):
    return all(min(x[t : t + duration + 1]) >= target - amount for t in p)


def inside(x, target, band, begin, end):
    return all(abs(value - target) <= band for value in x[begin:end])


def settles(x, _p, target, band, within):
    return any(inside(x, target, band, t, len(x)) for t in range(min(within + 1, len(x))))


def settles_after(x, p, target, band, within, duration):
    return all(
        any(inside(x, target, band, u, u + duration + 1) for u in range(t, min(t + within + 1, len(x))))
        for t in p
    )


def tracks(x, _p, target, band, within):
    out = 0
    for value in x:
        out = out + 1 if abs(value - target) > band else 0
        if out > within:
            return False
    return out == 0


def steady_state_error(x, p, target, amount, after, window):
    instants = [t + after for t in p if t + after < len(x)]
    means = [np.mean(x[max(t - window, 0) : t + 1]) for t in instants]
    return all(abs(mean - target) <= amount for mean in means)


NUMBERS, TIMES = st.integers(0, 2), st.integers(1, 3)
#: The definition of each pattern, and its arguments after p and x: numbers (n) and durations (d).
DEFINITIONS = {
    "stays": (lambda x, _p, low, high: bool(((low <= x) & (x <= high)).all()), "nn"),
    "constant": (constant, "nd"),
    "increases": (increases, "d"),
    "decreases": (lambda x, p, duration: increases(-x, p, duration), "d"),
    "bounded_rate": (bounded_rate, "nd"),
    "spike": (spike, "Nd"),
    "no_spike": (lambda *given: not spike(*given), "Nd"),
    "oscillates": (oscillates, "nNnd"),
    "no_oscillation": (no_oscillation, "nNnd"),
    "oscillation_period": (oscillation_period, "nNDd"),
    "rise_time": (rise_time, "nnd"),
    "fall_time": (fall_time, "nnd"),
    "overshoot": (overshoot, "nnd"),
    "undershoot": (undershoot, "nnd"),
    "settles": (settles, "nnd"),
    "settles_after": (settles_after, "nndd"),
    "tracks": (tracks, "nnd"),
    "steady_state_error": (steady_state_error, "nndd"),
}
ARGUMENTS = {"n": NUMBERS, "N": st.integers(0, 1), "d": TIMES, "D": st.integers(2, 3)}
WITH_P = {"increases", "decreases", "overshoot", "undershoot", "settles_after", "steady_state_error"}

_SPECS: dict[str, rtamt.Specification] = {}


def spec_of(call: str) -> rtamt.Specification:
    if call not in _SPECS:
        _SPECS[call] = rtamt.parse(f'import "signals.stl" bool p; float x; require R: {call}')
    return _SPECS[call]


@pytest.mark.parametrize("name", DEFINITIONS)
@given(data=st.data())
def test_a_pattern_holds_where_its_definition_does(name, data):
    definition, kinds = DEFINITIONS[name]
    arguments = [data.draw(ARGUMENTS[kind]) for kind in kinds]
    if kinds[-2:] == "Dd":
        arguments[-1] += arguments[-2]
    trace = data.draw(st.lists(st.tuples(st.integers(-2, 3), st.booleans()), min_size=1, max_size=14))
    x, p = (list(values) for values in zip(*trace, strict=True))
    operands = [*(["p"] if name in WITH_P else []), "x", *map(str, arguments)]
    found = spec_of(f"{name}({', '.join(operands)})").evaluate({"x": x, "p": p}).satisfied
    expected = definition(np.array(x), [t for t, value in enumerate(p) if value], *arguments)
    assert found is bool(expected)


#: With p at the second sample only.
BY_HAND = [
    ("stays(x, 0, 10)", [3, 8, 5], 2),  # 10 - 8
    ("constant(x, 4, 2s)", [0, 1, 3, 2, 5], 1),  # 4 - (5 - 2)
    ("increases(p, x, 2s)", [3, 2, 2.5, 4, 0], 0.5),  # 2.5 - 2; what comes after 2 s does not count
    ("decreases(p, x, 2s)", [3, 2, 2.5, 4, 0], -1.5),  # 4 - 2.5
    ("bounded_rate(x, 3, 2s)", [0, 1, 4, 5, 9], 0.5),  # 3 - (9 - 4) / 2
    ("spike(x, 2, 2s)", [0, 0, 5, 1, 0], 2),  # 5 - max(1, 0) is 2 more than 2
    ("no_spike(x, 2, 2s)", [0, 0, 5, 1, 0], -2),
    # A pulse is no spike of a width at whose beginning x is high: 3 s before the end x is 5, and 2 s before it 0.
    ("no_spike(x, 2, 3s)", [5, 0, 5, 0], 2),
    ("spike(x, 2, 3s)", [5, 0, 5, 0], -2),
    ("no_spike(x, 2, 2s)", [5, 0, 5, 0], -3),
    ("spike(x, 2, 2s)", [5, 0, 5, 0], 3),
    ("no_spike(x, 2, 1s)", [0, 0, 5, 5, 0], 2),  # wider than 1 s: 5 - max(5, 0) is 2 less than 2
    ("oscillates(x, 0, 1, 2, 9s)", [-2, 2, -2, 2, -2, 0], 0),  # two swings up: 2 - 2
    ("no_oscillation(x, 0, 1, 3, 9s)", [-2, 2, -2, 2, -2, 0], 1),  # 3 - 2
    ("rise_time(x, 1, 9, 2s)", [0, 2, 6, 10, 10], 1),  # 10 - 9
    ("rise_time(x, 1, 9, 2s)", [0, 2, 6, 8, 10], -1),  # 8 - 9
    ("fall_time(x, 9, 1, 2s)", [10, 5, 3, 0, 0], 1),  # 1 - 0
    ("overshoot(p, x, 10, 2, 3s)", [20, 6, 11, 10, 10, 20], 1),  # 12 - 11
    ("undershoot(p, x, 5, 2, 3s)", [0, 6, 4, 5, 5, 0], 1),  # 4 - 3
    ("settles(x, 10, 1, 3s)", [0, 6, 10.25, 9.5, 10], 0.5),  # 1 - |9.5 - 10|, from 10.25 on or from 9.5 on
    ("settles_after(p, x, 10, 1, 2s, 1s)", [0, 6, 9.5, 10, 10.25, 0], 0.75),  # 1 - 0.25, from 10 on
    ("tracks(x, 10, 1, 1s)", [10, 4, 9.5, 10, 3, 10], 0.5),  # 1 - |9.5 - 10|
    ("steady_state_error(p, x, 10, 1, 3s, 1s)", [0, 2, 11, 9, 10.5, 1], 0.75),  # 1 - |(9 + 10.5) / 2 - 10|
]


@pytest.mark.parametrize(("call", "x", "robustness"), BY_HAND)
def test_values_computed_by_hand(call, x, robustness):
    data = {"x": [float(value) for value in x], "p": [t == 1 for t in range(len(x))]}
    assert spec_of(call).evaluate(data).robustness == robustness


def test_an_oscillation_that_speeds_up_breaks_the_bound_on_its_period():
    steady = [-2, 2, 2, -2, -2, 2, 2, -2, -2, 2]  # up at 1, 5 and 9
    faster = [-2, 2, 2, -2, -2, 2, -2, 2]  # up at 1, 5 and 7
    spec = spec_of("oscillation_period(x, 0, 1, 3s, 4s)")
    verdicts = [spec.evaluate({"x": x, "p": [False] * len(x)}).satisfied for x in (steady, faster)]
    assert verdicts == [True, False]


DISCRETE_ONLY = {"increases", "decreases", "steady_state_error"}


@pytest.mark.parametrize("name", DEFINITIONS)
def test_the_page_names_the_patterns_of_discrete_time_only(name):
    call = next(
        example.call for group in signal_patterns.GROUPS.values() for example in group if example.name == name
    )
    text = f'import "signals.stl" bool p; float x; require R: {call}'
    data = {"x": [(0.0, 1.0), (1.5, 2.0)], "p": [(0.0, False), (1.0, True)]}
    if name in DISCRETE_ONLY:
        with pytest.raises(rtamt.SpecificationError):
            rtamt.parse(text, time="dense").evaluate(data)
    else:
        assert rtamt.parse(text, time="dense").evaluate(data).satisfied in (True, False)


def test_the_units_of_arguments_are_checked():
    text = 'import "signals.stl" input float x [m] const float most = {} require R: no_spike(x, most, 2s)'
    assert rtamt.parse(text.format("2 [m]")).warnings == ()
    (finding,) = rtamt.parse(text.format("2 [mm]")).warnings
    assert (finding.code, finding.text[finding.span.start :]) == ("RT302", "no_spike(x, most, 2s)")


@pytest.mark.parametrize(
    "example", [each for group in signal_patterns.GROUPS.values() for each in group], ids=str
)
def test_the_page_shows_a_satisfying_and_a_violating_trace_of_each_pattern(example):
    spec = spec_of(example.call)
    results = [
        spec.evaluate(signal_patterns.signals(trace)) for trace in (example.satisfied, example.violated)
    ]
    assert [result.satisfied for result in results] == [True, False]


def test_the_page_has_every_pattern_with_its_formula():
    page = (ROOT / "docs" / "reference" / "signal-patterns.md").read_text(encoding="utf-8")
    library = re.sub(r"\n {4,}", " ", LIBRARY.read_text(encoding="utf-8"))
    defined = dict(re.findall(r"^def (\w+\(.*?\)) = +(.*)$", library, re.MULTILINE))
    names = {signature.partition("(")[0] for signature in defined}
    shown = {each.name for group in signal_patterns.GROUPS.values() for each in group}
    assert names == shown | {"spike_ends", "swung_up", "swings"}
    assert names >= set(DEFINITIONS) == shown
    for signature, formula in defined.items():
        assert f"`{signature}`" in page
        assert f"{signature} = {formula}" in re.sub(r"\n {4,}", " ", page)
