"""Random formulas with quantifiers over cars, and scenes in which cars appear and disappear."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hypothesis import strategies as st

from rtamt.language.formula import Apply, Const, Formula, Var, fold
from rtamt.language.operators import STL, Sort
from rtamt.language.parsing.grammar import is_number
from rtamt.language.quantifiers import QUANTIFIERS, Binder, Field, FieldOf, Group, quantified
from rtamt.rewrite.truth import rebuilt
from rtamt.testing.strategies import dense_traces, formulas, traces

if TYPE_CHECKING:
    from hypothesis.strategies import DrawFn

CARS = Group("cars", "car_*", (Field("x"),))
#: The declaration of the group, before the text of a formula.
HEAD = 'group cars = "car_*" { float x }; '


def quantify(word: str, body: Formula, other: str | None = None, *, step: bool = True) -> Formula:
    """Return a quantifier over a formula whose variables x become fields v.x of cars.

    ``other``: a quantifier inside it, over other members, for which y is w.x, too; ``step``: one sample ahead.
    """

    def over(variable: str, name: str) -> Formula:
        def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
            if isinstance(node, Var) and node.name == name:
                return FieldOf(f"{variable}.x", None, None, variable, "x", CARS)
            return rebuilt(node, args) if isinstance(node, Apply) else node

        return fold(body, step)

    if other is None:
        return _over(word, Binder("v", CARS), over("v", "x"))
    body = over("w", "y")
    inner = _over(other, Binder("w", CARS, (("v", "w"),)), body)
    body = STL["or"](inner, Const(-1.0))
    body = STL["next"](body) if step else body
    return _over(word, Binder("v", CARS), over("v", "x"))


def _over(word: str, binder: Binder, body: Formula) -> Formula:
    """Return a quantifier over a body; what counts is a condition."""
    condition = STL["gt"](body, Const(0.0)) if word == "count" and is_number(body) else body
    return quantified(word, binder)(condition)


def inside(outer: Formula, quantifier: Formula) -> Formula:
    """Return a formula with a quantifier in place of its variable q; where a number is needed, 1 or 0."""
    is_count = isinstance(quantifier, Apply) and quantifier.op.result is Sort.NUMBER

    def suited(operand: Formula, sort: Sort) -> Formula:
        if operand is not quantifier or (sort is Sort.NUMBER) == is_count or sort is Sort.FORMULA:
            return operand
        return STL["gt"](operand, Const(0.0)) if is_count else STL["if"](operand, Const(1.0), Const(0.0))

    def step(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if isinstance(node, Var) and node.name == "q":
            return quantifier
        if not isinstance(node, Apply):
            return node
        return rebuilt(
            node, tuple(suited(arg, sort) for arg, sort in zip(args, node.op.operands, strict=False))
        )

    return fold(outer, step)


@st.composite
def quantified_formulas(
    draw: DrawFn, /, max_depth: int = 3, *, discrete: bool = True, **settings: Any
) -> Formula:
    """Draw a formula with a quantifier, sometimes with one inside it, beside the ordinary variable y.

    ``settings``: those of ``formulas``.
    """
    settings["discrete"] = discrete
    words = st.sampled_from(sorted(QUANTIFIERS))
    other = draw(st.none() | words)
    body = quantify(draw(words), draw(formulas(max_depth, **settings)), other, step=discrete)
    around = draw(formulas(2, ("q", "y"), **settings))
    return STL["or"](inside(around, body), STL["and"](Var("y"), body))


@st.composite
def scenes(draw: DrawFn, n: int) -> dict[str, list[float | None]]:
    """Draw the x of some cars, each of which appears and disappears."""
    trace = draw(traces(("a", "b", "c"), min_size=n, max_size=n))
    scene = {}
    for name, values in trace.items():
        present = draw(st.lists(st.booleans(), min_size=n, max_size=n))
        scene[f"car_{name}.x"] = [
            x if here else None for x, here in zip(values.tolist(), present, strict=True)
        ]
    return scene


@st.composite
def dense_scenes(draw: DrawFn, until: int) -> dict[str, list[tuple[int, float | None]]]:
    """Draw the x of some cars in ticks, None where one disappears."""
    trace = draw(dense_traces(("a", "b", "c"), max_size=6))
    scene = {}
    for name, (ticks, values) in trace.items():
        shown = draw(st.lists(st.booleans(), min_size=len(ticks), max_size=len(ticks)))
        samples = [
            (int(t), float(x) if here else None) for t, x, here in zip(ticks, values, shown, strict=True)
        ]
        scene[f"car_{name}.x"] = [each for each in samples if each[0] <= until]
    return {name: samples for name, samples in scene.items() if any(x is not None for _, x in samples)}
