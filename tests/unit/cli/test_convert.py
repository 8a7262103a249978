"""``rtamt convert``: requirements of FRET in both directions."""

import json

import rtamt


def test_a_file_of_fret_becomes_a_specification(run, write):
    write("pump.txt", "R1: When c the pump shall within 2 secs satisfy level > 3\nR2: no sentence\n")
    answer = run("convert", "pump.txt", "--from", "fret", "-o", "pump.stl")
    assert answer.code == 1
    assert answer.out.startswith(
        "pump.stl: 1 of 2 requirements\nnote: FRET counts one unit of time as one sample"
    )
    assert "rtamt: pump.txt: R2 is left out: " in answer.err
    spec = rtamt.load("pump.stl")
    assert str(spec.formula) == "always(rise(c) -> eventually[0:2](level > 3) or always[2:2] false)"


def test_a_specification_becomes_a_file_of_fret_and_is_the_same_again(run, write):
    write("spec.stl", "sample 100ms\nrequire R1: always(rise(x > 1) -> always[0:500ms](y > 1))\n")
    answer = run("convert", "spec.stl", "--to", "fret", "--component", "pump")
    assert answer.code == 0
    assert (
        json.loads(answer.out)["requirements"][0]["fulltext"]
        == "When x > 1 the pump shall for 5 ticks satisfy y > 1"
    )
    write("pump.json", answer.out)
    again = run("convert", "pump.json", "--from", "fret", "--period", "100ms")
    assert again.code == 0
    assert rtamt.parse(again.out).formula == rtamt.load("spec.stl").formula


def test_what_cannot_be_converted_is_an_error(run, write):
    write("spec.stl", "always(held(x, y > 1) > 1)\n")
    answer = run("convert", "spec.stl", "--to", "fret")
    assert answer.code == 2
    assert answer.err.endswith("rtamt: spec.stl: no requirement can be converted\n")
    assert "give the other format" in run("convert", "spec.stl").err
    assert "there is no format 'frt'; did you mean 'fret'?" in run("convert", "spec.stl", "--to", "frt").err
    for option, value in (
        ("--unit", "ms"),
        ("--set", "a=1"),
        ("--semantics", "boolean"),
        ("--backend", "python"),
    ):
        assert run("convert", "x.mtl", "--from", "mtl", option, value).err.endswith(
            f"{option} is for --to: it is about specifications, and --from reads another format\n"
        )
    assert "cannot read 'none.json'" in run("convert", "none.json", "--from", "fret").err


def test_a_file_that_is_not_text_is_an_error(run, tmp_path):
    (tmp_path / "odd.json").write_bytes(b"[\xff]")
    answer = run("convert", "odd.json", "--from", "fret")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "rtamt: 'odd.json' is not UTF-8 text (byte 1); is it a specification?\n"
