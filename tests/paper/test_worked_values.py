"""Values worked out by hand in the definition of the operators, in every mode of discrete time."""

from __future__ import annotations

from math import inf
from typing import Any

import numpy as np
import pytest

import rtamt

WORKED: list[tuple[str, dict[str, list[float]], list[float]]] = [
    ("x until y", {"x": [-1, -1, -1], "y": [3, 3, 3]}, [3, 3, 3]),
    ("once[2:2](x > 0) or once[2:2](x > 0)", {"x": [1, 2, 3, 4, 5]}, [-inf, -inf, 1, 2, 3]),
    ("historically(eventually[0:2] x)", {"x": [0, 0, 5, 5, 5, 5, 5]}, [5, 5, 5, 5, 5, 5, 5]),
    ("always[0:2] x", {"x": [5, 4, 3, 9]}, [3, 3, 3, 9]),
    ("eventually[2:3] x", {"x": [5, 4, 3, 9]}, [9, 9, -inf, -inf]),
    ("always[2:3] x", {"x": [5, 4, 3, 9]}, [3, 9, inf, inf]),
    ("historically[1:2] x", {"x": [5, 4, 3, 9]}, [inf, 5, 4, 3]),
    ("x since y", {"x": [9, 2, 8], "y": [5, 1, 0]}, [5, 2, 2]),
    ("x since[1:1] y", {"x": [9, 2, 8], "y": [5, 1, 0]}, [-inf, 2, 1]),
    ("x until[1:1] y", {"x": [9, 2, 8], "y": [5, 1, 0]}, [1, 0, -inf]),
    ("x unless y", {"x": [9, 2, 8], "y": [5, 1, 0]}, [5, 2, 8]),
    ("x precedes[1:2] y", {"x": [9, 2, 8], "y": [5, 1, 0]}, [5, 5, 1]),
    ("prev x", {"x": [1, 2]}, [inf, 1]),
    ("next x", {"x": [1, 2]}, [2, inf]),
    ("s_prev x", {"x": [1, 2]}, [-inf, 1]),
    ("s_next x", {"x": [1, 2]}, [2, -inf]),
    ("rise(x)", {"x": [-1, 2, 3, -4]}, [-1, 1, -2, -4]),
    ("fall(x)", {"x": [-1, 2, 3, -4]}, [1, -2, -3, 3]),
    ("x <-> y", {"x": [1, -1], "y": [2, 3]}, [1, -1]),
    ("x xor y", {"x": [1, -1], "y": [2, 3]}, [-1, 1]),
    ("x == y", {"x": [1, 3], "y": [2, 3]}, [-1, 0]),
    ("x !== y", {"x": [1, 3], "y": [2, 3]}, [1, 0]),
    ("(x since[0:3] true) and (true since[2:3] y)", {"x": [1, 2, 3], "y": [7, 8, 9]}, [-inf, -inf, 7]),
    ("eventually[5:5] true", {"time": [0, 1]}, [-inf, -inf]),
    ("true until[2:3] y", {"y": [1, 2, 3, 4]}, [4, 4, -inf, -inf]),
    ("false since y", {"y": [1, 2, 1]}, [1, 2, 1]),
    ("once[1:inf] x", {"x": [3, 1, 5]}, [-inf, 3, 3]),
    ("eventually[1:inf] x", {"x": [3, 1, 5]}, [5, 5, -inf]),
    ("x until[1:inf] y", {"x": [3, 4, 5], "y": [9, 1, 8]}, [3, 4, -inf]),
]


def bounded(text: str) -> bool:
    return rtamt.parse(text).horizon < inf


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(("text", "data", "values"), WORKED)
def test_offline(text: str, data: dict[str, Any], values: list[float], backend: str) -> None:
    result = rtamt.parse(text, backend=backend).evaluate(data)
    np.testing.assert_array_equal(result.signal.values, values)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(("text", "data", "values"), [case for case in WORKED if bounded(case[0])])
def test_online(text: str, data: dict[str, Any], values: list[float], backend: str) -> None:
    monitor = rtamt.parse(text, backend=backend).monitor()
    given = [
        monitor.update(i, **{name: data[name][i] for name in monitor.input_names}) for i in range(len(values))
    ]
    known = [value for value in given if value is not None]
    np.testing.assert_array_equal([*known, *monitor.finish().values], values)


FIG4 = {
    "a_satisfied": (3, True),
    "b_vacuous": (1, True),
    "c_violated": (-2, False),
    "d_weak_request": (-1, False),
}


@pytest.mark.parametrize("name", FIG4)
def test_fig_4_as_shipped(name: str) -> None:
    spec = rtamt.load("examples/request_grant/spec.stl")
    result = spec.evaluate(rtamt.read(f"examples/request_grant/{name}.csv", columns=spec.input_names))
    assert (result.robustness, result.satisfied) == FIG4[name]


def test_zero_robustness_has_a_verdict() -> None:
    at_least = rtamt.parse("always(x >= 3)").evaluate({"x": [3, 4]})
    more = rtamt.parse("always(x > 3)").evaluate({"x": [3, 4]})
    assert (at_least.robustness, at_least.satisfied) == (0, True)
    assert (more.robustness, more.satisfied) == (0, False)
