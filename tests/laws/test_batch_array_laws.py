"""Many traces in arrays give what each of them gives alone: to the bit, or the first error."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import rtamt
from rtamt.errors import StlError
from tests.support.strategies import formulas

if TYPE_CHECKING:
    from collections.abc import Callable

NUMBERS = st.integers(-4, 4).map(lambda n: n / 2) | st.sampled_from([np.inf, -np.inf, -0.0])


@st.composite
def batches(draw: st.DrawFn) -> tuple[dict[str, Any], list[int] | None]:
    """Draw traces of different lengths in arrays of any type and memory order; the rest of a row is NaN."""
    count, width = draw(st.integers(0, 19)), draw(st.integers(1, 9))
    lengths = draw(st.none() | st.lists(st.integers(1, width), min_size=count, max_size=count))
    data: dict[str, Any] = {}
    for name in ("x", "y"):
        values = draw(st.lists(NUMBERS, min_size=count * width, max_size=count * width))
        array = np.array(values, float).reshape(count, width)
        if draw(st.integers(0, 3)) == 0:
            with np.errstate(invalid="ignore"):
                array = array.astype(draw(st.sampled_from(["f4", "i8", "i1", "?"])))
        elif lengths is not None:
            for row, length in zip(array, lengths, strict=True):
                row[length:] = np.nan
        order = draw(st.sampled_from(["C", "F", "strided"]))
        data[name] = (
            np.repeat(array, 2, axis=1)[:, ::2] if order == "strided" else np.array(array, order=order)
        )
    times = draw(st.sampled_from(["none", "common", "each"]))
    if times != "none":
        periods = draw(st.lists(st.sampled_from([1.0, 1.04, 0.5]), min_size=count, max_size=count))
        common = np.arange(width) * draw(st.sampled_from([1.0, 0.5]))
        own = np.arange(width) * np.array(periods).reshape(count, 1)
        data["time"] = common if times == "common" else own
    return data, lengths


def outcome(call: Callable[[], Any]) -> Any:
    """Return what a call returns, or its error message."""
    try:
        return call()
    except StlError as error:
        return str(error)


def alone(spec: Any, data: dict[str, Any], lengths: list[int] | None, i: int) -> Any:
    n = data["x"].shape[1] if lengths is None else lengths[i]
    time = data.get("time")
    row = {name: data[name][i, :n] for name in ("x", "y")}
    return spec.evaluate(
        row if time is None else {**row, "time": time[:n] if time.ndim == 1 else time[i, :n]}
    )


@settings(max_examples=120)
@given(formulas(max_depth=3, unbounded_future=True), batches(), st.sampled_from(["cpp", "cpp", "python"]))
def test_a_batch_gives_what_each_trace_gives_alone(
    formula: Any, batch: tuple[dict[str, Any], list[int] | None], backend: str
) -> None:
    data, lengths = batch
    before = {name: array.copy() for name, array in data.items()}
    spec = rtamt.parse(f"{formula} or x > inf or y > inf", backend=backend)
    count, width = data["x"].shape
    expected = [outcome(lambda i=i: alone(spec, data, lengths, i)) for i in range(count)]
    wrong = [f"trace {i}: {want}" for i, want in enumerate(expected) if isinstance(want, str)]
    found = outcome(lambda: spec.evaluate_batch(data, lengths=lengths))
    assert all(np.array_equal(data[name], before[name], equal_nan=True) for name in data)
    if wrong:
        assert found == wrong[0]
        return
    assert len(found) == count
    assert found.signals.shape == (count, width)
    for i, want in enumerate(expected):
        n = len(want.signal)
        assert found.signals[i, :n].tobytes() == want.signal.values.tobytes()
        assert np.isnan(found.signals[i, n:]).all()
        assert found.robustness[i] == want.robustness
        assert found[i].signal.times.tobytes() == want.signal.times.tobytes()
        assert found[i].trace.period == want.trace.period
    satisfied = [outcome(lambda want=want: want.satisfied) for want in expected]
    unknown = [want for want in satisfied if isinstance(want, str)]
    assert outcome(lambda: list(found.satisfied)) == (unknown[0] if unknown else satisfied)


@settings(max_examples=60)
@given(
    formulas(max_depth=4, unbounded_future=True),
    st.sampled_from([1, 3, 7, 8, 9, 63, 64, 65, 100]),
    st.sampled_from([1, 2, 9, 63, 64, 65]),
    st.integers(0, 2**32 - 1),
)
def test_truth_values_of_many_traces_are_those_of_each_alone(
    formula: Any, count: int, width: int, seed: int
) -> None:
    random = np.random.default_rng(seed)
    numbers = [-1.0, -0.5, -0.0, 0.0, 0.5, 1.0, 2.0] + [-np.inf, np.inf] * (seed % 3 == 0)
    data = {name: random.choice(numbers, (count, width)) for name in ("x", "y")}
    lengths = random.integers(1, width + 1, count).tolist() if seed % 2 else None
    spec = rtamt.parse(f"{formula} or x > inf or y > inf", semantics="boolean")
    expected = [outcome(lambda i=i: alone(spec, data, lengths, i)) for i in range(count)]
    wrong = [f"trace {i}: {want}" for i, want in enumerate(expected) if isinstance(want, str)]
    found = outcome(lambda: spec.evaluate_batch(data, lengths=lengths))
    if wrong:
        assert found == wrong[0]
        return
    for i, want in enumerate(expected):
        n = len(want.signal)
        assert found.signals[i, :n].tobytes() == want.signal.values.tobytes()
        assert np.isnan(found.signals[i, n:]).all()
    assert found.satisfied.tolist() == [want.satisfied for want in expected]
