"""Monitors for real-time use: the same results, and no update that takes longer than others."""

from __future__ import annotations

import copy
import pickle
import re
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.cli import main
from rtamt.compiler.program import Program
from rtamt.errors import UsageError

FORMULAS = [
    "always[0:7](x >= y)",
    "historically[2:9](x >= 0) and once[0:1](y >= x)",
    "(x >= 0) until[2:6] (y >= 1)",
    "(x >= 0) since[1:5] (y >= 1)",
    "sqrt(maximum[0:4](x) - 0.2) >= y",
]
RANDOM = np.random.default_rng(1)
X, Y = RANDOM.integers(1, 20, (2, 60)) / 4.0
COPIES = (copy.copy, copy.deepcopy, lambda monitor: pickle.loads(pickle.dumps(monitor)))


def values(monitor: Any) -> list[float]:
    """Update with half of the samples one by one, push the rest in chunks, each to a copy."""
    known = [monitor.update(t, x=X[t], y=Y[t]) for t in range(30)]
    for number, begin in enumerate(range(30, 60, 6)):
        monitor = COPIES[number % 3](monitor)
        times = np.arange(begin, begin + 6)
        known += monitor.update_many({"time": times, "x": X[times], "y": Y[times]}).values.tolist()
    return [each for each in known if each is not None] + monitor.finish().values.tolist()


@pytest.mark.parametrize("text", FORMULAS)
def test_results_are_those_of_other_monitors(text):
    spec = rtamt.parse(text)
    assert values(spec.monitor(worst_case=True)) == values(spec.monitor())


def test_an_update_without_a_value_leaves_the_windows_unchanged():
    spec = rtamt.parse("sqrt(maximum[0:4](x) - minimum[0:2](x) - 1) >= 0")
    steady, other = spec.monitor(worst_case=True), spec.monitor()
    outcomes = [
        [update(monitor, x) for x in (0.0, 5.0, 1.0, 1.0, 1.0, 9.0, 0.0)] for monitor in (steady, other)
    ]
    assert outcomes[0] == outcomes[1]
    assert None in outcomes[0]


def update(monitor: Any, x: float) -> float | None:
    try:
        return monitor.update(monitor.samples, x=x)
    except rtamt.EvaluationError:
        return None


def test_a_reset_monitor_begins_anew():
    monitor = rtamt.parse("once[0:3](x >= 0)").monitor(worst_case=True)
    assert [monitor.update(t, x=x) for t, x in enumerate([5, 1, 1])] == [5, 5, 5]
    monitor.reset()
    assert monitor.update(0, x=1) == 1


def test_the_option_is_part_of_a_compiled_program():
    spec = rtamt.parse("always[0:3](x >= 0)")
    assert Program.from_bytes(spec.compile(worst_case=True).to_bytes()).worst_case
    assert not Program.from_bytes(spec.compile().to_bytes()).worst_case


@pytest.mark.parametrize(
    ("text", "settings", "message"),
    [
        ("sum[0:3](x) >= 0", {}, r"worst_case=True does not take 'sum\[0:3\]\(x\)', a sum over a window"),
        ("once[0:3](x >= 0)", {"time": "dense"}, "worst_case=True needs discrete time"),
        ("once[0:3](x >= 0)", {"verdict": "eager"}, "worst_case= belongs to verdict='delayed'"),
    ],
)
def test_what_has_no_worst_case_is_rejected(text, settings, message):
    with pytest.raises(UsageError, match=message):
        rtamt.parse(text).monitor(worst_case=True, **settings)


@pytest.mark.parametrize("text", ["count[0:1](z < 2)", "duration[0:1](fall(z < 2))"])
def test_the_rewritten_form_of_a_sum_was_shown(text):
    spec = rtamt.parse(f"always[0:2]({text} <= 2)")
    for make in (spec.monitor, spec.compile):
        with pytest.raises(UsageError, match=rf"does not take '{re.escape(text)}', a sum over a window"):
            make(worst_case=True)


def test_the_definition_has_no_worst_case():
    with pytest.raises(UsageError, match="needs the compiled core"):
        rtamt.parse("x >= 0", backend="python").monitor(worst_case=True)


def test_the_command_line_has_the_option(capsys, tmp_path):
    output = tmp_path / "limit.rtamt"
    assert main(["compile", "once[0:3](x >= 0)", "--worst-case", "-o", str(output)]) == 0
    assert Program.from_bytes(output.read_bytes()).worst_case
    assert main(["compile", "sum[0:3](x) >= 0", "--worst-case", "--dump"]) == 2
    assert "a sum over a window" in capsys.readouterr().err
