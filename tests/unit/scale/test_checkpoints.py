"""Checkpoints: replaced as a whole, in folders and object stores; damaged ones are rejected."""

import hashlib
import os

import pytest

import rtamt
from rtamt.scale.checkpoints import Checkpoint, Checkpoints


@pytest.mark.parametrize("remote", [False, True])
def test_a_checkpoint_replaces_the_one_before(tmp_path, remote):
    place = "memory://bucket/checkpoints" if remote else str(tmp_path / "checkpoints")
    found = Checkpoints(place, "group", "cars")
    assert found.load(3) is None
    for offset in (7, 9):
        found.save(Checkpoint("cars", 3, offset, b"state\n" * offset))
        assert Checkpoints(place, "group", "cars").load(3) == ("cars", 3, offset, b"state\n" * offset)
    assert found.load(4) is None
    assert Checkpoints(place, "group", "trucks").load(3) is None


def test_a_crash_while_writing_leaves_the_old_one(tmp_path, monkeypatch):
    found = Checkpoints(str(tmp_path), "group", "cars")
    found.save(Checkpoint("cars", 0, 7, b"old"))

    def crash(_file):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", crash)
    with pytest.raises(rtamt.UsageError) as caught:
        found.save(Checkpoint("cars", 0, 9, b"new"))
    assert str(caught.value) == f"cannot write checkpoints in '{tmp_path}': No space left on device"
    assert found.load(0) == ("cars", 0, 7, b"old")
    assert os.listdir(tmp_path / "group" / "cars") == ["0.checkpoint"]


def test_damaged_and_foreign_checkpoints_are_rejected(tmp_path):
    found = Checkpoints(str(tmp_path), "group", "cars")
    found.save(Checkpoint("cars", 0, 7, b"state"))
    path = tmp_path / "group" / "cars" / "0.checkpoint"
    content = path.read_bytes()
    path.with_name("1.checkpoint").write_bytes(content)
    with pytest.raises(rtamt.UsageError) as caught:
        found.load(1)
    assert str(caught.value) == (
        f"'{path.with_name('1.checkpoint')}' is the checkpoint of partition 0 of 'cars': was it renamed?"
    )
    for i in range(len(content)):
        path.write_bytes(content[:i] + bytes([content[i] ^ 1]) + content[i + 1 :])
        with pytest.raises(rtamt.UsageError) as caught:
            found.load(0)
        assert str(caught.value) == (
            f"'{path}' is no checkpoint of rtamt, or a damaged one: delete it to read the partition from its start"
        )
    path.write_bytes(content[:-1])
    with pytest.raises(rtamt.UsageError):
        found.load(0)


def test_names_are_no_paths():
    with pytest.raises(rtamt.UsageError) as caught:
        Checkpoints("x", "../group", "cars")
    assert str(caught.value) == (
        "the group '../group' cannot name a file: use letters, digits, '.', '_' and '-' with checkpoints"
    )


@pytest.mark.parametrize(
    "header",
    [
        b"",
        b"7",
        b"{}",
        b"[" * 100_000,
        b'{"topic": 1, "partition": 0, "offset": 7}',
        b'{"topic": "cars", "partition": true, "offset": 7}',
        b'{"topic": "cars", "partition": 0, "offset": "7"}',
        b'{"topic": "cars", "partition": 0, "offset": -7}',
    ],
)
def test_a_checkpoint_with_a_forged_header_is_rejected(tmp_path, header):
    found = Checkpoints(str(tmp_path), "group", "cars")
    found.save(Checkpoint("cars", 0, 7, b"state"))
    path = tmp_path / "group" / "cars" / "0.checkpoint"
    magic = path.read_bytes().partition(b"{")[0]
    body = magic + header + b"\nstate"
    path.write_bytes(body + hashlib.sha256(body).digest())
    with pytest.raises(rtamt.UsageError) as caught:
        found.load(0)
    assert str(caught.value) == (
        f"'{path}' is no checkpoint of rtamt, or a damaged one: delete it to read the partition from its start"
    )
