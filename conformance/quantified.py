"""Writes `corpus/quantified.jsonl`: forall, exists, count and pairs over members that appear and disappear.

Part of `python -m conformance.generate`. Formulas and values are drawn as for the rest of the corpus, from the
operators of `tests/oracle/agents.py`, which computes each answer again on the trace of each member alone.
"""

from __future__ import annotations

import itertools
import random
from typing import TYPE_CHECKING, Any

from conformance.cases import Case
from rtamt.errors import EvaluationError
from rtamt.language.formula import Apply, Const, Formula, Var, postorder
from rtamt.language.operators import STL
from rtamt.language.quantifiers import Binder, Field, FieldOf, Group, fields_of, quantified

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from conformance.generate import Drawing

DRAWN = 40  # cases of each kind and time domain
KINDS = ("forall", "exists", "count", "pairs", "nested", "boolean")

HEAD = 'group cars = "car_*" { float x; float u }; '
CARS = Group("cars", "car_*", (Field("x"), Field("u")))

CONNECTIVES = (
    "not",
    "and",
    "or",
    "always",
    "eventually",
    "historically",
    "once",
    "since",
    "until",
    "rise",
    "fall",
)
OF_SAMPLES = ("prev", "next", "s_prev", "s_next")
NUMBERS = ("add", "sub", "delay", "ahead", "held", "if", "minimum", "maximum")
SUMS = ("sum", "mean", "duration", "count")


class Bodies:
    """Draws formulas with quantifiers; ``draw`` is the source of all chance."""

    def __init__(self, draw: Drawing) -> None:
        self.draw = draw
        self.random = draw.random
        self.connectives = CONNECTIVES + (() if draw.dense else OF_SAMPLES)
        self.numbers = NUMBERS + (() if draw.dense else SUMS)

    def leaf(self, scope: str) -> Formula:
        """Draw a variable: a field of a member in scope, or the signal y."""
        if self.draw.chance(4):
            return Const(self.draw.half())
        if not scope or self.draw.chance(4):
            return Var("y")
        variable = self.random.choice(scope)
        field = self.random.choice("xxu")
        return FieldOf(f"{variable}.{field}", None, None, variable, field, CARS)

    def number(self, scope: str, depth: int) -> Formula:
        """Draw a number of at most this depth."""
        if depth == 0 or self.draw.chance(2):
            return self.leaf(scope)
        if len(scope) < 2 and self.draw.chance(8):
            return self.over("count", scope, depth)
        return self.apply(self.random.choice(self.numbers), scope, depth)

    def formula(self, scope: str, depth: int) -> Formula:
        """Draw a formula of at most this depth."""
        if depth == 0 or self.draw.chance(6):
            op = STL[self.random.choice(("ge", "gt", "le", "lt"))]
            return op(self.number(scope, min(depth, 2)), Const(self.draw.half()))
        if len(scope) < 2 and self.draw.chance(6):
            return self.over(self.random.choice(("forall", "exists")), scope, depth)
        return self.apply(self.random.choice(self.connectives), scope, depth)

    def apply(self, name: str, scope: str, depth: int) -> Formula:
        """Draw the operands and the interval of an operator."""
        op = STL[name]
        operands = [
            (self.formula if sort is not STL["add"].result else self.number)(scope, depth - 1)
            for sort in op.operands[: len(op.operands) - op.optional]
        ]
        return Apply(op, tuple(operands), self.draw.interval(op))

    def over(self, word: str, scope: str, depth: int) -> Formula:
        """Draw a quantifier; inside another one half of the time over pairs of different members."""
        variable = "vw"[len(scope)]
        apart = ((variable, scope),) if scope and self.draw.chance(2) else ()
        return quantified(word, Binder(variable, CARS, apart))(self.formula(scope + variable, depth - 1))

    def of_kind(self, kind: str) -> Formula:
        """Draw the formula of a case."""
        if kind in ("nested", "boolean"):
            return self.formula("", 4)
        word, other = (
            self.random.choices(("forall", "exists", "count"), k=2) if kind == "pairs" else (kind, None)
        )
        body = self.formula("v", 2)
        if other is not None:
            within = quantified(other, Binder("w", CARS, (("v", "w"),)))(self.formula("vw", 2))
            body = STL["ge"](within, Const(1.0)) if other == "count" else within
        made = quantified(word, Binder("v", CARS))(body)
        whole = STL["le"](made, Const(float(self.random.randint(0, 2)))) if word == "count" else made
        return whole if self.draw.chance(2) else STL["historically"](whole)


def signals(draw: Drawing) -> dict[str, list[Any]]:
    """Draw y and the fields of up to three members, which are present for a while, None where they are not."""
    chance = draw.random
    if not draw.dense:
        n = chance.choice((1, 3, 5, 7, 9))
        found: dict[str, list[Any]] = {"y": [draw.half() for _ in range(n)]}
        for member in range(chance.choice((1, 2, 2, 3))):
            here = presence(draw, n)
            for field in "xu":
                found[f"car_{member}.{field}"] = [draw.half() if shown else None for shown in here]
        return found
    n = chance.choice((3, 6, 10))
    found = {"y": [[t, draw.half()] for t in (0, *sorted(chance.sample(range(1, n), k=n // 3)), n)]}
    for member in range(chance.choice((1, 2, 2, 3))):
        here = presence(draw, n)
        for field in "xu":
            samples = [[t, draw.half() if shown else None] for t, shown in enumerate(here)]
            found[f"car_{member}.{field}"] = [
                each
                for before, each in itertools.pairwise([[-1, None], *samples])
                if (each[1] is None) != (before[1] is None) or (each[1] is not None and not draw.chance(2))
            ]
    return found


def presence(draw: Drawing, n: int) -> list[bool]:
    """Draw where a member is present: one run, or two."""
    here = [False] * n
    for _ in range(draw.random.choice((1, 1, 2))):
        begin = draw.random.randrange(n)
        for t in range(begin, min(n, begin + draw.random.randint(1, n))):
            here[t] = True
    return here


def cases(
    drawing: Callable[[str, str, str], Drawing],
    answered: Callable[[Case], Case],
    steps: tuple[str, ...],
    seed: int,
) -> Iterator[Case]:
    """Yield all cases with their answers."""
    for time in ("discrete", "dense"):
        for kind in KINDS:
            for k in range(DRAWN):
                name = f"{time}/quantified/{kind}/{k:02}"
                step = random.Random(f"{seed} {name}").choice(steps)
                semantics = "boolean" if kind == "boolean" else "standard"
                yield _drawn(
                    drawing, answered, Case(name, time, "", step, {}, semantics=semantics), kind, seed
                )


def _drawn(
    drawing: Callable[[str, str, str], Drawing],
    answered: Callable[[Case], Case],
    case: Case,
    kind: str,
    seed: int,
) -> Case:
    """Complete a case by a formula and signals for which it has an answer."""
    for attempt in itertools.count():
        draw = drawing(f"{seed} {case.id} {attempt}", case.time, case.step)
        formula = Bodies(draw).of_kind(kind)
        if not fields_of(formula):
            continue
        if "y" not in {node.name for node in postorder(formula) if isinstance(node, Var)}:
            formula = STL["and"](
                formula, STL["le"](Var("y"), Const(3.0))
            )  # y is what starts and ends the trace
        case.formula, case.signals = f"{HEAD}{formula}", signals(draw)
        try:
            return answered(case)
        except EvaluationError:
            continue
    raise AssertionError
