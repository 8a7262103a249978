"""The pattern library against its patterns in words: scopes as sets of instants, by brute force."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tools import patterns

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

    Truth = list[bool]

ROOT = Path(__file__).parents[3]
LIBRARY = ROOT / "src" / "rtamt" / "library" / "patterns.stl"

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
        _SPECS[call] = patterns.specification(call)
    return _SPECS[call]


@pytest.mark.parametrize("group", patterns.EXAMPLES)
def test_the_page_shows_a_satisfying_and_a_violating_trace_of_each_pattern(group):
    for call, (shared, *different) in patterns.EXAMPLES[group].items():
        results = [_spec(call).evaluate(patterns.signals({**shared, **own})) for own in different]
        assert [result.satisfied for result in results] == [True, False], call


def test_the_page_has_every_pattern_with_its_formula():
    page = (ROOT / "docs" / "reference" / "patterns.md").read_text(encoding="utf-8")
    library = LIBRARY.read_text(encoding="utf-8").replace("\n    ", " ")
    defined = re.findall(r"^def (\w+)(\(.*?\)) = +(.*)$", library, re.MULTILINE)
    shown = {call.partition("(")[0] for group in patterns.EXAMPLES.values() for call in group}
    assert {name for name, _, _ in defined} == shown | {"within_scope"}
    for name, parameters, formula in defined:
        assert name == "within_scope" or f"| `{name}{parameters}` | `{formula}` |" in page


def test_a_pattern_of_margins_has_the_robustness_of_its_worst_instant():
    spec = rtamt.parse('import "patterns.stl" response_within(x >= 3, y >= 1, 2s)')
    # Only x = 4 asks for an answer, which exceeds its threshold by 1.5.
    assert spec.evaluate({"x": [0, 4, 0, 0, 0], "y": [0, 0, 0, 2.5, 0]}).robustness == 1.5
