"""An operator of the table that has lost its kernel is still itself: its definition alone, called by the core."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import rtamt
from rtamt.language.formula import Apply, Formula, fold
from rtamt.language.operators import STL, Operator, Tense

PERIOD = Fraction(1, 2)
#: Longer than any window of the examples, so that what lies behind the window is forgotten.
SAMPLES = np.random.default_rng(16).integers(-3, 9, (2, 50)) / 2

TEMPORAL = [op for op in STL if op.tense is not Tense.NONE and op.definition is not None]


def own(op: Operator) -> Operator:
    """Return the operator with another name and without what makes it fast."""
    return replace(
        op, name=f"own_{op.name}", spellings=(f"own_{op.name}",), kernel=None, expansion=None, dual=None
    )


def specification(op: Operator, time: str, *, alone: bool) -> rtamt.Specification:
    settings: dict[str, Any] = (
        {"period": PERIOD} if time == "discrete" else {"time": "dense", "resolution": PERIOD}
    )
    spec = rtamt.parse(op.example, **settings)
    made = own(op)

    def exchanged(node: Formula, args: tuple[Formula, ...]) -> Formula:
        if not isinstance(node, Apply):
            return node
        return replace(node, op=made if alone and node.op is op else node.op, args=args)

    return spec.with_formula(fold(spec.formula, exchanged))


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.parametrize("op", TEMPORAL, ids=lambda op: op.name)
def test_an_operator_without_a_kernel_gives_the_same(op: Operator, time: str) -> None:
    if time == "dense" and (op.discrete_only or op.dense is None):
        with pytest.raises(rtamt.SpecificationError):
            specification(op, time, alone=False).evaluate({"x": [[0, 1.0]], "y": [[0, 1.0]]})
        return
    known, alone = (specification(op, time, alone=alone) for alone in (False, True))
    timestamps = np.arange(SAMPLES.shape[1]) * float(PERIOD)
    columns = dict(zip("xy", SAMPLES, strict=True))
    data = columns if time == "discrete" else {name: (timestamps, column) for name, column in columns.items()}
    used = {name: data[name] for name in known.input_names}
    expected, found = known.evaluate(used).signal, alone.evaluate(used).signal
    np.testing.assert_array_equal(found.values, expected.values)
    np.testing.assert_array_equal(found.times, expected.times)
    if time == "dense":
        return
    monitor = alone.monitor()
    outputs = [
        monitor.update(float(stamp), **{name: float(columns[name][i]) for name in used})
        for i, stamp in enumerate(timestamps)
    ]
    values = [value for value in outputs if value is not None]
    np.testing.assert_array_equal(values, expected.values[: len(values)])
    assert len(values) > SAMPLES.shape[1] // 2
