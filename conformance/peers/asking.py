"""Questions to peers: a case of the corpus translated, asked of a process, and its answer judged."""

from __future__ import annotations

import json
import math
import selectors
import subprocess
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import TYPE_CHECKING, Any

from conformance.cases import ROUNDED, TOLERANCE
from conformance.trees import in_steps, tree

import rtamt
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Formula, fold, postorder
from rtamt.language.operators import STL
from rtamt.language.records import Bounds, Tense

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from conformance.cases import Case

PATIENCE = 20.0  # seconds for an answer


class Talk:
    """A conversation with the adapter of a tool; begun anew where the tool breaks down."""

    def __init__(self, command: Sequence[str], patience: float = PATIENCE) -> None:
        self._command = list(command)
        self._patience = patience
        self._start()
        self.peer: str = self._declared["peer"]
        self.modes: list[tuple[str, str]] = [(time, mode) for time, mode in self._declared["modes"]]
        self.conventions: dict[str, str] = self._declared["conventions"]
        self.notes: str = self._declared["notes"]
        #: Whether it is told how long a step is; to the others it is a second.
        self.takes_steps: bool = self._declared.get("steps", False)

    def ask(self, question: Mapping[str, Any]) -> dict[str, Any]:
        """Return the answer; ``{"crash": why}`` where none came."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(question) + "\n")
            self._process.stdin.flush()
            said = self._read()
        except BrokenPipeError:
            said = None
        if said is not None:
            return said
        silent = self._process.poll() is None
        self.close()
        self._start()
        return {"crash": f"no answer in {self._patience:g} s" if silent else "the process ended"}

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.communicate()

    def _start(self) -> None:
        self._process = subprocess.Popen(
            self._command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        declared = self._read()
        if declared is None:
            raise RuntimeError(f"{self._command[-1]} does not start")
        self._declared = declared

    def _read(self) -> dict[str, Any] | None:
        """Return the next line; None where the process ends or says nothing."""
        assert self._process.stdout is not None
        with selectors.DefaultSelector() as selector:
            selector.register(self._process.stdout, selectors.EVENT_READ)
            if not selector.select(self._patience):
                return None
        line = self._process.stdout.readline()
        if line:
            said: dict[str, Any] = json.loads(line)
            return said
        self._process.wait()
        return None


@dataclass(frozen=True)
class Question:
    """A formula whose bounds are whole steps, a trace that begins at 0, and how it is to be evaluated.

    ``alone`` is the one operator that the formula asks about, "" where it is nested. ``step`` is the length of a step
    in seconds, and ``stored`` the answer in the corpus; None where the question is not that of the corpus.
    """

    formula: Formula
    mode: tuple[str, str]
    signals: dict[str, list[Any]]
    conventions: dict[str, str]
    alone: str = ""
    step: Fraction = Fraction(1)
    stored: list[list[Any]] | None = None

    def changed(self, formula: Formula, signals: dict[str, list[Any]]) -> Question:
        """Return a question that is not that of the corpus."""
        return Question(formula, self.mode, signals, self.conventions, self.alone)

    @cached_property
    def tolerance(self) -> float:
        """The relative tolerance of its answer."""
        return TOLERANCE if self.operators & ROUNDED else 0.0

    @cached_property
    def text(self) -> str:
        """The formula, in our language."""
        return str(self.formula)

    @cached_property
    def operators(self) -> set[str]:
        """The names of its operators."""
        return {node.op.name for node in postorder(self.formula) if isinstance(node, Apply)}

    @cached_property
    def size(self) -> int:
        """How much there is to read."""
        return len(self.text) + sum(len(json.dumps(samples)) for samples in self.signals.values())

    @cached_property
    def end(self) -> int | None:
        """The instant up to which windows end inside the trace, not included; None for nowhere."""
        depth = _inside(self.formula)
        columns = list(self.signals.values())
        last = len(columns[0]) if self.mode[0] == "discrete" else max(samples[-1][0] for samples in columns)
        return None if depth is None or last - depth <= 0 else last - depth

    def expected(self) -> list[list[Any]]:
        """Return the answer of the corpus, changes as [instant, value]; where there is none, that of the definition."""
        if self.stored is not None:
            return self.stored
        meant = self.meant
        spec = rtamt.parse(str(meant), backend="python", time=self.mode[0])
        signal = spec.evaluate(self.signals).signal
        return [list(pair) for pair in zip(signal.times.tolist(), signal.values.tolist(), strict=True)]

    @cached_property
    def meant(self) -> Formula:
        """What the peer means, in our language."""
        return fold(self.formula, self._meant)

    def _meant(self, node: Formula, args: tuple[Formula, ...]) -> Formula:
        """Say in our language what the peer means."""
        if not isinstance(node, Apply):
            return node
        closed = self.conventions.get("until", "")
        if node.op.name == "until" and (closed == "closed" or (closed and node.interval is not None)):
            args = (args[0], STL["and"](*args))
        return Apply(node.op, args, node.interval)


@dataclass(frozen=True)
class Asked:
    """What came of a question: agrees, incomplete, disagrees, error, crash or unsupported.

    Incomplete is an answer that is right wherever the tool told one, but not told for every instant that is
    judged: too late, too little or nothing.
    """

    kind: str
    expected: Any = None
    got: Any = None


def question_of(
    case: Case, mode: tuple[str, str], conventions: dict[str, str], *, takes_steps: bool = False
) -> Question | None:
    """Translate a case; None where nothing of it can be judged.

    The answer is the stored one, unless the peer means another formula, or seconds matter and its steps are seconds.
    """
    formula = in_steps(rtamt.parse(case.formula).formula, case.seconds)
    signals = case.signals if case.time == "discrete" else together(case.signals)
    _, asked, *_ = case.id.split("/")
    step = case.seconds if takes_steps else Fraction(1)
    question = Question(formula, mode, signals, conventions, asked if STL.get(asked) else "", step)
    if question.end is None:
        return None
    timed = any(isinstance(node, Apply) and node.op.timed for node in postorder(formula))
    if question.meant != formula or (timed and step != case.seconds):
        return question
    return replace(question, stored=_stored(case))


def _stored(case: Case) -> list[list[Any]]:
    """Return the answer of a case, from 0 on."""
    if case.time == "discrete":
        return [[k, value] for k, value in enumerate(case.values)]
    start = case.values[0][0]
    return [[tick - start, value] for tick, value in case.values]


def together(signals: Mapping[str, Sequence[Sequence[Any]]]) -> dict[str, list[Any]]:
    """Return dense signals that all begin at 0, the latest first time, and end at the latest last one."""
    start = max(samples[0][0] for samples in signals.values())
    last = max(samples[-1][0] for samples in signals.values())
    result = {}
    for name, samples in signals.items():
        held = [v for t, v in samples if t <= start][-1]
        result[name] = [[0, held], *([t - start, v] for t, v in samples if t > start)]
        if result[name][-1][0] < last - start:
            result[name].append([last - start, result[name][-1][1]])
    return result


def ask(talk: Talk, question: Question) -> Asked:
    """Ask a peer, and judge what it says."""
    time, mode = question.mode
    asked = {
        "formula": tree(question.formula),
        "time": time,
        "mode": mode,
        "signals": question.signals,
        "end": question.end,
    }
    said = talk.ask(asked | {"step": str(question.step)} if talk.takes_steps else asked)
    for kind in ("unsupported", "error", "crash"):
        if kind in said:
            # The definition has no value for some of these either (0/0): then nobody is at fault.
            return Asked(
                kind, None if kind == "unsupported" else _cut(question.expected(), question), said[kind]
            )
    expected = question.expected()
    end = question.end or 0
    tolerance = question.tolerance
    if time == "discrete":
        got = [[i, v] for i, v in enumerate(said["values"])]
        return Asked(
            _compare(expected, got, len(got) >= end, end, tolerance),
            _cut(expected, question),
            _cut(got, question),
        )
    got = said["points"] if "points" in said else said["values"]
    told, whole = _reported_steps(expected, got, said, end)
    kind = _compare(expected, told, whole, end, tolerance)
    until = said.get("until", end)
    shown = _cut(got, question)
    return Asked(kind, _cut(expected, question), shown if until >= end else f"{shown}, told up to {until}")


def _reported_steps(
    expected: list[Any], got: list[Any], said: Mapping[str, Any], end: int
) -> tuple[list[Any], bool]:
    """Return what a dense answer says wherever it or the expected one changes, and whether that is all."""
    if "points" in said:
        return got, {t for t, _ in got} >= set(range(end))
    if not got:
        return [], False
    first, until = max(got[0][0], 0), said.get("until", end)
    instants = {t for t in (first, *(t for t, _ in (*expected, *got))) if first <= t <= until}
    return [[t, _at(got, t)] for t in sorted(instants)], first == 0 and until >= end


def _compare(expected: list[Any], told: list[Any], whole: bool, end: int, tolerance: float) -> str:
    """Return what an answer is worth: every value told counts, and an answer that stops early is incomplete."""
    if not all(_same(_at(expected, t), v, tolerance) for t, v in told if t < end):
        return "disagrees"
    return "agrees" if whole else "incomplete"


def _at(steps: Sequence[Sequence[Any]], t: float) -> float:
    return float([v for at, v in steps if at <= t][-1])


def _same(a: float, b: float | None, tolerance: float) -> bool:
    return b is not None and (a == b or math.isclose(a, b, rel_tol=tolerance))


def _cut(steps: Sequence[Any], question: Question) -> list[Any]:
    """Return what is judged of an answer: of a discrete one the values, of a dense one its changes."""
    kept = [[t, v] for t, v in steps if t < (question.end or 0)]
    if question.mode[0] == "discrete":
        return [v for _, v in kept]
    return [pair for k, pair in enumerate(kept) if k == 0 or pair[1] != kept[k - 1][1]]


def _inside(formula: Formula) -> int | None:
    """Return how far ahead windows reach; None where an unbounded one reads what is cut at the end."""

    def depth(node: Formula, below: tuple[int | None, ...]) -> int | None:
        if None in below:
            return None
        deepest = max((d for d in below if d is not None), default=0)
        if not isinstance(node, Apply) or node.op.tense is not Tense.FUTURE:
            return deepest
        if node.op.bounds is Bounds.NONE:
            return deepest + (node.op.reach or 0)
        if node.interval is None or node.interval.end is None:
            begin = 0 if node.interval is None else int(node.interval.begin)
            return None if deepest else begin
        return int(node.interval.end) + deepest

    return fold(formula, depth)


def answerable(question: Question) -> bool:
    """Return whether the definition has an answer, and of some instant."""
    if question.end is None or not variables(question.formula):
        return False
    try:
        question.expected()
    except EvaluationError:
        return False
    return True
