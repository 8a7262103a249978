"""Shrink counterexamples: simplify formula and trace step by step while the tool's answer stays wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from asking import Asked, Question, Talk, answerable, ask, together

from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, Interval

if TYPE_CHECKING:
    from collections.abc import Iterator


def shrunk(talk: Talk, question: Question, limit: int) -> tuple[Question, Asked]:
    """Return a smaller question that goes wrong in the same way, and what comes of it."""
    outcome = ask(talk, question)
    spent, progress = 0, True
    while progress:
        progress = False
        for candidate in _smaller(question):
            if spent >= limit:
                return question, outcome
            if candidate.size >= question.size or not answerable(candidate):
                continue
            spent += 1
            said = ask(talk, candidate)
            if said.kind == outcome.kind:
                question, outcome, progress = candidate, said, True
                break
    return question, outcome


def _smaller(question: Question) -> Iterator[Question]:
    for formula in _formulas(question.formula):
        names = variables(formula)
        if names:
            yield question.changed(formula, {name: question.signals[name] for name in names})
    for signals in _traces(question.signals, dense=question.mode[0] == "dense"):
        yield question.changed(question.formula, signals)


def _formulas(formula: Formula) -> Iterator[Formula]:
    """Yield the formula with one node replaced by an operand, a bound made smaller, or a number simpler."""
    if isinstance(formula, Const):
        yield from (Const(v) for v in (0.0, 1.0) if v != formula.value)
    if not isinstance(formula, Apply):
        return
    for operand, sort in zip(formula.args, formula.op.operands, strict=True):
        if sort is formula.op.result and not isinstance(operand, Const):
            yield operand
    bounds = formula.interval
    if bounds is not None and bounds.end is not None:
        begin, end = bounds.begin, bounds.end
        for first, last in ((0, end), (begin, end - 1), (begin - 1, end - 1), (0, end - begin)):
            if 0 <= first <= last and (first, last) != (begin, end):
                yield Apply(formula.op, formula.args, Interval(first + 0 * begin, last + 0 * begin))
    for k, operand in enumerate(formula.args):
        for smaller in _formulas(operand):
            yield Apply(formula.op, (*formula.args[:k], smaller, *formula.args[k + 1 :]), bounds)


def _traces(signals: dict[str, list[Any]], *, dense: bool) -> Iterator[dict[str, list[Any]]]:
    """Yield traces with a sample less, or a value made simpler."""
    if dense:
        for name, samples in signals.items():
            for k in range(1, len(samples)):
                yield together(signals | {name: samples[:k] + samples[k + 1 :]})
                gap = samples[k][0] - samples[k - 1][0]
                if gap > 1:
                    moved = [[t - gap + 1, v] for t, v in samples[k:]]
                    yield together(signals | {name: samples[:k] + moved})
        last = max(samples[-1][0] for samples in signals.values())
        cut = {name: [pair for pair in samples if pair[0] < last] for name, samples in signals.items()}
        yield together(cut)
    else:
        for k in range(len(next(iter(signals.values()))) if len(next(iter(signals.values()))) > 1 else 0):
            yield {name: column[:k] + column[k + 1 :] for name, column in signals.items()}
    for name, samples in signals.items():
        for k, sample in enumerate(samples):
            for value in (0.0, 1.0, -1.0):
                if value != (sample[1] if dense else sample):
                    new = [sample[0], value] if dense else value
                    yield signals | {name: [*samples[:k], new, *samples[k + 1 :]]}
