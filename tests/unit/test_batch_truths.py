"""Boolean semantics of many traces in arrays: words of 64 traces, for every operator that has truth values."""

import numpy as np
import pytest

import rtamt
from rtamt.engine.discrete.evaluate import Evaluator

#: A share of a window is selected among numbers.
WHOLE = {"atleast", "wasatleast"}
#: They read no variable.
CONSTANT = {"true", "false"}


@pytest.fixture
def joined(monkeypatch):
    """Whether words were joined, for each evaluation of rows that gave results."""
    found = []
    rows = Evaluator.rows

    def watched(self, *given):
        evaluated = rows(self, *given)
        if evaluated:
            found.append(self._batch[1].joins_words)
        return evaluated

    monkeypatch.setattr(Evaluator, "rows", watched)
    return found


@pytest.mark.parametrize(
    "operator", [op for op in rtamt.STL if op.name not in CONSTANT], ids=lambda op: op.name
)
def test_every_operator_gives_the_bits_of_each_trace_alone(operator, joined):
    spec = rtamt.parse(operator.example)
    random = np.random.default_rng(1)
    data = {name: random.integers(1, 10, (70, 66)) / 2.0 for name in spec.input_names}
    batch = spec.evaluate_batch(data, semantics="boolean")
    assert joined == [operator.name not in WHOLE]
    assert np.isin(batch.signals, [np.inf, -np.inf]).all()
    for i in (0, 1, 62, 63, 64, 69):
        alone = spec.evaluate({name: column[i] for name, column in data.items()}, semantics="boolean")
        assert batch.signals[i].tobytes() == alone.signal.values.tobytes()


def test_verdicts_are_joined_in_words_under_every_semantics(joined):
    spec = rtamt.parse("always(x >= 3 -> eventually[0:5](y > 1))")
    x, y = np.random.default_rng(1).normal(2, 2, (2, 200, 40))
    batch = spec.evaluate_batch({"x": x, "y": y})
    assert batch.satisfied.tolist() == [spec.evaluate({"x": x[i], "y": y[i]}).satisfied for i in range(200)]
    assert joined == [False, True]


def test_lengths_differ(joined):
    spec = rtamt.parse("(x >= 3) until[0:9] (y > 2)")
    random = np.random.default_rng(1)
    x, y = random.normal(2, 2, (2, 300, 70))
    lengths = random.choice([1, 30, 64, 70], 300)
    batch = spec.evaluate_batch({"x": x, "y": y}, lengths=lengths, semantics="boolean")
    assert joined == [True] * 4
    for i, n in enumerate(lengths):
        alone = spec.evaluate({"x": x[i, :n], "y": y[i, :n]}, semantics="boolean")
        assert batch.signals[i, :n].tobytes() == alone.signal.values.tobytes()
        assert np.isnan(batch.signals[i, n:]).all()


def test_a_number_of_later_samples_is_compared_in_lanes(joined):
    spec = rtamt.parse("ahead[2](x) - x >= 1 or y > 3")
    x, y = np.random.default_rng(1).normal(2, 2, (2, 70, 20))
    batch = spec.evaluate_batch({"x": x, "y": y}, semantics="boolean")
    assert joined == [True]
    for i in range(70):
        alone = spec.evaluate({"x": x[i], "y": y[i]}, semantics="boolean")
        assert batch.signals[i].tobytes() == alone.signal.values.tobytes()
