"""The manifest: only new and changed recordings are computed again, and a crash loses nothing."""

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
from rtamt.scale.engines import check_recordings
from rtamt.scale.job import Job
from rtamt.scale.recordings import recordings_of
from tests.unit.scale.recorded import expected, rows, suite, write_csv


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
