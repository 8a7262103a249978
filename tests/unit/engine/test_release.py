"""Specifications, monitors and results are freed with their last reference, not by the garbage collector.

With cycles, a program that makes many of them needs more memory and time: parsing a requirement and making its
monitor took a sixth longer.
"""

from __future__ import annotations

import gc

import numpy as np
import pytest

import rtamt
from rtamt.engine.discrete.monitor import Monitor
from rtamt.language.formula import Formula
from rtamt.results import Result

RESPONSE = "always[0:5](req >= 3.5 -> eventually[0:3](gnt >= 4))"
SEVERAL = "asked = req >= 3; require R1: always[0:2](asked -> eventually[0:3](gnt >= 4)); require R2: once(req <= 9)"
TYPED = "enum Mode { A, B } input Mode m input bool p; always[0:2](p -> m == A)"
DATA = {"req": np.arange(10.0), "gnt": np.arange(10.0)}
DENSE = {name: (np.arange(10.0), values) for name, values in DATA.items()}


def evaluated(text: str) -> object:
    result = rtamt.parse(text).evaluate(DATA)
    return result, result.robustness, result.satisfied


MAKERS = {
    "a specification": lambda: rtamt.parse(RESPONSE),
    "several requirements": lambda: rtamt.parse(SEVERAL).requirements["R2"],
    "types": lambda: rtamt.parse(TYPED).monitor(),
    "a standalone program": lambda: rtamt.parse(SEVERAL).compile(),
    "a result": lambda: evaluated(SEVERAL),
    "a result in dense time": lambda: rtamt.parse(RESPONSE).evaluate(DENSE, time="dense").satisfied,
    "an explanation": lambda: rtamt.parse(RESPONSE).evaluate(DATA).explain(),
    "results of several formulas": lambda: rtamt.evaluate_all(
        list(map(rtamt.parse, (RESPONSE, SEVERAL))), DATA
    ),
    "a suite": lambda: rtamt.Suite([rtamt.parse(SEVERAL)]).evaluate(DATA),
    "a monitor with watched formulas": lambda: rtamt.parse(SEVERAL).monitor(watch=["R1", "gnt - req"]),
    "a monitor of the Python back end": lambda: rtamt.parse(RESPONSE, backend="python").monitor(),
} | {
    f"a monitor, {verdict}, {time} time": lambda verdict=verdict, time=time: rtamt.parse(RESPONSE).monitor(
        verdict=verdict, time=time
    )
    for verdict in ("delayed", "eager", "interval", "causation")
    for time in ("discrete", "dense")
}


@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)
def test_nothing_is_left_to_the_garbage_collector(make):
    for _ in range(3):  # what is made once for all is made now
        make()
    gc.collect()
    gc.disable()
    try:
        make()
        gc.set_debug(gc.DEBUG_SAVEALL)
        gc.collect()
        left = [
            each for each in gc.garbage if isinstance(each, Formula | Monitor | Result | rtamt.Specification)
        ]
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
        gc.enable()
    assert left == []
