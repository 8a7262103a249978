"""Quantifiers over groups agree with an oracle that evaluates every member on a trace of its own."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from tests.oracle import agents
from tests.oracle.agents import Group, World

if TYPE_CHECKING:
    import random
    from collections.abc import Sequence

    from tests.oracle.agents import Node

SIZE = 12
FIELDS = ("x", "v")
BOUNDS = [(0, 0), (0, 1), (0, 3), (1, 2), (2, 4), (1, 1)]
QUANTIFIERS = ("forall", "exists")


def _value(rng: random.Random) -> float:
    return rng.randint(-8, 8) / 2


class Writer:
    """Draws formulas; a body may read the fields of the members in scope."""

    def __init__(self, rng: random.Random, *, dense: bool, past_only: bool = False) -> None:
        self.rng, self.dense, self.past_only = rng, dense, past_only

    def bounds(self, *, past: bool) -> tuple[int, float]:
        if past and self.rng.random() < 0.3:
            return self.rng.choice([0, 1]), agents.inf
        return self.rng.choice(BOUNDS)

    def number(self, scope: list[str], depth: int) -> Node:
        rng = self.rng
        if depth <= 0 or rng.random() < 0.4:
            leaves: list[Node] = [("value", _value(rng)), ("signal", "y")]
            leaves += [("field", name, field) for name in scope for field in FIELDS] * 2
            return rng.choice(leaves)
        kinds = ["+", "-", "delay", "held", "if", "minimum", "maximum", "number of"]
        if not self.dense:
            kinds += ["sum", "mean", "duration", "count"]
        kind = rng.choice(kinds)
        if kind in "+-":
            return (kind, self.number(scope, depth - 1), self.number(scope, depth - 1))
        if kind == "delay":
            return (kind, rng.choice([1, 2]), self.number(scope, depth - 1))
        if kind == "held":
            return (kind, self.number(scope, depth - 1), self.formula(scope, depth - 1))
        if kind == "if":
            return (
                kind,
                self.formula(scope, depth - 1),
                self.number(scope, depth - 1),
                self.number(scope, depth - 1),
            )
        if kind == "number of":
            return self.quantified("number of", scope, depth)
        child = self.formula if kind in ("duration", "count") else self.number
        a, b = self.bounds(past=True)
        if kind in ("minimum", "maximum"):  # an empty window is infinite, and inf - inf has no value
            a = 0
        return (kind, a, b, child(scope, depth - 1))

    def quantified(self, kind: str, scope: list[str], depth: int) -> Node:
        if len(scope) == 2:
            return self.formula(scope, 0) if kind != "number of" else ("value", 1.0)
        name = "vw"[len(scope)]
        other = scope[0] if scope and self.rng.random() < 0.5 else None
        return (kind, name, "cars", other, self.formula([*scope, name], depth - 1))

    def formula(self, scope: list[str], depth: int) -> Node:
        rng = self.rng
        if depth <= 0 or rng.random() < 0.2:
            return (
                rng.choice(sorted(agents.COMPARISONS)),
                self.number(scope, depth),
                self.number(scope, depth - 1),
            )
        past = ["historically", "once", "since"]
        future = [] if self.past_only else ["always", "eventually", "until"]
        edges = [] if self.dense else ["prev", "s_prev"] + ([] if self.past_only else ["next", "s_next"])
        kind = rng.choice(["not", "and", "or", "rise", "fall", *past, *future, *edges, *QUANTIFIERS * 2])
        if kind in QUANTIFIERS:
            return self.quantified(kind, scope, depth)
        if kind in ("and", "or"):
            return (kind, self.formula(scope, depth - 1), self.formula(scope, depth - 1))
        if kind in ("since", "until"):
            bounds = self.bounds(past=kind == "since")
            return (kind, *bounds, self.formula(scope, depth - 1), self.formula(scope, depth - 1))
        if kind in past + future:
            return (kind, *self.bounds(past=kind in past), self.formula(scope, depth - 1))
        return (kind, self.formula(scope, depth - 1))

    def closed(self) -> Node:
        body = self.quantified(self.rng.choice(QUANTIFIERS), [], 3)
        a, b = self.bounds(past=True)
        outer = (
            ["historically", "once"] if self.past_only else ["historically", "once", "always", "eventually"]
        )
        around = (self.rng.choice(outer), a, 3 if b == agents.inf else b, body)
        beside = (self.rng.choice(["and", "or"]), body, self.twin(body))
        # The ordinary signal y is read, so the start and the end of the trace are those of y.
        return ("and", self.rng.choice([body, beside, around]), ("<", ("signal", "y"), ("value", 100.0)))

    def twin(self, node: Any) -> Any:
        """Return the formula with another operator in one of its comparisons: nearly the same, and easily mistaken."""
        if not isinstance(node, tuple):
            return node
        if node[0] in agents.COMPARISONS:
            return (self.rng.choice(sorted(agents.COMPARISONS)), *node[1:])
        inner = [i for i, each in enumerate(node) if isinstance(each, tuple)]
        if not inner:
            return node
        place = self.rng.choice(inner)
        return (*node[:place], self.twin(node[place]), *node[place + 1 :])


def presence(rng: random.Random, size: int) -> list[bool]:
    """Return instants of presence: one run, several, or none at all."""
    shown = [False] * size
    for _ in range(rng.choice([0, 1, 1, 1, 2])):
        begin = rng.randrange(size)
        for t in range(begin, min(begin + rng.randint(1, size), size)):
            shown[t] = True
    return shown


def world(rng: random.Random, *, dense: bool = False, members: int | None = None) -> World:
    members = rng.choice([1, 2, 3]) if members is None else members
    cars: dict[str, Any] = {}
    for k in range(members):
        shown = presence(rng, SIZE)
        cars[f"car_{k}"] = {field: [_value(rng) if here else None for here in shown] for field in FIELDS}
    return World({"y": [_value(rng) for _ in range(SIZE)]}, {"cars": Group(cars)}, SIZE, 1.0, dense)


def columns(known: World) -> dict[str, Any]:
    data: dict[str, Any] = {"time": list(range(known.size)), "y": known.signals["y"]}
    for member, fields in known.groups["cars"].members.items():
        data.update({f"{member}.{field}": values for field, values in fields.items()})
    return data


HEAD = 'group cars = "car_*" { float x; float v }\nfloat y\n'


def same(found: Sequence[float], expected: Sequence[float]) -> bool:
    return [float(v) for v in found] == [float(v) for v in expected]


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(rng=st.randoms(use_true_random=False))
@settings(max_examples=60)
def test_quantifiers_mean_what_the_oracle_says(backend, rng):
    formula = Writer(rng, dense=False).closed()
    known = world(rng)
    expected = agents.evaluate(known, formula)
    spec = rtamt.parse(HEAD + agents.text(formula), backend=backend)
    found = spec.evaluate(columns(known)).signal.values
    assert same(found, expected), agents.text(formula)


def dense_signals(known: World) -> dict[str, list[tuple[int, float | None]]]:
    """Return samples where a value changes: None ends a presence."""

    def samples(values: Sequence[float | None]) -> list[tuple[int, float | None]]:
        changes = [t for t, v in enumerate(values) if t == 0 or v != values[t - 1]]
        return [(t, values[t]) for t in changes if t or values[t] is not None]

    signals: dict[str, Any] = {"y": [*samples(known.signals["y"]), (SIZE, known.signals["y"][-1])]}
    for member, fields in known.groups["cars"].members.items():
        signals.update({f"{member}.{field}": samples(values) for field, values in fields.items()})
    return {name: values for name, values in signals.items() if values}


def going_on(known: World, cells: int) -> World:
    """Return the world with its last cell repeated."""

    def longer(values: Sequence[Any]) -> list[Any]:
        return [*values, *[values[-1]] * cells]

    cars = {
        member: {field: longer(values) for field, values in fields.items()}
        for member, fields in known.groups["cars"].members.items()
    }
    signals = {name: longer(values) for name, values in known.signals.items()}
    return known._replace(signals=signals, groups={"cars": Group(cars)}, size=known.size + cells)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@given(rng=st.randoms(use_true_random=False))
@settings(max_examples=60)
def test_in_dense_time_quantifiers_mean_what_the_oracle_says(backend, rng):
    formula = Writer(rng, dense=True).closed()
    known = world(rng, dense=True)
    data = dense_signals(known)
    if len(data) == 1:
        return
    expected = agents.evaluate(going_on(known, 60), formula)[: SIZE + 1]
    spec = rtamt.parse(HEAD + agents.text(formula), time="dense", resolution="1s", backend=backend)
    found = spec.evaluate(data).signal
    at = np.searchsorted(found.times, np.arange(SIZE + 1), side="right") - 1
    assert same(found.values[at], expected), agents.text(formula)
