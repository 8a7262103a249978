"""The corpus is true: an evaluator of its own gives every answer, and so does every path of the engine."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from conformance import cases
from conformance.generate import ALONE, data_of, ticks_of
from conformance.quantified import CARS
from conformance.trees import table_of

import rtamt
from rtamt.language.formula import Apply, Const, Formula, Interval, Var, fold, postorder
from rtamt.language.operators import STL, Fixity
from rtamt.language.parsing import parser
from rtamt.language.quantifiers import Binder, FieldOf, quantified
from rtamt.language.shares import Share, ShareKind
from rtamt.language.tables import Table, table_operator
from rtamt.language.unwritten import UNWRITTEN
from rtamt.rewrite.ground import ground
from tests.oracle import meaning

if TYPE_CHECKING:
    from conformance.cases import Case

# As many parts as keep a failure close to its case and the suite quick to start.
PARTS = 8
CORPUS = [case for name in cases.FILES for case in cases.read(name)]
KNOWN = [case for case in CORPUS if case.known is not None]
INFINITE = Const(inf), Const(-inf)

parts = pytest.mark.parametrize("part", range(PARTS))


def specification(case: Case, backend: str) -> rtamt.Specification:
    settings: dict[str, Any] = {"semantics": case.semantics, "roles": dict.fromkeys(case.inputs, "input")}
    if case.time == "discrete":
        return rtamt.parse(case.formula, backend=backend, period=case.seconds, **settings)
    return rtamt.parse(case.formula, backend=backend, time="dense", resolution=case.seconds, **settings)


def same(case: Case, got: list[Any], wanted: list[Any]) -> bool:
    """Return whether two lists of values agree: to the last bit, but for what the C library rounds."""
    if len(got) != len(wanted):
        return False
    if case.semantics == "boolean":
        got = [v if isinstance(v, bool) else v > 0 for v in got]
    if got == wanted:
        return True
    names = {node.op.name for node in postorder(rtamt.parse(case.formula).formula) if isinstance(node, Apply)}
    return bool(names & cases.ROUNDED) and np.allclose(got, wanted, rtol=cases.TOLERANCE, atol=0)


def mismatch(case: Case, what: list[Any]) -> str:
    return f"{case.id}: '{case.formula}' gave {what} instead of {case.values}"


def changes(ticks: list[int], values: list[Any], semantics: str) -> list[list[Any]]:
    """Return a step function as its changes."""
    kept: list[list[Any]] = []
    for tick, value in zip(ticks, values, strict=True):
        v = value > 0 if semantics == "boolean" and not isinstance(value, bool) else value
        if not kept or kept[-1][1] != v:
            kept.append([tick, v])
    return kept


def agree(case: Case, ticks: list[int], values: list[Any]) -> bool:
    """Return whether dense events are the answer."""
    got = changes(ticks, values, case.semantics)
    return [t for t, _ in got] == [t for t, _ in case.values] and same(
        case, [v for _, v in got], [v for _, v in case.values]
    )


def test_the_corpus_has_every_operator_and_names_each_case_once() -> None:
    assert len({case.id for case in CORPUS}) == len(CORPUS)
    asked = {
        time: {case.id.split("/")[1] for case in CORPUS if case.time == time}
        for time in ("discrete", "dense")
    }
    assert {op.name for op in STL} <= asked["discrete"]
    assert {op.name for op in STL if not op.discrete_only} <= asked["dense"]
    assert {op.name for op in STL} <= meaning.COVERED
    assert sum(case.id.startswith("discrete/until/") for case in CORPUS) == ALONE


def plain(formula: Formula) -> Formula:
    """Return a formula whose tables, Booleans and members are written with operators that the evaluator has.

    A table is linear between its points and constant outside them; what holds or not is +inf or -inf.
    """

    def line(x: Formula, left: list[float], right: list[float]) -> Formula:
        between = STL["min"](STL["max"](x, Const(left[0])), Const(right[0]))  # beyond it inf * 0 has no value
        share = STL["div"](STL["sub"](between, Const(left[0])), Const(right[0] - left[0]))
        return STL["add"](Const(left[1]), STL["mul"](share, Const(right[1] - left[1])))

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        table = table_of(node.op)
        if table is not None:
            (x,) = args
            points = [list(point) for point in zip(table.xs, table.ys, strict=True)]
            value: Formula = Const(points[-1][1])
            for left, right in reversed(list(pairwise(points))):
                value = STL["if"](STL["lt"](x, Const(right[0])), line(x, left, right), value)
            return STL["if"](STL["lt"](x, Const(points[0][0])), Const(points[0][1]), value)
        if node.op.name == "truth":
            return STL["if"](STL["eq"](*args, Const(1.0)), *INFINITE)
        if node.op.name in ("holds_eq", "holds_ne"):
            return STL["if"](STL[node.op.name.removeprefix("holds_")](*args), *INFINITE)
        return Apply(node.op, args, node.interval)

    return fold(formula, step)


@parts
def test_an_evaluator_of_its_own_gives_every_answer(part: int) -> None:
    for case in CORPUS[part::PARTS]:
        formula = plain(rtamt.parse(case.formula).formula)
        roles = (case.semantics, case.inputs)
        horizon = meaning.horizon(formula, case.seconds)
        if case.time == "discrete":
            n = len(next(iter(case.signals.values())))
            values = meaning.discrete(formula, case.signals, n, case.seconds, *roles)
            assert same(case, values, case.values), mismatch(case, values)
            late = None if horizon is None else [k + horizon for k in range(n)]
            assert case.known == (late and [k if k < n else None for k in late]), case.id
            continue
        signals = {name: [tuple(pair) for pair in samples] for name, samples in case.signals.items()}
        start, cells = meaning.dense(formula, signals, case.seconds, *roles)
        assert agree(case, list(range(start, start + len(cells))), cells), mismatch(case, cells)
        assert case.end == start + len(cells) - 1
        if horizon is None:
            assert case.known is None
        else:
            assert case.known is not None
            for now, until in case.known:
                lasts = [
                    max([t for t, _ in samples if t <= now], default=-inf) for samples in signals.values()
                ]
                assert until == (
                    min(lasts) - horizon if min(lasts) - horizon >= start and min(lasts) > -inf else None
                )


@pytest.mark.parametrize("backend", ["cpp", "python"])
@parts
def test_offline(part: int, backend: str) -> None:
    for case in CORPUS[part::PARTS]:
        signal = specification(case, backend).evaluate(data_of(case)).signal
        if case.time == "discrete":
            assert same(case, signal.values.tolist(), case.values), mismatch(case, signal.values.tolist())
        else:
            ticks = ticks_of(signal.times, case.seconds)
            assert agree(case, ticks, signal.values.tolist()), mismatch(case, signal.values.tolist())
            assert ticks[-1] == case.end


@pytest.mark.parametrize("backend", ["cpp", "python"])
@parts
def test_online_sample_by_sample(part: int, backend: str) -> None:
    # The Python back end evaluates again at every update: a share of the cases will do.
    for case in KNOWN[part :: PARTS * (1 if backend == "cpp" else 8)]:
        monitor = specification(case, backend).monitor()
        data = data_of(case)
        (one_after_another if case.time == "discrete" else instant_by_instant)(case, monitor, data)


def one_after_another(case: Case, monitor: Any, data: dict[str, Any]) -> None:
    assert case.known is not None
    values = []
    for i, time in enumerate(data["time"]):
        value = monitor.update(time, **{name: data[name][i] for name in case.signals})
        assert (value is not None) == (i in case.known), f"{case.id}: sample {i}"
        values += [] if value is None else [value]
    values += monitor.finish().values.tolist()
    assert same(case, values, case.values), mismatch(case, values)


def instant_by_instant(case: Case, monitor: Any, data: dict[str, Any]) -> None:
    assert case.known is not None
    at = {name: dict(zip(times.tolist(), values, strict=True)) for name, (times, values) in data.items()}
    ticks: list[int] = []
    values: list[float] = []
    nanoseconds = int(case.seconds * 10**9)
    for now, until in case.known:
        stamp = now * nanoseconds
        signal = monitor.update(
            np.timedelta64(stamp, "ns"), **{name: at[name][stamp] for name in at if stamp in at[name]}
        )
        ticks += ticks_of(signal.times, case.seconds)
        values += signal.values.tolist()
        assert (ticks[-1] if ticks else None) == until, f"{case.id}: after {now}"
    rest = monitor.finish()
    ticks += ticks_of(rest.times, case.seconds)
    values += rest.values.tolist()
    assert agree(case, ticks, values), mismatch(case, values)
    assert ticks[-1] == case.end


@parts
def test_online_in_chunks(part: int) -> None:
    for case in KNOWN[part::PARTS]:
        monitor = specification(case, "cpp").monitor()
        data = data_of(case)
        longest = max(len(samples) for samples in case.signals.values())
        parts = []
        for begin in range(0, longest, 2):
            cut = slice(begin, begin + 2)
            if case.time == "discrete":
                chunk: dict[str, Any] = {name: column[cut] for name, column in data.items()}
            else:
                chunk = {name: (times[cut], values[cut]) for name, (times, values) in data.items()}
            parts.append(monitor.update_many(chunk))
        parts.append(monitor.finish())
        values = [v for signal in parts for v in signal.values.tolist()]
        if case.time == "discrete":
            assert same(case, values, case.values), mismatch(case, values)
        else:
            ticks = [t for signal in parts for t in ticks_of(signal.times, case.seconds)]
            assert agree(case, ticks, values), mismatch(case, values)


@pytest.mark.parametrize("name", cases.FILES)
def test_a_case_is_written_as_it_was_read(name: str) -> None:
    lines = (cases.FOLDER / name).read_text(encoding="utf-8").splitlines()
    assert [cases.line(case) for case in cases.read(name)] == lines


def formula_of(tree: dict[str, Any], step: Fraction) -> Formula:
    """Read a tree, as another tool would."""
    if "var" in tree:
        return Var(tree["var"])
    if "const" in tree:
        return Const(tree["const"])
    if "field" in tree:
        variable, field = tree["of"], tree["field"]
        return FieldOf(f"{variable}.{field}", None, None, variable, field, CARS)
    interval = None
    if tree["interval"] is not None:
        begin, end = tree["interval"]
        share = None
        if "share" in tree:
            kind, amount = ShareKind(tree["share"][0]), Fraction(tree["share"][1])
            share = Share(amount * step if kind is ShareKind.DURATION else amount, kind)
        interval = Interval(begin * step, None if end is None else end * step, share=share)
    if "member" in tree:
        binder = Binder(tree["member"], CARS, tuple(map(tuple, tree["apart"])))
        return quantified(tree["op"], binder)(formula_of(tree["args"][0], step))
    if "points" in tree:
        xs, ys = zip(*tree["points"], strict=True)
        op = table_operator("curve", Table(xs, ys))
    else:
        op = UNWRITTEN.get(tree["op"]) or STL[tree["op"]]
    return Apply(op, tuple(formula_of(arg, step) for arg in tree["args"]), interval)


def test_every_tree_is_its_formula() -> None:
    for case in CORPUS:
        formula = ground(rtamt.parse(case.formula).formula, case.seconds)
        assert formula_of(case.tree, case.seconds) == formula, case.id


def test_bounds_of_a_tree_are_in_steps_and_named_parts_stand_where_they_are_used() -> None:
    found = {case.id: case.tree for case in CORPUS}
    assert found["corner/discrete/period-100ms/standard"]["interval"] == [0, 3]
    assert found["corner/discrete/unbounded-from-2/standard"]["interval"] == [2, None]
    assert found["corner/discrete/named-parts/standard"] == {
        "op": "always",
        "args": [{"op": "le", "args": [{"var": "x"}, {"const": 3.0}], "interval": None}],
        "interval": [0, 1],
    }


README = (Path(__file__).parents[2] / "conformance" / "README.md").read_text(encoding="utf-8")


def test_the_readme_has_the_grammar_of_the_parser() -> None:
    _, _, rest = (parser.__doc__ or "").partition("::\n")
    productions = [line.strip() for line in rest.splitlines() if " = " in line]
    assert len(productions) == 11
    listing = README.split("```ebnf\n")[1].split("```")[0]
    assert listing.splitlines() == productions


def test_the_readme_has_the_precedence_of_the_table() -> None:
    written = [op for op in STL if op.fixity in (Fixity.PREFIX, Fixity.LEFT, Fixity.RIGHT)]
    rows = [
        " ".join(f"'{op.spellings[0]}'" for op in written if op.power == power)
        for power in sorted({op.power for op in written}, reverse=True)
    ]
    listing = README.split("bind alike:\n\n```text\n")[1].split("```")[0].splitlines()
    assert listing == [f"{rows[0]} before an operand", *rows[1:]]
    assert [op.spellings[0] for op in written if op.fixity is Fixity.RIGHT] == ["->"]
    named = [op.spellings[0] for op in STL if op.fixity in (Fixity.FUNCTION, Fixity.ATOM)]
    others = README.split("All others are")[1].split("\n- ")[0]
    assert [name for name in named if f"`{name}" not in others] == []
