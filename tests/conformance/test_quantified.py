"""The corpus of quantifiers is true: an oracle gives every answer, and so does every path of the engine."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any

import pytest
from conformance import cases
from conformance.generate import data_of, ticks_of
from conformance.quantified import HEAD, KINDS

import rtamt
from rtamt.rewrite.ground import ground
from tests.conformance.test_conformance import (
    agree,
    formula_of,
    instant_by_instant,
    mismatch,
    one_after_another,
    same,
    specification,
)
from tests.oracle import agents

if TYPE_CHECKING:
    from conformance.cases import Case

    from tests.oracle.agents import Node

CORPUS = cases.read(cases.QUANTIFIED)
SYMBOLS = {"ge": ">=", "gt": ">", "le": "<=", "lt": "<", "add": "+", "sub": "-"}
BOUNDED = {
    *("always", "eventually", "historically", "once", "since", "until"),
    *("minimum", "maximum", "sum", "mean", "duration", "count"),
}
PARTS = 4
AFTER = 30  # cells after the end of a dense trace, by which all has settled

parts = pytest.mark.parametrize("part", range(PARTS))


def node_of(tree: dict[str, Any]) -> Node:
    """Return a tree as the oracle has it."""
    if "const" in tree:
        return ("value", tree["const"])
    if "var" in tree:
        return ("signal", tree["var"])
    if "field" in tree:
        return ("field", tree["of"], tree["field"])
    name, operands = tree["op"], tuple(map(node_of, tree["args"]))
    if "member" in tree:
        others = [other for pair in tree["apart"] for other in pair if other != tree["member"]]
        word = "number of" if name == "count" else name
        return (word, tree["member"], tree["group"], others[0] if others else None, *operands)
    if name in ("delay", "ahead"):
        return (name, tree["interval"][0] if tree["interval"] else 1, *operands)
    if name in BOUNDED:
        begin, end = tree["interval"] or (0, None)
        return (name, begin, inf if end is None else end, *operands)
    return (SYMBOLS.get(name, name), *operands)


def in_cells(samples: list[Any], start: int, size: int) -> list[Any]:
    """Return dense samples as cells from the start of the trace on; None where there is no value."""
    return [next((value for t, value in reversed(samples) if t <= start + k), None) for k in range(size)]


def world_of(case: Case) -> tuple[agents.World, int]:
    """Return what the oracle evaluates, and the number of entries that are reported."""
    signals, size = case.signals, len(case.signals["y"])
    reported = size
    if case.time == "dense":
        start, reported = signals["y"][0][0], signals["y"][-1][0] - signals["y"][0][0] + 1
        size = reported + AFTER
        signals = {name: in_cells(samples, start, size) for name, samples in signals.items()}
    members: dict[str, dict[str, Any]] = {}
    for name, values in signals.items():
        if name != "y":
            member, field = name.split(".")
            members.setdefault(member, {})[field] = values
    group = agents.Group(members)
    world = agents.World(
        {"y": signals["y"]}, {"cars": group}, size, float(case.seconds), case.time == "dense"
    )
    return world, reported


@parts
def test_an_oracle_gives_every_answer(part: int) -> None:
    for case in CORPUS[part::PARTS]:
        world, reported = world_of(case)
        found = agents.evaluate(world, node_of(case.tree), truth=case.semantics == "boolean")[:reported]
        if case.time == "discrete":
            assert same(case, found, case.values), mismatch(case, found)
        else:
            assert agree(case, list(range(reported)), found), mismatch(case, found)
            assert case.end == reported - 1


@pytest.mark.parametrize("backend", ["cpp", "python"])
@parts
def test_offline(part: int, backend: str) -> None:
    for case in CORPUS[part::PARTS]:
        signal = specification(case, backend).evaluate(data_of(case)).signal
        values = signal.values.tolist()
        if case.time == "discrete":
            assert same(case, values, case.values), mismatch(case, values)
        else:
            ticks = ticks_of(signal.times, case.seconds)
            assert agree(case, ticks, values), mismatch(case, values)
            assert ticks[-1] == case.end


@pytest.mark.parametrize("backend", ["cpp", "python"])
@parts
def test_sample_by_sample(part: int, backend: str) -> None:
    for case in CORPUS[part::PARTS]:
        if case.known is not None:
            monitor = specification(case, backend).monitor()
            (one_after_another if case.time == "discrete" else instant_by_instant)(
                case, monitor, data_of(case)
            )


def test_there_are_cases_of_each_kind_and_trees_of_all_formulas() -> None:
    kinds = {tuple(case.id.split("/")[:3]) for case in CORPUS}
    assert kinds == {(time, "quantified", kind) for time in ("discrete", "dense") for kind in KINDS}
    assert any(None in values for case in CORPUS for values in case.signals.values())
    for case in CORPUS:
        assert case.formula.startswith(HEAD)
        formula = ground(rtamt.parse(case.formula).formula, case.seconds)
        assert formula_of(case.tree, case.seconds) == formula, case.id
