"""``rtamt describe``: requirements as sentences."""

import json

SPEC = 'input float gap [m]; near = gap < 2; require R1 "keeps away": always not near; require R2: gap > -1\n'


def test_sentences(run, write):
    write("gap.stl", SPEC)
    assert run("describe", "gap.stl") == (
        0,
        "R1 (keeps away): At every instant from now on, it is not the case that near.\n"
        "  near: gap is less than 2 m.\n"
        "R2: gap is more than -1 m.\n",
        "",
    )
    assert run("describe", "x > 1").out == "x is more than 1.\n"


def test_json(run, write):
    write("gap.stl", SPEC)
    first = json.loads(run("describe", "gap.stl", "--json").out.splitlines()[0])
    assert first == {
        "requirement": "R1",
        "text": "keeps away",
        "sentence": "At every instant from now on, it is not the case that near.",
        "names": {"near": "gap is less than 2 m."},
        "formula": "always(not(gap < 2))",
    }
