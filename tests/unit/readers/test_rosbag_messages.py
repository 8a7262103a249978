"""What is read of the messages of a bag: their times, and the nearest range of a laser scan."""

from __future__ import annotations

import json
import math

import pytest

import rtamt
from rtamt.cli import main
from rtamt.errors import TraceError
from tests.unit.readers.bags import Bag

START = 1_700_000_000


@pytest.mark.parametrize("kind", ["ros1", "mcap"])
@pytest.mark.parametrize("options", [["--time", "dense"], ["--time", "dense", "--early"], ["--period", "1s"]])
def test_a_violation_in_simulated_time_was_missed_beside_a_topic_with_times_of_recording(
    tmp_path, capsys, kind, options
):
    with Bag(tmp_path, kind) as bag:
        for i in range(5):
            bag.stamped("/x", 1 + i, -1.0 if i == 2 else 1.0, late=START)
            bag.plain("/y", START + 1 + i, 1.0)
    both = 'always("/x.value" >= 0 and "/y.data" >= 0)'
    assert main(["check", both, str(bag.path), "--json", *options]) == 1
    row = json.loads(capsys.readouterr().out)
    assert row["first_violation"] == START + 3
    note = (
        "the stamps in the headers on /x are 1.7e+09 s behind the clock of the recording, which is that of /y: "
        "its messages have the times of their recording"
    )
    assert note in row["notes"]
    assert rtamt.read(bag.path, columns=["/x.value", "/y.data"]).losses == (note,)
    alone = rtamt.read(bag.path, columns=["/x.value"])
    assert (alone["/x.value"].times.tolist(), alone.losses) == ([1, 2, 3, 4, 5], ())


def test_an_obstacle_too_close_to_measure_was_left_out_and_so_were_all_ranges_without_limits(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        for i, ranges in enumerate(
            ([9.0, 3.0, 0.01], [9.0, 0.0], [2.0, -math.inf], [math.inf, math.nan, 0.5])
        ):
            bag.scan("/scan", i + 1, ranges)
            bag.scan("/unset", i + 1, ranges, limits=(0.0, 0.0))
    trace = rtamt.read(bag.path, columns=["/scan.ranges.min"])
    assert trace["/scan.ranges.min"].values.tolist() == [3, math.inf, -math.inf, 0.5]
    with pytest.raises(TraceError) as refused:
        rtamt.read(bag.path, columns=["/unset.ranges.min"])
    assert str(refused.value) == (
        "a laser scan on /unset has no valid range, because its range_min is 0 and its range_max 0: "
        "read single ranges, such as /unset.ranges[0], or correct the driver"
    )


@pytest.mark.parametrize("late", [START, 0])
def test_a_simulation_that_starts_at_0_was_an_error(tmp_path, late):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(5):
            bag.stamped("/x", i / 10, i, late=late)
    trace = rtamt.read(bag.path)
    assert trace["/x.value"].times.tolist() == [0, 0.1, 0.2, 0.3, 0.4]


def test_stamps_that_were_left_at_0_at_first_are_times_of_recording(tmp_path):
    with Bag(tmp_path, "mcap") as bag:
        for i in range(5):
            at = START + i
            bag.stamped("/x", at if i > 1 else 0, i, late=0 if i > 1 else at)
    assert rtamt.read(bag.path)["/x.value"].times.tolist() == [(START + i) * 10**9 for i in range(5)]
