"""Which mutants a requirement has: each kind of change, and no mutant that is trivially equal."""

from collections import Counter

import pytest

import rtamt
from rtamt.language.operators import STL
from rtamt.mutation import mutants_of


def changes(text, **settings):
    settings.setdefault("period", 1)
    return [mutant.change for mutant in mutants_of(rtamt.parse(text, **settings))]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (
            "x > 3",
            ["x > 3 → x <= 3", "x > 3 → x >= 3", "x > 3 → x < 3", "x > 3 → x > 3.3", "x > 3 → x > 2.7"],
        ),
        ("x > 1.2", ["x > 1.2 → x > 1.32", "x > 1.2 → x > 1.08"]),
        ("x == 0", ["x == 0 → x != 0", "x == 0 → x == 0.1", "x == 0 → x == -0.1"]),
        (
            "count(x > y) <= 3",
            ["count(x > y) <= 3 → count(x > y) <= 4", "count(x > y) <= 3 → count(x > y) <= 2"],
        ),
        ("const float low = 3; float x; x >= low", ["x >= 3 → x >= 3.3"]),
        ("parameter float low = 3; float x; x >= low", ["x >= 3 → x >= 3.3"]),
        (
            "always[2:5] (x > y)",
            ["always[2:5](x > y) → always[3:5](x > y)", "always[2:5](x > y) → always[2:4](x > y)"],
        ),
        ("once (x > y)", ["once(x > y) → historically(x > y)", "once(x > y) → x > y"]),
        ("atleast[0:5](80%, x > y)", ["atleast[0:5](80%, x > y) → atleast[0:5](90%, x > y)"]),
        ("x > y until[0:5] z > y", ["x > y until[0:5] z > y → x > y unless[0:5] z > y"]),
        ("rise(x > y)", ["rise(x > y) → fall(x > y)", "rise(x > y) → x > y"]),
        ("x > y -> z > y", ["x > y -> z > y → x > y and z > y", "x > y -> z > y → x > y xor z > y"]),
        ("x + y > z", ["x + y → x - y"]),
        ("minimum[0:5](x) > z", ["minimum[0:5](x) → maximum[0:5](x)", "minimum[0:5](x) → x"]),
        ("max(x, y) > z", ["max(x, y) → min(x, y)"]),
        ("abs(x) > z", ["abs(x) → x"]),
        ("not (x > y and z > y)", ["x > y and z > y → x > y or z > y"]),
        ("delay[2](x) > z", ["delay[2](x) → delay[3](x)", "delay[2](x) → delay[1](x)"]),
        ("bool b; b", ["b → not b"]),
        ("enum M { A, B, C } M m; m == A", ["m == A → m != A", "m == A → m == C", "m == A → m == B"]),
        (
            'group cars = "car_*"; always forall c in cars: c.x > 3',
            [
                "forall c in cars: c.x > 3 → exists c in cars: c.x > 3",
                "c.x > 3 → c.x > 3.3",
            ],
        ),
    ],
)
def test_changes(text, expected):
    found = changes(text)
    assert set(expected) <= set(found), found


def test_no_mutant_is_trivially_equal_to_its_requirement_or_to_another_one():
    # The dual of `always` under `not`, and the other direction of a comparison, give what other changes give.
    found = changes("not always(x > y)")
    assert found == [
        "not(always(x > y)) → always(x > y)",
        "always(x > y) → eventually(x > y)",
        "always(x > y) → x > y",
        "x > y → x <= y",
        "x > y → x >= y",
        "x > y → x < y",
    ]
    assert changes("always[0:0](x > y)")[0] == "always[0:0](x > y) → always[0:1](x > y)"


def test_in_dense_time_bounds_change_by_a_tenth():
    found = changes("always[0:500ms](x > y)", time="dense", period=None)
    assert "always[0:500ms](x > y) → always[0:550ms](x > y)" in found


def test_bounds_are_whole_periods():
    found = changes("always[0:500ms](x > y)", period="100ms")
    assert found[2:4] == [
        "always[0:500ms](x > y) → always[0:600ms](x > y)",
        "always[0:500ms](x > y) → always[0:400ms](x > y)",
    ]


def test_each_requirement_has_its_own_mutants_with_their_places():
    spec = rtamt.parse("require A: x > y;\nrequire B: always(z > y)")
    mutants = mutants_of(spec)
    assert [mutant.name for mutant in mutants] == [f"M{k}" for k in range(1, len(mutants) + 1)]
    assert {(mutant.requirement, mutant.line, mutant.column) for mutant in mutants} == {
        ("A", 1, 12),
        ("B", 2, 12),
        ("B", 2, 19),
    }


def test_bounds_need_a_period():
    with pytest.raises(rtamt.errors.UsageError) as failure:
        mutants_of(rtamt.parse("always[0:5](x > y)"))
    assert str(failure.value) == (
        "mutants have other bounds, in whole sampling periods, and the period is not known; give it, such as "
        "period='100ms'"
    )
    with pytest.raises(rtamt.errors.UsageError) as failure:
        mutants_of(rtamt.parse("x + y"))
    assert "is a number, which has no verdict; compare it, such as" in str(failure.value)


def test_the_example_of_every_operator_has_mutants():
    for op in STL:
        if op.operands and not op.presence:
            found = Counter(mutant.kind for mutant in mutants_of(rtamt.parse(op.example, period=1)))
            assert found["operator"] + found["threshold"] > 0, op.name
