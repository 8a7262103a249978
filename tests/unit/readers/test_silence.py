"""A note tells where a signal ends long before the recording: a sensor that failed satisfied its requirements."""

from __future__ import annotations

import json

import pytest

import rtamt
from rtamt.cli import main
from tests.unit.readers.bags import Bag

NOTE = "/x.data has no sample in the last 20 s of the recording: its last value is held"
BOTH = "always(/x.data >= 0 and /y.data >= 0)"


def bag_of(folder, kind, counts):
    """A bag with so many messages of each topic, one a second."""
    with Bag(folder, kind) as bag:
        for i in range(max(counts.values())):
            for topic, count in counts.items():
                if i < count:
                    bag.plain(topic, 100 + i, 1.0)
    return str(bag.path)


@pytest.fixture
def failed(tmp_path):
    """A bag of 30 s in which /x stops after 10 s, and /map is sent twice."""
    return bag_of(tmp_path, "mcap", {"/y": 31, "/x": 11, "/map": 2})


@pytest.mark.parametrize("options", [["--time", "dense"], ["--period", "1"], ["--time", "dense", "--early"]])
def test_a_signal_that_ended_early_had_no_note_beside_the_verdict(failed, capsys, options):
    assert main(["check", BOTH, failed, "--json", *options]) == 0
    assert NOTE in json.loads(capsys.readouterr().out)["notes"]


def test_notes_are_on_regular_signals_beside_others_that_go_on(failed):
    assert rtamt.read(failed).losses == (NOTE,)
    assert rtamt.read(failed, columns=["/x.data"]).losses == ()
    assert rtamt.read(failed, columns=["/map.data", "/y.data"]).losses == ()


def test_a_pause_of_a_few_samples_is_no_silence(tmp_path):
    assert rtamt.read(bag_of(tmp_path, "sqlite3", {"/y": 30, "/x": 20})).losses == ()
