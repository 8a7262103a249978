"""Writes the corpus: `python -m conformance.generate`, the same files from the same seed.

Formulas come from the table of operators, so that a new operator has cases by itself; each operator
first alone over plain predicates, then nested at random. The answers come from the definition, the
Python back end; a case that has none (0/0, inf - inf) or whose answer hangs on the sign of a zero that
min or max chose is drawn again.
"""

from __future__ import annotations

import itertools
import random
import sys
from fractions import Fraction
from math import inf
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import rtamt
from conformance import cases, corners, early, quantified
from conformance.cases import SEMANTICS, Case
from conformance.trees import in_steps, table_of, tree
from rtamt.errors import EvaluationError
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, postorder
from rtamt.language.operators import STL
from rtamt.language.records import Bounds, Operator, Sort
from rtamt.language.shares import Share, ShareKind
from rtamt.language.tables import Table, table_operator

if TYPE_CHECKING:
    from collections.abc import Iterator

SEED = 20240607
ALONE = 20  # cases an operator
NESTED = 420  # cases under the standard semantics
NESTED_OTHERWISE = 90  # under each of the others
STEPS = ("1", "1", "1", "1/10", "1/2", "3")

_AWKWARD = (0.1, -0.3, 1e300, 5e-324, 1 / 3, inf, -inf)


class Drawing:
    """Draws formulas and traces; everything from one seed, of small numbers, so that ties occur."""

    def __init__(self, seed: str, time: str, step: str) -> None:
        self.random = random.Random(seed)
        self.dense = time == "dense"
        self.step = Fraction(step)
        operators = [op for op in STL if not (self.dense and op.discrete_only)]
        self.formulas = [op for op in operators if op.result is Sort.FORMULA]
        self.numbers = [op for op in operators if op.result is Sort.NUMBER]
        self.comparisons = [
            op for op in self.formulas if op.operands and Sort.FORMULA not in op.operands and not op.presence
        ]
        self.connectives = [op for op in self.formulas if Sort.FORMULA in op.operands]

    def chance(self, one_in: int) -> bool:
        """Return true once in ``one_in`` draws."""
        return self.random.randrange(one_in) == 0

    def half(self) -> float:
        """Draw a multiple of 1/2 between -3 and 3."""
        return self.random.randint(-6, 6) / 2

    def number(self, depth: int) -> Formula:
        """Draw an arithmetic expression of at most this depth."""
        if depth == 0 or self.chance(2):
            return Const(self.half()) if self.chance(3) else Var(self.random.choice("xy"))
        op = self.random.choice(self.numbers)
        return op(*(self.operand(sort, depth - 1) for sort in op.operands), interval=self.interval(op))

    def operand(self, sort: Sort, depth: int) -> Formula:
        """Draw an operand of a number."""
        return self.number(depth) if sort is Sort.NUMBER else self.plain()

    def plain(self) -> Formula:
        """Draw a predicate that any tool has: a variable against a number."""
        op = self.random.choice([STL[name] for name in ("ge", "gt", "le", "lt")])
        return op(Var(self.random.choice("xy")), Const(self.half()))

    def interval(self, op: Operator) -> Interval | None:
        """Draw the interval of an operator; None where it takes none, or none is drawn."""
        if op.bounds is Bounds.NONE or (op.bounds is Bounds.OPTIONAL and self.chance(5)):
            return None
        begin = self.random.choice((0, 0, 0, 1, 2, 3))
        if op.bounds is Bounds.DURATION:
            begin = max(begin, op.positive)
            return Interval(begin * self.step, begin * self.step)
        if op.bounds is Bounds.OPTIONAL and self.chance(10):
            return Interval(begin * self.step, None)
        width = self.random.choice((0, 1, 1, 2, 3))
        if op.share:  # in dense time of more than an instant
            width += 1
            counts = [Share(Fraction(self.random.choice((10, 50, 80, 100))), ShareKind.PERCENT)]
            counts.append(Share(self.random.randint(1, width) * self.step, ShareKind.DURATION))
            counts += (
                [] if self.dense else [Share(Fraction(self.random.randint(1, width)), ShareKind.SAMPLES)]
            )
            return Interval(begin * self.step, (begin + width) * self.step, share=self.random.choice(counts))
        return Interval(begin * self.step, (begin + width) * self.step)

    def table(self) -> Operator:
        """Draw a lookup table; the lines between its points are exact at multiples of 1/2."""
        gaps = self.random.choices((0.5, 1, 1, 2, 4), k=self.random.randint(1, 4))
        xs = tuple(itertools.accumulate(gaps, initial=self.half()))
        return table_operator("curve", Table(xs, tuple(self.half() for _ in xs)))

    def alone(self, op: Operator) -> Formula:
        """Draw a formula with one operator over plain predicates or, for a number's, in one."""
        if op in self.numbers or op in self.comparisons or table_of(op) is not None:
            given: list[Formula] = []
            for sort in op.operands:
                if sort is not Sort.NUMBER:
                    given.append(self.plain())
                elif any(isinstance(operand, Var) for operand in given):
                    given.append(Var("y") if self.chance(2) else Const(self.half()))
                else:
                    given.append(Var("x"))
            made = op(*given, interval=self.interval(op))
            return made if op in self.comparisons else STL["ge"](made, Const(self.half()))
        operands = (Var("x") if op.presence else self.plain() for _ in op.operands)
        made = op(*operands, interval=self.interval(op))
        return made if op.operands else STL["or"](made, self.plain())

    def nested(self, depth: int) -> Formula:
        """Draw a formula of at most this depth."""
        if depth == 0 or self.chance(8):
            if self.chance(2):
                return self.plain()
            op = self.random.choice(self.comparisons)
            return op(*(self.number(2) for _ in op.operands))
        op = self.random.choice(self.connectives)
        operands = (
            self.nested(depth - 1) if sort is Sort.FORMULA else self.number(2) for sort in op.operands
        )
        return op(*operands, interval=self.interval(op))

    def signals(self, names: tuple[str, ...]) -> dict[str, list[Any]]:
        """Draw a trace: values in discrete time, [time, value] pairs in dense time."""
        palettes = {name: [self.half() for _ in range(self.random.randint(1, 5))] for name in names}
        if self.chance(12):
            palettes[self.random.choice(names)].append(self.random.choice(_AWKWARD))
        if not self.dense:
            n = self.random.choice((1, 2, 3, 5, 7, 9, 11))
            return {name: self.random.choices(palette, k=n) for name, palette in palettes.items()}
        origin = self.random.choice((0, 0, 0, -4, 1000))
        drawn = {}
        for name, palette in palettes.items():
            n = self.random.randint(1, 6)
            gaps = [
                origin + self.random.choice((0, 0, 0, 1, 4)),
                *self.random.choices((1, 1, 2, 3, 5), k=n - 1),
            ]
            values = self.random.choices(palette, k=n)
            drawn[name] = [list(pair) for pair in zip(itertools.accumulate(gaps), values, strict=True)]
        return drawn


def answered(case: Case, backend: str = "python") -> Case:
    """Fill in the tree and the answer: from the definition, which is the Python back end."""
    settings: dict[str, Any] = {"semantics": case.semantics, "roles": dict.fromkeys(case.inputs, "input")}
    if case.time == "discrete":
        settings["period"] = case.seconds
    else:
        settings |= {"time": "dense", "resolution": case.seconds}
    spec = rtamt.parse(case.formula, backend=backend, **settings)
    case.tree = tree(in_steps(spec.formula, case.seconds))
    signal = spec.evaluate(data_of(case)).signal
    values = [v > 0 for v in signal.values] if case.semantics == "boolean" else signal.values
    depth = None if spec.horizon == inf else round(Fraction(spec.horizon) / case.seconds)
    values = [v.item() for v in np.asarray(values)]
    if case.time == "discrete":
        n = len(values)
        case.values = values
        case.known = None if depth is None else [i + depth if i + depth < n else None for i in range(n)]
        return case
    ticks = ticks_of(signal.times, case.seconds)
    changes = [
        pair for k, pair in enumerate(zip(ticks, values, strict=True)) if k == 0 or pair[1] != values[k - 1]
    ]
    case.values, case.end = [list(pair) for pair in changes], ticks[-1]
    case.known = None if depth is None else [[t, known_until(case, t, depth)] for t in case.instants]
    return case


def known_until(case: Case, now: int, depth: int) -> int | None:
    """Return up to when the answer is known once all samples up to ``now`` have come."""
    signals = [samples for name, samples in case.signals.items() if "." not in name]  # members move nothing
    firsts = [samples[0][0] for samples in signals]
    if max(firsts) > now:
        return None
    until = min(max(t for t, _ in samples if t <= now) for samples in signals) - depth
    return until if until >= max(firsts) else None


def data_of(case: Case) -> dict[str, Any]:
    """Return the trace as the library takes it; of dense time in whole nanoseconds, exact."""
    if case.time == "discrete":
        n = len(next(iter(case.signals.values())))
        return {"time": [float(i * case.seconds) for i in range(n)], **case.signals}
    nanoseconds = int(case.seconds * 10**9)
    return {
        name: (np.array([t * nanoseconds for t, _ in samples], "m8[ns]"), [v for _, v in samples])
        for name, samples in case.signals.items()
    }


def ticks_of(times: Any, tick: Fraction) -> list[int]:
    """Return times in whole nanoseconds as ticks."""
    nanoseconds = int(tick * 10**9)
    return [int(t) // nanoseconds for t in times]


def settled(formula: Formula) -> bool:
    """Return whether the answer is one: min and max may give either zero, and only these tell them apart."""
    names = {node.op.name for node in postorder(formula) if isinstance(node, Apply)}
    return not (names & {"min", "max"} and names & {"div", "pow"})


def drawn(name: str, time: str, semantics: str, op: Operator | Literal["table"] | None = None) -> Case:
    """Draw a case that has an answer; ``op`` is the operator to ask, None for a nested formula."""
    step = random.Random(f"{SEED} {name}").choice(STEPS)
    for attempt in itertools.count():
        draw = Drawing(f"{SEED} {name} {attempt}", time, step)
        asked = draw.table() if op == "table" else op
        formula = draw.nested(draw.random.choice((2, 2, 3, 4))) if asked is None else draw.alone(asked)
        names = variables(formula)
        if not names or not settled(formula):
            continue
        inputs = [] if semantics in ("standard", "boolean") else [draw.random.choice(names)]
        text = f"{declared(asked)}{formula}"
        case = Case(name, time, text, step, draw.signals(names), semantics, inputs)
        try:
            return answered(case)
        except EvaluationError:
            continue
    raise AssertionError


def declared(op: Operator | None) -> str:
    """Return what declares an operator in the text of a case: that of a table."""
    table = None if op is None else table_of(op)
    if op is None or table is None:
        return ""
    points = ", ".join(f"({x:g}, {y:g})" for x, y in zip(table.xs, table.ys, strict=True))
    return f"table {op.name} = {{{points}}}; "


def names_of(time: str) -> Iterator[tuple[str, str, Operator | Literal["table"] | None]]:
    """Yield of each case in a time domain its name, its semantics and the operator it asks, if it is one."""
    for op in STL:
        if time == "discrete" or not op.discrete_only:
            for k in range(ALONE):
                yield f"{time}/{op.name}/{k:02}", "standard", op
    for k in range(ALONE):
        yield f"{time}/table/{k:02}", "standard", "table"
    for semantics in SEMANTICS:
        for k in range(NESTED if semantics == "standard" else NESTED_OTHERWISE):
            yield f"{time}/nested/{semantics}/{k:03}", semantics, None


def main() -> None:
    """Write all files, and say how far it is."""
    cases.write("corners.jsonl", [answered(case) for case in corners.cases()])
    for time in ("discrete", "dense"):
        todo = list(names_of(time))
        made = []
        for k, (name, semantics, op) in enumerate(todo):
            made.append(drawn(name, time, semantics, op))
            if k % 50 == 0:
                sys.stderr.write(f"\r{time}: {k} of {len(todo)} cases")
        sys.stderr.write(f"\r{time}: {len(todo)} cases       \n")
        cases.write(f"{time}.jsonl", made)
    cases.write(cases.QUANTIFIED, list(quantified.cases(Drawing, answered, STEPS, SEED)))
    early.write(list(early.cases(Drawing, STEPS, SEED)))


if __name__ == "__main__":
    main()
