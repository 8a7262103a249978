"""``rtamt mutate``: the mutants of a requirement, on recordings."""

import json

import pytest

SPEC = "input float x\nrequire HIGH: always(x >= 3)\n"
OUT = """\
4 of 7 mutants killed by 2 recordings: score 57%

mutant  line  change             killed by
M4      2:22  x >= 3 → x > 3     survives
M6      2:22  x >= 3 → x >= 3.3  survives
M7      2:22  x >= 3 → x >= 2.7  survives

recording  kills  alone
a.csv          2      2
b.csv          2      2
"""


def test_survivors_are_listed(run, write):
    write("high.stl", SPEC)
    write("a.csv", "x\n5\n2\n")
    write("b.csv", "x\n9\n8\n")
    assert run("mutate", "high.stl", "a.csv", "b.csv") == (1, OUT, "")
    every = run("mutate", "high.stl", "a.csv", "b.csv", "--all")
    assert "M1      2:15  always(x >= 3) → eventually(x >= 3)  a.csv" in every.out
    assert "M3      2:22  x >= 3 → x < 3                       b.csv" in every.out


def test_json_and_plot(run, write):
    write("high.stl", "input float x; require A: x > x - 1")
    write("a.csv", "x\n5\n2\n")
    answer = run("mutate", "high.stl", "a.csv", "--json", "-o", "matrix.png")
    found = json.loads(answer.out)
    assert answer.err == ""
    assert found["recordings"][0]["name"] == "a.csv"
    assert found["mutants"][0]["change"] == "x > x - 1 → x <= x - 1"
    assert found["mutants"][0]["killed_by"] == ["a.csv"]
    with open("matrix.png", "rb") as file:
        assert file.read(4) == b"\x89PNG"


def test_groups_on_the_command_line(run, write):
    write("cars.stl", 'group cars = "car_*"\nalways forall c in cars: c.x > 3\n')
    write("a.csv", "time,car_1.x,car_2.x\n0,4,9\n1,4,2\n")
    answer = run("mutate", "cars.stl", "a.csv", "--all")
    assert answer.err == ""
    assert "forall c in cars: c.x > 3 → exists c in cars: c.x > 3" in answer.out


@pytest.mark.parametrize(
    ("text", "trace"),
    [
        (
            'enum M { A, B } M m; group cars = "car_*"; require R: always(m == A); '
            "require S: always(forall c in cars: c.x > 3)",
            "time,car_1.x,m\n0,4,A\n1,4,A\n",
        ),
        (
            'enum M { A, B } group cars = "car_*" { M mode  float x }\nalways(forall c in cars: c.mode == A)',
            "time,car_1.mode,car_1.x\n0,A,1\n1,A,1\n",
        ),
    ],
)
def test_members_of_enumerations_beside_members_of_groups_are_read_by_their_names(run, write, text, trace):
    write("cars.stl", text)
    write("a.csv", trace)
    answer = run("mutate", "cars.stl", "a.csv", "--all")
    assert answer.err == ""
    assert "== A → " in answer.out


def test_what_is_wrong_is_said(run, write):
    write("a.stl", "x > 3")
    write("b.stl", "x > 4")
    write("a.csv", "x\n5\n2\n")
    assert run("mutate", "a.stl", "b.stl", "a.csv") == (
        2,
        "",
        "rtamt: 'rtamt mutate' takes one specification; leave out 'b.stl'\n",
    )
    assert (
        run("mutate", "a.stl", "a.csv", "a.csv").err == "rtamt: 'a.csv' is given twice; leave it out once\n"
    )
    assert run("mutate", "a.stl").err.startswith("rtamt: there is no trace to mutate: name a file")
