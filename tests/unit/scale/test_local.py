"""Very many recordings on this machine: damaged recordings, processes that die, the command."""

from __future__ import annotations

import json
import os
import shlex

import pandas as pd
import pyarrow as pa
import pytest
from pyarrow import parquet

import rtamt
from rtamt.cli import main
from rtamt.scale.engines import Progress, check_recordings
from rtamt.scale.job import Job
from rtamt.scale.local import _batch
from rtamt.scale.recordings import Recording, recordings_of
from tests.unit.scale.recorded import DeadlyJob, expected, rows, suite, write_csv


def test_the_table_has_the_values_of_each_recording_in_their_order(folder):
    recordings = recordings_of([str(folder / "*.csv")])
    found = rows(check_recordings(Job(suite()), recordings, jobs=2))
    assert found == [row for i in range(6) for row in expected(i, str(folder / f"{i}.csv"))]


def test_a_damaged_recording_is_rows_with_its_error_and_not_the_end(folder):
    (folder / "3.csv").write_bytes(b"time,x,y\n0,1,2\n0.5,nonsense,3\n")
    (folder / "9.parquet").write_bytes(b"PAR1 and no more")
    found = rows(check_recordings(Job(suite()), recordings_of([str(folder)]), jobs=1))
    errors = {os.path.basename(row.recording): row.error for row in found if row.error is not None}
    assert list(errors) == ["3.csv", "9.parquet"]
    assert "cannot be read as Parquet" in errors["9.parquet"]
    assert "nonsense" in errors["3.csv"]
    assert len(found) == 7 * 3


def test_times_that_go_back_are_the_error_of_that_recording(folder):
    (folder / "2.csv").write_text("time,x,y\n0,1,2\n1,1,2\n0.5,1,2\n")
    found = rows(check_recordings(Job(suite()), recordings_of([str(folder)]), jobs=1))
    wrong = [row for row in found if row.error is not None]
    assert {os.path.basename(row.recording) for row in wrong} == {"2.csv"}
    assert len(wrong) == 3


def test_a_recording_whose_process_dies_is_rows_with_an_error_and_the_others_are_checked(folder):
    for i in range(10, 40):  # so many that several are handed out together
        write_csv(folder / f"{i}.csv", i)
    write_csv(folder / "2_deadly.csv", 2)
    job = DeadlyJob(suite())
    found = {row.recording: row for row in rows(check_recordings(job, recordings_of([str(folder)]), jobs=2))}
    wrong = {path: row.error for path, row in found.items() if row.error is not None}
    deadly = str(folder / "2_deadly.csv")
    assert wrong == {
        deadly: f"{deadly} cannot be checked: the process that read it was ended, perhaps for want of memory"
    }
    assert len(found) == 6 + 30 + 1


def test_small_files_are_handed_out_together_and_the_last_ones_one_at_a_time(tmp_path):
    def sizes(files):
        for i, size in enumerate(files):
            (tmp_path / f"{i}.csv").write_bytes(bytes(size))
        waiting = [Recording(str(tmp_path / f"{i}.csv"), "") for i in range(len(files))]
        found = []
        while waiting:
            found.append(len(_batch(waiting, 2, waiting[:0])))
            del waiting[: found[-1]]
        return found

    assert sizes([100] * 40) == [5, 4, 3, 3, 3, 2, 2, 2, 2, *[1] * 14]
    assert sizes([100] * 1000)[:3] == [16, 16, 16]
    assert sizes([2**17] * 100)[:3] == [2, 2, 2]
    assert sizes([2**20, 0] * 2) == [1] * 4
    remote = [Recording(f"s3://logs/{i}.csv", "") for i in range(100)]
    assert len(_batch(remote, 2, ())) == 1
    local = [Recording(str(tmp_path / f"{i}.csv"), "") for i in range(4, 100)]
    assert len(_batch(local, 2, ())) == 2
    assert len(_batch(local, 2, {local[1]})) == 1


# ---- the command ---------------------------------------------------------------------------------


def run(capsys, *arguments):
    code = main(["check", *map(str, arguments)])
    out, err = capsys.readouterr()
    return code, out, err


def test_the_command_takes_folders_and_patterns_in_any_order_and_counts(folder, tmp_path, capsys):
    specs = tmp_path / "specs"
    specs.mkdir()
    (specs / "a.stl").write_text("require LOW: always(x <= 4)")
    (specs / "b.stl").write_text("require HIGH: always(x >= -9)")
    (folder / "bad.csv").write_text("")
    more = ("--engine", "local", "--period", "500ms", "--jobs", 1)
    code, out, err = run(capsys, folder / "*.csv", specs, *more)
    low = [row.satisfied for i in range(6) for row in expected(i, "")[:1]]
    assert code == 2
    head, first, second, _, total = out.splitlines()
    assert head.split() == [
        *"requirement satisfied violated unchecked error worst robustness recording".split()
    ]
    assert first.split()[:5] == ["LOW", str(sum(low)), str(6 - sum(low)), "0", "1"]
    assert second.split()[:5] == ["HIGH", "6", "0", "0", "1"]
    assert total == f"7 recordings: {6 + sum(low)} satisfied, {6 - sum(low)} violated, 2 error"
    assert "bad.csv" in err
    assert run(capsys, specs, folder / "*.csv", *more)[1] == out


def test_the_table_is_written_as_csv_and_parquet_with_equal_rows(folder, tmp_path, capsys):
    import pyarrow.csv
    import pyarrow.parquet

    arguments = ("always(x <= 4)", folder, "--manifest", tmp_path / "m", "--period", "500ms", "--jobs", 1)
    for name in ("t.csv", "t.parquet"):
        run(capsys, *arguments, "-o", tmp_path / name)
    parquet = pyarrow.parquet.read_table(tmp_path / "t.parquet")
    text = pyarrow.csv.read_csv(tmp_path / "t.csv")
    assert parquet["robustness"].to_pylist() == text["robustness"].to_pylist()
    assert parquet.column_names == text.column_names
    assert parquet.num_rows == 6
    _, out, _ = run(capsys, *arguments)
    assert "6 recordings, 6 of them from the manifest: " in out


def test_a_path_that_begins_like_a_formula_is_no_formula_in_the_table(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_csv(tmp_path / "=1+1.csv", 1)
    run(
        capsys,
        "always(x <= 4)",
        "=*.csv",
        "--engine",
        "local",
        "--period",
        "500ms",
        "--jobs",
        1,
        "-o",
        "t.out.csv",
    )
    assert (tmp_path / "t.out.csv").read_text().splitlines()[1].startswith("./=1+1.csv,")


def test_rows_as_json(folder, capsys):
    (folder / "5.csv").write_text("time,z\n0,1\n")
    code, out, _ = run(
        capsys, "require A: always(x <= 4)", folder, "--engine", "local", "--json", "--jobs", 1
    )
    found = [json.loads(line) for line in out.splitlines()]
    assert code == 2
    assert found[0]["requirement"] == "A"
    assert found[0]["trace"] == str(folder / "0.csv")
    assert set(found[0]) == {"requirement", "trace", "satisfied", "robustness", "first_violation"}
    assert "'x'" in found[5]["error"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            ["--junit", "r.xml"],
            "--junit is for recordings that are checked one by one: leave it out, or --engine and --manifest",
        ),
        (["-o", "t.mcap"], "--output is 't.mcap'; with --engine, write the table to a file .parquet or .csv"),
        (["--jobs", "0"], "jobs is 0; give a number of processes, 1 or more"),
        (["--manifest", "/nowhere/m"], "cannot write the manifest '/nowhere/m': No such file or directory"),
        (["--skip-nan", "z"], "skip_nan has 'z', which no requirement reads"),
    ],
)
def test_wrong_options(folder, capsys, arguments, message):
    code, _, err = run(capsys, "always(x <= 4)", folder, "--engine", "local", *arguments)
    assert (code, err) == (2, f"rtamt: {message}\n")


def test_an_unknown_engine_and_nothing_to_check(folder, capsys):
    code, _, err = run(capsys, "always(x <= 4)", folder, "--engine", "sparks")
    assert code == 2
    assert err.startswith("rtamt: there is no engine 'sparks'; did you mean 'spark'?")
    code, _, err = run(capsys, "always(x <= 4)", "none*.csv", "--engine", "local")
    assert (code, err) == (2, "rtamt: 'none*.csv' names no recording\n")


def test_the_remaining_time_is_that_of_the_pace_so_far(monkeypatch):
    from rtamt.cli import many

    now = [100.0]
    monkeypatch.setattr(many.time, "monotonic", lambda: now[0])
    counter = many._Counter(many.Progress())
    assert counter.remaining(Progress(0, 10, 110)) == ""
    now[0] = 160.0
    assert counter.remaining(Progress(20, 10, 110)) == "0:04:00 left"


def test_members_of_groups_and_recorded_names_are_read(tmp_path):
    (tmp_path / "a.csv").write_text("time,car_1.x,car_2.x,drive.speed [km/h]\n0,4,9,36\n1,5,2,18\n")
    spec = rtamt.parse(
        'group cars = "car_*"; input float v [m/s] = "drive.speed"; '
        "require GAP: always forall c in cars: c.x > 3; require V: always(v <= 9)",
        period=1,
    )
    (table,) = check_recordings(Job(rtamt.Suite(spec)), recordings_of([str(tmp_path)]), jobs=1)
    assert [(row.robustness, row.error) for row in table] == [(-1.0, None), (-1.0, None)]


OPTIONAL = """
optional input float v
optional input float w
optional input float x
require A: always(x > 3)
require B: always(v > 3)
require C: always(v > w)
"""
#: How a recording may lack a column that a requirement reads, or have it without numbers.
COLUMNS = {
    "complete": {"x": [5, 2, 6], "v": [5, 5, 5], "w": [1, 2, 3]},
    "without v": {"x": [5, 2, 6], "w": [1, 2, 3]},
    "without w": {"x": [5, 2, 6], "v": [5, 5, 5]},
    "texts": {"x": [5, 2, 6], "v": ["on", "off", "on"], "w": [1, 2, 3]},
    "nothing": {"y": [5, 2, 6]},
}


@pytest.mark.parametrize("suffix", ["csv", "parquet", "xlsx"])
@pytest.mark.parametrize("has", COLUMNS)
@pytest.mark.parametrize("optional", [True, False])
def test_a_column_that_one_requirement_lacks_was_the_error_of_all(tmp_path, capsys, suffix, has, optional):
    frame = pd.DataFrame({"time": [0.0, 1.0, 2.0], **COLUMNS[has]})
    path = tmp_path / f"a.{suffix}"
    {"csv": frame.to_csv, "parquet": frame.to_parquet, "xlsx": frame.to_excel}[suffix](path, index=False)
    (tmp_path / "s.stl").write_text(OPTIONAL if optional else OPTIONAL.replace("optional ", ""))

    def outcomes(*more):
        main(["check", str(tmp_path / "s.stl"), str(path), "--json", *more])
        found = map(json.loads, capsys.readouterr().out.splitlines())
        read = ("requirement", "satisfied", "robustness", "first_violation", "unchecked", "error")
        return [{name: row.get(name) for name in read} for row in found]

    alone = outcomes()
    assert outcomes("--engine", "local") == alone
    assert (has == "complete") == all(row["error"] is None and row["unchecked"] is None for row in alone)


GROUPED = """
input float x = "sig.x"
input group cars = "car_*" { float s }
require R1: always(x > 0)
require R2: always(forall v in cars: v.s > -2)
require R3: always[0:1](forall v in cars: v.s > 3 and x > 0)
"""


@pytest.mark.parametrize(
    "rows",
    [
        "time,sig.x,car_1.s\n0,5,4\n1,5,4\n2,6,5\n",
        "time,sig.x,car_1.s,car_2.s\n0,5,4,ERR\n1,5,4,ERR\n",
        "time,x,car_1.s\n0,5,4\n1,5,4\n",
        "time,sig.x,car_1.s\n0,5,4\n1,5,4\n2,,5\n",
        "time,sig.x,car_1.s,junk\n0,5,4,nan\n1,5,4,\n",
    ],
    ids=["complete", "texts", "another name", "gap", "column that nothing reads"],
)
def test_requirements_over_members_are_those_of_a_check(tmp_path, capsys, rows):
    """One quantifier in a file made all requirements read all columns, under any name and with gaps."""
    (tmp_path / "a.csv").write_text(rows)
    (tmp_path / "s.stl").write_text(GROUPED)

    def outcomes(*more):
        code = main(["check", str(tmp_path / "s.stl"), str(tmp_path / "a.csv"), "--json", *more])
        found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
        read = ("requirement", "satisfied", "robustness", "first_violation")
        return code, [({name: row.get(name) for name in read}, "error" in row) for row in found]

    assert outcomes("--engine", "local") == outcomes()


def test_a_recording_on_which_nothing_is_checked_was_no_error(tmp_path, capsys):
    (tmp_path / "a.csv").write_text("time,x\n0,5\n1,5\n")
    (tmp_path / "s.stl").write_text("optional input float y\nrequire R: always(y > 0)")
    for more in [], ["--engine", "local"]:
        assert main(["check", str(tmp_path / "s.stl"), str(tmp_path / "a.csv"), *more]) == 2
        assert "a.csv: nothing was checked: every requirement reads signals" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("name", "content", "time", "message"),
    [
        (
            "gap.csv",
            "time,x\n0,1\n1,\n2,3\n",
            "discrete",
            "'x' is missing at sample 1 of {}, but discrete time needs a value at every sample: fill the gap, hold the "
            "value before it (--hold-for DURATION), or use dense time (--time dense)",
        ),
        (
            "nan.csv",
            "time,x\n0,1\n1,nan\n2,3\n",
            "dense",
            "{}, line 3: 'x' is NaN: fill the gap, or leave such samples out with skip_nan=, on the command line "
            "--skip-nan",
        ),
        ("y.csv", "time,y\n0,1\n", "discrete", "{} has no column 'x'; columns: time, y"),
        (
            "damaged.parquet",
            "no",
            "dense",
            "'{}' cannot be read as Parquet: Parquet file size is 2 bytes, smaller than the minimum file footer "
            "(8 bytes); the file is damaged, incomplete or of another kind: copy or export it again",
        ),
    ],
)
@pytest.mark.parametrize("scheme", ["", "file://"])
def test_errors_name_the_address_and_options_of_the_command(
    tmp_path, capsys, name, content, time, message, scheme
):
    if scheme:
        pytest.importorskip("fsspec")
    (tmp_path / name).write_text(content)
    recording = f"{scheme}{tmp_path / name}"
    assert main(["check", "always(x >= 0)", recording, "--time", time, "--engine", "local", "--json"]) == 2
    assert json.loads(capsys.readouterr().out)["error"] == message.format(recording)


@pytest.mark.parametrize(("name", "written"), [("x", "x"), ("driver's door", '"driver\'s door"')])
def test_errors_about_nan_name_the_option_that_leaves_it_out(tmp_path, capsys, name, written):
    file = tmp_path / "nan.parquet"
    parquet.write_table(pa.table({"time": [0.0, 1.0], name: [1.0, float("nan")]}), file)
    main(["check", f"always({written} >= 0)", str(file), "--engine", "local", "--json"])
    error = json.loads(capsys.readouterr().out)["error"]
    option = f"--skip-nan {shlex.quote(name)}"
    assert error == f"'{name}' is NaN at sample 1, time 1 s: fill the gap or leave the sample out ({option})"
