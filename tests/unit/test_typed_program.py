"""The program whose types ``make lint`` checks also runs; its names are public."""

import pytest

import rtamt
from tests.unit import typed_program


@pytest.mark.parametrize(
    "part",
    [typed_program.specifications, typed_program.results, typed_program.monitors, typed_program.fleets],
)
def test_a_typed_program_runs_and_gets_values_of_the_classes_it_expects(part, monkeypatch):
    checked = []

    def confirm(value: object, kind: object) -> object:
        if isinstance(kind, type):
            assert isinstance(value, kind)
            checked.append(kind)
        return value

    monkeypatch.setattr(typed_program, "assert_type", confirm)
    part()
    assert checked


def test_a_typed_program_reads_a_recording(tmp_path):
    path = tmp_path / "log.csv"
    path.write_text("time,x\n0,4\n1,2\n")
    typed_program.recordings(str(path))


def test_public_names_are_listed_once_and_exist():
    assert len(rtamt.__all__) == len(set(rtamt.__all__))
    assert [name for name in rtamt.__all__ if not hasattr(rtamt, name)] == []
