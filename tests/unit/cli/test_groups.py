"""Quantifiers on the command line: the members are the columns of the file."""

from __future__ import annotations

import json

import pytest

from rtamt.cli import main

SPEC = """input float ego.x
input group cars = "car_*" { float x [m] }
require A: always forall v in cars: v.x - ego.x > 5
require B: ego.x >= 0
"""
TRACE = "time,ego.x,car_1.x,car_2.x [m]\n0,0,10,\n1,1,11,9\n2,2,12,6\n3,3,13,\n"


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "f.stl").write_text(SPEC)
    (tmp_path / "forall.stl").write_text(SPEC.partition("require B")[0])
    (tmp_path / "f.csv").write_text(TRACE)
    (tmp_path / "empty.csv").write_text("time,ego.x\n0,0\n1,1\n")


@pytest.mark.parametrize("time", ["discrete", "dense"])
@pytest.mark.usefixtures("files")
def test_the_members_are_the_columns_of_each_file(capsys, time):
    assert main(["check", "f.stl", "f.csv", "empty.csv", "--time", time, "--json"]) == 2
    a, b, *rest = map(json.loads, capsys.readouterr().out.splitlines())
    assert (a["requirement"], a["robustness"], a["first_violation"]) == ("A", -1, 2)
    assert (b["requirement"], b["robustness"]) == ("B", 0)
    message = "empty.csv has no member of the group 'cars': no name matches \"car_*\" and a field, such as car_1.x; "
    assert {row["error"] for row in rest} == {message + "names: ego.x"}


@pytest.mark.usefixtures("files")
def test_explanations_and_reports_name_the_members(capsys):
    main(["explain", "forall.stl", "f.csv"])
    assert "'car_2.x - ego.x > 5' fails at 2 s (-1)" in capsys.readouterr().out


@pytest.mark.usefixtures("files")
def test_info_lists_groups(capsys):
    assert main(["info", "f.stl"]) == 0
    assert 'groups     input cars = "car_*" { float x [m] }\n' in capsys.readouterr().out


@pytest.mark.usefixtures("files")
def test_what_cannot_run_over_unknown_members_is_one_sentence(capsys):
    assert main(["monitor", "f.stl"]) == 2
    assert capsys.readouterr().err == (
        "rtamt: the formula quantifies over 'cars', whose members are known with the data, and 'rtamt monitor' "
        "needs them before; evaluate recordings, or name the members: spec.over({'cars': [...]})\n"
    )
