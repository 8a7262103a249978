"""Settings that a verdict mode does not have, or that are wrong."""

from __future__ import annotations

import pytest

import rtamt


@pytest.mark.parametrize(
    ("text", "settings", "message"),
    [
        (
            "x",
            {"verdict": "eagre"},
            "verdict is 'eagre'; did you mean 'eager'? (verdicts: eager, delayed, interval, causation)",
        ),
        (
            "x",
            {"lateness": 2},
            "lateness= belongs to verdict='interval', and this is verdict='delayed'",
        ),
        ("x", {"verdict": "interval", "at": "end"}, "at is 'end'; choices: start, every"),
        (
            "x",
            {"verdict": "interval", "ranges": {"x": (3, 1)}},
            "the range of 'x' is (3, 1), reversed; give (lower, upper)",
        ),
        (
            "x",
            {"verdict": "causation", "ranges": {"x": (1, 3)}},
            "ranges= belongs to verdict='eager' or 'interval', and this is verdict='causation'",
        ),
    ],
)
def test_wrong_setting_is_rejected_with_one_sentence(text, settings, message):
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.parse(text).monitor(**settings)
    assert str(error.value) == message


TIMES = pytest.mark.parametrize("time", ["discrete", "dense"])


@TIMES
def test_causation_of_a_share_is_rejected_with_a_caret(time):
    with pytest.raises(rtamt.SpecificationError) as error:
        rtamt.parse("always(atleast[0:3](80%, x > 0))").monitor(verdict="causation", time=time)
    assert str(error.value) == (
        "'atleast[0:3](80%, x > 0)' is a share of a window, which has no causation; use another verdict mode\n"
        "  line 1, column 8:\n    always(atleast[0:3](80%, x > 0))\n           ^^^^^^^^^^^^^^^^^^^^^^^^"
    )


@TIMES
def test_causation_of_an_uncertain_sample_is_rejected_with_one_sentence(time):
    monitor = rtamt.parse("always(x >= 0)").monitor(verdict="causation", time=time)
    with pytest.raises(rtamt.TraceError) as error:
        monitor.update(0, x=(4.8, 5.0))
    assert str(error.value) == (
        "'x' is (4.8, 5.0) at sample 0, time 0 s, and causation needs exact samples: give a number, or monitor with "
        "verdict='interval'"
    )


@TIMES
def test_causation_at_an_instant_of_unbounded_future_is_rejected_with_one_sentence(time):
    monitor = rtamt.parse("always(x >= 0)").monitor(verdict="causation", time=time)
    with pytest.raises(rtamt.UsageError) as error:
        monitor.causation(0)
    assert str(error.value) == (
        "a formula of unbounded future has causation at the start of the trace alone; call causation()"
    )
