"""Malformed files of the corpus are reported with file, line and case."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import pytest
from conformance import cases, early

if TYPE_CHECKING:
    from pathlib import Path

CASE: dict[str, Any] = {
    "id": "discrete/x/00", "time": "discrete", "formula": "x", "step": "1", "signals": {"x": [1.0, 2.0]},
    "tree": {"var": "x"}, "values": [1.0, 2.0], "known": [0, 1],
}  # fmt: skip
EARLY: dict[str, Any] = {
    "id": "early/x", "time": "discrete", "formula": "x", "step": "1", "signals": {"x": [1.0]}, "ranges": {},
    "tree": {}, "bounds": [], "verdicts": [], "causation": [],
}  # fmt: skip
FIELDS = "id, time, formula, step, signals, tree, semantics, inputs, values, end, known"
OTHER = {**CASE, "id": "discrete/x/01"}


def without(name: str) -> dict[str, Any]:
    return {key: value for key, value in CASE.items() if key != name}


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cases, "FOLDER", tmp_path)
    monkeypatch.setattr(early, "FOLDER", tmp_path)
    return tmp_path


@pytest.mark.parametrize(
    ("second", "message"),
    [
        ("{", "line 2: no JSON (Expecting property name enclosed in double quotes: line 1 column 2 (char 1))"),
        ("[1, 2]", "line 2: a case is an object, not [1, 2]"),
        (without("id"), "line 2: the field 'id' is missing"),
        (without("values"), "line 2, case 'discrete/x/00': the field 'values' is missing"),
        (without("known"), "line 2, case 'discrete/x/00': the field 'known' is missing"),
        ({**CASE, "value": []}, f"line 2, case 'discrete/x/00': there is no field 'value'; the fields are {FIELDS}"),
        (CASE, "line 2, case 'discrete/x/00': some.jsonl, line 1, has this id, too"),
        ({**OTHER, "time": "sparse"},
         "line 2, case 'discrete/x/01': the time is 'sparse', and must be 'discrete' or 'dense'"),
        ({**OTHER, "values": [1.0]}, "line 2, case 'discrete/x/01': there are 1 values for 2 samples"),
        ({**OTHER, "time": "dense"},
         "line 2, case 'discrete/x/01': the field 'end' is missing, which dense cases have"),
        ({**OTHER, "values": 3}, "line 2, case 'discrete/x/01': 'signals' must be an object, and 'values' a list"),
    ],
)  # fmt: skip
def test_a_malformed_line_of_the_corpus_was_a_traceback(folder: Path, second: Any, message: str) -> None:
    lines = [json.dumps(CASE), second if isinstance(second, str) else json.dumps(second)]
    (folder / "some.jsonl").write_text("\n".join(lines) + "\n")
    with pytest.raises(cases.CorpusError) as error:
        cases.read("some.jsonl")
    assert str(error.value) == f"{folder / 'some.jsonl'}, {message}"


def test_an_id_of_another_file_of_the_corpus_is_rejected(folder: Path) -> None:
    for name in cases.FILES:
        (folder / name).write_text("")
    for name in cases.FILES[:2]:
        (folder / name).write_text(json.dumps(CASE) + "\n")
    with pytest.raises(cases.CorpusError) as error:
        cases.robustness()
    assert str(error.value) == (
        f"{folder / cases.FILES[1]}, line 1, case 'discrete/x/00': {cases.FILES[0]}, line 1, has this id, too"
    )


def test_a_malformed_line_of_early_verdicts_is_reported(folder: Path) -> None:
    (folder / early.FILE).write_text(json.dumps(EARLY) + "\n" + json.dumps(EARLY) + "\n")
    with pytest.raises(cases.CorpusError) as error:
        early.read()
    assert (
        str(error.value)
        == f"{folder / early.FILE}, line 2, case 'early/x': {early.FILE}, line 1, has this id, too"
    )
