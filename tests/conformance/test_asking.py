"""The runner of `make conformance` judges rightly: ourselves, a tool that lies and one that breaks down."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from tests.conformance import cases

PEERS = Path(__file__).parents[2] / "benchmarks" / "peers"
sys.path.insert(0, str(PEERS))

import asking  # noqa: E402 - found by the line above
import shrinking  # noqa: E402

LIAR = """
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
                found = asking.question_of(case, mode, talk.conventions)
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
