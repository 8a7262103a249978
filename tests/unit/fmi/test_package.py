"""What is in the archive of a unit, and what is not exported."""

from __future__ import annotations

import shutil
import zipfile

import pytest

import rtamt
from rtamt import fmi
from rtamt.language.parsing.parser import parse_formula


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (
            "known >= 3",
            "the output 'known' has the name that an input of the unit has already: rename it in the specification",
        ),
        (
            "time >= 3",
            "the input 'time' has the name that the time of the unit has already: rename it in the specification",
        ),
        ("always(x >= 3)", None),
    ],
)
def test_what_cannot_be_a_unit_is_refused_and_nothing_is_written(tmp_path, text, sentence):
    path = tmp_path / "unit.fmu"
    with pytest.raises(rtamt.StlError) as refused:
        fmi.export(rtamt.parse(text), path)
    assert sentence is None or str(refused.value) == sentence
    assert not path.exists()


def test_a_version_that_does_not_exist_and_a_folder_that_does_not(tmp_path):
    spec = rtamt.parse("x >= 3")
    with pytest.raises(rtamt.UsageError) as refused:
        fmi.export(spec, tmp_path / "unit.fmu", version=1)
    assert str(refused.value) == "there is no FMI version 1 to write, only 2 and 3"
    path = tmp_path / "nowhere" / "unit.fmu"
    with pytest.raises(rtamt.UsageError) as refused:
        fmi.export(spec, path)
    assert str(refused.value) == f"cannot write the unit '{path}': No such file or directory"


def test_equal_requirements_make_equal_archives_with_the_library_and_the_program(exported, tmp_path):
    path = exported("x >= 3", 2)
    again = tmp_path / "again.fmu"
    shutil.copy(path, again)
    fmi.export(rtamt.parse("x >= 3"), path)
    assert path.read_bytes() == again.read_bytes()
    with zipfile.ZipFile(path) as archive:
        assert archive.namelist() == [
            "modelDescription.xml",
            f"binaries/{fmi.platform(2)}/unit2.so",
            "resources/program.rtamt",
        ]
    assert parse_formula("x >= 3") == rtamt.parse("x >= 3").formula
