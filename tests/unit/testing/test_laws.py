"""check_operator: true operators pass, whichever way they are run, and wrong ones fail with a counterexample."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.extend import STL, Blocks, Operator
from rtamt.testing import check_operator
from tests.unit.test_extend import AVG, BETWEEN, FLIPS, TOTAL


def by_definition_alone(name: str) -> Operator:
    """Return an operator of the table as a user would try it first."""
    op = STL[name]
    return replace(
        op, name=f"my_{name}", spellings=(f"my_{name}",), kernel=None, expansion=None, truth=None, folds=False,
        example=op.example.replace(op.spellings[0], f"my_{name}", 1), dual=None,
    )  # fmt: skip


@pytest.mark.parametrize("name", ["since", "until", "s_next", "ge"])
def test_a_definition_alone_obeys_the_laws_in_every_mode(name: str) -> None:
    check_operator(by_definition_alone(name), examples=6)


@pytest.mark.parametrize("op", [AVG, FLIPS, BETWEEN, STL["once"]], ids=lambda op: op.name)
def test_these_obey_the_laws(op: Operator) -> None:
    check_operator(op, infinite=False, examples=6)


def test_a_class_over_blocks_obeys_the_laws() -> None:
    check_operator(TOTAL, infinite=False, examples=6)


class Flips:
    """FLIPS over stretches of events: the instants at which a change enters the window, and leaves it."""

    def __init__(self, a: int, b: int) -> None:
        self.a, self.b = a, b
        self.changes: list[int] = []
        self.last: float | None = None
        self.told: int | None = None

    def push(self, events: Any, *, until: int) -> Any:
        times, values = events
        begin = int(times[0]) if self.told is None else self.told + 1
        for time, value in zip(times.tolist(), values.tolist(), strict=True):
            if self.last is not None and value != self.last:
                self.changes.append(time)
            self.last = value
        moves = {c + shift for c in self.changes for shift in (self.a, self.b)}
        instants = sorted(
            {m for m in moves if begin <= m <= until} | ({begin} if self.told is None else set())
        )
        self.told = until
        return np.array(instants, np.int64), [
            float(sum(t - self.b < c <= t - self.a for c in self.changes)) for t in instants
        ]


def test_a_class_over_events_obeys_the_laws() -> None:
    check_operator(replace(FLIPS, kernel=Blocks(dense=Flips)), infinite=False, examples=8)


def test_a_class_over_events_that_tells_too_much_is_told() -> None:
    class Early(Flips):
        def push(self, events: Any, *, until: int) -> Any:
            return super().push(events, until=until + 5)

    language = STL.extend(replace(FLIPS, kernel=Blocks(dense=Early)))
    spec = rtamt.parse("flips[0:3ns] x", language=language, time="dense")
    with pytest.raises(rtamt.EvaluationError) as info:
        spec.evaluate({"x": (np.array([0, 3, 4]), [1.0, 2.0, 3.0])})
    assert str(info.value) == (
        "the kernel of 'flips' failed in 'flips[0:3ns] x': it gave a value that is not due yet; mend the kernel"
    )


class Forgetful:
    """A sum that begins anew with every block."""

    def push(self, x: Any) -> Any:
        return np.cumsum(x)


def test_a_kernel_that_forgets_between_blocks_is_found() -> None:
    wrong = replace(TOTAL, kernel=Blocks(discrete=Forgetful))
    with pytest.raises(AssertionError) as info:
        check_operator(wrong, infinite=False, examples=20)
    message = str(info.value)
    assert "the operator 'total' breaks the law" in message
    assert "\n  x = [" in message
    assert "\n  expected [" in message


def test_a_kernel_that_is_not_its_definition_is_found() -> None:
    class Negative:
        def push(self, x: Any) -> Any:
            return -np.cumsum(x)

    with pytest.raises(AssertionError) as info:
        check_operator(replace(TOTAL, kernel=Blocks(discrete=Negative)), infinite=False)
    assert str(info.value).startswith("the operator 'total' breaks the law \"fast is the definition\" in '")


def test_an_interval_that_says_less_than_is_read_is_found() -> None:
    greedy = replace(AVG, definition=lambda x, _a, _b: np.cumsum(x))
    with pytest.raises(AssertionError, match="breaks the law"):
        check_operator(greedy, infinite=False, examples=20)


def test_a_wrong_dual_is_found() -> None:
    with pytest.raises(AssertionError, match="its dual is 'and'"):
        check_operator(replace(by_definition_alone("implies"), dual="and"), examples=4)


def test_an_example_that_does_not_show_the_operator_is_found() -> None:
    with pytest.raises(AssertionError, match="the example shows the operator"):
        check_operator(replace(BETWEEN, example="x >= 3"))


def test_what_an_operator_raises_is_told() -> None:
    with pytest.raises(rtamt.EvaluationError, match="the operator 'between' failed in"):
        check_operator(replace(BETWEEN, definition=lambda x, _low, _high: x[99]))
