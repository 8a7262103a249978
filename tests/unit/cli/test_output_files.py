"""Output files: what a command reads is never overwritten."""

import os
from pathlib import Path

import pytest


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("x.stl").write_text("historically(x >= 0)")
    Path("t.csv").write_text("time,x\n0,1\n1,2\n")
    Path("linked.csv").symlink_to("t.csv")
    os.link("t.csv", "hard.csv")
    return {path.name: path.read_text() for path in tmp_path.iterdir()}


@pytest.mark.parametrize(
    ("args", "message"),
    [
        (
            ("check", "x.stl", "t.csv", "-o", "t.csv"),
            "-o would overwrite 't.csv', which is read: name another file",
        ),
        (
            ("check", "x.stl", "t.csv", "-o", "./linked.csv"),
            "-o would overwrite './linked.csv', which is read",
        ),
        (
            ("check", "x.stl", "t.csv", "--html", "hard.csv"),
            "--html would overwrite 'hard.csv', which is read",
        ),
        (("check", "x.stl", "t.csv", "--junit", "x.stl"), "--junit would overwrite 'x.stl', which is read"),
        (
            ("check", "x.stl", "t.csv", "--junit", "r", "--sarif", "./r"),
            "--junit and --sarif would both write './r'",
        ),
        (("report", "x.stl", "t.csv", "-o", "t.csv"), "-o would overwrite 't.csv', which is read"),
        (("compile", "x.stl", "-o", "x.stl"), "-o would overwrite 'x.stl', which is read"),
        (("fmu", "x.stl", "-o", "x.stl"), "-o would overwrite 'x.stl', which is read"),
        (("plot", "x.stl", "t.csv", "-o", "t.csv"), "-o would overwrite 't.csv', which is read"),
    ],
)
def test_a_command_does_not_overwrite_what_it_reads(run, files, args, message):
    code, out, err = run(*args)
    assert (code, out) == (2, "")
    assert err.startswith(f"rtamt: {message}")
    assert {path.name: path.read_text() for path in Path().iterdir()} == files


def test_a_formula_and_devices_may_be_called_like_the_output(run, files):
    assert run("check", "(x >= 0)", "t.csv", "-o", "(x >= 0)").code == 0
    assert (
        run("check", "x" * 5000 + " >= 0 or x >= 0", "t.csv", "--name", "x" * 5000 + "=x", "-o", "o").code
        == 0
    )
    assert run("check", "x.stl", "t.csv", "-o", os.devnull, "--junit", os.devnull).code == 0
    assert files["t.csv"] == Path("t.csv").read_text()


@pytest.mark.parametrize("output", ["r.parquet", "r.json", "r.CSV.gz", "folder.csv/r.txt"])
def test_a_file_of_any_other_format_was_written_as_csv(run, files, output):
    message = f"rtamt: --output is '{output}'; write the robustness to a file .csv or .mcap\n"
    assert run("check", "x.stl", "t.csv", "-o", output) == (2, "", message)
    assert {path.name: path.read_text() for path in Path().iterdir()} == files
    assert run("check", "x.stl", "t.csv", "-o", "R.CSV", "--quiet") == (0, "", "")


@pytest.mark.parametrize("output", ["r.json", "r"])
def test_verdicts_of_an_engine_have_two_formats(run, files, output):
    assert output not in files
    message = f"rtamt: --output is '{output}'; with --engine, write the table to a file .parquet or .csv\n"
    assert run("check", "x.stl", "t.csv", "--engine", "local", "-o", output) == (2, "", message)
