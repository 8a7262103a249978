"""``rtamt check --early`` on bags: it stops at the message that decides, and finds what the whole bag gives."""

from __future__ import annotations

import json

import pytest

from rtamt.cli import main
from tests.unit.readers.bags import Bag

START = 1_700_000_000
#: Violated at 9 s, which the bag shows at 11.25 s.
REQUIREMENT = "always(req >= 3 -> eventually[0:2] gnt >= 3)"
NAMES = ("--name", "req=/req.value", "--name", "gnt=/gnt.data")


def record(bag, *, back=False):
    for i in range(40):
        bag.stamped("/req", START + i, 5.0 if i in {2, 9} else 0.0)
        bag.plain("/gnt", START + i + 0.25, 4.0 if i == 3 else 0.0)
    if back:
        bag.stamped("/req", START + 1, 0.0, late=100)


def check(capsys, bag, *options):
    code = main(["check", REQUIREMENT, str(bag.path), *NAMES, "--json", *options])
    out, err = capsys.readouterr()
    return code, json.loads(out.splitlines()[-1]), err


@pytest.mark.parametrize("kind", ["ros1", "sqlite3", "mcap"])
@pytest.mark.parametrize("how", ["hold", "linear"])
def test_early_check_of_a_bag_that_is_sampled_is_that_of_the_whole_bag(
    tmp_path, capsys, monkeypatch, kind, how
):
    monkeypatch.setattr("rtamt.readers.rosbag._MESSAGES", 5)
    with Bag(tmp_path, kind) as bag:
        record(bag)
    options = ("--period", "500ms", "--how", how)
    code, whole, _ = check(capsys, bag, *options)
    early_code, early, err = check(capsys, bag, *options, "--early")
    assert (code, early_code, err) == (1, 1, "")
    assert (early["satisfied"], early["first_violation"]) == (False, whole["first_violation"])
    assert early["decided_at"] <= START + 12
    assert early["samples"] < whole["samples"]
    assert early["period"] == whole["period"] == 0.5
    assert early["upper"] >= whole["robustness"]


@pytest.mark.parametrize("kind", ["ros1", "sqlite3", "mcap"])
def test_early_check_of_a_bag_in_dense_time_is_that_of_the_whole_bag(tmp_path, capsys, monkeypatch, kind):
    monkeypatch.setattr("rtamt.readers.rosbag._MESSAGES", 5)
    with Bag(tmp_path, kind) as bag:
        record(bag)
    code, whole, _ = check(capsys, bag, "--time", "dense")
    early_code, early, err = check(capsys, bag, "--time", "dense", "--early")
    assert (code, early_code, err) == (1, 1, "")
    assert (early["satisfied"], early["first_violation"]) == (False, whole["first_violation"])
    assert whole["first_violation"] == START + 9
    assert early["decided_at"] == pytest.approx(START + 11.25)
    assert early["samples"] < whole["samples"] == 80
    assert early["upper"] == whole["robustness"] == -2


def test_early_check_of_a_bag_does_not_see_what_was_recorded_later(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("rtamt.readers.rosbag._MESSAGES", 5)
    with Bag(tmp_path, "mcap") as bag:
        record(bag, back=True)
    code, _, err = check(capsys, bag, "--time", "dense")
    assert code == 2
    assert "go back" in err
    code, early, err = check(capsys, bag, "--time", "dense", "--early")
    assert (code, early["first_violation"], err) == (1, START + 9, "")
