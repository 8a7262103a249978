"""Explanations are true: what they claim is done, and looked at by the definition.

A formula is evaluated by the definition over stand-ins for its predicates, one for the places under an
even number of negations and one for the others (``separated``, written here again), so that each
can be given any value at any instant.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import EvaluationError
from rtamt.explain.explain import explain
from rtamt.language.contents import variables
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, postorder
from rtamt.language.operators import STL
from rtamt.language.records import Sort
from rtamt.reference import dense_robustness as dense_reference
from rtamt.reference import discrete_robustness as reference
from rtamt.signals.dense import record_dense
from rtamt.signals.discrete import record_discrete
from tests.oracle import boolean
from tests.oracle.dense_grid import on_grid
from tests.support.strategies import dense_traces, formulas, traces

ONE = Fraction(1)
BACKENDS = st.sampled_from(["cpp", "cpp", "cpp", "python"])


# ---- formulas over stand-ins ---------------------------------------------------------------------


def is_predicate(node: Formula) -> bool:
    if isinstance(node, Const):
        return abs(node.value) != inf
    return not isinstance(node, Apply) or node.op.result is Sort.NUMBER or node.op.truth is not None


def separated(node: Formula, found: list[Formula], sign: int = 1) -> Formula:
    """The formula over stand-ins: ``p3+`` for the fourth of the ``found`` predicates at positive places."""
    if is_predicate(node):
        if node not in found:
            found.append(node)
        return Var(f"p{found.index(node)}{'+' if sign > 0 else '-'}") if variables(node) else node
    if not isinstance(node, Apply):
        return node
    if node.op.name == "not":
        return STL["not"](separated(node.args[0], found, -sign))
    if node.op.expansion is not None:
        return separated(node.op.expansion(*node.args, node.interval), found, sign)
    args = tuple(separated(arg, found, sign) for arg in node.args)
    return Apply(node.op, args, node.interval)


# ---- the two time domains ------------------------------------------------------------------------


class Discrete:
    name = "discrete"

    def __init__(self, formula: Formula, data: dict[str, Any]) -> None:
        self.formula = formula
        self.data = data
        self.size = self.recorded = len(next(iter(data.values())))
        self.recording = record_discrete(data, tuple(data), ONE)

    def value(self, formula: Formula, columns: dict[str, Any], cell: int) -> float:
        return float(reference.evaluate(formula, columns, self.size, ONE)[cell])

    def holds(self, cell: int) -> bool:
        return boolean.satisfied(self.formula, self.data, self.size, ONE)[cell]

    def column(self, predicate: Formula) -> np.ndarray:
        return reference.evaluate(predicate, self.data, self.size, ONE)

    def truth(self, predicate: Formula) -> np.ndarray:
        return np.array(boolean.satisfied(predicate, self.data, self.size, ONE))


class Dense:
    """Cell k is the tick k after the latest first one; as many as can matter."""

    name = "dense"

    def __init__(self, formula: Formula, data: dict[str, Any]) -> None:
        self.formula = formula
        self.data = {name: data[name] for name in variables(formula)}
        self.start = max(int(times[0]) for times, _ in self.data.values())
        end = max(int(times[-1]) for times, _ in self.data.values())
        self.recorded = end - self.start + 1
        bounds = [n.interval for n in postorder(formula) if isinstance(n, Apply) and n.interval is not None]
        self.size = self.recorded + sum(int(i.end or i.begin) for i in bounds) + 2
        told = {name: (times.astype(float), values) for name, (times, values) in self.data.items()}
        self.recording = record_dense(told, tuple(told), ONE)

    def value(self, formula: Formula, columns: dict[str, Any], cell: int) -> float:
        events = {}
        for name, column in columns.items():
            changes = np.flatnonzero(np.concatenate(([True], column[1:] != column[:-1])))
            events[name] = (changes, column[changes])
        # The answer is wanted up to the cell; what is ahead of the last change is settled.
        name = next(iter(events))
        times, values = events[name]
        if times[-1] < self.size:
            events[name] = np.append(times, self.size), np.append(values, values[-1])
        steps = dense_reference.evaluate(formula, events, ONE)
        return float(steps.values[np.searchsorted(steps.times, cell, side="right") - 1])

    def holds(self, cell: int) -> bool:
        return bool(on_grid(self.formula, self.data, ONE, truth=True)[1][2 * cell])

    def column(self, predicate: Formula) -> np.ndarray:
        columns = {name: self.samples(name) for name in variables(predicate)}
        return reference.evaluate(predicate, columns, self.size, ONE)

    def truth(self, predicate: Formula) -> np.ndarray:
        columns = {name: self.samples(name) for name in variables(predicate)}
        return np.array(boolean.satisfied(predicate, columns, self.size, ONE))

    def samples(self, name: str) -> np.ndarray:
        times, values = self.data[name]
        at = np.searchsorted(times, self.start + np.arange(self.size), side="right") - 1
        return np.asarray(values)[at]


World = Discrete | Dense


@dataclass
class Case:
    """A formula, a recording, an instant, the explanation, and the formula over stand-ins."""

    world: World
    cell: int
    explanation: Any
    apart: Formula
    predicates: list[Formula]

    def columns(self, change: Any = lambda _k, _sign, column: column) -> dict[str, np.ndarray]:
        """The stand-ins' values, changed by ``change(which, sign, values)``."""
        found = {}
        for k, predicate in enumerate(self.predicates):
            if variables(predicate):
                for sign in (1, -1):
                    column = self.world.column(predicate).copy()
                    found[f"p{k}{'+' if sign > 0 else '-'}"] = change(k, sign, column)
        return found or {"#": np.zeros(self.world.size)}

    def robustness(self, columns: dict[str, np.ndarray]) -> float:
        return self.world.value(self.apart, columns, self.cell)

    def known(self, stretches: Any) -> dict[int, np.ndarray]:
        """Of each predicate, where its truth is known."""
        masks = {k: np.zeros(self.world.size, bool) for k in range(len(self.predicates))}
        for stretch in stretches:
            begin, end = (
                self.world.size if time is None else int(time) - offset
                for time, offset in ((stretch.start, self.offset), (stretch.end, self.offset))
            )
            masks[self.predicates.index(stretch.formula)][begin : end + stretch.closed] = True
        return masks

    @property
    def offset(self) -> int:
        return self.world.start if isinstance(self.world, Dense) else 0

    def forced(self, stretches: Any, elsewhere: Any) -> bool:
        """Whether the verdict stands where the predicates are as they are on ``stretches`` alone.

        ``elsewhere(sign, shape)`` gives the truth of stand-ins at all other instants.
        """
        known = self.known(stretches)
        truths = [self.world.truth(predicate) for predicate in self.predicates]

        def change(k: int, sign: int, _column: np.ndarray) -> np.ndarray:
            truth = np.where(known[k], truths[k], elsewhere(k, sign, truths[k]))
            return np.where(truth, inf, -inf)

        columns = self.columns(change)
        fixed: dict[Formula, Formula] = {}
        for k, (predicate, truth) in enumerate(zip(self.predicates, truths, strict=True)):
            if not variables(predicate):  # it may change all the same: a window before the start is empty
                fixed[predicate] = Var(f"p{k}")
                columns[f"p{k}"] = np.where(truth, inf, -inf)
        formula = replaced(self.apart, fixed)
        value = self.world.value(formula, columns, self.cell)
        assert abs(value) == inf
        return (value > 0) == self.explanation.satisfied

    def adversary(self, _k: int, sign: int, truth: np.ndarray) -> np.ndarray:
        return np.full(len(truth), (sign > 0) != self.explanation.satisfied)


def replaced(node: Formula, by: dict[Formula, Formula]) -> Formula:
    if node in by:
        return by[node]
    if isinstance(node, Apply) and not is_predicate(node):
        return Apply(node.op, tuple(replaced(arg, by) for arg in node.args), node.interval)
    return node


@st.composite
def cases(draw: Any, *, domain: str, **settings: Any) -> Case:
    settings = {"unbounded_future": True, "max_depth": 4, **settings}
    world: World
    if domain == "dense":
        formula = draw(formulas(discrete=False, arithmetic=False, **settings))
        assume(variables(formula))
        world = Dense(formula, draw(dense_traces(max_size=7)))
    else:
        formula = draw(formulas(**settings))
        world = Discrete(formula, draw(traces(max_size=14)))
    cell = draw(st.integers(0, world.recorded - 1))
    at = float(cell + (world.start if isinstance(world, Dense) else 0))
    try:
        explanation = explain(formula, world.recording, at=at, backend=draw(BACKENDS))
    except EvaluationError:
        assume(False)
    predicates: list[Formula] = []
    apart = separated(formula, predicates)
    return Case(world, cell, explanation, apart, predicates)


few = settings(max_examples=settings().max_examples // 2)
both_domains = pytest.mark.parametrize("domain", ["discrete", "dense"])


# ---- the laws ------------------------------------------------------------------------------------


@both_domains
@few
@given(data=st.data(), moved_to=st.one_of(st.sampled_from([inf, -inf]), st.integers(-20, 20)))
def test_the_critical_value_is_the_robustness_which_follows_it_as_far_as_told(
    domain: str, data: Any, moved_to: float
) -> None:
    case = data.draw(cases(domain=domain))
    assert case.explanation.satisfied == case.world.holds(case.cell)
    assert case.explanation.robustness == case.robustness(case.columns())
    point = case.explanation.critical
    assert point.polarity * point.value == case.explanation.robustness
    assert point.lowest <= case.explanation.robustness <= point.highest
    assume(point.formula is not None)
    begin, end = int(point.start) - case.offset, point.end
    end = case.world.size if end is None else int(end) - case.offset + (domain == "discrete")
    column = case.world.column(point.formula)
    assert begin <= int(point.time) - case.offset < end
    assert set(column[begin:end]) == {point.value}
    critical = case.predicates.index(point.formula)

    def change(k: int, sign: int, column: np.ndarray) -> np.ndarray:
        if k == critical and sign == point.polarity:
            column[begin:end] = point.polarity * moved_to
        return column

    assume(point.decided_by == "predicate")
    followed = case.robustness(case.columns(change))
    assert followed == min(max(moved_to, point.lowest), point.highest)


@both_domains
@few
@given(data=st.data())
def test_a_place_was_critical_that_changes_nothing_alone_beside_one_that_overturns_the_verdict(
    domain: str, data: Any
) -> None:
    case = data.draw(cases(domain=domain, max_depth=3))
    robustness, point = case.explanation.robustness, case.explanation.critical
    falls = point.lowest < 0 if robustness > 0 else point.highest > 0
    if robustness == 0 or falls:
        return
    for k, predicate in enumerate(case.predicates):
        column = case.world.column(predicate)
        edges = np.arange(1, len(column)) if domain == "discrete" else np.flatnonzero(np.diff(column)) + 1
        for begin, end in pairwise([0, *edges, len(column)]):
            for sign in (1, -1):
                if variables(predicate) and sign * column[begin] == robustness:

                    def against(which: int, place: int, column: np.ndarray) -> np.ndarray:
                        if (which, place) == (k, sign):  # noqa: B023 - called at once
                            column[begin:end] = -sign * robustness  # noqa: B023 - as above
                        return column

                    assert case.robustness(case.columns(against)) * robustness >= 0


@both_domains
@few
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_the_verdict_stands_while_predicates_move_by_less_than_the_robustness_and_falls_when_all_cross(
    domain: str, data: Any, seed: int
) -> None:
    case = data.draw(cases(domain=domain))
    robustness = case.explanation.robustness
    assume(robustness != 0)
    most = min(abs(robustness), 100.0) * (1 - 1e-9)
    random = np.random.default_rng(seed)
    shifted = case.columns(lambda _k, _sign, column: column + random.uniform(-most, most, len(column)))
    assert (case.robustness(shifted) > 0) == case.explanation.satisfied == (robustness > 0)
    against = case.columns(lambda _k, sign, column: column - sign * np.sign(robustness) * most)
    assert (case.robustness(against) > 0) == case.explanation.satisfied
    # Across together: where nothing but predicates decides, which leaves no constants.
    assume(case.explanation.critical.decided_by == "predicate" and abs(robustness) != inf)
    assume(all(variables(predicate) for predicate in case.predicates))
    by = -robustness - np.copysign(1.0, robustness)
    crossed = case.columns(lambda _k, sign, column: column + sign * by)
    assert case.robustness(crossed) == robustness + by


@both_domains
@few
@given(data=st.data(), seed=st.integers(0, 2**32 - 1))
def test_the_implicant_forces_the_verdict_whatever_happens_elsewhere_and_no_interval_of_it_is_idle(
    domain: str, data: Any, seed: int
) -> None:
    case = data.draw(cases(domain=domain))
    implicant = case.explanation.implicant
    random = np.random.default_rng(seed)
    assert case.forced(implicant, case.adversary)
    assert case.forced(implicant, lambda _k, _sign, truth: random.random(len(truth)) < 0.5)
    for k, predicate in enumerate(case.predicates):
        mine = [stretch for stretch in implicant if stretch.formula == predicate]
        assert all((case.world.truth(predicate) == s.holds)[case.known([s])[k]].all() for s in mine)
    for left_out in implicant:
        rest = [stretch for stretch in implicant if stretch is not left_out]
        assert not case.forced(rest, case.adversary)


@few
@given(st.data(), st.integers(0, 2**32 - 1))
def test_signals_may_do_anything_outside_the_implicant(data: Any, seed: int) -> None:
    """Over formulas whose predicates read a variable each: every one of them can be moved alone."""
    drawn = data.draw(formulas(arithmetic=False, unbounded_future=True))
    names: dict[Formula, Formula] = {}

    def own_variables(node: Formula) -> Formula:
        if is_predicate(node):
            own = STL["ge"](Var(f"v{len(names)}"), Const(1.0))
            return names.setdefault(node, own) if variables(node) else node
        if isinstance(node, Apply):
            return Apply(node.op, tuple(map(own_variables, node.args)), node.interval)
        return node

    formula = own_variables(drawn)
    assume(names)
    signals_of = tuple(variables(formula))
    columns = data.draw(traces(signals_of, min_size=2, max_size=14))
    n = len(columns[signals_of[0]])
    explanation = explain(formula, record_discrete(columns, signals_of, ONE))
    random = np.random.default_rng(seed)
    for _ in range(5):
        changed = {name: random.integers(-4, 5, n) / 2 for name in signals_of}
        for stretch in explanation.implicant:
            (name,) = variables(stretch.formula)
            kept = slice(int(stretch.start), int(stretch.end) + 1)
            changed[name][kept] = columns[name][kept]
        assert boolean.satisfied(formula, changed, n, ONE)[0] == explanation.satisfied


def test_stand_ins_are_told_apart_by_sign() -> None:
    found: list[Formula] = []
    x = STL["ge"](Var("x"), Const(3.0))
    window = Interval(Fraction(0), Fraction(2))
    assert str(separated(STL["implies"](x, STL["always"](x, interval=window)), found)) == (
        'not "p0-" or always[0:2] "p0+"'
    )


@both_domains
@few
@given(data=st.data())
def test_the_first_violation_of_an_explanation_is_that_of_the_result(domain: str, data: Any) -> None:
    dense = domain == "dense"
    one = formulas(discrete=not dense, arithmetic=False, unbounded_future=True, max_depth=3)
    parts = data.draw(
        st.lists(st.tuples(st.sampled_from(["", "always", "always[1:3]"]), one), min_size=1, max_size=3)
    )
    text = " and ".join(f"{window}({part})" for window, part in parts)
    spec = rtamt.parse(text, time=domain)
    assume(spec.input_names)
    signals = data.draw(dense_traces(max_size=7) if dense else traces(max_size=14))
    signals = {name: signals[name] for name in spec.input_names}
    try:
        result = spec.evaluate(signals)
        explanation = result.explain()
    except EvaluationError:
        assume(False)
    assert explanation.first_violation == rtamt.first_violation(result)
