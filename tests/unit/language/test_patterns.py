"""The pattern library against its patterns in words: scopes as sets of instants, by brute force."""

from __future__ import annotations

import functools
import re
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from hypothesis import given
from hypothesis import strategies as st
from tools import patterns
from tools.pattern_examples import EXAMPLES

import rtamt

if TYPE_CHECKING:
    from collections.abc import Callable

    from tools.patterns import Time

    Truth = list[bool]

TIMES: tuple[Time, ...] = ("discrete", "dense")
ROOT = Path(__file__).parents[3]
LIBRARY = ROOT / "src" / "rtamt" / "library" / "patterns.stl"

#: Parts of the patterns; the page explains them in words.
HELPERS = {"within_scope", "occurrences", "reaches", "reaches_later"}

#: What a pattern requires of the instants of one scope.
PATTERNS: dict[str, tuple[str, Callable[[Truth, Truth, Truth], bool]]] = {
    "absence": ("p", lambda p, _s, _t: not any(p)),
    "universality": ("p", lambda p, _s, _t: all(p)),
    "existence": ("p", lambda p, _s, _t: any(p)),
    "bounded_existence": (
        "p, 1",
        lambda p, _s, _t: sum(p[i] and (i == 0 or not p[i - 1]) for i in _all(p)) <= 1,
    ),
    "response": ("p, s", lambda p, s, _t: all(any(s[i:]) for i in _where(p))),
    "precedence": ("p, s", lambda p, s, _t: all(any(s[: i + 1]) for i in _where(p))),
    "response_chain": (
        "p, s, t",
        lambda p, s, t: all(any(i <= j and any(t[j + 1 :]) for j in _where(s)) for i in _where(p)),
    ),
    "chain_response": (
        "s, t, p",
        lambda p, s, t: all(any(p[t.index(True, i + 1) :]) for i in _where(s) if any(t[i + 1 :])),
    ),
    "precedence_chain": (
        "p, s, t",
        lambda p, s, t: all(any(j <= i and any(s[:j]) for j in _where(t)) for i in _where(p)),
    ),
    "chain_precedence": (
        "s, t, p",
        lambda p, s, t: all(any(p[: i + 1]) for i in _where(s) if any(t[i + 1 :])),
    ),
}


def _all(p: Truth) -> range:
    return range(len(p))


def _where(p: Truth) -> list[int]:
    return [i for i, value in enumerate(p) if value]


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

#: What a pattern with times requires of a scope of a trace, of which p and s are given, for a duration of one sample.
TIMED: dict[str, tuple[str, Callable[[Truth, Truth, range], bool]]] = {
    "existence_within": ("p, 1s", lambda p, _s, scope: any(p[i] for i in scope[:2])),
    "response_within": (
        "p, s, 1s",
        lambda p, s, scope: all(any(s[j] for j in _window(scope, i)) for i in scope if p[i]),
    ),
    "precedence_within": (
        "p, s, 1s",
        lambda p, s, scope: all(any(s[j] for j in scope if i - 1 <= j <= i) for i in scope if p[i]),
    ),
    "invariance": (
        "p, s, 1s",
        lambda p, s, scope: all(all(s[j] for j in _window(scope, i)) for i in scope if p[i]),
    ),
    "recurrence": (
        "p, 1s",
        lambda p, _s, scope: all(any(p[j] for j in _window(scope, i)) or _ends(p, scope, i) for i in scope),
    ),
    "minimum_duration": (
        "p, 1s",
        lambda p, _s, scope: all(all(p[j] for j in _window(scope, i)) for i in scope if _becomes_true(p, i)),
    ),
    "maximum_duration": (
        "p, 1s",
        lambda p, _s, scope: all(
            not all(p[j] for j in _window(scope, i)) or _ends(p, scope, i)
            for i in scope
            if _becomes_true(p, i)
        ),
    ),
}


def _window(scope: range, i: int) -> list[int]:
    return [j for j in scope if i <= j <= i + 1]


def _ends(p: Truth, scope: range, i: int) -> bool:
    """Whether an r, and not the end of the trace, ends the scope within the duration after i."""
    return scope.stop < len(p) and scope.stop <= i + 1


def _becomes_true(p: Truth, i: int) -> bool:
    return p[i] and (i == 0 or not p[i - 1])


TRACES = st.lists(st.tuples(*[st.booleans()] * 5), min_size=1, max_size=9).map(
    lambda rows: dict(zip("pqrst", (list(values) for values in zip(*rows, strict=True)), strict=True))
)


def _expected(pattern: str, scope: str, signals: dict[str, Truth]) -> bool:
    holds, scopes = PATTERNS[pattern][1], SCOPES[scope][1]
    within = scopes(signals["q"], signals["r"])
    return all(holds(*([signals[name][i] for i in instants] for name in "pst")) for instants in within)


@functools.cache
def _spec(*calls: str, time: Time = "discrete") -> rtamt.Specification:
    return patterns.specification(*calls, time=time)


def _in_scopes(pattern: str, operands: str, time: Time) -> rtamt.Specification:
    return _spec(*(f"{pattern}{scope}({operands}{names})" for scope, (names, _) in SCOPES.items()), time=time)


@pytest.mark.parametrize("pattern", PATTERNS)
@given(signals=TRACES)
def test_a_pattern_holds_where_every_scope_has_it(pattern, signals):
    result = _in_scopes(pattern, PATTERNS[pattern][0], "discrete").evaluate(signals)
    satisfied = [part.satisfied for part in result.requirements.values()]
    assert satisfied == [_expected(pattern, scope, signals) for scope in SCOPES]


@pytest.mark.parametrize("pattern", TIMED)
@given(signals=TRACES)
def test_a_pattern_with_times_holds_where_every_scope_has_it(pattern, signals):
    operands, holds = TIMED[pattern]
    result = _in_scopes(pattern, operands, "discrete").evaluate(signals)
    satisfied = [part.satisfied for part in result.requirements.values()]
    assert satisfied == [
        all(holds(signals["p"], signals["s"], scope) for scope in scopes(signals["q"], signals["r"]))
        for _, scopes in SCOPES.values()
    ]


@given(signals=TRACES)
def test_bounded_existence_counts_the_same_in_dense_time(signals):
    steps = {name: list(enumerate(values)) for name, values in signals.items()}
    result = _in_scopes("bounded_existence", "p, 1", "dense").evaluate(steps)
    satisfied = [part.satisfied for part in result.requirements.values()]
    assert satisfied == [_expected("bounded_existence", scope, signals) for scope in SCOPES]


@pytest.mark.parametrize("group", EXAMPLES)
def test_the_page_shows_a_satisfying_and_a_violating_trace_of_each_pattern(group):
    for call, (shared, *different) in EXAMPLES[group].items():
        for time in TIMES:
            traces = [patterns.signals({**shared, **own}, time) for own in different]
            results = [_spec(call, time=time).evaluate(trace) for trace in traces]
            assert [result.satisfied for result in results] == [True, False], (call, time)


def test_the_page_has_every_pattern_with_its_formula():
    page = (ROOT / "docs" / "reference" / "patterns.md").read_text(encoding="utf-8")
    library = LIBRARY.read_text(encoding="utf-8").replace("\n    ", " ")
    defined = re.findall(r"^def (\w+)(\(.*?\)) = +(.*)$", library, re.MULTILINE)
    shown = {call.partition("(")[0] for group in EXAMPLES.values() for call in group}
    assert {name for name, _, _ in defined} == shown | HELPERS
    for name, parameters, formula in defined:
        assert name in HELPERS or f"| `{name}{parameters}` | `{formula}` |" in page


def test_a_pattern_of_margins_has_the_robustness_of_its_worst_instant():
    spec = rtamt.parse('import "patterns.stl" response_within(x >= 3, y >= 1, 2s)')
    # Only x = 4 asks for an answer, which exceeds its threshold by 1.5.
    assert spec.evaluate({"x": [0, 4, 0, 0, 0], "y": [0, 0, 0, 2.5, 0]}).robustness == 1.5
