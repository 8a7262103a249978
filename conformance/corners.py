"""Hand-written cases: worked values, the paper's figures and listings, and common errors of tools.

Formula and trace only; the answers are computed like all others.
"""

from __future__ import annotations

import csv
from math import inf
from pathlib import Path

from conformance.cases import SEMANTICS, Case

_FIGURE_4 = Path(__file__).parents[1] / "examples" / "request_grant"

X5 = {"x": [5.0, 4.0, 3.0, 9.0]}
XY = {"x": [9.0, 2.0, 8.0], "y": [5.0, 1.0, 0.0]}
ZERO = {"x": [3.0, 2.5, 3.5, 3.0]}

_TABLE = "table curve = {(0, 1), (4, 3), (6, -1)};"

# Booleans are 1 or 0 in a trace, members their codes.
_TYPES = "enum Mode { MANUAL, AUTO = 4, RTL }  input Mode mode  input bool p  float x  "
_MODES = {"mode": [0.0, 4.0, 5.0, 4.0, 7.0], "p": [0.0, 1.0, 1.0, 0.0, 1.0], "x": [3.0, 1.0, 2.5, 4.0, 0.0]}


def _with(*names: str) -> dict[str, list[float]]:
    return {name: _MODES[name] for name in names}


_TYPED = (
    ("a-boolean-is-infinite", "always[0:1](p or x > 2)", _with("p", "x")),
    ("a-boolean-is-a-number-in-arithmetic", "2 * p >= x or p == 1", _with("p", "x")),
    ("a-boolean-implies-a-member", "p -> mode == AUTO", _with("p", "mode")),
    ("members-of-a-set", "once[0:1](mode in {AUTO, RTL})", _with("mode")),
    ("an-unknown-code-is-no-member", "mode != MANUAL and mode != AUTO and mode != RTL", _with("mode")),
    ("a-member-beside-a-margin", "eventually[0:2](mode == RTL and x > 2)", _with("mode", "x")),
    ("the-member-before", "delay[1](mode, RTL) == AUTO", _with("mode")),
    ("the-member-that-is-held", "held(mode, p) == RTL", _with("mode", "p")),
    ("a-boolean-before-the-start", "delay[1](p, true) and held(p, x > 2, false)", _with("p", "x")),
    ("a-choice-of-members", "(if p then mode else RTL) == AUTO", _with("mode", "p")),
)

# name, formula, signals, and the period where it is not 1 s
DISCRETE = (
    ("until-does-not-ask-for-the-first-at-the-end", "x until y", {"x": [-1.0] * 3, "y": [3.0] * 3}),
    ("equal-sub-formulas", "once[2:2](x > 0) or once[2:2](x > 0)", {"x": [1.0, 2.0, 3.0, 4.0, 5.0]}),
    ("past-over-future", "historically(eventually[0:2] x)", {"x": [0.0, 0.0, 5.0, 5.0, 5.0, 5.0, 5.0]}),
    ("future-over-past", "eventually[0:2] historically[0:1] x", {"x": [0.0, 1.0, 5.0, 5.0, 2.0, 5.0]}),
    ("once-over-next", "once[0:1] next x", {"x": [3.0, 1.0, 4.0, 1.0, 5.0]}),
    ("two-horizons", "always[0:2](x >= 1) and x >= 2", {"x": [3.0, 1.0, 4.0, 1.0, 5.0]}),
    ("three-horizons", "(eventually[1:3] x) or next(x) or x", {"x": [3.0, 1.0, 4.0, 1.0, 5.0]}),
    ("since-over-until", "(x until[0:2] y) since[0:2] (y >= 1)", {**XY}),
    ("nested-until", "(x until[0:1] y) until[1:2] (y until[0:1] x)", {**XY}),
    ("window-cut-at-the-start", "historically[1:2] x", X5),
    ("window-cut-at-the-end", "always[2:3] x", X5),
    ("window-before-the-trace", "once[6:9] x", X5),
    ("window-before-the-trace-all", "historically[6:9] x", X5),
    ("window-after-the-trace", "eventually[6:9] x", X5),
    ("window-after-the-trace-all", "always[6:9] x", X5),
    ("window-of-one", "once[2:2] x", X5),
    ("unbounded-from-2", "once[2:inf] x", X5),
    ("unbounded-ahead-from-2", "eventually[2:inf] x", X5),
    ("one-sample", "always[0:3](x until[1:2] x)", {"x": [2.0]}),
    ("since-one-ago", "x since[1:1] y", XY),
    ("until-one-ahead", "x until[1:1] y", XY),
    ("unless", "x unless y", XY),
    ("unless-later", "x unless[1:2] y", XY),
    ("precedes", "x precedes[1:2] y", XY),
    ("prev-is-weak", "prev x", X5),
    ("next-is-weak", "next x", X5),
    ("s_prev-is-strong", "s_prev x", X5),
    ("s_next-is-strong", "s_next x", X5),
    ("rise-at-the-first-sample", "rise(x >= 0)", {"x": [1.0, -1.0, 1.0, 2.0]}),
    ("fall-at-the-first-sample", "fall(x >= 0)", {"x": [-1.0, 1.0, -1.0, -2.0]}),
    ("half-open-behind", "once(0:2] x", X5),
    ("half-open-ahead", "always[1:3) x", X5),
    ("half-open-at-both-ends", "x until(0:3) y", XY),
    ("half-open-and-unbounded", "x since(0:inf) y", XY),
    ("half-open-of-half-a-second", "eventually(0:1s) x", {"x": [5.0, 4.0, 3.5, 9.0, 7.0]}, "1/2"),
    ("both-true-is-iff", "x >= 0 <-> y >= 0", {"x": [1.0, -1.0], "y": [4.0, -3.0]}),
    ("both-true-is-not-xor", "x >= 0 xor y >= 0", {"x": [1.0, -1.0], "y": [4.0, -3.0]}),
    ("implication-to-the-right", "x >= 0 -> y >= 0 -> x >= 2", {"x": [1.0, -1.0], "y": [4.0, -3.0]}),
    ("negative-literal", "x >= -2", {"x": [-3.0, -2.0, 0.0]}),
    ("minus-a-variable", "-x >= -2", {"x": [-3.0, 2.0, 3.0]}),
    ("minus-of-minus", "- -x - -1 >= 0", {"x": [-3.0, -1.0, 3.0]}),
    ("named-parts", "low = x <= 3; always[0:1] low", X5),
    ("time-after-time", "always[0:1] eventually[0:2] always[0:1] x", {"x": [1.0, 5.0, 4.0, 0.0, 3.0, 3.0]}),
    ("equality-of-thirds", "x + y == 0.3", {"x": [0.1], "y": [0.2]}),
    ("tiny", "x >= 0", {"x": [5e-324, -5e-324, 2.2250738585072014e-308]}),
    ("huge", "2 * x >= 0", {"x": [1.7976931348623157e308, -1e308, 8e307]}),
    ("infinite-input", "always[0:1](x >= 3)", {"x": [inf, 1.0, -inf, inf]}),
    ("infinite-both", "eventually[0:1](x >= 3) and once x", {"x": [-inf, inf, 0.0]}),
    ("minus-zero", "eventually[0:1] x", {"x": [-0.0, 0.0, -0.0]}),
    ("not-at-zero", "not(x >= 3)", ZERO),
    ("period-100ms", "always[0:300ms](x >= 3)", {"x": [5.0, 4.0, 3.5, 9.0, 7.0]}, "1/10"),
    ("period-100ms-in-seconds", "x >= 4 since[0.1:0.3] x >= 8", {"x": [9.0, 4.0, 3.5, 9.0, 7.0]}, "1/10"),
    ("period-half-in-units", "eventually[500ms:1s] x", {"x": [5.0, 4.0, 3.5, 9.0, 7.0]}, "1/2"),
    ("true-and-false", "(true until[1:2] x) or false", X5),
    ("a-number-is-a-formula", "always[0:1] (x - 4)", X5),
    ("beyond-the-ends-of-a-table", f"{_TABLE} curve(x) >= 2", {"x": [-inf, -1.0, 0.0, 2.0, 4.0, 9.0, inf]}),
    (
        "between-the-points-of-a-table",
        f"{_TABLE} always[0:1](curve(x) >= y)",
        {"x": [1.0, 3.0], "y": [0.0, 2.0]},
    ),
    *((name, _TYPES + formula, signals) for name, formula, signals in _TYPED),
)

# The same of dense time: a signal is (tick, value) pairs, and last comes the length of a tick in seconds.
REQ = [(0, 0.0), (2, 6.0), (4, 0.0), (10, 0.0)]
GNT = [(0, 0.0), (6, 6.0), (8, 0.0), (10, 0.0)]
HOUR = 3_600_000_000_000
EPOCH = 1_700_000_000_000_000_000
STEPS = {"x": [(0, 5.0), (2, 4.0), (3, 3.0), (7, 9.0), (8, 9.0)]}
TWO = {"x": [(0, 2.0), (3, -1.0), (5, 4.0), (9, 0.0)], "y": [(0, -3.0), (3, 5.0), (4, 1.0), (9, 2.0)]}

DENSE = (
    ("listing-1", "always(req >= 3 -> eventually[0:5](gnt >= 3))", {"req": REQ, "gnt": GNT}),
    (
        "listing-2",
        "historically[0:10]((once[5:5](req >= 3)) -> (once[0:5](gnt >= 3)))",
        {"req": REQ, "gnt": [(0, 0.0), (5, 6.0), (8, 0.0), (10, 0.0)]},
    ),
    (
        "until-does-not-ask-for-the-first-at-the-end",
        "x until y",
        {"x": [(0, -1.0)], "y": [(0, 3.0), (4, 3.0)]},
    ),
    ("reached-as-the-first-ends", "(h < 0.5) until[0:1] (h >= 0.5)", {"h": [(0, 0.0), (1, 1.0)]}, "1/2"),
    ("reached-later-than-the-first-ends", "x until[1:2] y", TWO),
    ("a-lone-value-at-an-instant", "x until[2:2] y", {"x": [(0, 2.0), (2, -1.0)], "y": [(0, 0.0), (2, 5.0)]}),
    ("since-asks-for-the-rest-of-the-segment", "x since y", TWO),
    ("since-later", "x since[1:3] y", TWO),
    ("precedes", "x precedes[1:3] y", TWO),
    ("precedes-of-a-point", "x precedes[2:2] y", TWO),
    ("unless", "x unless y", TWO),
    ("unless-later", "x unless[1:2] y", TWO),
    ("the-last-value-holds", "eventually[0:3](x >= 4)", STEPS),
    ("a-window-after-the-trace", "eventually[20:30] x", STEPS),
    ("a-window-before-the-trace", "once[20:30] x", STEPS),
    ("a-window-that-ends-before-the-trace", "historically[20:30] x", STEPS),
    ("a-delay", "once[3:3] x", STEPS),
    ("past-over-future", "historically(eventually[0:2] x)", STEPS),
    ("future-over-past", "always[1:2] once[0:2] x", STEPS),
    ("equal-sub-formulas", "once[2:2](x > 0) or once[2:2](x > 0)", STEPS),
    ("iff", "x >= 0 <-> y >= 0", TWO),
    ("starts-differ", "x >= 0 and y >= 0", {"x": [(0, 1.0), (5, 2.0)], "y": [(3, 4.0), (4, 0.5)]}),
    ("one-ends-before-the-other-begins", "x since y", {"x": [(0, 1.0), (2, 3.0)], "y": [(6, 4.0), (9, 0.5)]}),
    ("one-sample-each", "eventually[0:1](x >= y)", {"x": [(4, 1.0)], "y": [(4, 2.0)]}),
    ("one-sample", "always(x >= 3)", {"x": [(7, 5.0)]}),
    ("values-that-repeat", "rose = x >= 2; once[0:1] rose", {"x": [(0, 1.0), (1, 1.0), (2, 3.0), (3, 3.0)]}),
    ("half-a-second-in-ms", "eventually[0:500ms] x", {"x": [(0, 1.0), (7, 5.0), (20, 0.0)]}, "1/10"),
    ("exactly-200-ms-after", "once[0:0.2] x", {"x": [(1, 5.0), (2, 0.0), (3, 0.0), (9, 0.0)]}, "1/10"),
    (
        "exactly-100-ns-after-hours",
        "always(a >= 1 -> eventually[0:100ns](b >= 1))",
        {
            "a": [(5 * HOUR, 0.0), (5 * HOUR + 7, 2.0), (5 * HOUR + 8, 0.0), (5 * HOUR + 120, 0.0)],
            "b": [(5 * HOUR, 0.0), (5 * HOUR + 107, 2.0), (5 * HOUR + 108, 0.0)],
        },
        "1/1000000000",
    ),
    (
        "one-tick-too-late",
        "a >= 1 -> eventually[0:100ns](b >= 1)",
        {
            "a": [(EPOCH, 0.0), (EPOCH + 7, 2.0), (EPOCH + 8, 0.0), (EPOCH + 120, 0.0)],
            "b": [(EPOCH, 0.0), (EPOCH + 108, 2.0), (EPOCH + 109, 0.0)],
        },
        "1/1000000000",
    ),
    ("rise-at-the-start", "rise(x >= 4)", STEPS),
    ("fall-at-the-start", "fall(x >= 6)", STEPS),
    ("a-rise-is-one-tick-long", "once[0:2] rise(x >= 4 and y >= 0)", TWO, "1/2"),
    ("a-pulse-is-counted-until-it-has-left", "count[1:2](x >= 4) >= 1", STEPS),
    ("pulses-so-far", "count(x >= 0) - count[0:2](y >= 2) >= 2", TWO),
    ("pulses-ahead", "eventually[1:3](count[0:2](x >= 0 and y >= 0) >= 1)", TWO, "1/2"),
    ("half-open-behind", "once(0:2] x", STEPS),
    ("half-open-ahead", "x until[0:2) y", TWO, "1/2"),
    ("half-open-and-unbounded", "x since(1:inf) y", TWO, "1/2"),
    ("infinite-input", "always[0:1](x >= 3)", {"x": [(0, inf), (2, -inf), (3, 4.0)]}),
    ("negative-times", "once[1:2] x", {"x": [(-9, 1.0), (-7, 5.0), (-3, 0.0)]}),
    ("between-the-points-of-a-table", f"{_TABLE} always[0:1](curve(x) >= y)", TWO),
    *(
        (name, _TYPES + formula, {signal: list(enumerate(values)) for signal, values in signals.items()})
        for name, formula, signals in _TYPED
    ),
)

# Values at which the semantics differ.
_ROLES = "always[0:1](x >= 3 -> eventually[0:1](y > 2)) and x + y != 4 and once(x == 3)"


def cases() -> list[Case]:
    """Return the cases, answers left out."""
    made = []
    for name, formula, signals, *period in DISCRETE:
        made += [_discrete(name, formula, signals, *period, semantics=s) for s in ("standard", "boolean")]
    for name, formula, dense, *tick in DENSE:
        made += [_dense(name, formula, dense, *tick, semantics=s) for s in ("standard", "boolean")]
    figure = "always(req >= 3 -> eventually[0:5](gnt >= 3))"
    for path in sorted(_FIGURE_4.glob("*.csv")):
        rows = list(csv.DictReader(path.read_text(encoding="utf-8").splitlines()))
        signals = {name: [float(row[name]) for row in rows] for name in ("req", "gnt")}
        held = {name: list(enumerate(column)) for name, column in signals.items()}
        for semantics in SEMANTICS:
            name = f"figure-4-{path.stem}"
            made.append(_discrete(name, figure, signals, semantics=semantics, inputs=["req"]))
            made.append(_dense(name, figure, held, semantics=semantics, inputs=["req"]))
    trace = {"x": [3.0, 2.0, 3.0, 4.0], "y": [2.0, 2.0, 3.0, 1.0]}
    for semantics in SEMANTICS:
        made.append(_discrete("roles", _ROLES, trace, semantics=semantics, inputs=["x"]))
    return made


def _discrete(
    name: str,
    formula: str,
    signals: dict[str, list[float]],
    period: str = "1",
    *,
    semantics: str,
    inputs: list[str] | None = None,
) -> Case:
    case = f"corner/discrete/{name}/{semantics}"
    return Case(case, "discrete", formula, period, signals, semantics, _inputs(semantics, inputs))


def _dense(
    name: str,
    formula: str,
    signals: dict[str, list[tuple[int, float]]],
    tick: str = "1",
    *,
    semantics: str,
    inputs: list[str] | None = None,
) -> Case:
    pairs = {variable: [list(pair) for pair in samples] for variable, samples in signals.items()}
    case = f"corner/dense/{name}/{semantics}"
    return Case(case, "dense", formula, tick, pairs, semantics, _inputs(semantics, inputs))


def _inputs(semantics: str, inputs: list[str] | None) -> list[str]:
    return [] if inputs is None or semantics in ("standard", "boolean") else inputs
