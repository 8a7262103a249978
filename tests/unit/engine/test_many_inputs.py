"""Formulas and groups that read many more signals than their programs have instructions."""

from __future__ import annotations

import pytest

import rtamt


def everything(n: int) -> str:
    return " and ".join(f"x{i} > 0" for i in range(n))


def positive(n: int) -> dict[str, list[float]]:
    return {"time": [0.0, 1.0, 2.0]} | {f"x{i}": [i + 3.0, i + 2.0, i + 1.0] for i in range(n)}


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("n", [79, 81, 200])
def test_a_formula_of_unbounded_future_over_more_inputs_than_its_last_program_has_bytes(
    n: int, time: str
) -> None:
    data = positive(n)
    assert rtamt.parse(f"always({everything(n)})").evaluate(data, time=time).robustness == 1
    assert rtamt.parse(f"eventually({everything(n)})").evaluate(data, time=time).robustness == 3
    data[f"x{n - 1}"][1] = -1.0
    result = rtamt.parse(f"always({everything(n)})").evaluate(data, time=time)
    assert result.robustness == -1
    assert f"x{n - 1}" in str(result.explain())


@pytest.mark.parametrize("time", ["discrete", "dense"])
def test_a_group_of_200_members(time: str) -> None:
    data = {"time": [0.0, 1.0]} | {f"car_{i}.x": [i + 1.0, i + 2.0] for i in range(200)}
    rule = 'group cars = "car_*"; always '
    found = [
        rtamt.parse(rule + each).evaluate(data, time=time).robustness
        for each in (
            "forall v in cars: v.x > 0",
            "exists v in cars: v.x > 0",
            "(count v in cars: v.x > 0) >= 3",
        )
    ]
    assert found == [1, 200, 197]
