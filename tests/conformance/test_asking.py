"""The runner of `make conformance` judges rightly: ourselves, a tool that lies and one that breaks down."""

from __future__ import annotations

import dataclasses
import sys
from pathlib import Path
from typing import Any

import asking
import pytest
import shrinking
from conformance import cases

import rtamt

PEERS = Path(__file__).parents[2] / "conformance" / "peers"

LIAR = """
import dataclasses
import sys
sys.path.insert(0, {peers!r})
from protocol import UnsupportedError, operators, serve

def answer(formula, time, mode, signals, end):
    if "since" in operators(formula):
        raise UnsupportedError("since")
    if "xor" in operators(formula):
        sys.exit(1)
    if "iff" in operators(formula):
        raise ValueError("no iff here")
    samples = next(iter(signals.values()))
    if time == "discrete":
        return {{"values": [0.0 for _ in samples]}}
    return {{"values": [[t, 0.0] for t, _ in samples]}}

serve({{"peer": "liar", "modes": [], "conventions": {{}}, "notes": ""}}, answer)
"""


@pytest.fixture
def liar(tmp_path: Path):
    path = tmp_path / "liar.py"
    path.write_text(LIAR.format(peers=str(PEERS)))
    talk = asking.Talk([sys.executable, str(path)])
    yield talk
    talk.close()


CORPUS = {case.id: case for file in cases.FILES for case in cases.read(file)}


def question(case: cases.Case, mode: str, talk: asking.Talk) -> asking.Question:
    found = asking.question_of(case, (case.time, mode), talk.conventions)
    assert found is not None
    return found


def test_we_agree_with_ourselves_in_every_mode() -> None:
    talk = asking.Talk([sys.executable, str(PEERS / "ask_this.py")])
    asked = 0
    for case in list(CORPUS.values())[::40]:
        for mode in talk.modes:
            if mode[0] == case.time and case.semantics == "standard":
                found = asking.question_of(case, mode, talk.conventions, takes_steps=talk.takes_steps)
                if found is not None:
                    assert asking.ask(talk, found).kind in ("agrees", "unsupported"), case.id
                    asked += 1
    talk.close()
    assert asked > 50


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize(
    ("operator", "kind"),
    [("always", "disagrees"), ("since", "unsupported"), ("xor", "crash"), ("iff", "error")],
)
def test_what_a_tool_does_is_told_apart(liar: asking.Talk, time: str, operator: str, kind: str) -> None:
    todo = [CORPUS[f"{time}/{operator}/{k:02}"] for k in range(20)]
    found = [asking.question_of(case, (time, "offline"), {}) for case in todo]
    assert any(asking.ask(liar, one).kind == kind for one in found if one is not None)


class Said:
    """A tool that gives one answer, whatever it is asked."""

    takes_steps = False

    def __init__(self, said: dict[str, Any]) -> None:
        self.said = said

    def ask(self, _question: Any) -> dict[str, Any]:
        return self.said


# once x, from 0 to 3: 1, 2, 2, 5; in dense time judged on [0, 3).
@pytest.mark.parametrize(
    ("time", "said", "kind"),
    [
        ("discrete", {"values": [1.0, 2.0, 2.0, 5.0]}, "agrees"),
        ("discrete", {"values": [1.0, 2.0]}, "incomplete"),
        ("discrete", {"values": []}, "incomplete"),
        ("discrete", {"values": [1.0, 3.0]}, "disagrees"),
        ("dense", {"values": [[0, 1.0], [1, 2.0], [3, 5.0]], "until": 3}, "agrees"),
        ("dense", {"values": [[0, 1.0], [1, 2.0]]}, "agrees"),
        ("dense", {"values": [[0, 1.0], [1, 2.0]], "until": 2}, "incomplete"),
        ("dense", {"values": [[1, 2.0]], "until": 3}, "incomplete"),
        ("dense", {"values": [], "until": 0}, "incomplete"),
        ("dense", {"values": [[-2, 3.0]], "until": -1}, "incomplete"),
        ("dense", {"values": [[0, 1.0], [0.5, 2.0], [1, 2.0]], "until": 2}, "disagrees"),
        ("dense", {"values": [[0, 1.0], [2, 2.0]], "until": 2}, "disagrees"),
        ("dense", {"values": [[0, 3.0]], "until": 0}, "disagrees"),
        ("dense", {"points": [[0, 1.0], [1, 2.0], [2, 2.0]]}, "agrees"),
        ("dense", {"points": [[0, 1.0], [1, 2.0]]}, "incomplete"),
        ("dense", {"points": [[0, 1.0], [1, 1.0]]}, "disagrees"),
    ],
)
def test_an_answer_that_is_right_but_incomplete_is_told_from_a_wrong_one(
    time: str, said: dict[str, Any], kind: str
) -> None:
    values = [1.0, 2.0, 2.0, 5.0]
    signal: list[Any] = values if time == "discrete" else [[t, v] for t, v in enumerate(values)]
    once = rtamt.parse("once x").formula
    asked = asking.Question(once, (time, "online"), {"x": signal}, {})
    talk: Any = Said(said)
    assert asking.ask(talk, asked).kind == kind


def test_a_counterexample_is_made_small_and_stays_one(liar: asking.Talk) -> None:
    wrong = question(CORPUS["corner/discrete/past-over-future/standard"], "offline", liar)
    small, outcome = shrinking.shrunk(liar, wrong, 150)
    assert outcome.kind == "disagrees"
    assert (small.text, small.signals) == ("x", {"x": [5.0]})
    assert (outcome.expected, outcome.got) == ([5.0], [0.0])


def test_a_closed_until_is_translated() -> None:
    case = CORPUS["corner/discrete/until-does-not-ask-for-the-first-at-the-end/standard"]
    plain, closed = (asking.question_of(case, ("discrete", "offline"), c) for c in ({}, {"until": "closed"}))
    assert plain is not None
    assert closed is not None
    assert [v for _, v in plain.expected()] == [3.0] * 3
    assert [v for _, v in closed.expected()] == [-1.0] * 3


def test_only_instants_whose_windows_end_inside_the_trace_are_judged() -> None:
    listing = asking.question_of(CORPUS["corner/dense/listing-1/standard"], ("dense", "offline"), {})
    assert listing is None  # an unbounded always over a bounded eventually
    window = asking.question_of(
        CORPUS["corner/discrete/window-cut-at-the-end/standard"], ("discrete", "offline"), {}
    )
    assert window is not None
    assert window.end == 1  # always[2:3] over four samples


def test_the_answer_of_the_corpus_was_never_looked_at() -> None:
    talk = asking.Talk([sys.executable, str(PEERS / "ask_this.py")])
    kinds = {}
    for name in ("discrete/always/00", "dense/once/00", "discrete/integral/03", "dense/rate/03"):
        case = CORPUS[name]
        for values in (case.values, _moved(case.values)):
            wrong = dataclasses.replace(case, values=values)
            found = asking.question_of(wrong, (case.time, "offline"), {}, takes_steps=True)
            assert found is not None
            kinds.setdefault(name, []).append(asking.ask(talk, found).kind)
    talk.close()
    assert kinds == {name: ["agrees", "disagrees"] for name in kinds}


def _moved(values: list[Any]) -> list[Any]:
    """Return values of which the first differs a little."""
    first, *others = values
    return [[first[0], first[1] + 1e-9], *others] if isinstance(first, list) else [first + 1e-9, *others]


def test_a_formula_that_a_tool_reads_otherwise_has_the_answer_of_the_definition() -> None:
    case = next(case for k in range(20) if (case := CORPUS[f"discrete/rate/{k:02}"]).step != "1")
    mode = ("discrete", "offline")
    of_seconds = asking.question_of(case, mode, {})
    of_steps = asking.question_of(case, mode, {}, takes_steps=True)
    assert of_seconds is not None
    assert of_steps is not None
    assert of_seconds.stored is None  # its steps are seconds
    assert of_steps.stored == [list(pair) for pair in enumerate(case.values)]


@pytest.mark.parametrize(
    ("formula", "off", "kind"),
    [
        ("once x", 1e-15, "disagrees"),
        ("once exp(x)", 1e-13, "agrees"),
        ("once exp(x)", 1e-11, "disagrees"),
    ],
)
def test_only_functions_of_the_c_library_have_a_tolerance(formula: str, off: float, kind: str) -> None:
    asked = asking.Question(rtamt.parse(formula).formula, ("discrete", "offline"), {"x": [1.0]}, {})
    ((_, value),) = asked.expected()
    talk: Any = Said({"values": [value * (1 + off)]})
    assert asking.ask(talk, asked).kind == kind
