"""The binding of the compiled core: what its monitor takes, refuses and answers."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from math import inf, nan
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from rtamt.compiler.program import Instruction

if TYPE_CHECKING:
    from collections.abc import Callable
from tests.unit.engine.discrete.programs import CORE, DIFFERENCE, A, B, monitor, program, state

# a - b known two samples late, and its maximum over three samples
LATE = program(
    A,
    B,
    Instruction("sub", a=0, b=1),
    Instruction("slide_max", a=2, n=3, lag=2),
    outputs=(3, 2),
    inputs=("a", "b"),
)


def check_rejected(m: Any, method: str, *arguments: Any) -> str:
    """Return why a call was refused, after checking that it changed nothing."""
    before = state(m)
    with pytest.raises(CORE.Refused) as caught:
        getattr(m, method)(*arguments)
    assert state(m) == before
    return str(caught.value)


def test_update_takes_a_dict_in_any_order() -> None:
    m = monitor()
    assert m.update(0.0, {"a": 5.0, "b": 1.0}) == 4.0
    assert m.update(1, {"b": 1, "a": 3}) == 2.0
    name = "".join(["a"])  # equal, and another object
    assert m.update(2.0, {name: 9.0, "b": 1.0}) == 8.0
    assert (m.samples, m.last_time) == (3, 2.0)


def test_a_value_is_none_until_it_is_known() -> None:
    m = CORE.Monitor(LATE, ["a", "b"])
    assert [m.step(float(x), 0.0) for x in (3, 1, 2, 5)] == [None, None, 3.0, 5.0]
    late, now = m.finish()
    assert late.tolist() == [5.0, 5.0]
    assert now.tolist() == []
    assert m.recent(2).tolist() == [2.0, 3.0]


@pytest.mark.parametrize(
    "number",
    [2, 2.0, True + 1, np.float64(2), np.float32(2), np.int8(2), np.uint64(2), Fraction(2)],
)
def test_every_real_number_is_taken(number: Any) -> None:
    assert monitor().update(0.0, {"a": number, "b": 1.0}) == 1.0
    assert monitor().update(number, {"a": 0.0, "b": 1.0}) == -1.0


def test_booleans_are_zero_and_one() -> None:
    assert monitor().step(True, False) == 1.0
    assert monitor().step(np.True_, np.False_) == 1.0


class Rude:
    def __float__(self) -> float:
        raise RuntimeError("no")


@pytest.mark.parametrize("value", ["2", b"2", None, 2j, Decimal(2), [2.0], np.ones(1), nan, 10**400, Rude()])
def test_what_is_no_number_is_refused(value: Any) -> None:
    m = monitor()
    m.update(0.0, {"a": 1.0, "b": 0.0})
    assert check_rejected(m, "update", 1.0, {"a": value, "b": 1.0}) == "value"
    assert check_rejected(m, "update_pairs", 1.0, [("a", value)]) == "value"
    assert check_rejected(m, "step", 1.0, value) == "value"
    assert check_rejected(m, "update", value, {"a": 1.0, "b": 1.0}) == "time"


def test_an_interrupt_in_a_number_is_not_swallowed() -> None:
    class Interrupted(Fraction):
        def __float__(self) -> float:
            raise KeyboardInterrupt

    m = monitor()
    with pytest.raises(KeyboardInterrupt):
        m.step(Interrupted(1), 0.0)
    assert m.samples == 0


@pytest.mark.parametrize(
    "values", [{}, {"a": 1.0}, {"a": 1.0, "c": 1.0}, {"a": 1.0, "b": 1.0, "c": 1.0}, {1: 1.0, "a": 2.0}, []]
)
def test_update_wants_every_variable_and_no_other(values: Any) -> None:
    assert check_rejected(monitor(), "update", 0.0, values) == "names"


def test_time_must_grow_and_be_finite() -> None:
    m = monitor()
    m.update(1.0, {"a": 1.0, "b": 1.0})
    for time in (1.0, 0.0, inf, -inf, nan, "2"):
        assert check_rejected(m, "update", time, {"a": 1.0, "b": 1.0}) == "time"
        assert check_rejected(m, "update_pairs", time, []) == "time"


def test_a_strict_monitor_refuses_a_gap_and_another_counts_it() -> None:
    strict = monitor(period=0.5, tolerance=0.1)
    strict.update(0.0, {"a": 1.0, "b": 1.0})
    assert check_rejected(strict, "update", 0.6, {"a": 1.0, "b": 1.0}) == "time"
    assert strict.update(0.5, {"a": 1.0, "b": 1.0}) == 0.0
    lenient = monitor(period=0.5, tolerance=0.1, strict=False)
    for time in (0.0, 0.5, 1.2, 1.7, 1.8):
        lenient.update_pairs(time, [("a", 1.0), ("b", 1.0)])
    assert lenient.violations == 2
    lenient.push(np.array([2.3, 9.0, 9.5]), [np.zeros(3), np.zeros(3)])
    assert lenient.violations == 3


def test_pairs_keep_the_value_of_what_is_left_out() -> None:
    m = monitor(ignored={"c"})
    assert check_rejected(m, "update_pairs", 0.0, [("a", 5.0)]) == "names"
    assert m.update_pairs(0.0, (["a", 5.0], ("c", "anything"), ("b", 1.0))) == 4.0
    assert m.update_pairs(1.0, [("b", 2.0)]) == 3.0
    assert m.update_pairs(2.0, []) == 3.0
    assert m.update_pairs(3.0, [("a", 1.0), ("a", 9.0)]) == 7.0
    m.push(None, [np.array([1.0, 10.0]), np.array([1.0, 3.0])])
    assert m.update_pairs(6.0, [("b", 4.0)]) == 6.0
    m.reset()
    assert check_rejected(m, "update_pairs", 0.0, [("a", 5.0)]) == "names"


@pytest.mark.parametrize(
    ("pairs", "reason"),
    [({"a": 1.0}, "pairs"), ("ab", "pairs"), ([("a",)], "pairs"), ([("a", 1.0, 2.0)], "pairs"),
     (["ab"], "pairs"), ([("d", 1.0)], "names"), ([([], 1.0)], "names"), ([(1, 1.0)], "names")],
)  # fmt: skip
def test_pairs_that_are_none_are_refused(pairs: Any, reason: str) -> None:
    m = monitor(ignored={"c"})
    m.step(1.0, 1.0)
    assert check_rejected(m, "update_pairs", 1.0, pairs) == reason


def test_a_failed_operation_names_instruction_and_sample_and_changes_nothing() -> None:
    m = monitor()
    m.step(3.0, 1.0)
    before = state(m)
    calls: list[Callable[[], Any]] = [
        lambda: m.step(inf, inf),
        lambda: m.update(1.0, {"a": inf, "b": inf}),
        lambda: m.update_pairs(1.0, [("a", inf), ("b", inf)]),
        lambda: m.push(None, [np.array([inf]), np.array([inf])]),
    ]
    for call in calls:
        with pytest.raises(CORE.Undefined) as caught:
            call()
        assert caught.value.args == (2, 1)
        assert state(m) == before
    assert m.update_pairs(1.0, [("b", 0.0)]) == 3.0
    with pytest.raises(CORE.Undefined) as caught:
        CORE.evaluate(DIFFERENCE, [np.array([1.0, inf]), np.array([1.0, inf])], 2)
    assert caught.value.args == (2, 1)


def test_after_finish_samples_are_refused_until_reset() -> None:
    m = CORE.Monitor(LATE, ["a", "b"])
    m.step(1.0, 0.0)
    assert [values.tolist() for values in m.finish()] == [[1.0], []]
    assert [values.tolist() for values in m.finish()] == [[], []]
    assert check_rejected(m, "step", 1.0, 1.0) == "finished"
    assert check_rejected(m, "update", 1.0, {"a": 1.0, "b": 1.0}) == "finished"
    assert check_rejected(m, "update_pairs", 1.0, []) == "finished"
    assert check_rejected(m, "push", None, [np.ones(1), np.ones(1)]) == "finished"
    m.reset()
    assert m.samples == 0
    assert (m.last_time, m.last(2)) == (None, None)
    assert m.step(1.0, 0.0) is None


def test_chunks_give_what_single_samples_give() -> None:
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 10_000))
    times = np.cumsum(rng.uniform(0.5, 1.5, size=10_000))
    whole = CORE.evaluate(LATE, [a, b], len(a))
    chunks = CORE.Monitor(LATE, ["a", "b"])
    parts = [
        chunks.push(times[i:j], [a[i:j], b[i:j]]) for i, j in ((0, 1), (1, 1), (1, 5000), (5000, 10_000))
    ]
    parts.append(chunks.finish())
    for output in (0, 1):
        assert np.array_equal(np.concatenate([part[output] for part in parts]), whole[output])
    assert chunks.recent(3).tolist() == times[-3:].tolist()
    assert chunks.samples == 10_000


def test_step_takes_as_many_values_as_inputs() -> None:
    assert check_rejected(monitor(), "step", 1.0) == "count"
    assert check_rejected(monitor(), "step", 1.0, 2.0, 3.0) == "count"


def test_the_latest_value_of_each_output_is_there_once_it_is_known() -> None:
    m = CORE.Monitor(LATE, ["a", "b"])
    assert [m.latest(0), m.latest(1)] == [None, None]
    for a in (5.0, 4.0, 6.0):
        m.step(a, 1.0)
        assert m.latest(1) == a - 1.0
    assert m.latest(0) == 5.0
    with pytest.raises(IndexError, match=r"^There is no output 2\.$"):
        m.latest(2)


def test_another_monitor_goes_on_from_a_state() -> None:
    m, other = CORE.Monitor(LATE, ["a", "b"]), CORE.Monitor(LATE, ["a", "b"])
    for t, a in enumerate((5.0, 4.0)):
        m.update(t + 0.5, {"a": a, "b": 1.0})
    other.step(9.0, 0.0)
    other.restore(m.state())
    for each in (m, other):
        assert each.update_pairs(2.5, [("a", 2.0)]) == 4.0
        assert (each.samples, each.last_time) == (3, 2.5)
        assert each.recent(3).tolist() == [0.5, 1.5, 2.5]
    assert m.state() == other.state()
    with pytest.raises(ValueError, match=r"^This is not the state of a monitor of this program\.$"):
        monitor().restore(m.state())


def test_wrong_calls_say_what_is_wrong() -> None:
    m = monitor()
    with pytest.raises(TypeError, match=r"^Monitor.update takes 2 arguments, got 1.$"):
        m.update(0.0)
    with pytest.raises(TypeError, match=r"^Monitor.update_pairs takes 2 arguments, got 3.$"):
        m.update_pairs(0.0, [], [])
    with pytest.raises(ValueError, match=r"^Got 1 columns for a program with 2 inputs.$"):
        m.push(None, [np.ones(1)])
    with pytest.raises(ValueError, match=r"^A column has 2 samples where 1 are expected.$"):
        m.push(None, [np.ones(1), np.ones(2)])
    with pytest.raises(ValueError, match=r"^A column has 1 samples where 2 are expected.$"):
        m.push(np.arange(2.0), [np.ones(1), np.ones(1)])
    with pytest.raises(ValueError, match=r"^Only the times of the last 0 samples are remembered.$"):
        m.recent(1)
    with pytest.raises(IndexError, match=r"^There is no instruction 3.$"):
        m.last(3)
    with pytest.raises(ValueError, match=r"^Got 1 names for a program with 2 inputs.$"):
        CORE.Monitor(DIFFERENCE, ["a"])
    with pytest.raises(ValueError, match=r"^Two inputs are called 'a'.$"):
        CORE.Monitor(DIFFERENCE, ["a", "a"])
    with pytest.raises(
        ValueError, match=r"^The period must be positive and finite, the tolerance 0 or more.$"
    ):
        monitor(period=0.0)
    with pytest.raises(
        ValueError,
        match=r"^This is not a program that can be run: its checksum does not match, so it was damaged on the way.$",
    ):
        CORE.Monitor(DIFFERENCE[:-1] + b"\0", ["a", "b"])
    with pytest.raises(TypeError, match=r"^The monitor was never initialised.$"):
        CORE.Monitor.__new__(CORE.Monitor).step(1.0)


def test_a_monitor_whose_memory_cannot_be_had_is_refused_in_a_sentence() -> None:
    huge = program(A, Instruction("slide_max", a=0, n=2**48), outputs=(1,), inputs=("a",))
    with pytest.raises(MemoryError, match=r"^There is not enough memory\.$"):
        CORE.Monitor(huge, ["a"])


def test_scans_are_unbounded_future() -> None:
    phi, psi = np.array([1.0, 5.0, -2.0]), np.array([-9.0, 3.0, 4.0])
    assert CORE.scan("run_max", phi).tolist() == [5.0, 5.0, -2.0]
    assert CORE.scan("run_min", phi).tolist() == [-2.0, -2.0, -2.0]
    assert CORE.scan("until", phi, psi).tolist() == [1.0, 4.0, 4.0]
    with pytest.raises(ValueError, match=r"^The scan 'until' takes two columns of the same length.$"):
        CORE.scan("until", phi)
    with pytest.raises(ValueError, match=r"^There is no scan 'next': it is run_max, run_min or until.$"):
        CORE.scan("next", phi)


def test_memory_is_that_of_a_new_monitor_and_irregular_times_add_to_it() -> None:
    m = CORE.Monitor(LATE, ["a", "b"])
    assert m.state_bytes == CORE.memory(LATE)
    m.update(0.0, {"a": 1.0, "b": 1.0})
    m.update(1.0, {"a": 1.0, "b": 1.0})
    assert m.state_bytes == CORE.memory(LATE)
    m.update(2.25, {"a": 1.0, "b": 1.0})
    assert m.state_bytes == CORE.memory(LATE) + 3 * 8
