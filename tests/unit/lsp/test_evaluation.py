"""Verdicts on recordings for the language server."""

from __future__ import annotations

from rtamt.lsp.evaluation import answer

TEXT = """
require DECIDED: eventually(x >= 3)
require OPEN: always(x >= 3)
require EXACT: always(y >= 1)
"""


def test_missing_samples_leave_verdicts_without_a_robustness_or_none(tmp_path):
    path = tmp_path / "gaps.csv"
    path.write_text("time,x,y\n0,5,1\n1,,1\n2,4,1\n")
    assert answer({"recording": str(path), "text": TEXT}) == {
        "rows": [
            {"name": "DECIDED", "verdict": "satisfied"},
            {
                "name": "OPEN",
                "verdict": "error",
                "reason": "the samples do not decide whether the formula holds, because some are missing or uncertain; "
                "read result.interval",
            },
            {"name": "EXACT", "verdict": "satisfied", "robustness": "0.0"},
        ]
    }
