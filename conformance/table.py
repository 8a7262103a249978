"""Run the conformance corpus through every peer, and write conformance/RESULTS.md.

Each tool runs only the cases that it claims to support (the operators and modes of its adapter). Its answers are
compared with the values in the corpus: exactly, or with a relative tolerance of 1e-12 if the formula contains a
function that differs between C libraries. No tool has a wider tolerance. A tool with conventions of its own has the
expected answer of the equivalent formula in our language, computed from the definition, where the convention matters.
Choices that the literature leaves open are not tested: dense traces begin and end at the same
instant for all signals, and only instants count whose windows end inside the trace.

Every value that a tool reports is checked, in the same way for all tools: one wrong value makes the answer
disagree. An answer without a wrong value that does not cover all of these instants (late, short or empty) is
"right, but incomplete". An answer extends to the last instant that the tool reports or, for tools that report
only changes (see the notes), to the time of the last sample.
"""

from __future__ import annotations

import datetime as dt
import platform
import sys
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path[:0] = [str(Path(__file__).parents[1]), str(Path(__file__).parent / "peers")]

from asking import Asked, Question, Talk, ask, question_of  # noqa: E402 - found by the line above
from peers import HERE, PEERS  # noqa: E402 - found in the path set above
from shrinking import shrunk  # noqa: E402 - found in the path set above

from conformance import cases  # noqa: E402 - found in the path set above
from rtamt.language.operators import STL  # noqa: E402 - found in the path set above

if TYPE_CHECKING:
    from collections.abc import Iterator

OUT = Path(__file__).parent / "RESULTS.md"
SHRINK = 150  # questions that one counterexample may take


@dataclass
class Row:
    """How often one peer agreed in one mode: by operator, alone and as a part of nested formulas."""

    talk: Talk
    mode: tuple[str, str]
    asked: dict[str, Counter[str]] = field(
        default_factory=lambda: {k: Counter() for k in ("alone", "nested")}
    )
    agreed: dict[str, Counter[str]] = field(
        default_factory=lambda: {k: Counter() for k in ("alone", "nested")}
    )
    outcomes: Counter[str] = field(default_factory=Counter)
    # The smallest question that went wrong; an incomplete answer only where there is no other.
    worst: dict[str, tuple[tuple[bool, int], Question]] = field(default_factory=dict)

    def count(self, question: Question, outcome: Asked) -> None:
        """Count one answer under every operator of its formula."""
        self.outcomes[outcome.kind] += 1
        if outcome.kind == "unsupported":
            return
        kind = "alone" if question.alone else "nested"
        for op in {question.alone} if question.alone else question.operators:
            self.asked[kind][op] += 1
            self.agreed[kind][op] += outcome.kind == "agrees"
        if outcome.kind != "agrees":
            blamed = question.alone or "nested"
            rank = (outcome.kind == "incomplete", question.size)
            if blamed not in self.worst or rank < self.worst[blamed][0]:
                self.worst[blamed] = rank, question

    def cell(self, op: str) -> str:
        """Return what the table says of one operator."""
        alone, nested = (f"{self.agreed[k][op]}/{self.asked[k][op]}" for k in ("alone", "nested"))
        return "" if alone == nested == "0/0" else f"{alone} · {nested}"


def talks() -> Iterator[Talk | tuple[str, str]]:
    """Yield a conversation with each tool, or its name and why there is none."""
    yield Talk([sys.executable, str(HERE / "ask_this.py")])
    for peer in PEERS:
        yield Talk(peer.command()) if peer.installed else (peer.name, peer.why_not())


def main() -> None:
    """Ask everybody everything, and write the table."""
    try:
        corpus = cases.robustness()
    except cases.CorpusError as error:
        sys.exit(str(error))
    rows: list[Row] = []
    absent: list[tuple[str, str]] = []
    examples: list[str] = []
    for talk in talks():
        if isinstance(talk, tuple):
            absent.append(talk)
            continue
        for mode in talk.modes:
            row = Row(talk, mode)
            todo = [c for c in corpus if c.time == mode[0]]
            for k, case in enumerate(todo):
                if k % 100 == 0:
                    sys.stderr.write(f"\r{talk.peer}, {' '.join(mode)}: {k} of {len(todo)} ")
                    sys.stderr.flush()
                question = question_of(case, mode, talk.conventions, takes_steps=talk.takes_steps)
                if question is not None:
                    row.count(question, ask(talk, question))
            sys.stderr.write(f"\r{talk.peer}, {' '.join(mode)}: {dict(row.outcomes)}\n")
            rows.append(row)
            examples += [example(talk, blamed, row.worst[blamed][1]) for blamed in sorted(row.worst)]
        talk.close()
    OUT.write_text(report(rows, absent, examples, len(corpus)), encoding="utf-8")
    sys.stderr.write(f"written: {OUT}\n")


def example(talk: Talk, blamed: str, question: Question) -> str:
    """Return one counterexample, made as small as it gets."""
    small, outcome = shrunk(talk, question, SHRINK)
    trace = "; ".join(f"{name} = {samples}" for name, samples in small.signals.items())
    return (
        f"| {talk.peer} | {' '.join(small.mode)} | {blamed} | {outcome.kind} | `{small.text}` | {trace} | "
        f"{shown(outcome.expected)} | {shown(outcome.got)} |"
    )


def shown(what: Any) -> str:
    """Return an answer as a cell of the table."""
    text = what if isinstance(what, str) else str(what)
    return text.replace("|", "\\|").replace("\n", " ")[:160]


def report(rows: list[Row], absent: list[tuple[str, str]], examples: list[str], cases_count: int) -> str:
    """Return the page."""
    system = f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
    lines = [
        "# Agreement with the definition",
        "",
        f"Made by `make conformance` on {dt.datetime.now(tz=dt.timezone.utc):%Y-%m-%d}, {system}, from the "
        f"{cases_count} robustness cases of [the corpus](README.md).",
        "",
        (__doc__ or "").split("\n\n", 1)[1].strip(),
        "",
        "| tool | mode | agrees | right, but incomplete | disagrees | error | crash | not run |",
        "|---|---|---:|---:|---:|---:|---:|---:|",
    ]
    kinds = ("agrees", "incomplete", "disagrees", "error", "crash", "unsupported")
    lines += [
        f"| {row.talk.peer} | {' '.join(row.mode)} | {' | '.join(str(row.outcomes[k]) for k in kinds)} |"
        for row in rows
    ]
    lines += [f"| {name} | | not installed: {why} | | | | | |" for name, why in absent]
    lines += ["", "How each tool was run:", ""]
    lines += [
        f"- {talk.peer}: {talk.notes}"
        + "".join(f" ({key} is {value})" for key, value in talk.conventions.items())
        for talk in dict.fromkeys(row.talk for row in rows)
    ]
    lines += [
        "",
        "## By operator",
        "",
        "Cases that agree, of those that were run: over plain predicates · in nested formulas, where another operator "
        "may be at fault.",
        "An incomplete answer does not count as agreement. Operators that a tool does not have, or that were not run, "
        "are left out.",
    ]
    for talk in dict.fromkeys(row.talk for row in rows):
        own = [row for row in rows if row.talk is talk]
        modes = " | ".join(" ".join(row.mode) for row in own)
        lines += ["", f"| {talk.peer} | {modes} |", "|---|" + "---|" * len(own)]
        for op in STL:
            cells = [row.cell(op.name) for row in own]
            if any(cells):
                lines.append(f"| {op.name} | " + " | ".join(cells) + " |")
    lines += [
        "",
        "## Smallest counterexamples",
        "",
        "Each is found by shrinking formula and trace while the outcome remains the same. An incomplete answer is "
        "shown only if there is no worse one. Traces are samples, or [tick, value] pairs; answers of dense tools that "
        "evaluate one tick at a time are values at ticks.",
        "",
        "| tool | mode | operator | outcome | formula | trace | definition | tool's answer |",
        "|---|---|---|---|---|---|---|---|",
        *examples,
        "",
    ]
    return "\n".join(lines)


if __name__ == "__main__":
    main()
