"""The compiled monitor of dense time as Python sees it: shapes, refusals, and what a refusal leaves behind."""

from __future__ import annotations

import math
import struct
import zlib
from numbers import Real
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from rtamt.compiler.program import NO_OPERAND, OPCODES

_core = pytest.importorskip("rtamt.engine._core")


def program(
    *instructions: tuple[Any, ...], outputs: tuple[int, ...], inputs: int = 1, domain: int = 1
) -> bytes:
    """Return the bytes of instructions given as (opcode, a, b, n, x, lag)."""
    body = struct.pack(
        "<8sHBBIIIII", b"RTAMTPRG", 1, domain, 0, len(instructions), inputs, len(outputs), 0, 0
    )
    for opcode, a, b, n, x, lag in instructions:
        operands = [NO_OPERAND if i is None else i for i in (a, b)]
        body += struct.pack("<B3xIIIqdq", OPCODES.index(opcode), *operands, 0, n, x, lag)
    body += struct.pack(f"<{len(outputs)}I", *outputs)
    return body + struct.pack("<I", zlib.crc32(body))


A = ("input", None, None, 0, 0.0, 0)
#: always[0,3] a
ALWAYS = program(A, ("slide_min", 0, None, 3, 0.0, 3), outputs=(1,))
ROOT = program(A, ("sqrt", 0, None, 0, 0.0, 0), outputs=(1,))
#: max(a, b), and a
TWO = program(
    A,
    ("input", None, None, 1, 0.0, 0),
    ("max", 0, 1, 0, 0.0, 0),
    outputs=(2, 0),
    inputs=2,
)


def events(times: list[int], values: list[float]) -> tuple[Any, Any]:
    return np.array(times, dtype=np.int64), np.array(values, dtype=np.float64)


def lists(results: Any) -> list[tuple[list[int], list[float]]]:
    for times, values in results:
        assert times.dtype == np.int64
        assert values.dtype == np.float64
    return [(times.tolist(), values.tolist()) for times, values in results]


class Base:
    """The base of what an update answers."""

    __slots__ = ("_times",)

    def _many_points(self) -> str:
        return "many points"


#: What an update answers: its scale, and its events.
Answer = _core.update_signal_class(Base)
#: Of times in seconds, a tick each.
SCALE = SimpleNamespace(rate=1)


def monitor(code: bytes, names: list[str], ignored: set[str] | None = None) -> Any:
    """Return a monitor that is told the time in seconds of one tick."""
    m = _core.DenseMonitor(code, names, ignored)
    m.set_time_scale(Answer, SCALE, 1.0)
    return m


def decode(answer: Any) -> tuple[list[int], list[float]]:
    assert type(answer) is Answer
    assert answer._scale is SCALE
    half = len(answer._events) // 2
    return np.frombuffer(answer._events[:half], np.int64).tolist(), np.frombuffer(
        answer._events[half:], np.float64
    ).tolist()


def known(events: Any) -> tuple[list[int], list[float]]:
    return lists([events])[0]


def state(m: Any) -> tuple[int | None, int | None, list[int | None]]:
    """Return where the trace begins, how far it is known, and where each input stands."""
    return m.start, m.known_until, m.last_times


def test_one_instant_at_a_time_tells_what_became_known_and_how_far() -> None:
    m = monitor(ALWAYS, ["a"])
    assert state(m) == (None, None, [None])
    assert decode(m.update(0, {"a": 1})) == ([], [])
    assert m.counts == [1]
    assert decode(m.update(2, {"a": 2.0})) == ([], [])
    assert decode(m.update(5.0, {"a": np.float64(0.0)})) == ([0, 2], [1.0, 0.0])
    assert state(m) == (0, 2, [5])
    assert decode(m.update(np.float64(7), {"a": 3.0})) == ([4], [0.0])
    assert state(m) == (0, 4, [7])
    assert decode(m.update(7, {})) == ([], [])
    assert m.counts == [4]
    assert known(m.finish()) == ([7], [3.0])
    assert state(m) == (0, 7, [7])
    m.reset()
    assert state(m) == (None, None, [None])
    assert m.counts == [0]
    assert known(m.finish()) == ([], [])


def test_variables_on_clocks_of_their_own_in_chunks() -> None:
    m = monitor(TWO, ["a", "b"], {"c"})
    assert known(m.push([events([0, 4, 9], [1, 2, 3]), events([], [])])) == ([], [])
    assert decode(m.update(6, {"b": 2.5, "c": None})) == ([6], [2.5])
    assert known(m.last_output(0)) == ([6], [2.5])
    assert known(m.last_output(1)) == ([6], [2.0])
    assert known(m.push([events([], []), events([8, 20], [0, 9])])) == ([8, 9], [2.0, 3.0])
    assert known(m.last_output(1)) == ([9], [3.0])
    assert (m.start, m.known_until, m.known(1), m.last_times) == (6, 9, 9, [9, 20])
    assert m.counts == [3, 3]
    assert known(m.finish()) == ([20], [9.0])
    assert known(m.last_output(1)) == ([20], [3.0])


@pytest.mark.parametrize(
    ("rate", "time", "tick"),
    [
        (10.0, 0.25, 2),
        (10.0, 0.35, 4),
        (10.0, -0.25, -2),
        (1e9, 0.3, 300_000_000),
        (1e5, 2.0**36, 2**36 * 10**5),
    ],
)
def test_seconds_are_rounded_to_the_nearest_tick_and_halves_to_the_even_one(
    rate: float, time: float, tick: int
) -> None:
    m = _core.DenseMonitor(ALWAYS, ["a"])
    m.set_time_scale(Answer, SCALE, rate)
    m.update(time, {"a": 1.0})
    assert m.last_times == [tick] == [round(time * rate)]


def test_integers_that_are_ticks() -> None:
    m = _core.DenseMonitor(ALWAYS, ["a"])
    m.set_time_scale(Answer, SCALE, 1.0, True)
    m.update(np.int64(10**18 + 1), {"a": 1.0})
    assert m.last_times == [10**18 + 1]
    for time in (1e18, True, 2**62, np.int64(2**62), np.uint64(2**63), np.timedelta64(10**18 + 2), "1"):
        with pytest.raises(_core.Refused, match=r"^time$"):
            m.update(time, {"a": 1.0})


def test_before_it_is_told_how_and_after_a_reset_no_time_is_plain() -> None:
    m = _core.DenseMonitor(ALWAYS, ["a"])
    with pytest.raises(_core.Refused, match=r"^time$"):
        m.update(1.0, {"a": 1.0})
    m.set_time_scale(Answer, SCALE, 1.0)
    m.reset()
    with pytest.raises(_core.Refused, match=r"^time$"):
        m.update(1.0, {"a": 1.0})


@pytest.mark.parametrize(
    ("t", "values", "reason"),
    [
        (5, {"a": 1.0}, "time"),
        (4, {"a": 1.0}, "time"),
        (math.nan, {"a": 1.0}, "time"),
        (math.inf, {"a": 1.0}, "time"),
        ("6", {"a": 1.0}, "time"),
        (True, {"a": 1.0}, "time"),
        (np.int64(6), {"a": 1.0}, "time"),
        (2**62, {"a": 1.0}, "time"),
        (10**400, {"a": 1.0}, "time"),
        (6, {"b": 1.0}, "names"),
        (6, [("a", 1.0)], "names"),
        (6, {"a": "1"}, "value"),
        (6, {"a": math.nan}, "value"),
    ],
)
def test_what_is_wrong_is_refused_and_changes_nothing(t: Any, values: Any, reason: str) -> None:
    m = monitor(ALWAYS, ["a"])
    m.update(5, {"a": 1.0})
    m.update(8, {"a": 1.0})
    with pytest.raises(_core.Refused, match=f"^{reason}$"):
        m.update(t, values)
    assert (m.last_times, m.counts) == ([8], [2])
    assert known(m.last_output(0)) == ([5], [1.0])
    assert decode(m.update(9, {"a": 1.0})) == ([6], [1.0])


def test_chunks_that_go_back_or_too_far_are_refused() -> None:
    m = monitor(ALWAYS, ["a"])
    assert m.last_possible == 2**63 - 2 - 3
    m.push([events([5], [1])])
    for times in ([5, 6], [6, 2**63 - 4]):
        with pytest.raises(_core.Refused, match=r"^time$"):
            m.push([events(times, [1, 1])])
    m.finish()
    with pytest.raises(_core.Refused, match=r"^finished$"):
        m.push([events([7], [1])])
    with pytest.raises(_core.Refused, match=r"^finished$"):
        m.update(7, {"a": 1.0})


def test_an_update_that_makes_nan_names_instruction_and_tick_and_leaves_the_monitor_as_it_was() -> None:
    m = monitor(ROOT, ["a"])
    with pytest.raises(_core.Undefined) as caught:
        m.update(3, {"a": -1})
    assert caught.value.args == (1, 3)
    assert (m.start, m.last_times, m.counts) == (None, [None], [0])
    with pytest.raises(_core.Undefined) as caught:
        m.push([events([2, 6], [4, -1])])
    assert caught.value.args == (1, 6)
    assert decode(m.update(1, {"a": 9})) == ([1], [3.0])
    with pytest.raises(_core.Undefined):
        m.update(2, {"a": -1})
    assert known(m.last_output(0)) == ([1], [3.0])
    with pytest.raises(_core.Undefined) as caught:
        _core.dense_evaluate(ROOT, [events([2, 6], [4, -1])])
    assert caught.value.args == (1, 6)


def test_another_monitor_goes_on_from_a_state() -> None:
    m, other = monitor(TWO, ["a", "b"]), monitor(TWO, ["a", "b"])
    m.push([events([0, 4, 9], [1, 2, 3]), events([2, 5], [0, 7])])
    other.update(50, {"a": 1.0})
    other.restore(m.state())
    for each in (m, other):
        assert (state(each), each.counts) == ((2, 5, [9, 5]), [3, 2])
        assert known(each.last_output(1)) == ([2, 4, 5], [1.0, 2.0, 2.0])
        assert decode(each.update(6, {"b": 1.0})) == ([6], [2.0])
        assert known(each.finish()) == ([9], [3.0])
    with pytest.raises(ValueError, match=r"^This is not the state of a monitor of this program\.$"):
        monitor(ALWAYS, ["a"]).restore(m.state())


def test_a_number_that_comes_back_into_its_own_update_is_taken_after_what_it_did() -> None:
    m, plain = monitor(ALWAYS, ["a"]), monitor(ALWAYS, ["a"])

    class Meddler:
        def __float__(self) -> float:
            m.update(1, {"a": 1.0})
            return 2.0

    Real.register(Meddler)
    plain.update(1, {"a": 1.0})
    assert decode(m.update(3, {"a": Meddler()})) == decode(plain.update(3, {"a": 2.0}))
    assert m.state() == plain.state()


def test_whole_signals_at_once_and_beyond_their_end() -> None:
    a = events([0, 5], [1, 2])
    always_past = program(A, ("slide_min", 0, None, 3, 0.0, 0), outputs=(1,))
    assert lists(_core.dense_evaluate(always_past, [a])) == [([0], [1.0])]
    assert lists(_core.dense_evaluate(always_past, [a], 3)) == [([0, 8], [1.0, 2.0])]
    assert lists([_core.dense_scan("run_max", a)]) == [([0], [2.0])]
    assert lists([_core.dense_scan("run_min", a)]) == [([0, 5], [1.0, 2.0])]
    assert lists([_core.dense_scan("until", a, events([1, 7], [0, 1]))]) == [([1], [1.0])]


@pytest.mark.parametrize(
    ("rate", "points"), [(2, [(0.0, 1.0)]), (None, "many points"), (2**53 + 1, "many points")]
)
def test_times_that_are_no_quotients_of_doubles_are_left_to_the_base(rate: int | None, points: Any) -> None:
    m = _core.DenseMonitor(ALWAYS, ["a"])
    m.set_time_scale(Answer, SimpleNamespace(rate=rate), 1.0)
    m.update(0, {"a": 1.0})
    assert m.update(3, {"a": 2.0}).points() == points


def test_wrong_calls_say_what_is_wrong() -> None:
    m = monitor(ALWAYS, ["a"])
    with pytest.raises(TypeError, match=r"^DenseMonitor.update takes 2 arguments, got 1.$"):
        m.update(1)
    with pytest.raises(TypeError, match=r"^The monitor was never initialised.$"):
        _core.DenseMonitor.__new__(_core.DenseMonitor).update(1, {})
    with pytest.raises(ValueError, match=r"^Got 0 signals for a program with 1 inputs.$"):
        m.push([])
    with pytest.raises(ValueError, match=r"^A signal has 1 times and 2 values.$"):
        m.push([(np.array([1]), np.array([1.0, 2.0]))])
    with pytest.raises(ValueError, match=r"^Got 2 names for a program with 1 inputs.$"):
        _core.DenseMonitor(ALWAYS, ["a", "b"])
    with pytest.raises(ValueError, match=r"^Two inputs are called 'a'.$"):
        _core.DenseMonitor(TWO, ["a", "a"])
    with pytest.raises(ValueError, match=r"^The class of the results is none of update_signal_class\(\).$"):
        m.set_time_scale(Base, SCALE, 1.0)
    with pytest.raises(IndexError, match=r"^There is no output 1.$"):
        m.known(1)
    with pytest.raises(IndexError, match=r"^There is no output 1.$"):
        m.last_output(1)
    with pytest.raises(ValueError, match=r"^There is no scan 'x': it is run_max, run_min or until.$"):
        _core.dense_scan("x", events([1], [1]))
    with pytest.raises(ValueError, match=r"^The scan 'until' takes two signals.$"):
        _core.dense_scan("until", events([1], [1]))
    with pytest.raises(ValueError, match=r"^The extra ticks cannot be fewer than 0.$"):
        _core.dense_evaluate(ALWAYS, [events([1], [1])], -1)
    refusal = "This is not a program that can be run: it is for "
    with pytest.raises(ValueError, match=f"^{refusal}dense time, and discrete time is wanted here.$"):
        _core.Monitor(ALWAYS, ["a"])
    with pytest.raises(ValueError, match=f"^{refusal}discrete time, and dense time is wanted here.$"):
        _core.DenseMonitor(program(A, outputs=(0,), domain=0), ["a"])
