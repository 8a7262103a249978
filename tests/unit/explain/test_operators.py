"""Worked by hand: of every operator the critical point and the implicant, satisfied and violated."""

import pytest

import rtamt
from rtamt.language.formula import Apply, postorder
from rtamt.language.operators import STL
from rtamt.language.records import Sort

inf = float("inf")
X = [5, 4, 3, 2, -1, 6, 7]
Y = [-1, -2, -3, 4, -2, 5, -6]

# text, instant; critical predicate, instant, value, how far the robustness follows; implicant:
# predicate, whether it held, first and last instant.
DISCRETE = [
    ("x and y", 0, ("y", 0, -1, -inf, 5), [("y", False, 0, 0)]),
    ("x and y", 3, ("x", 3, 2, -inf, 4), [("x", True, 3, 3), ("y", True, 3, 3)]),
    ("x or y", 0, ("x", 0, 5, -1, inf), [("x", True, 0, 0)]),
    ("x or y", 4, ("x", 4, -1, -2, inf), [("x", False, 4, 4), ("y", False, 4, 4)]),
    ("x -> y", 0, ("y", 0, -1, -5, inf), [("x", True, 0, 0), ("y", False, 0, 0)]),
    ("x -> y", 4, ("x", 4, -1, -2, inf), [("x", False, 4, 4)]),
    ("x <-> y", 0, ("y", 0, -1, -5, 5), [("x", True, 0, 0), ("y", False, 0, 0)]),
    ("x <-> y", 4, ("x", 4, -1, -2, 2), [("x", False, 4, 4), ("y", False, 4, 4)]),
    ("x xor y", 0, ("y", 0, -1, -5, 5), [("x", True, 0, 0), ("y", False, 0, 0)]),
    ("x xor y", 4, ("x", 4, -1, -2, 2), [("x", False, 4, 4), ("y", False, 4, 4)]),
    ("not x", 0, ("x", 0, 5, -inf, inf), [("x", True, 0, 0)]),
    ("not x", 4, ("x", 4, -1, -inf, inf), [("x", False, 4, 4)]),
    ("always x", 0, ("x", 4, -1, -inf, 2), [("x", False, 4, 4)]),
    ("always[1:3] x", 0, ("x", 3, 2, -inf, 3), [("x", True, 1, 3)]),
    ("eventually[0:2] y", 0, ("y", 0, -1, -2, inf), [("y", False, 0, 2)]),
    ("eventually y", 0, ("y", 5, 5, 4, inf), [("y", True, 5, 5)]),
    ("once[1:2] y", 4, ("y", 3, 4, -3, inf), [("y", True, 3, 3)]),
    ("once[0:2] y", 2, ("y", 0, -1, -2, inf), [("y", False, 0, 2)]),
    ("historically x", 6, ("x", 4, -1, -inf, 2), [("x", False, 4, 4)]),
    ("historically[1:2] x", 3, ("x", 2, 3, -inf, 4), [("x", True, 1, 2)]),
    # t' = 3: min(y(3), x on [0, 3)) = min(4, 3).
    ("x until y", 0, ("x", 2, 3, -1, 4), [("x", True, 0, 2), ("y", True, 3, 3)]),
    ("x until y", 4, ("x", 4, -1, -2, 5), [("x", False, 4, 4), ("y", False, 4, 4)]),
    ("x until[0:2] y", 0, ("y", 0, -1, -2, inf), [("y", False, 0, 2)]),
    # t' = 4 fails by y, t' = 5 and 6 by x(4) before them.
    ("x until[4:6] y", 0, ("x", 4, -1, -2, 2), [("x", False, 4, 4), ("y", False, 4, 4)]),
    # t' = 3, and x on (3, 4].
    ("x since y", 4, ("x", 4, -1, -2, 4), [("x", False, 4, 4), ("y", False, 4, 4)]),
    ("x since y", 3, ("y", 3, 4, -1, inf), [("y", True, 3, 3)]),
    ("x since[1:2] y", 4, ("x", 4, -1, -inf, 4), [("x", False, 4, 4)]),
    ("x since[1:3] y", 6, ("y", 5, 5, -1, 7), [("x", True, 6, 6), ("y", True, 5, 5)]),
    ("x unless[0:2] y", 0, ("x", 2, 3, -1, 4), [("x", True, 0, 2)]),
    ("x unless y", 0, ("x", 2, 3, -1, 4), [("x", True, 0, 2), ("y", True, 3, 3)]),
    ("x unless[0:2] y", 4, ("x", 4, -1, -2, 6), [("x", False, 4, 4), ("y", False, 4, 4)]),
    # From 2 on: t' = 3, and x on [2, 3).
    ("x precedes[0:2] y", 4, ("x", 2, 3, -3, 4), [("x", True, 2, 2), ("y", True, 3, 3)]),
    ("x precedes[1:2] y", 2, ("y", 1, -2, -3, 5), [("y", False, 1, 2)]),
    ("prev x", 4, ("x", 3, 2, -inf, inf), [("x", True, 3, 3)]),
    ("s_prev x", 5, ("x", 4, -1, -inf, inf), [("x", False, 4, 4)]),
    ("next x", 4, ("x", 5, 6, -inf, inf), [("x", True, 5, 5)]),
    ("s_next x", 3, ("x", 4, -1, -inf, inf), [("x", False, 4, 4)]),
    ("rise(x)", 5, ("x", 4, -1, -inf, 6), [("x", False, 4, 4), ("x", True, 5, 5)]),
    ("rise(x)", 1, ("x", 0, 5, -inf, 4), [("x", True, 0, 0)]),
    ("fall(x)", 4, ("x", 4, -1, -inf, 2), [("x", True, 3, 3), ("x", False, 4, 4)]),
    ("fall(x)", 5, ("x", 5, 6, -inf, -1), [("x", True, 5, 5)]),
    # 3 of 5: the three largest; for less than 3 of 5, the three smallest.
    ("atleast[0:4](60%, x)", 0, ("x", 2, 3, 2, 4), [("x", True, 0, 2)]),
    ("atleast[0:4](60%, y)", 0, ("y", 1, -2, -2, -1), [("y", False, 1, 2), ("y", False, 4, 4)]),
    # After the end: no sample of those that are needed, one of those that a percentage counts.
    ("atleast[0:2](2, x)", 5, ("x", 5, 6, -inf, 7), [("x", True, 5, 6)]),
    ("atleast[0:2](100%, y)", 5, ("y", 6, -6, -inf, 5), [("y", False, 6, 6)]),
    ("wasatleast[0:4](2s, x)", 4, ("x", 1, 4, 3, 5), [("x", True, 0, 1)]),
    ("wasatleast[1:3](50%, y)", 5, ("y", 4, -2, -3, 4), [("y", False, 2, 2), ("y", False, 4, 4)]),
    # Comparisons, and arithmetic in them, are predicates as they stand.
    ("x >= 3", 3, ("x >= 3", 3, -1, -inf, inf), [("x >= 3", False, 3, 3)]),
    ("x + y > 3", 3, ("x + y > 3", 3, 3, -inf, inf), [("x + y > 3", True, 3, 3)]),
    ("min(x, y)", 3, ("min(x, y)", 3, 2, -inf, inf), [("min(x, y)", True, 3, 3)]),
    ("valid(x)", 0, ("valid(x)", 0, inf, -inf, inf), [("valid(x)", True, 0, 0)]),
    ("x >= 3 and true", 0, ("x >= 3", 0, 2, -inf, inf), [("x >= 3", True, 0, 0)]),
    ("x >= 3 or false", 0, ("x >= 3", 0, 2, -inf, inf), [("x >= 3", True, 0, 0)]),
]

# In dense time the segments are [start, end), a window's end is closed.
DENSE = [
    ("always[1:3] x", 0, ("x", 3, 2, -inf, 3), [("x", True, 1, 3, True)]),
    ("always x", 0, ("x", 4, -1, -inf, 2), [("x", False, 4, 5, False)]),
    ("always(x >= -2)", 5, ("x >= -2", 5, 8, -inf, 9), [("x >= -2", True, 5, None, False)]),
    ("eventually[0:2] y", 0, ("y", 0, -1, -2, inf), [("y", False, 0, 2, True)]),
    ("eventually y", 0, ("y", 5, 5, 4, inf), [("y", True, 5, 6, False)]),
    ("once[1:2] y", 4, ("y", 3, 4, -3, inf), [("y", True, 3, 3, True)]),
    ("historically[1:2] x", 3, ("x", 2, 3, -inf, 4), [("x", True, 1, 2, True)]),
    ("x until y", 0, ("x", 2, 3, -1, 4), [("x", True, 0, 3, False), ("y", True, 3, 4, False)]),
    # x just before t' = 3.5 too: the segment in which t' lies counts.
    ("x until[3:4] y", 0, ("x", 3, 2, -inf, 3), [("x", True, 0, 3, True), ("y", True, 3, 4, False)]),
    ("x until y", 4, ("x", 4, -1, -2, 5), [("x", False, 4, 5, False), ("y", False, 4, 4, True)]),
    # The rest of the segment in which y held needs x as well.
    ("x since[1:3] y", 6, ("y", 5, 5, -1, 6), [("x", True, 5, 6, True), ("y", True, 5, 5, True)]),
    ("x since y", 4, ("x", 4, -1, -2, 2), [("x", False, 4, 4, True), ("y", False, 4, 4, True)]),
    ("x precedes[0:2] y", 4, ("x", 2, 3, -3, 4), [("x", True, 2, 3, False), ("y", True, 3, 4, False)]),
    ("x precedes[1:2] y", 4, ("x", 3, 2, -inf, 3), [("x", True, 2, 3, True), ("y", True, 3, 4, False)]),
    ("x unless[0:2] y", 0, ("x", 2, 3, -1, 4), [("x", True, 0, 2, True)]),
    # Just after 0 s, 3 is reached for a little less than 3 s.
    ("atleast[0:4](3s, x)", 0, ("x", 3, 2, -1, 3), [("x", True, 0, 4, False)]),
    ("atleast[0:4](50%, y)", 0, ("y", 1, -2, -2, 4), [("y", False, 0, 3, False)]),
    # What leaves the window at its beginning comes in at its end.
    ("wasatleast[0:2](1s, x)", 5, ("x", 3, 2, -1, 6), [("x", True, 3, 4, False), ("x", True, 5, 5, True)]),
    # After the last sample the last value holds.
    ("eventually[8:9] x", 2, ("x", 10, 7, -inf, inf), [("x", True, 10, 11, True)]),
]


def result(text, **options):
    spec = rtamt.parse(text)
    data = {"time": range(7), "x": X, "y": Y}
    return spec.evaluate({name: data[name] for name in ("time", *spec.input_names)}, **options)


@pytest.mark.parametrize("backend", ["cpp", "python"])
@pytest.mark.parametrize(("text", "at", "critical", "implicant"), DISCRETE)
def test_discrete(text, at, critical, implicant, backend):
    spec = rtamt.parse(text, backend=backend)
    explanation = spec.evaluate({name: {"x": X, "y": Y}[name] for name in spec.input_names}).explain(at)
    point = explanation.critical
    assert (point.predicate, point.time, point.value, point.lowest, point.highest) == critical
    assert [(s.predicate, s.holds, s.start, s.end) for s in explanation.implicant] == implicant
    assert all(s.closed for s in explanation.implicant)


@pytest.mark.parametrize(("text", "at", "critical", "implicant"), DENSE)
def test_dense(text, at, critical, implicant):
    explanation = result(text, time="dense").explain(at)
    point = explanation.critical
    assert (point.predicate, point.time, point.value, point.lowest, point.highest) == critical
    assert [(s.predicate, s.holds, s.start, s.end, s.closed) for s in explanation.implicant] == implicant


def test_every_operator_is_here():
    shown = {
        node.op.name
        for text, *_ in (*DISCRETE, ("true",), ("false",))
        for node in postorder(rtamt.parse(text).formula)
        if isinstance(node, Apply)
    }
    assert {op.name for op in STL if op.result is Sort.FORMULA and op.truth is None} <= shown


@pytest.mark.parametrize(
    ("text", "at", "decided_by", "robustness"),
    [
        ("prev x", 0, "start", inf),
        ("s_prev x", 0, "start", -inf),
        ("next x", 6, "end", inf),
        ("s_next x", 6, "end", -inf),
        ("once[2:3] x", 1, "start", -inf),
        ("historically[2:3] x", 1, "start", inf),
        ("eventually[2:3] x", 5, "end", -inf),
        ("always[2:3] x", 5, "end", inf),
        ("atleast[2:3](50%, x)", 6, "end", inf),
        ("wasatleast[2:3](1, x)", 1, "start", -inf),
        ("x since[2:3] y", 1, "start", -inf),
        ("x until[2:3] y", 5, "end", -inf),
        ("x or true", 0, "constant", inf),
        ("x > 3 and false", 0, "constant", -inf),
    ],
)
def test_what_no_predicate_decides(text, at, decided_by, robustness):
    explanation = result(text).explain(at)
    assert explanation.robustness == robustness
    assert explanation.implicant == ()
    point = explanation.critical
    assert (point.predicate, point.formula, point.decided_by) == (None, None, decided_by)
    assert point.lowest == point.highest == robustness


def test_a_predicate_without_variables_is_a_constant():
    explanation = result("x >= 3 or 3 >= 1").explain(3)
    point = explanation.critical
    assert (point.predicate, point.value, point.decided_by) == ("3 >= 1", 2, "constant")
    assert explanation.implicant == ()
