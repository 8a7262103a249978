"""``rtamt export``: files for Foxglove and Rerun."""

import json

import pytest

from tests.unit.telemetry.results import messages

SPEC = "require SPEED: always(speed <= 30)\nrequire SLOW: speed <= 25"
LOG = "time [ns],speed\n1700000000100000001,20\n1700000001100000001,32\n"


@pytest.fixture
def files(write):
    write("spec.stl", SPEC)
    write("log.csv", LOG)


@pytest.mark.usefixtures("files")
def test_an_mcap_file_and_its_layout(run, tmp_path):
    assert run("export", "spec.stl", "log.csv", "-o", "x.mcap", "--layout", "x.json") == (
        0,
        "x.mcap: 1 satisfied, 1 violated\nx.json: 1 satisfied, 1 violated\n",
        "",
    )
    rows = messages(tmp_path / "x.mcap")
    assert [time for time, _ in rows["/rtamt/signals/speed"]] == [1700000000100000001, 1700000001100000001]
    layout = json.loads((tmp_path / "x.json").read_text())
    assert {"configById", "layout"} <= set(layout)


@pytest.mark.usefixtures("files")
def test_bounds_over_time(run, tmp_path):
    assert run("export", "spec.stl", "log.csv", "-o", "x.mcap", "--bounds", "--time", "dense").code == 0
    assert "/rtamt/requirements/SPEED/known" in messages(tmp_path / "x.mcap")


@pytest.mark.usefixtures("files")
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((), "there is nothing to write; name a file, such as -o verdicts.mcap"),
        (("-o", "x.csv"), "--output is 'x.csv', which is no MCAP file; write to a file .mcap"),
        (("--rerun", "x.txt"), "--rerun is 'x.txt', which is no recording of Rerun; write to a file .rrd"),
        (
            ("-o", "x.mcap", "--layout", "x.mcap"),
            "-o and --layout would both write 'x.mcap': name another file; see 'rtamt export --help'",
        ),
        (
            ("-o", "none/x.mcap"),
            "log.csv: cannot write 'none/x.mcap': No such file or directory",
        ),
    ],
)
def test_errors_are_one_sentence(run, arguments, message):
    assert run("export", "spec.stl", "log.csv", *arguments) == (2, "", f"rtamt: {message}\n")
