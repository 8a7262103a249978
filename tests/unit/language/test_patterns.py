"""The pattern library against its patterns in words: scopes as sets of instants, by brute force."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

    Truth = list[bool]

#: What a pattern requires of the instants of one scope.
PATTERNS: dict[str, tuple[str, Callable[[Truth, Truth], bool]]] = {
    "absence": ("p", lambda p, _s: not any(p)),
    "universality": ("p", lambda p, _s: all(p)),
    "existence": ("p", lambda p, _s: any(p)),
    "response": ("p, s", lambda p, s: all(any(s[t:]) for t in range(len(p)) if p[t])),
    "precedence": ("p, s", lambda p, s: all(any(s[: t + 1]) for t in range(len(p)) if p[t])),
}


def _next(r: Truth, t: int) -> int | None:
    return next((u for u in range(t, len(r)) if r[u]), None)


def _before(_q: Truth, r: Truth) -> list[range]:
    first = _next(r, 0)
    return [] if first is None else [range(first)]


def _after(q: Truth, _r: Truth) -> list[range]:
    first = _next(q, 0)
    return [] if first is None else [range(first, len(q))]


def _opened(q: Truth, r: Truth) -> list[tuple[int, int | None]]:
    return [(t, _next(r, t)) for t in range(len(q)) if q[t] and not r[t]]


SCOPES: dict[str, tuple[str, Callable[[Truth, Truth], list[range]]]] = {
    "": ("", lambda q, _r: [range(len(q))]),
    "_before": (", r", _before),
    "_after": (", q", _after),
    "_between": (
        ", q, r",
        lambda q, r: [range(begin, end) for begin, end in _opened(q, r) if end is not None],
    ),
    "_until": (
        ", q, r",
        lambda q, r: [range(begin, len(q) if end is None else end) for begin, end in _opened(q, r)],
    ),
}

NAMES = [(pattern, scope) for pattern in PATTERNS for scope in SCOPES]


@pytest.mark.parametrize(("pattern", "scope"), NAMES)
@given(trace=st.lists(st.tuples(*[st.booleans()] * 4), min_size=1, max_size=9))
def test_a_pattern_holds_where_every_scope_has_it(pattern, scope, trace):
    operands, holds = PATTERNS[pattern]
    names, scopes = SCOPES[scope]
    signals = dict(zip("pqrs", (list(values) for values in zip(*trace, strict=True)), strict=True))
    within = scopes(signals["q"], signals["r"])
    expected = all(
        holds([signals["p"][t] for t in instants], [signals["s"][t] for t in instants]) for instants in within
    )
    spec = _spec(f"{pattern}{scope}({operands}{names})")
    assert spec.evaluate(signals).satisfied is expected


_SPECS: dict[str, rtamt.Specification] = {}


def _spec(call: str) -> rtamt.Specification:
    if call not in _SPECS:
        text = f'import "patterns.stl" bool p; bool q; bool r; bool s; require R: {call}'
        _SPECS[call] = rtamt.parse(text)
    return _SPECS[call]


#: Of the patterns with times: a call, p and s of a satisfying trace, and of a violating one.
TIMED = {
    "response_within(p, s, 2s)": (("100100", "001100"), ("100100", "000100")),
    "invariance(p, s, duration=2s)": (("010000", "011100"), ("010000", "011000")),
    "recurrence(p, 2s)": (("001001", "000000"), ("100001", "000000")),
    "minimum_duration(p, 2s)": (("0111011", "0000000"), ("0110000", "0000000")),
    "maximum_duration(p, 2s)": (("0110110", "0000000"), ("0111000", "0000000")),
}


@pytest.mark.parametrize("call", TIMED)
def test_a_pattern_with_times_separates_two_traces(call):
    for traces, satisfied in zip(TIMED[call], (True, False), strict=True):
        p, s = ([value == "1" for value in trace] for trace in traces)
        result = _spec(call).evaluate({"p": p, "q": p, "r": p, "s": s})
        assert result.satisfied is satisfied, (call, traces)


def test_a_pattern_of_margins_has_the_robustness_of_its_worst_instant():
    spec = rtamt.parse('import "patterns.stl" response_within(x >= 3, y >= 1, 2s)')
    # Only x = 4 asks for an answer, which exceeds its threshold by 1.5.
    assert spec.evaluate({"x": [0, 4, 0, 0, 0], "y": [0, 0, 0, 2.5, 0]}).robustness == 1.5
