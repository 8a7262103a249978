"""Arrays of results whose memory is used again after they are gone."""

from __future__ import annotations

import gc
import threading

import numpy as np

import rtamt

SIZES = [5_000, 9_000, 20_000, 20_001, 300_000, 900_000]


def test_results_that_are_kept_keep_their_values() -> None:
    spec = rtamt.parse("x >= 1")
    random = np.random.default_rng(1)
    held = []
    for size in random.choice(SIZES, 40):
        data = random.normal(size=size)
        signal = spec.evaluate({"x": data}).signal
        if random.random() < 0.4:
            held.append((data, signal.values[size // 3 :]))  # the array that owns the memory goes
    del signal
    gc.collect()
    for data, values in held:
        assert (values == data[len(data) // 3 :] - 1).all()


def test_many_small_results_of_one_program_are_apart() -> None:
    data = {"x": np.arange(2_000.0)}
    specs = [rtamt.parse(f"x >= {i}") for i in range(300)]
    results = rtamt.evaluate_all(specs, data)
    kept = [result.signal.values for result in results]
    kept[7][:] = 0
    for i, values in enumerate(kept):
        assert (values == (0 if i == 7 else data["x"] - i)).all(), i


def test_columns_that_a_recording_copies_are_its_own() -> None:
    spec = rtamt.parse("x + y >= 1")
    data = {name: np.ones(100_000) for name in "xy"}
    result = spec.evaluate(data)
    data["x"][:] = 5
    other = spec.evaluate(data)
    assert result["x"].values.max() == 1
    assert other["x"].values.min() == 5


def test_threads_get_memory_of_their_own() -> None:
    spec, wrong = rtamt.parse("x >= 1"), []

    def work(value: float) -> None:
        for size in SIZES * 3:
            values = spec.evaluate({"x": np.full(size, value)}).signal.values
            if not (values == value - 1).all():
                wrong.append(value)

    threads = [threading.Thread(target=work, args=(value,)) for value in (2.0, 3.0, 4.0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong
