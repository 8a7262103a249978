"""Very many recordings on this machine: manifest, resumption, damaged recordings, processes that die."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import psutil
import pytest

import rtamt
from rtamt.cli import main
from rtamt.scale import recordings
from rtamt.scale.engines import Progress, check_recordings
from rtamt.scale.job import Job
from rtamt.scale.local import _batch
from rtamt.scale.recordings import Recording, recordings_of
from tests.unit.scale.recorded import DeadlyJob, expected, suite, write_csv


@pytest.fixture
def folder(tmp_path):
    logs = tmp_path / "logs"
    logs.mkdir()
    for i in range(6):
        write_csv(logs / f"{i}.csv", i)
    return logs


def rows(tables):
    return [row for table in tables for row in table]


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


# ---- the manifest --------------------------------------------------------------------------------


def computed(job, recordings, manifest):
    """Return how many recordings are computed, and the rows."""
    seen = []
    found = rows(check_recordings(job, recordings, manifest=str(manifest), jobs=1, progress=seen.append))
    return seen[-1].done, found


def test_only_new_and_changed_recordings_are_computed_again(folder, tmp_path):
    manifest = tmp_path / "done.jsonl"
    job = Job(suite())
    pattern = [str(folder / "*.csv")]
    first, before = computed(job, recordings_of(pattern), manifest)
    again, same = computed(job, recordings_of(pattern), manifest)
    assert (first, again, same) == (6, 0, before)
    write_csv(folder / "6.csv", 6)
    write_csv(folder / "1.csv", 11)
    os.utime(folder / "1.csv", ns=(1, 1))
    count, after = computed(job, recordings_of(pattern), manifest)
    assert count == 2
    assert after[3:6] == expected(11, str(folder / "1.csv"))
    assert after[:3] == before[:3]
    assert after[-3:] == expected(6, str(folder / "6.csv"))


@pytest.mark.parametrize("number", [1, 100_000], ids=["small", "large"])
@pytest.mark.parametrize("scheme", ["", "file://"])
@pytest.mark.parametrize("changes", ["have a time", "have none"])
def test_a_recording_that_changes_in_its_middle_alone_is_computed_again(
    tmp_path, monkeypatch, number, scheme, changes
):
    monkeypatch.setattr(recordings, "_HAS_CHANGE_TIME", changes == "have a time")
    path, manifest = tmp_path / "log.csv", tmp_path / "done.jsonl"
    comment = "#aaaaaaa\n" * number

    def write(x):
        path.write_text(f"time,x,y\n{comment}0,{x},1\n0.5,{x},1\n{comment}")
        os.utime(path, ns=(7, 7))

    write(2)
    job, place = Job(suite()), f"{scheme}{path}"
    changed = path.stat().st_ctime_ns
    first, before = computed(job, recordings_of([place]), manifest)
    assert (first, computed(job, recordings_of([place]), manifest)) == (1, (0, before))
    write(9)
    while path.stat().st_ctime_ns == changed:  # the clock of the system has ticks of milliseconds
        os.utime(path, ns=(7, 7))
    again, after = computed(job, recordings_of([place]), manifest)
    assert again == 1
    assert after != before


@pytest.mark.parametrize(
    ("other", "same"),
    [
        (lambda: Job(suite()), True),
        (lambda: Job(suite(), skip_nan=["x"]), False),
        (lambda: Job(suite(select=["satisfied"])), False),
        (lambda: Job(rtamt.Suite(rtamt.parse("require LOW: always(x <= 5)", period="500ms"))), False),
    ],
)
def test_other_requirements_or_options_are_computed_again(folder, tmp_path, other, same):
    recordings = recordings_of([str(folder)])
    computed(Job(suite()), recordings, tmp_path / "done.jsonl")
    count, _ = computed(other(), recordings, tmp_path / "done.jsonl")
    assert count == (0 if same else 6)


def test_the_key_of_a_suite_that_cannot_be_stored_is_the_same_in_every_process():
    program = (
        "import rtamt; from rtamt.scale.job import Job; "
        "print(Job(rtamt.Suite(rtamt.parse('always[0:1](x >= 3)', semantics='boolean'))).key)"
    )
    run = [sys.executable, "-c", program]
    keys = {
        subprocess.run(
            run, capture_output=True, text=True, check=True, env={**os.environ, "PYTHONHASHSEED": seed}
        ).stdout
        for seed in ("1", "2")
    }
    assert len(keys) == 1


@pytest.mark.parametrize("left", [1, 5, 9, -20])
def test_a_line_that_a_crash_cut_off_is_computed_again(folder, tmp_path, left):
    manifest = tmp_path / "done.jsonl"
    recordings = recordings_of([str(folder)])
    _, before = computed(Job(suite()), recordings, manifest)
    *lines, last = manifest.read_bytes().splitlines(keepends=True)
    manifest.write_bytes(b"".join(lines) + last[:left])
    count, after = computed(Job(suite()), recordings, manifest)
    assert (count, after) == (1, before)
    assert len(manifest.read_bytes().splitlines()) == 6


def test_a_damaged_line_of_a_manifest_is_reported(folder, tmp_path):
    manifest = tmp_path / "done.jsonl"
    recordings = recordings_of([str(folder)])
    computed(Job(suite()), recordings, manifest)
    lines = manifest.read_bytes().splitlines(keepends=True)
    damaged = b"".join([lines[0], lines[1][:30] + bytes(20) + lines[1][50:], *lines[2:]])
    manifest.write_bytes(damaged)
    with pytest.raises(rtamt.UsageError, match=f"is damaged at byte {len(lines[0])}: delete it"):
        list(check_recordings(Job(suite()), recordings, manifest=str(manifest)))
    assert manifest.read_bytes() == damaged


@pytest.mark.parametrize("rest", [b"[" * 100_000, b"7}"])
def test_a_forged_line_of_a_manifest_is_reported(folder, tmp_path, rest):
    manifest = tmp_path / "done.jsonl"
    manifest.write_bytes(b'{"rtamt":1,' + rest + b"\n")
    with pytest.raises(rtamt.UsageError, match="is damaged at byte 0: delete it"):
        list(check_recordings(Job(suite()), recordings_of([str(folder)]), manifest=str(manifest)))


def test_a_file_that_is_no_manifest_is_not_touched(folder, tmp_path):
    other = tmp_path / "notes.txt"
    other.write_text("my notes\n")
    with pytest.raises(rtamt.UsageError) as caught:
        list(check_recordings(Job(suite()), recordings_of([str(folder)]), manifest=str(other)))
    assert str(caught.value) == f"'{other}' is no manifest of rtamt: name another file"
    assert other.read_text() == "my notes\n"


def test_infinite_and_exact_numbers_come_back_from_the_manifest(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("time,x\n0,0.1\n0.3,0.30000000000000004\n")
    job = Job(rtamt.Suite([rtamt.parse("require A: true; require B: x >= 0.3", period="300ms")]))
    recordings = recordings_of([str(path)])
    (table,) = check_recordings(job, recordings, manifest=str(tmp_path / "m"), jobs=1)
    assert [row.robustness for row in table] == [np.inf, 0.1 - 0.3]


def test_killed_in_the_middle_the_same_command_goes_on_and_computes_nothing_twice(tmp_path, monkeypatch):
    logs, manifest, table = tmp_path / "logs", tmp_path / "done.jsonl", tmp_path / "table.csv"
    logs.mkdir()
    count = 120
    for i in range(count):
        write_csv(logs / f"{i:03}.csv", i)
    (tmp_path / "spec.stl").write_text("require LOW: always(x <= 4); require POS: always(y / x >= -50)")
    command = [sys.executable, "-m", "rtamt", "check", "spec.stl", "logs/*.csv", "--engine", "local"]
    command += ["--jobs", "2", "--period", "500ms", "--quiet"]
    resumed = [*command, "--manifest", str(manifest), "-o", str(table)]
    process = subprocess.Popen(resumed, cwd=tmp_path)
    until = time.monotonic() + 60
    while not manifest.exists() or manifest.read_bytes().count(b"\n") < 5:
        assert process.poll() is None
        assert time.monotonic() < until
        time.sleep(0.002)
    children = psutil.Process(process.pid).children(recursive=True)
    assert len(children) >= 2
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert psutil.wait_procs(children, timeout=20)[1] == []  # they have nothing to do any more
    done = manifest.read_bytes()
    whole_lines = done[: done.rindex(b"\n") + 1]
    assert 5 <= whole_lines.count(b"\n") < count
    assert not table.exists()
    again = subprocess.run(resumed, cwd=tmp_path, check=False)
    assert again.returncode == 1
    after = manifest.read_bytes()
    assert after.startswith(whole_lines)
    paths = [json.loads(line)["path"] for line in after.splitlines()]
    assert sorted(paths) == [f"logs/{i:03}.csv" for i in range(count)]
    clean = tmp_path / "clean.csv"
    monkeypatch.chdir(tmp_path)
    assert main([*command[3:-5], *command[-3:], "--jobs", "1", "-o", str(clean)]) == 1
    assert clean.read_bytes() == table.read_bytes()


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


# ---- recordings ----------------------------------------------------------------------------------


def test_remote_recordings_are_listed_and_fetched_by_fsspec(folder):
    fsspec = pytest.importorskip("fsspec")
    memory = fsspec.filesystem("memory")
    for i in range(2):
        memory.pipe_file(f"/logs/{i}.csv", (folder / f"{i}.csv").read_bytes())
    try:
        recordings = recordings_of(["memory://logs/*.csv"])
        assert [recording.path for recording in recordings] == [
            "memory:///logs/0.csv",
            "memory:///logs/1.csv",
        ]
        found = rows(check_recordings(Job(suite()), recordings, jobs=1))
        assert found == [row for i in range(2) for row in expected(i, f"memory:///logs/{i}.csv")]
        changed = recordings_of(["memory://logs/*.csv"])
        assert changed == recordings
        memory.pipe_file("/logs/1.csv", b"time,x,y\n0,1,1\n")
        assert recordings_of(["memory://logs/*.csv"])[1].etag != recordings[1].etag
    finally:
        memory.rm("/logs", recursive=True)
    with pytest.raises(rtamt.UsageError, match=r"^cannot read 'memory://logs/3.csv'"):
        recordings_of(["memory://logs/3.csv"])


@pytest.mark.parametrize(
    ("info", "read"),
    [
        ({"ETag": '"9b2cf535"', "LastModified": "2026-01-01"}, False),  # S3
        ({"etag": "CJj3", "md5Hash": "kAFQmDzST7DWlj99KOF/cg==", "mtime": "2026-01-01"}, False),  # GCS
        ({"etag": "0x8D9", "last_modified": "2026-01-01"}, False),  # Azure
        ({"ETag": '"5e1-2f"', "Last-Modified": "Thu, 01 Jan 2026 00:00:00 GMT"}, False),  # HTTP
        ({"Content-MD5": "kAFQmDzST7DWlj99KOF/cg=="}, False),
        ({"ETag": 'W/"5e1-2f"'}, True),
        ({"Last-Modified": "Thu, 01 Jan 2026 00:00:00 GMT"}, True),
        ({"mtime": 1_767_225_600}, True),  # SFTP
        ({}, True),
    ],
)
def test_a_remote_recording_without_an_etag_is_known_by_its_content(monkeypatch, info, read):
    fsspec = pytest.importorskip("fsspec")
    memory = fsspec.filesystem("memory")
    opened = []

    def open_file(path, mode="rb", **settings):
        if mode == "rb":
            opened.append(path)
        return type(memory).open(memory, path, mode, **settings)

    monkeypatch.setattr(memory, "info", lambda path: {"name": path, "size": 4, "type": "file", **info})
    monkeypatch.setattr(memory, "open", open_file)
    monkeypatch.setattr(memory, "isdir", lambda _path: False)
    try:
        memory.pipe_file("/one.csv", b"x\n1\n")
        before = recordings_of(["memory://one.csv"])
        assert recordings_of(["memory://one.csv"]) == before
        memory.pipe_file("/one.csv", b"x\n2\n")
        assert (recordings_of(["memory://one.csv"]) != before) is read
        assert (len(opened) > 0) is read
    finally:
        memory.store.pop("/one.csv", None)


def test_members_of_groups_and_recorded_names_are_read(tmp_path):
    (tmp_path / "a.csv").write_text("time,car_1.x,car_2.x,drive.speed [km/h]\n0,4,9,36\n1,5,2,18\n")
    spec = rtamt.parse(
        'group cars = "car_*"; input float v [m/s] = "drive.speed"; '
        "require GAP: always forall c in cars: c.x > 3; require V: always(v <= 9)",
        period=1,
    )
    (table,) = check_recordings(Job(rtamt.Suite(spec)), recordings_of([str(tmp_path)]), jobs=1)
    assert [(row.robustness, row.error) for row in table] == [(-1.0, None), (-1.0, None)]
