"""Recordings of remote stores, and by what they are known."""

from __future__ import annotations

import pytest

import rtamt
from rtamt.scale.engines import check_recordings
from rtamt.scale.job import Job
from rtamt.scale.recordings import recordings_of
from tests.unit.scale.recorded import expected, rows, suite


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
