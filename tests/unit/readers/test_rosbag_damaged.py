"""Damaged bags: what ``--recover`` reads of an MCAP file that was cut off or lost its index, and what is noted."""

from __future__ import annotations

import json
import sqlite3
import struct
from contextlib import suppress

import lz4.frame
import numpy as np
import pytest
from rosbags.rosbag2.storage_mcap import zstd

import rtamt
from rtamt.cli import main
from rtamt.errors import TraceError
from tests.unit.readers.bags import SECOND, Bag


def in_chunks_of(data, compression):
    """Return an MCAP file whose one chunk is compressed, without an index."""
    pack = {"": bytes, "lz4": lz4.frame.compress, "zstd": zstd.compress}[compression]
    header = 9 + struct.unpack_from("<Q", data, 9)[0]
    at = 8 + header
    start, end, size, crc, length = struct.unpack_from("<QQQII", data, at + 9)
    assert (data[at], length) == (0x06, 0)
    records = data[at + 9 + 40 :][:size]
    packed, name = pack(records), compression.encode()
    chunk = (
        struct.pack("<QQQII", start, end, size, crc, len(name))
        + name
        + struct.pack("<Q", len(packed))
        + packed
    )
    return data[:at] + struct.pack("<BQ", 0x06, len(chunk)) + chunk, at


@pytest.mark.parametrize("compression", ["", "lz4", "zstd"])
def test_an_mcap_file_that_was_cut_off_is_read_so_far_on_request(tmp_path, compression):
    noise = np.random.default_rng(1).random(800)  # blocks of compressed data have to be whole: make several
    with Bag(tmp_path, "mcap") as bag:
        for i in range(150):
            bag.scan("/scan", i, [float(i * i % 17), *np.roll(noise, i)])
    whole, at = in_chunks_of(bag.path.read_bytes(), compression)
    path, counts = tmp_path / "cut.mcap", []
    for end in [at, *(at + (len(whole) - at) * i // 8 for i in range(1, 9))]:
        path.write_bytes(whole[:end])
        with pytest.raises(TraceError) as caught:
            rtamt.read(path)
        assert str(caught.value) == (
            f"'{path}' cannot be read as ROS bag: File end magic is invalid; the file is damaged, incomplete or of "
            "another kind: read it as far as possible with recover=True (--recover)"
        )
        if not counts:
            with pytest.raises(TraceError) as caught:
                rtamt.read(path, recover=True)
            assert str(caught.value) == (
                f"'{path}' is damaged at byte {at} of {end:,}, and no message comes before that"
            )
            counts.append(0)
            continue
        with suppress(TraceError):
            trace = rtamt.read(path, columns=["/scan.ranges[0]"], recover=True)
            values = trace["/scan.ranges[0]"].values.tolist()
            assert values == [float(i * i % 17) for i in range(len(values))]
            counts.append(len(values))
            reached = at if end < len(whole) else end
            last = np.datetime64((len(values) - 1) * SECOND, "ns")
            assert trace.losses == (
                f"the file is damaged at byte {reached:,} of {end:,}: read up to {last} UTC",
            )
    assert counts == sorted(counts)
    assert len(set(counts)) >= 3
    assert counts[-1] == 150


def test_an_mcap_file_whose_index_is_gone_is_read_whole_on_request(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(20):
            bag.plain("/other", i, float(i))
    path = tmp_path / "cut.mcap"
    path.write_bytes(bag.path.read_bytes()[:-100])
    trace = rtamt.read(path, recover=True)
    assert trace["/other.data"].values.tolist() == list(range(20))
    assert trace.losses == ()


def test_check_reads_a_damaged_mcap_file_with_recover_and_notes_what_is_lost(tmp_path, capsys):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(20):
            bag.plain("/other", i, float(i))
    path = tmp_path / "cut.mcap"
    path.write_bytes(bag.path.read_bytes()[:800])
    spec = tmp_path / "a.stl"
    spec.write_text("always(x <= 100)")
    command = ["check", str(spec), str(path), "--time", "dense", "--name", "x=/other.data"]
    assert main(command) == 2
    assert "read it as far as possible with recover=True (--recover)" in capsys.readouterr().err
    junit, page = tmp_path / "a.xml", tmp_path / "a.html"
    assert main([*command, "--recover", "--junit", str(junit), "--html", str(page)]) == 0
    note = "the file is damaged at byte 43 of 800: read up to 1970-01-01T00:00:"
    assert f"note: {path}: {note}" in capsys.readouterr().out
    assert f"<system-out>{note}" in junit.read_text()
    assert f"note: {note}" in page.read_text()
    assert main([*command, "--recover", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["notes"][0].startswith(note)
    assert main(["info", str(path), "--recover"]) == 0
    assert note in capsys.readouterr().out


def test_messages_that_the_metadata_counts_and_the_bag_lacks_are_noted(tmp_path):
    with Bag(tmp_path, "sqlite3") as bag:
        for i in range(4):
            bag.plain("/speed", i, 5.0 - i)
    folder = bag.path.parent
    assert rtamt.read(folder).losses == ()
    with sqlite3.connect(bag.path) as database:
        database.execute("delete from messages where timestamp >= 2000000000")
    database.close()
    trace = rtamt.read(folder)
    assert trace["/speed.data"].values.tolist() == [5, 4]
    assert trace.losses == ("2 of the 4 messages on /speed that the bag counts are not in it",)


def test_a_bag_without_a_line_at_its_beginning_was_read_to_its_end(tmp_path):
    path = tmp_path / "log.bag"
    with open(path, "wb") as file:
        file.truncate(2**40)
    with pytest.raises(TraceError) as error:
        rtamt.read(path)
    assert str(error.value) == (
        f"'{path}' cannot be read as ROS bag: the file does not begin with a line such as #ROSBAG V2.0; the file is "
        f"damaged, incomplete or of another kind: copy or export it again"
    )
