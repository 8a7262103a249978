"""Threads change no bit of a long trace, and parts of it have the values of the whole."""

from __future__ import annotations

import multiprocessing
from fractions import Fraction

import numpy as np
import pytest

import rtamt
from rtamt.compiler.plan import compile_program
from rtamt.engine.cores import threads
from rtamt.engine.native import core
from rtamt.errors import EvaluationError
from rtamt.language.parsing.parser import parse_formula
from rtamt.rewrite.desugar import desugar

#: Long enough for three parts and for threads.
N = 2_000_000
FORMULAS = [
    "always[0:40](a >= 0 -> eventually[3:9](b > 0))",
    "historically[0:1000](once[5:5](a) >= b) and next(prev(a)) <= 1",
    "(a until[2:30] b) since[0:7] (b >= 0)",
]


def noise(n: int) -> dict[str, np.ndarray]:
    """Return columns of few values, zeros of both signs among them."""
    random = np.random.default_rng(1)
    return {name: random.choice([-1.0, -0.0, 0.0, 0.5, 1.0], n) for name in "ab"}


@pytest.fixture(scope="module")
def data() -> dict[str, np.ndarray]:
    return noise(N)


@pytest.mark.parametrize("text", FORMULAS)
def test_threads_change_no_bit(text: str, data: dict[str, np.ndarray]) -> None:
    program = compile_program((desugar(parse_formula(text)),), Fraction(1), clip=N)
    evaluator = core().Evaluator(program.code())
    columns = [data[name] for name in program.inputs]
    asked = []

    def given(count: int) -> bytes:
        return bytes(evaluator.run(columns, N, lambda: asked.append(count) or count)[0])

    alone = given(1)
    assert given(2) == alone
    assert given(5) == alone
    assert asked == [1, 2, 5]
    assert (np.frombuffer(alone) == core().evaluate(program.code(), columns, N)[0]).all()


def test_an_undefined_value_of_a_long_trace_is_at_its_sample(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setenv("RTAMT_THREADS", "2")
    x = np.ones(N)
    x[N - 5] = -1
    spec = rtamt.parse("always[0:40](sqrt(x) >= 0 and historically[0:5](x <= 9))")
    with pytest.raises(EvaluationError, match=f"at sample {N - 5}"):
        spec.evaluate({"x": x})


def test_the_environment_sets_the_threads(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("RTAMT_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    assert threads() >= 1
    monkeypatch.setenv("OMP_NUM_THREADS", "3")
    assert threads() == 3
    monkeypatch.setenv("RTAMT_THREADS", "2")
    assert threads() == 2
    monkeypatch.setenv("RTAMT_THREADS", "0")
    assert threads() == 1
    monkeypatch.setenv("RTAMT_THREADS", "many")
    assert threads() == 3


def test_a_worker_of_multiprocessing_has_one_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("RTAMT_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(threads) == 1
