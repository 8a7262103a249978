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
            "verdict is 'eagre'; did you mean 'eager'?; choose from delayed, eager, interval",
        ),
        (
            "x",
            {"lateness": 2},
            "lateness= belongs to verdict='interval', and this is verdict='delayed'",
        ),
        ("x", {"verdict": "interval", "at": "end"}, "at is 'end'; choose from start, every"),
        (
            "x",
            {"verdict": "interval", "ranges": {"x": (3, 1)}},
            "the range of 'x' is (3, 1), reversed; give (lower, upper)",
        ),
    ],
)
def test_wrong_setting_is_rejected_with_one_sentence(text, settings, message):
    with pytest.raises(rtamt.UsageError) as error:
        rtamt.parse(text).monitor(**settings)
    assert str(error.value) == message
