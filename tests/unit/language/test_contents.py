"""The contents of a large formula are found once, and kept for few such formulas."""

from __future__ import annotations

from typing import TYPE_CHECKING

import rtamt
from rtamt.language import contents as module
from rtamt.language.contents import contents
from rtamt.language.formula import KEPT, Apply, Formula, Var
from rtamt.language.operators import STL
from rtamt.language.parsing.parser import parse_formula

if TYPE_CHECKING:
    import pytest


def large(name: str) -> Formula:
    return parse_formula(" and ".join([f"{name} >= 3"] * (KEPT // 2)))


def test_the_contents_of_a_large_formula_are_kept() -> None:
    formula = large("x")
    assert contents(formula).names == ("x",)
    assert contents(formula) is contents(formula)


def test_only_the_last_large_formulas_keep_their_contents() -> None:
    formulas = [large(f"x{k}") for k in range(6)]
    found = [contents(formula) for formula in formulas]
    assert [contents(formula) is known for formula, known in zip(formulas[2:], found[2:], strict=True)] == [
        True
    ] * 4
    again = contents(formulas[0])
    assert again is not found[0]
    assert again == found[0]


def test_a_forgotten_formula_frees_its_contents() -> None:
    formula = large("x")
    contents(formula)
    assert isinstance(formula, Apply)
    kept = formula._contents
    assert isinstance(kept, module.LargeContents)
    last = kept._last[-1]
    assert last() is kept
    del formula, kept
    assert last() is None


def test_a_monitor_walks_a_large_formula_few_times(monkeypatch: pytest.MonkeyPatch) -> None:
    spec = rtamt.parse(" and ".join(["x >= 3"] * KEPT))
    walked: list[tuple[Formula, ...]] = []
    walk = module.postorder

    def recorded(*formulas: Formula) -> tuple[Formula, ...]:
        walked.append(formulas)
        return walk(*formulas)

    monkeypatch.setattr(module, "postorder", recorded)
    assert spec.monitor().update(0, x=5) == 2.0
    assert len(walked) <= 2


def test_the_contents_of_a_small_formula_are_stored_in_it() -> None:
    formula = STL["not"](Var("x"))
    assert contents(formula) is formula._contents
