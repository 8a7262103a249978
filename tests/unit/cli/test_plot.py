"""``rtamt plot``, as a user calls it."""

from xml.etree import ElementTree as ET

import pytest

from rtamt.cli import main

FORMULA = "always((req >= 3) -> eventually[0:5](gnt >= 3))"
TRACE = "examples/request_grant/c_violated.csv"


@pytest.mark.parametrize(
    ("suffix", "first"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")], ids=["png", "svg", "pdf"]
)
def test_a_picture_is_written(tmp_path, suffix, first, capsys):
    path = tmp_path / f"picture.{suffix}"
    assert main(["plot", FORMULA, TRACE, "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}: violated, robustness -2, first violation at 2 s\n"
    assert path.read_bytes().startswith(first)


def test_several_requirements_are_drawn_together(tmp_path, capsys):
    path = tmp_path / "both.png"
    both = "require A: always(req <= 5); require B: always(gnt >= 0)"
    assert main(["plot", both, TRACE, "-o", str(path)]) == 0
    assert capsys.readouterr().out == f"{path}: violated, robustness -1, first violation at 2 s\n"


def test_a_tree_in_dense_time_at_an_instant(tmp_path):
    path = tmp_path / "tree.png"
    arguments = ["plot", FORMULA, TRACE, "--time", "dense", "--tree", "--at", "2", "-o", str(path)]
    assert main(arguments) == 0
    assert path.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["-o", "picture.doc"],
            "rtamt: 'picture.doc' is no image format that can be written: choose from .",
        ),
        (["-o", "no/such/x.png"], "rtamt: cannot write 'no/such/x.png': No such file or directory\n"),
        (["-o", "x.png", "--rows", "0"], "rtamt: --rows is 0; give a number of formulas, 1 or more\n"),
        (["-o", "x.png", "--at", "0.5"], f"rtamt: {TRACE}: "),
        ([], "rtamt: there is no display to show the plot on: name a file, such as -o plot.png\n"),
    ],
)
def test_what_is_wrong_is_one_sentence(arguments, message, capsys, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "agg")
    assert main(["plot", FORMULA, TRACE, *arguments]) == 2
    told = capsys.readouterr().err
    assert told.startswith(message)
    assert told.count("\n") == 1


def test_a_part_of_the_time(tmp_path, capsys):
    path = tmp_path / "part.svg"
    for part in (["--from", "2", "--to", "5500ms"], ["--zoom", "violation"]):
        assert main(["plot", FORMULA, TRACE, "-o", str(path), *part]) == 0
    capsys.readouterr()
    assert main(["plot", FORMULA, TRACE, "-o", str(path), "--from", "noon"]) == 2
    assert capsys.readouterr().err.startswith("rtamt: ")
    assert main(["plot", FORMULA, TRACE, "-o", str(path), "--from", "500"]) == 2
    assert "there is nothing to plot from 500 s to " in capsys.readouterr().err


TEXT = "require slow: always(v <= 3); require near: always(d >= 1)"


def test_requirements_that_start_at_different_times_have_a_report_and_no_plot(tmp_path, capsys):
    log = tmp_path / "late.csv"
    log.write_text("time,v,d\n0,5,\n0.5,4,4\n2,2,3\n")
    assert main(["check", TEXT, str(log), "--time", "dense"]) == 1
    capsys.readouterr()
    assert main(["plot", TEXT, str(log), "--time", "dense", "-o", str(tmp_path / "late.svg")]) == 2
    assert capsys.readouterr() == (
        "",
        f"rtamt: {log}: the requirements start at different times, so that they have no plot in common; "
        "'rtamt report' plots each of them\n",
    )
    assert main(["report", TEXT, str(log), "--time", "dense", "-o", str(tmp_path / "late.html")]) == 1


@pytest.mark.filterwarnings("error")
def test_characters_that_the_fonts_lack_are_a_note(tmp_path, capsys):
    log, path = tmp_path / "log.csv", tmp_path / "x.png"
    log.write_text("time,速度\n0,1\n1,3\n", encoding="utf-8")
    assert main(["plot", "always(速度 >= 1)", str(log), "-o", str(path)]) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert told.out.endswith(f"\nnote: {log}: the fonts of the plot lack 速 度, drawn as boxes\n")


def test_a_drawing_has_control_characters_escaped(tmp_path):
    log, path = tmp_path / "log.csv", tmp_path / "x.svg"
    log.write_text("time,a\x07b\n0,1\n1,3\n", encoding="utf-8")
    assert main(["plot", 'always("a\x07b" >= 1)', str(log), "-o", str(path)]) == 0
    ET.parse(path)
